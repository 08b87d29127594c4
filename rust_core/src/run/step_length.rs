//! The length of the next step: fixed, or such that the local error is the requested one.

use serde::{Deserialize, Serialize};

use crate::dynamics::SHORTEST;
use crate::robot::Part;
use crate::scenario::Scenario;
use crate::units::Seconds;

/// [s] Longest step. Rates do not become more accurate by this limit, but observations between steps do.
const LONGEST: Seconds = Seconds(0.016);
/// [s] Length of the first step.
const FIRST: Seconds = Seconds(1e-3);
/// [rad] Largest turn of anything in a step: larger turns would pass over corners without contact.
pub(super) const FARTHEST_TURN: f64 = 0.7;
/// Exponents of the controller, on the last error and on the one before (Gustafsson 1991), and the order of the
/// error.
const PROPORTIONAL: f64 = 0.7;
const MEMORY: f64 = 0.4;
const ORDER: f64 = 2.0;
/// Smallest and largest ratio of a step to the previous one.
const GROWTH: f64 = 2.5;
const SHRINKAGE: f64 = 0.1;
/// Fraction of the accuracy that the next step aims at.
const AIM: f64 = 0.8;
/// A step is taken again if its error exceeds the accuracy by this factor.
const TOO_MUCH: f64 = 1.5;
/// Smallest error in units of the accuracy that the controller remembers.
const LEAST: f64 = 1e-3;
/// [s] Times closer than this are the same.
pub(super) const SAME_TIME: Seconds = Seconds(1e-9);

/// How the length of steps is chosen.
#[derive(Clone, Copy, Debug)]
pub(super) enum StepRule {
    /// [s] Fixed.
    Fixed(f64),
    /// [m] Such that the local error has this value.
    Accuracy { accuracy: f64, longest: f64 },
}

impl StepRule {
    /// The choice of a scenario whose robot has these parts.
    pub(super) fn of(scenario: &Scenario, parts: &[Part]) -> Self {
        match (scenario.solver.accuracy, scenario.solver.time_step) {
            (Some(accuracy), _) => Self::Accuracy {
                accuracy,
                longest: LONGEST
                    .value()
                    .min(FARTHEST_TURN / fastest_turn(scenario, parts)),
            },
            (None, step) => Self::Fixed(step.unwrap_or_default()),
        }
    }
}

/// Decides the length of the next step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct StepControl {
    /// [s] Length that the last errors suggest.
    wanted: f64,
    /// The last error in units of the accuracy.
    last: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            wanted: FIRST.value(),
            last: 1.0,
        }
    }
}

impl StepControl {
    /// [s] Length of the next step, which has to end at `limit` at the latest.
    pub(super) fn next(&self, rule: StepRule, time: f64, limit: f64) -> f64 {
        let (limit, wanted) = match rule {
            StepRule::Fixed(step) => {
                let next = ((time + SAME_TIME.value()) / step).floor() + 1.0;
                (limit.min(next * step), step)
            }
            StepRule::Accuracy { longest, .. } => (limit, self.wanted.min(longest)),
        };
        let left = limit - time;
        if left <= wanted + SAME_TIME.value() {
            left
        } else {
            // Avoids a short step at the end.
            wanted.min(0.5 * left)
        }
    }

    /// Whether a step of `h` [s] with this error [m] is accepted; if not, the length to try instead.
    pub(super) fn judge(&mut self, rule: StepRule, h: f64, error: f64) -> Result<(), f64> {
        let StepRule::Accuracy { accuracy, .. } = rule else {
            return Ok(());
        };
        let ratio = (error / accuracy).max(LEAST);
        let too_much = ratio > TOO_MUCH;
        let share = AIM / ratio;
        if too_much && h > SHORTEST.value() {
            let factor = if ratio.is_finite() {
                libm::pow(share, 1.0 / ORDER).clamp(SHRINKAGE, 0.7)
            } else {
                SHRINKAGE
            };
            self.wanted = (h * factor).max(SHORTEST.value());
            return Err(self.wanted);
        }
        let factor = libm::pow(share, PROPORTIONAL / ORDER) * libm::pow(self.last, MEMORY / ORDER);
        let next = (h * factor.clamp(SHRINKAGE, GROWTH)).max(SHORTEST.value());
        // A step that was cut short does not mean that a longer one fails.
        self.wanted = if factor >= 1.0 {
            next.max(self.wanted)
        } else {
            next
        };
        self.wanted = self.wanted.min(LONGEST.value());
        self.last = ratio;
        Ok(())
    }

    /// A state that no step leaves behind.
    #[cfg(test)]
    pub(super) fn never() -> Self {
        Self {
            wanted: -1.0,
            last: 1.0,
        }
    }

    /// Whether steps can have led to this state.
    pub(super) fn fits(&self) -> bool {
        (SHORTEST.value()..=LONGEST.value()).contains(&self.wanted)
            && self.last.is_finite()
            && self.last > 0.0
    }
}

/// [s] The time after a step, which is exactly `limit` if it is close to that.
pub(super) fn arrive(time: f64, limit: f64) -> f64 {
    if (limit - time).abs() < SAME_TIME.value() {
        limit
    } else {
        time
    }
}

