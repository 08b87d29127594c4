//! The push that frees a robot from a stop.

use super::{Simulation, ValidScenario};
use crate::error::Error;
use crate::limits::Cancel;
use crate::observe::Outcome;
use crate::scenario::ScenarioError;

/// First and last level of the push, in weights, and the ratio of consecutive levels.
const LEVELS: (f64, f64, f64) = (0.01, 10.0, 1.1);
/// [s] Shortest time for which a level is held, and duration of the rise to it.
const HOLD: f64 = 0.5;
const RISE: f64 = 0.1;
/// [m] A robot that moves by more in the last half of a hold is still moving, and the level is held again, at most
/// this many times: just beyond its limit, a robot takes seconds to leave.
const SETTLED: f64 = 5e-5;
const HOLDS: usize = 10;
/// [s] Duration of the push after the robot is free, to see whether it tips over.
const AFTERWARDS: f64 = 2.0;

/// A measured escape force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapeForce {
    /// [N] The last level that did not free the robot; 0 if the first did.
    pub low: f64,
    /// [N] The first level that freed it: it got `criteria.escape_distance` farther than before; infinite if none did.
    pub high: f64,
    /// That push tipped it over.
    pub tips: bool,
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and measures the push along the command that
/// frees the robot.
///
/// # Errors
/// As [`simulate`](crate::simulate), [`Error::Interrupted`] once `cancel` is asked, and [`Error::Scenario`] without
/// gravity.
pub fn escape_force(
    scenario: &ValidScenario,
    at: f64,
    cancel: &Cancel,
) -> Result<EscapeForce, Error> {
    let stop = Simulation::replayed(scenario, at, cancel)?;
    let weight = stop.weight();
    if weight <= 0.0 {
        let rule = "must be > 0 for an escape force, whose levels are shares of the weight";
        return Err(ScenarioError::new("gravity", 0.0, rule).into());
    }
    let mut robot = stop.copy();
    let (direction, greatest) = (robot.direction(), stop.monitor().best_advance());
    let far = stop.scenario().criteria.escape_distance;
    let is_on = |robot: &Simulation| {
        let ahead = direction * robot.reading().position.x - greatest;
        ahead > far || robot.monitor().ended_as().is_some()
    };
    let tips = |robot: &Simulation| robot.monitor().ended_as() == Some(Outcome::TippedOver);
    let begin = robot.reading().position;
    let way = |robot: &Simulation| (robot.reading().position - begin).length();
    let (first, last, ratio) = LEVELS;
    let (mut low, mut level) = (0.0, first * weight);
    while level <= last * weight {
        robot.raise_push(direction * level, RISE)?;
        for _ in 0..HOLDS {
            let mut leaves = advance_until(&mut robot, 0.5 * HOLD, &is_on, cancel)?;
            let half_way = way(&robot);
            leaves = leaves || advance_until(&mut robot, 0.5 * HOLD, &is_on, cancel)?;
            if leaves {
                return Ok(EscapeForce {
                    low,
                    high: level,
                    tips: advance_until(&mut robot, AFTERWARDS, &tips, cancel)?,
                });
            }
            if (way(&robot) - half_way).abs() < SETTLED {
                break;
            }
        }
        (low, level) = (level, level * ratio);
    }
    Ok(EscapeForce {
        low,
        high: f64::INFINITY,
        tips: false,
    })
}

/// Advances by a time [s], or until a condition is true; returns whether it is.
fn advance_until(
    robot: &mut Simulation,
    time: f64,
    until: &dyn Fn(&Simulation) -> bool,
    cancel: &Cancel,
) -> Result<bool, Error> {
    let end = robot.time() + time;
    while robot.time() < end {
        robot.step_until(end)?;
        cancel.check()?;
        if until(robot) {
            return Ok(true);
        }
    }
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{ForceSupport, ForceTrack, Track, shared};

    /// The Engineer without motor force on skids of some friction, 1 m in front of a step, its centre of mass that high [m] over
    /// its axles.
    fn skids(skid_friction: f64, height: f64) -> ValidScenario {
        let mut scenario = shared("engineer_belt_step");
        scenario.robot.track = Track::Force(ForceTrack {
            support: ForceSupport::Skids,
            skid_friction,
            wheel_count: 5,
        });
        scenario.robot.drivetrain.max_torque = 0.0;
        scenario.robot.center_of_mass = [0.0, height];
        scenario.start.approach = 1.0;
        ValidScenario::new(&scenario).expect("it is valid")
    }

    /// Of its weight, 21.2 kg x 9.81 m/s^2 = 207.972 N, the first level is a hundredth, and each is 1.1 times the one
    /// before: 1.1^16 / 100 = 0.0459, 1.1^17 / 100 = 0.0505.
    #[test]
    fn the_force_lies_between_two_levels_from_a_hundredth_of_the_weight_on() {
        for (friction, low, high) in [(0.0, 0.0, 2.079_72), (0.048, 9.556_26, 10.511_88)] {
            let found = escape_force(&skids(friction, 0.02), 0.1, &Cancel::default());
            let found = found.expect("it stays finite");
            assert!((found.low - low).abs() < 1e-4, "{found:?}");
            assert!((found.high - high).abs() < 1e-4, "{found:?}");
            assert!(!found.tips, "{found:?}");
        }
    }

    /// Its axles are 0.365 m apart and 0.064 m over the ground, so a push 0.3 m above them tips it about the front one from
    /// 0.1825 / 0.364 = 0.5014 of its weight on, that is between 1.1^41 / 100 and 1.1^42 / 100. Its friction would bear all of it.
    #[test]
    fn a_push_high_above_skids_that_hold_tips_the_robot() {
        let found = escape_force(&skids(1.0, 0.3), 0.1, &Cancel::default());
        let found = found.expect("it stays finite");
        assert!((found.low - 103.54).abs() < 0.1, "{found:?}");
        assert!((found.high - 113.89).abs() < 0.1, "{found:?}");
        assert!(found.tips, "{found:?}");
    }
}
