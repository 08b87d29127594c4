//! A belt that runs along an envelope: the motion of points on it, and its grousers.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use super::envelope::Envelope;
use super::hull::{Curve, Stretch};
use super::{Pose, Rotation, Vector, right_of};
use crate::scenario::{MAX_GROUSERS, ScenarioError, TrackOutline};

/// Motion of anything on a belt along the hull, per metre of belt travel.
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
    /// The same motion in a frame where its own frame has this `pose`.
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

    /// Interpolates between this motion and another one, of which at most one turns.
    fn mixed(self, other: Self, fraction: f64) -> Self {
        Self {
            center: if self.turn == 0.0 {
                other.center
            } else {
                self.center
            },
            turn: self.turn * (1.0 - fraction) + other.turn * fraction,
            along: self.along * (1.0 - fraction) + other.along * fraction,
        }
    }
}

impl Stretch {
    /// Motion of anything on a belt on this stretch.
    fn motion(&self) -> Motion {
        match self.curve {
            Curve::Arc(arc) => Motion {
                center: arc.center,
                turn: 1.0 / arc.radius,
                along: Vector::ZERO,
            },
            Curve::Run(run) => Motion {
                along: run.along,
                ..Motion::default()
            },
        }
    }
}

impl Envelope {
    /// The point at a position [m] along the hull, and the outward normal there.
    pub(crate) fn place_at(&self, position: f64) -> (Vector, Vector) {
        let position = position.rem_euclid(self.length());
        let stretch = self.stretch_at(position);
        let point = stretch.point_at(position - stretch.start);
        let outward = match stretch.curve {
            Curve::Arc(arc) => (point - arc.center) / arc.radius,
            Curve::Run(run) => run.outward,
        };
        (point, outward)
    }

    /// [rad] Direction of belt travel at a position [m] along the hull; it counts full turns.
    pub(crate) fn angle_at(&self, position: f64) -> f64 {
        let inside = position.rem_euclid(self.length());
        // Not the floor of the quotient, which rounding may raise to the next round.
        let rounds = ((position - inside) / self.length()).round();
        let turned = |stretch: &Stretch| match stretch.curve {
            Curve::Arc(arc) if inside > stretch.start => {
                arc.sweep * ((inside - stretch.start) / stretch.length).min(1.0)
            }
            _ => 0.0,
        };
        let turns: f64 = self.stretches.iter().map(turned).sum();
        let outward = match self.stretches[0].curve {
            Curve::Arc(arc) => arc.from,
            Curve::Run(run) => libm::atan2(run.outward.y, run.outward.x),
        };
        outward - FRAC_PI_2 - turns - TAU * rounds
    }

    /// Motion of a belt, averaged within `reach` [m] of a position along the hull: otherwise the motion of a tip would
    /// jump where an arc joins a run.
    pub(crate) fn motion_at(&self, position: f64, reach: f64) -> Motion {
        let position = position.rem_euclid(self.length());
        let (number, count) = (self.number_at(position), self.stretches.len());
        let here = &self.stretches[number];
        // The nearer joint of the stretch, and the fraction of the span beyond it.
        let (behind, ahead) = (position - here.start, here.start + here.length - position);
        let (gap, beyond) = if behind < ahead {
            (behind, number + count - 1)
        } else {
            (ahead, number + 1)
        };
        let mut motion = here.motion();
        if gap < reach && count > 1 {
            let fraction = 0.5 * (1.0 - gap / reach);
            motion = motion.mixed(self.stretches[beyond % count].motion(), fraction);
        }
        motion
    }
}

/// A grouser fixed to a belt, which carries it along.
#[derive(Clone, Debug)]
pub struct Grouser {
    /// The line of the belt.
    belt: Arc<Envelope>,
    /// [m] Position along the line at the start.
    position: f64,
    /// [m] Corners, counter-clockwise, x along the belt's travel and y outwards from its line.
    corners: [Vector; 4],
}

