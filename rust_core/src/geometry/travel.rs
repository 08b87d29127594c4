//! Position and motion of what a belt carries along an envelope.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::envelope::Envelope;
use super::stretch::{Form, Stretch};
use super::{Pose, Vector, right_of};

/// How a belt along the hull moves what it carries, per metre of belt travel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// [m] Centre of the clockwise turn.
    pub center: Vector,
    /// [1/m] Turn.
    pub turn: f64,
    /// Translation, in addition.
    pub along: Vector,
}

impl Motion {
    /// The same motion, seen from a frame in which its own frame is at `pose`.
    pub(crate) fn seen_from(self, pose: Pose) -> Self {
        Self {
            center: pose.transform_point(self.center),
            turn: self.turn,
            along: pose.rotation * self.along,
        }
    }

    /// Displacement of a point, per metre of belt travel.
    pub(crate) fn at(&self, point: Vector) -> Vector {
        right_of(point - self.center) * self.turn + self.along
    }

    /// Mixes in a share of another motion; at most one of the two turns.
    fn mixed(self, other: Self, share: f64) -> Self {
        Self {
            center: if self.turn == 0.0 {
                other.center
            } else {
                self.center
            },
            turn: self.turn * (1.0 - share) + other.turn * share,
            along: self.along * (1.0 - share) + other.along * share,
        }
    }
}

impl Stretch {
    /// How a belt moves what it carries on this stretch.
    fn motion(&self) -> Motion {
        match self.shape {
            Form::Arc { center, radius, .. } => Motion {
                center,
                turn: 1.0 / radius,
                along: Vector::ZERO,
            },
            Form::Run { along, .. } => Motion {
                along,
                ..Motion::default()
            },
        }
    }
}

impl Envelope {
    /// The point at a position `way` [m] along the hull, and the outward normal there.
    pub(crate) fn place_at(&self, way: f64) -> (Vector, Vector) {
        let way = way.rem_euclid(self.length());
        let stretch = self.stretch_at(way);
        let point = stretch.point_at(way - stretch.start);
        let outward = match stretch.shape {
            Form::Arc { center, radius, .. } => (point - center) / radius,
            Form::Run { outward, .. } => outward,
        };
        (point, outward)
    }

    /// [rad] Direction of belt travel at a position [m] along the hull; it counts full turns.
    pub(crate) fn angle_at(&self, way: f64) -> f64 {
        let inside = way.rem_euclid(self.length());
        // Not the floor of the quotient, which rounding may lift to the next round.
        let rounds = ((way - inside) / self.length()).round();
        let turned = |stretch: &Stretch| match stretch.shape {
            Form::Arc { sweep, .. } if inside > stretch.start => {
                sweep * ((inside - stretch.start) / stretch.length).min(1.0)
            }
            _ => 0.0,
        };
        let turns: f64 = self.stretches.iter().map(turned).sum();
        let outward = match self.stretches[0].shape {
            Form::Arc { from, .. } => from,
            Form::Run { outward, .. } => libm::atan2(outward.y, outward.x),
        };
        outward - FRAC_PI_2 - turns - TAU * rounds
    }

    /// Mean motion of what a belt carries within `reach` [m] of a position along the hull; averaged because the
    /// motion of a tip would jump where an arc joins a run.
    pub(crate) fn motion_at(&self, way: f64, reach: f64) -> Motion {
        let way = way.rem_euclid(self.length());
        let here = self.stretch_at(way);
        // The nearer joint of the stretch, and how much of the span lies beyond it.
        let (behind, ahead) = (way - here.start, here.start + here.length - way);
        let (gap, beyond) = if behind < ahead {
            (behind, here.start - behind)
        } else {
            (ahead, way + 2.0 * ahead)
        };
        let mut motion = here.motion();
        if gap < reach && self.stretches.len() > 1 {
            let share = 0.5 * (1.0 - gap / reach);
            let beyond = beyond.rem_euclid(self.length());
            motion = motion.mixed(self.stretch_at(beyond).motion(), share);
        }
        motion
    }
}
