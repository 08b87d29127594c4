//! What the motors of a robot can do at a speed, and how they correct it.
//!
//! The equations: docs/physics.md, "Motors".

use crate::scenario::{Drivetrain, TrackOutline};

/// One of the equal motors of a robot, as its surface feels it.
#[derive(Clone, Debug)]
pub struct MotorRule {
    /// [N] Its largest force, which it has at rest.
    pub force: f64,
    /// [kg] Mass at the surface that would be as hard to speed up as its rotor.
    pub rotor_mass: f64,
    /// [m/s] Speeds of the surface, from 0, and shares of the largest force there; none if that is there at any speed.
    pub(crate) curve: Vec<[f64; 2]>,
    /// How it corrects its speed; `None` if it holds that.
    pub(crate) correction: Option<Correction>,
    /// Its gear locks itself: the load turns it neither back nor faster than it turns by itself.
    pub(crate) self_locking: bool,
}

/// Force of a motor against an error of its speed, and against the sum of those errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    /// [N s/m]
    pub gain: f64,
    /// [N/m]
    pub integral: f64,
}

/// A force that falls in a line with the speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// [N]
    pub at_rest: f64,
    /// [N s/m]
    pub slope: f64,
}

/// A largest force near a speed: that of one piece of a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub line: Line,
    /// [m/s] The lowest and the highest speed of the piece.
    pub ends: [f64; 2],
}

impl Piece {
    /// The same of a motor that turns the other way.
    fn reversed(self) -> Self {
        let [low, high] = self.ends;
        let at_rest = -self.line.at_rest;
        Self {
            line: Line {
                at_rest,
                ..self.line
            },
            ends: [-high, -low],
        }
    }
}

impl Correction {
    /// Its force at a speed, a `time` [s] after the error of that was `error` [m/s] and the sum of errors made `integral` [N].
    pub(crate) fn force(&self, target: f64, error: f64, integral: f64, time: f64) -> Line {
        let later = 0.5 * time * self.integral;
        let slope = self.gain + later;
        Line {
            at_rest: slope * target + later * error + integral,
            slope,
        }
    }
}

/// The speed or rate that a motor holds where one is commanded: without a force or torque to give, a gear that locks
/// itself stays at rest.
pub(crate) fn held_speed(commanded: f64, most: f64, self_locking: bool) -> f64 {
    if most > 0.0 || !self_locking {
        commanded
    } else {
        0.0
    }
}

impl MotorRule {
    /// Both tracks' motors together.
    pub(super) fn of(drivetrain: &Drivetrain, outline: &TrackOutline) -> Self {
        let radius = outline.belt_radius();
        // Of what one sprocket feels, a share of its radius acts at the belt; a rate is a speed over the radius.
        let at_belt = 2.0 / (radius * radius);
        let most = drivetrain.max_torque;
        let line = drivetrain
            .no_load_speed
            .map(|speed| vec![[0.0, 1.0], [speed, 0.0]]);
        let curve = drivetrain.torque_curve.as_ref().map(|curve| {
            let share = |torque: f64| if most > 0.0 { torque / most } else { 0.0 };
            curve
                .iter()
                .map(|[speed, torque]| [*speed, share(*torque)])
                .collect()
        });
        Self {
            force: drivetrain.max_force(outline),
            rotor_mass: drivetrain.rotor_inertia * at_belt,
            curve: line.or(curve).unwrap_or_default(),
            correction: drivetrain.controller.map(|pi| Correction {
                gain: pi.gain * at_belt,
                integral: pi.integral * at_belt,
            }),
            self_locking: drivetrain.self_locking,
        }
    }

    /// One of so many motors that do together what some motors like this one do.
    pub(super) fn shared(&self, now: usize, among: usize) -> Self {
        let share = |of_one: f64| of_one * now as f64 / among as f64;
        Self {
            force: share(self.force),
            rotor_mass: share(self.rotor_mass),
            correction: self.correction.map(|correction| Correction {
                gain: share(correction.gain),
                integral: share(correction.integral),
            }),
            ..self.clone()
        }
    }

