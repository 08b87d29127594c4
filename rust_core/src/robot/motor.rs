//! The force of motors at a speed, and how they control the speed.
//!
//! The equations: docs/physics.md, "Motors".

use crate::scenario::{Drivetrain, TrackOutline};

/// One of the equal motors of a robot, with all quantities at its surface.
#[derive(Clone, Debug)]
pub struct MotorRule {
    /// [N] Its largest force, at rest.
    pub force: f64,
    /// [kg] Mass at the surface that is equivalent to the inertia of its rotor.
    pub rotor_mass: f64,
    /// [m/s] Speeds of the surface, from 0, and fractions of the largest force there; empty if the force does not
    /// depend on speed.
    pub(crate) curve: Vec<[f64; 2]>,
    /// How it corrects its speed; `None` if it holds the speed exactly.
    pub(crate) correction: Option<Correction>,
    /// Whether its gear is self-locking: the load turns it neither back nor faster than the motor.
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

/// A force that decreases linearly with the speed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// [N]
    pub at_rest: f64,
    /// [N s/m]
    pub slope: f64,
}

/// The largest force near a speed, from one piece of a curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub line: Line,
    /// [m/s] The lowest and the highest speed of the piece.
    pub ends: [f64; 2],
}

impl Piece {
    /// The same for a motor that turns in the other direction.
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
    /// Its force at a speed, a `time` [s] after the error of the speed was `error` [m/s] and the integral term
    /// `integral` [N].
    pub(crate) fn force(&self, target: f64, error: f64, integral: f64, time: f64) -> Line {
        let later = 0.5 * time * self.integral;
        let slope = self.gain + later;
        Line {
            at_rest: slope * target + later * error + integral,
            slope,
        }
    }
}

/// The speed or rate that a motor holds for a command: without force or torque, a self-locking gear stays at rest.
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
        // Forces at the belt are torques over the radius, and a rate is a speed over the radius.
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

    /// One of several motors that together replace a number of motors like this one.
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

    /// [m/s] The speed of the surface that it holds for a command; with a self-locking gear, no speed at which it has
    /// no force.
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

    /// Its largest forward force near a speed. Against its motion, it has the same force as at rest.
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

    /// Whether its force depends on its speed, apart from the limits within which it holds the speed.
    pub(crate) fn depends_on_speed(&self) -> bool {
        !self.curve.is_empty() || self.correction.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::shared;

    impl Line {
        fn at(self, speed: f64) -> f64 {
            self.at_rest - self.slope * speed
        }
    }

    /// Whether two forces [N] are the same except for rounding.
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

    /// Without torque there is no share of it at any speed.
    #[test]
    fn a_curve_of_torques_is_one_of_shares_of_the_largest() {
        let mut robot = shared("engineer_belt_step").robot;
        let mut curve = |most: f64, torques: Option<[[f64; 2]; 3]>| {
            robot.drivetrain.max_torque = most;
            robot.drivetrain.no_load_speed = torques.is_none().then_some(0.75);
            robot.drivetrain.torque_curve = torques.map(|curve| curve.to_vec());
            MotorRule::of(&robot.drivetrain, &robot.outline).curve
        };
        let falls = [[0.0, 8.0], [0.25, 2.0], [0.5, 0.0]];
        let shares = [[0.0, 1.0], [0.25, 0.25], [0.5, 0.0]];
        assert_eq!(curve(8.0, Some(falls)), shares);
        let none = falls.map(|[speed, _]| [speed, 0.0]);
        assert_eq!(curve(0.0, Some(none)), none);
        assert_eq!(curve(8.0, None), [[0.0, 1.0], [0.75, 0.0]]);
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