/// [rad/s] Fastest rate at which a wheel or flipper of these parts can be driven.
pub(super) fn fastest_turn(scenario: &Scenario, parts: &[Part]) -> f64 {
    let radii = parts.iter().flat_map(Part::discs);
    let tip = radii.fold(f64::INFINITY, |tip, (outer, _)| tip.min(outer.radius));
    let of_flippers = scenario
        .robot
        .flippers
        .as_ref()
        .map_or(0.0, |f| f.rate_limit);
    of_flippers.max(scenario.robot.drivetrain.max_speed / tip)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // lengths are handed on

    use super::*;
    use crate::geometry::Vector;
    use crate::robot::{Model, Shape};
    use crate::scenario::shared;

    const ACCURACY: f64 = 1e-6;
    const RULE: StepRule = StepRule::Accuracy {
        accuracy: ACCURACY,
        longest: 0.01,
    };

    /// After a step of `h` [s] with an error that is a multiple of the accuracy.
    fn after(h: f64, ratio: f64) -> (StepControl, Result<(), f64>) {
        let mut control = StepControl {
            wanted: h,
            last: 1.0,
        };
        let judged = control.judge(RULE, h, ratio * ACCURACY);
        (control, judged)
    }

    /// Wheels of 30 mm at 1.39 m/s turn by 46.3 rad/s, and by 0.7 rad in 15.1 ms.
    #[test]
    fn nothing_may_turn_by_more_than_0_7_rad_in_a_step() {
        let mut scenario = shared("engineer_flippers_step");
        let model = Model::new(&scenario.robot).expect("it can be built");
        let parts = [0.06, 0.03, 0.04].map(|radius| Part {
            shape: Shape::Disc {
                center: Vector::ZERO,
                radius,
            },
            ..model.parts[0].clone()
        });
        for (max_speed, rate_limit, longest) in [
            (1.39, 1.0, 0.7 * 0.03 / 1.39),
            (1.39, 50.0, 0.7 / 50.0),
            (0.1, 1.0, LONGEST.value()),
        ] {
            scenario.robot.drivetrain.max_speed = max_speed;
            let arms = scenario.robot.flippers.as_mut().expect("it has some");
            arms.rate_limit = rate_limit;
            let StepRule::Accuracy { longest: found, .. } = StepRule::of(&scenario, &parts) else {
                panic!("it has an accuracy");
            };
            assert!((found - longest).abs() < 1e-15, "{found} s");
        }
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(2e-3));
        let rule = StepRule::of(&scenario, &parts);
        assert!(matches!(rule, StepRule::Fixed(step) if step == 2e-3));
    }

    #[test]
    fn a_step_is_repeated_only_where_its_error_exceeds_the_accuracy_by_half() {
        assert_eq!(after(1e-3, 1.49).1, Ok(()));
        for ratio in [1.51, 40.0, f64::INFINITY] {
            let (control, judged) = after(1e-3, ratio);
            let shorter = judged.expect_err("it is off by too much");
            assert!((1e-4..=0.7e-3).contains(&shorter), "{shorter} s");
            assert_eq!(control.wanted, shorter);
        }
        assert_eq!(after(SHORTEST.value(), 40.0).1, Ok(()));
    }

    #[test]
    fn errors_of_the_third_order_settle_where_the_controller_keeps_its_length() {
        let mut control = StepControl::default();
        let mut h = 1e-4;
        for _ in 0..200 {
            control
                .judge(RULE, h, ACCURACY * (h / 2e-3_f64).powi(3))
                .ok();
            h = control.next(RULE, 0.0, f64::INFINITY);
        }
        // (AIM / r)^0.35 r^0.2 is 1 at this share of the accuracy.
        let ratio: f64 = AIM.powf(0.35 / 0.15);
        let settled = 2e-3 * ratio.cbrt();
        assert!((h - settled).abs() < 1e-6 * settled, "{h} s, {settled} s");
    }

    #[test]
    fn a_step_that_ends_near_its_limit_ends_there() {
        assert_eq!(arrive(2.0 - 0.9e-9, 2.0), 2.0);
        assert_eq!(arrive(2.0 + 0.9e-9, 2.0), 2.0);
        assert_eq!(arrive(2.0 - 1.1e-9, 2.0), 2.0 - 1.1e-9);
    }

    #[test]
    fn a_step_that_was_cut_short_says_nothing_against_a_longer_one() {
        let (mut control, _) = after(4e-3, 0.6);
        let wanted = control.wanted;
        control
            .judge(RULE, 1e-4, 1e-5 * ACCURACY)
            .expect("it will do");
        assert_eq!(control.wanted, wanted);
        let next = control.next(RULE, 1.0, f64::INFINITY);
        assert_eq!(next, wanted);
    }

    #[test]
    fn no_short_step_is_left_for_the_end() {
        let (control, _) = after(4e-3, 0.6);
        let wanted = control.wanted;
        assert_eq!(
            control.next(RULE, 1.0, 1.0 + 0.9 * wanted),
            1.0 + 0.9 * wanted - 1.0
        );
        let half = control.next(RULE, 0.0, 1.2 * wanted);
        assert_eq!(half, 0.6 * wanted);
    }

    #[test]
    fn steps_of_a_given_length_end_at_its_multiples() {
        let rule = StepRule::Fixed(0.25);
        let mut control = StepControl::default();
        assert_eq!(control.judge(rule, 0.25, f64::INFINITY), Ok(()));
        assert_eq!(control.next(rule, 0.5, f64::INFINITY), 0.25);
        assert_eq!(control.next(rule, 0.625, f64::INFINITY), 0.125);
        assert_eq!(control.next(rule, 0.5, 0.5625), 0.0625);
    }

    #[test]
    fn only_what_steps_lead_to_is_taken_from_a_snapshot() {
        assert!(StepControl::default().fits());
        assert!(!StepControl::never().fits());
        let control = |wanted: f64, last: f64| StepControl { wanted, last };
        assert!(control(LONGEST.value(), LEAST).fits());
        assert!(control(SHORTEST.value(), 1.0).fits());
        for wanted in [1.1 * LONGEST.value(), 0.9 * SHORTEST.value(), 0.0, f64::NAN] {
            assert!(!control(wanted, 1.0).fits());
        }
        for last in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(!control(1e-3, last).fits());
        }
    }
}