impl Grouser {
    /// A grouser with a height and thickness [m] that starts at a position [m] on the belt's line.
    pub(crate) fn new(belt: &Arc<Envelope>, position: f64, height: f64, thickness: f64) -> Self {
        let half = 0.5 * thickness;
        // It extends into the belt, so that no corner of the ground can get under it where the belt bends.
        let corner = |x: f64, y: f64| Vector::new(x, y);
        Self {
            belt: Arc::clone(belt),
            position,
            corners: [
                corner(-half, -half),
                corner(half, -half),
                corner(half, height),
                corner(-half, height),
            ],
        }
    }

    /// The evenly spaced grousers of a belt: the given number, or the one closest to the outline's pitch.
    ///
    /// # Errors
    /// The pitch requires more grousers than a belt may have.
    pub(crate) fn along(
        line: &Arc<Envelope>,
        count: Option<u32>,
        height: f64,
        outline: &TrackOutline,
    ) -> Result<impl Iterator<Item = Self> + use<>, ScenarioError> {
        let length = line.length();
        let count = match count {
            Some(count) => count,
            None => outline.pitches_along(length, [1, MAX_GROUSERS])?,
        };
        let pitch = length / f64::from(count);
        let (line, thickness) = (Arc::clone(line), outline.grouser_thickness);
        Ok((0..count).map(move |i| Self::new(&line, f64::from(i) * pitch, height, thickness)))
    }

    /// [m] Its corners in its own frame, counter-clockwise.
    pub fn corners(&self) -> &[Vector; 4] {
        &self.corners
    }

    /// Its frame in the chassis frame when the belt has run by `run` [m].
    pub fn place(&self, run: f64) -> Pose {
        let (point, outward) = self.belt.place_at(self.position + run);
        // Turns +y outwards.
        let rotation = Rotation::from_cos_sin_unchecked(outward.y, -outward.x);
        Pose::from_parts(point, rotation)
    }

    /// [m] Position along the belt's line at which it starts.
    pub fn start(&self) -> f64 {
        self.position
    }

    /// [rad] Angle of that frame; it counts full turns.
    pub(crate) fn angle(&self, run: f64) -> f64 {
        self.belt.angle_at(self.position + run)
    }

    /// Motion of a point [m] of the chassis frame with the belt when that has run by `run` [m]: as part of this
    /// grouser, unless the grouser is elsewhere.
    pub(crate) fn motion_where(&self, run: f64, point: Vector) -> Motion {
        let reach = self
            .corners
            .map(Vector::length)
            .into_iter()
            .fold(0.0, f64::max);
        if (self.place(run).translation - point).length() <= 1.1 * reach {
            return self.motion(run, 0.0);
        }
        self.belt.motion_at(self.belt.position_of(point), 0.0)
    }