    /// [m/s] The speed of the surface that it holds where that is commanded: behind a gear that locks itself none at which it
    /// has no force left.
    pub(crate) fn target(&self, commanded: f64) -> f64 {
        let held = held_speed(commanded, self.force, self.self_locking);
        let spent = self.curve.iter().find(|[_, share]| *share <= 0.0);
        match spent {
            Some([fastest, _]) if self.self_locking => held.clamp(-fastest, *fastest),
            _ => held,
        }
    }

    /// Its largest forces near a speed [m/s] of the surface, forwards and backwards.
    pub(crate) fn limits(&self, speed: f64) -> [Piece; 2] {
        [self.limit(speed), self.limit(-speed).reversed()]
    }

    /// Its largest force forwards near a speed. Against its motion it has the force that it has at rest.
    fn limit(&self, speed: f64) -> Piece {
        let level = |share: f64, ends: [f64; 2]| Piece {
            line: Line {
                at_rest: share * self.force,
                slope: 0.0,
            },
            ends,
        };
        let Some(&[fastest, last]) = self.curve.last() else {
            return level(1.0, [f64::NEG_INFINITY, f64::INFINITY]);
        };
        if speed < 0.0 {
            return level(1.0, [f64::NEG_INFINITY, 0.0]);
        }
        let mut pieces = self.curve.iter().zip(self.curve.iter().skip(1));
        let Some((&[from, share], &[to, next])) = pieces.find(|(_, [to, _])| speed < *to) else {
            return level(last, [fastest, f64::INFINITY]);
        };
        let slope = (share - next) / (to - from) * self.force;
        Piece {
            line: Line {
                at_rest: share * self.force + slope * from,
                slope,
            },
            ends: [from, to],
        }
    }

    /// Whether its force depends on its speed, but for its limits where it holds that.
    pub(crate) fn depends_on_speed(&self) -> bool {
        !self.curve.is_empty() || self.correction.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Line {
        fn at(self, speed: f64) -> f64 {
            self.at_rest - self.slope * speed
        }
    }

    /// Whether two forces [N] are the same but for rounding.
    fn is(found: f64, expected: f64) -> bool {
        (found - expected).abs() < 1e-12
    }

    fn rule(curve: &[[f64; 2]]) -> MotorRule {
        MotorRule {
            force: 100.0,
            rotor_mass: 0.0,
            curve: curve.to_vec(),
            correction: None,
            self_locking: false,
        }
    }

    #[test]
    fn behind_a_lock_it_turns_no_faster_than_by_itself() {
        let locks = |curve: &[[f64; 2]], force: f64| MotorRule {
            force,
            self_locking: true,
            ..rule(curve)
        };
        let falls = [[0.0, 1.0], [1.0, 0.8], [2.0, 0.0], [3.0, 0.0]];
        for (rule, commanded, expected) in [
            (locks(&[], 100.0), 9.0, 9.0),
            (locks(&[], 0.0), 9.0, 0.0),
            (locks(&falls, 100.0), 9.0, 2.0),
            (locks(&falls, 100.0), -9.0, -2.0),
            (locks(&falls, 100.0), 1.5, 1.5),
            (rule(&falls), 9.0, 9.0),
        ] {
            assert!(is(rule.target(commanded), expected));
        }
    }

    #[test]
    fn a_motor_without_a_curve_has_its_force_at_any_speed() {
        for speed in [-3.0, 0.0, 3.0] {
            let [most, least] = rule(&[]).limits(speed).map(|limit| limit.line.at(speed));
            assert!(is(most, 100.0) && is(least, -100.0));
        }
    }

    #[test]
    fn its_force_follows_the_curve_forwards_and_brakes_with_all_of_it() {
        let rule = rule(&[[0.0, 1.0], [1.0, 0.8], [2.0, 0.0]]);
        for (speed, expected) in [
            (0.0, 100.0),
            (0.5, 90.0),
            (1.0, 80.0),
            (1.5, 40.0),
            (2.0, 0.0),
            (5.0, 0.0),
        ] {
            let [most, least] = rule.limits(speed).map(|limit| limit.line.at(speed));
            assert!(is(most, expected), "{most} N at {speed} m/s");
            let brakes = if speed > 0.0 { -100.0 } else { -expected };
            assert!(is(least, brakes), "{least} N at {speed} m/s");
            let [forwards, backwards] = rule.limits(-speed).map(|limit| limit.line.at(-speed));
            assert!(is(forwards, -least) && is(backwards, -most));
        }
    }
}