    /// Its motion there, averaged while the belt runs from `reach` [m] before to `reach` after.
    pub(crate) fn motion(&self, run: f64, reach: f64) -> Motion {
        self.belt.motion_at(self.position + run, reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Disc;

    #[test]
    fn a_point_moves_with_a_grouser_that_it_is_on_and_else_with_the_belt() {
        let disc = |x: f64| Disc {
            center: Vector::new(x, 0.0),
            radius: 0.1,
        };
        let belt = Arc::new(Envelope::new(&[disc(-0.3), disc(0.3)]));
        let arc = 0.1 * 0.5 * TAU;
        let grouser = Grouser::new(&belt, 0.5 * arc, 0.02, 0.008);
        let place = grouser.place(0.0).translation;
        let on_run = belt.motion_at(arc + 0.3, 0.0);
        let turns = |point: Vector| grouser.motion_where(0.0, point).turn.abs();
        assert!((turns(place) - 10.0).abs() < 1e-9 && on_run.turn == 0.0);
        let far = belt.point_at(arc + 0.3);
        assert!(turns(far) < 1e-9);
    }

    #[test]
    fn near_a_joint_the_motion_is_mixed_with_that_beyond_it() {
        let disc = |x: f64| Disc {
            center: Vector::new(x, 0.0),
            radius: 0.1,
        };
        let hull = Envelope::new(&[disc(-0.3), disc(0.3)]);
        let (arc, reach) = (0.1 * 0.5 * TAU, 0.02);
        let half = hull.length() / 2.0;
        assert!((half - arc - 0.6).abs() < 1e-12);
        // It begins on an arc, whose turn is 1 / radius; within reach of a joint it fades to that of a run, which is 0.
        let begin = hull.motion_at(0.5 * arc, reach).turn;
        assert!((begin.abs() - 10.0).abs() < 1e-9);
        for joint in [0.0, arc, half, half + arc] {
            for (way, share) in [(0.0, 0.5), (0.25, 0.375), (0.5, 0.25), (1.5, 0.0)] {
                for side in [-1.0, 1.0] {
                    let at = joint + side * (way * reach + 1e-9);
                    let inside = (at.rem_euclid(half)) < arc;
                    let expected = begin * if inside { 1.0 - share } else { share };
                    let found = hull.motion_at(at, reach).turn;
                    assert!(
                        (found - expected).abs() < 1e-5,
                        "{joint} {way} {side}: {found}"
                    );
                }
            }
        }
    }

    /// The motion is averaged over a span, part of which is on an arc and the rest on a run.
    #[test]
    fn a_grouser_moves_as_its_motion_says() {
        let discs = [(0.0, 0.1), (0.4, 0.06)].map(|(x, radius)| Disc {
            center: Vector::new(x, 0.0),
            radius,
        });
        let belt = Arc::new(Envelope::new(&discs));
        let grouser = Grouser::new(&belt, 0.03, 0.02, 0.008);
        let reach = 1e-5;
        let joints: Vec<f64> = belt.stretches.iter().map(|stretch| stretch.start).collect();
        assert_eq!(joints.len(), 4);
        let shares = [-2.0, -0.9, -0.4, 0.0, 0.3, 0.8, 2.0];
        for run in joints
            .iter()
            .flat_map(|joint| shares.map(|share| joint - 0.03 + share * reach))
        {
            let tip = grouser.corners()[2];
            let at = |run: f64| grouser.place(run).transform_point(tip);
            let moved = (at(run + reach) - at(run - reach)) / (2.0 * reach);
            let off = (grouser.motion(run, reach).at(at(run)) - moved).length();
            // A point of an arc of 0.06 m turns by 2e-4 rad meanwhile.
            assert!(off < 5e-4, "{off} of {moved} after {run} m");
        }
    }

    /// With a disc of 0.1 m at either end.
    fn stadium() -> Arc<Envelope> {
        let discs = [-0.3, 0.3].map(|x| Disc {
            center: Vector::new(x, 0.0),
            radius: 0.1,
        });
        Arc::new(Envelope::new(&discs))
    }

    #[test]
    fn grousers_stand_equally_far_apart_all_round_the_belt() {
        let belt = stadium();
        let outline = TrackOutline {
            discs: TrackOutline::two_discs(0.6, [0.12, 0.12]),
            grouser_height: 0.02,
            grouser_pitch: 0.1,
            grouser_thickness: 0.008,
        };
        // The belt is 1.828 m long.
        for (given, count) in [(None, 18), (Some(7), 7)] {
            let grousers = Grouser::along(&belt, given, 0.02, &outline).expect("not too many");
            let mut starts: Vec<f64> = grousers.map(|grouser| grouser.start()).collect();
            assert_eq!(starts.len(), count);
            starts.push(starts[0] + belt.length());
            for pair in starts.windows(2) {
                let off = pair[1] - pair[0] - belt.length() / count as f64;
                assert!(off.abs() < 1e-12, "{starts:?}");
            }
        }
    }

    #[test]
    fn the_direction_of_travel_turns_clockwise_once_per_round_and_never_jumps() {
        let belt = stadium();
        let step = belt.length() / 1000.0;
        let angle = |i: i32| belt.angle_at(f64::from(i) * step);
        for i in -2000..2000 {
            let turned = angle(i) - angle(i + 1);
            // By the step over the radius on an arc, and by nothing on a run.
            let most = step / 0.1 + 1e-9;
            assert!((-1e-9..=most).contains(&turned), "{turned} rad at {i}");
            let round = angle(i) - angle(i + 1000);
            assert!((round - TAU).abs() < 1e-9, "{round} rad from {i}");
        }
    }
}
