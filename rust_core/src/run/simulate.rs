//! Runs of a scenario: to its end, to a stop that is examined, or until it tips over.

use super::clock::Clock;
use super::record::{Record, batch_budget};
use super::recording::{Recording, Run};
use super::trials;
use super::{Simulation, ValidScenario};
use crate::diagnosis::{Balance, Change};
use crate::error::Error;
use crate::geometry::Vector;
use crate::limits::Cancel;
use crate::limits::memory::Budget;
use crate::observe::Outcome;
use crate::scenario::Scenario;

/// Simulates a scenario to its end.
///
/// # Errors
/// [`Error::Limit`] before the run or if the record needs too much memory, [`Error::Simulation`] if the
/// state became non-finite.
pub fn simulate(checked: &ValidScenario, record: Record) -> Result<Run, Error> {
    let budget = batch_budget(std::slice::from_ref(checked), record, 1)?;
    simulate_within(checked, record, (&budget, &Cancel::default()))
}

/// The same within a budget of memory; ends early with [`Error::Interrupted`] if asked to.
pub(crate) fn simulate_within(
    checked: &ValidScenario,
    record: Record,
    limits: Limits,
) -> Result<Run, Error> {
    let clock = Clock::start();
    let end = checked.scenario().duration;
    advance(&mut Simulation::new(checked), end, record, limits, clock)
}

/// Simulates `scenario` up to the time `at` [s], then continues as `variant` for its whole duration, with a push that
/// rises to a force [N] in a time [s]. A run of a trial begins later by the number of starts that
/// [`what_if`](crate::what_if) returns, each a fifth of a stop window; like the trial, it ignores the schedules.
///
/// # Errors
/// As [`simulate`], [`Error::Scenario`] if the push is out of range, and [`Error::Interrupted`] once `cancel` is asked.
pub fn branch(
    scenario: &ValidScenario,
    (at, trial): (f64, Option<usize>),
    (variant, push): (&ValidScenario, (f64, f64)),
    record: Record,
    cancel: &Cancel,
) -> Result<Run, Error> {
    let clock = Clock::start();
    let budget = batch_budget(std::slice::from_ref(variant), record, 1)?;
    let mut trunk = Simulation::replayed(scenario, at, cancel)?;
    if let Some(later) = trial {
        trunk = trunk.copy();
        for _ in 0..later {
            trunk = trials::next_start(&trunk, cancel)?;
        }
    }
    let mut simulation = trunk.branch(variant);
    simulation.raise_push(push.0, push.1)?;
    let end = simulation.time() + variant.scenario().duration;
    advance(&mut simulation, end, record, (&budget, cancel), clock)
}

/// The scenario of a trial made at a stop of `scenario` at the time `at` [s], and its run; `None` if the change makes
/// no sense for the robot.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn run_of_trial(
    scenario: &ValidScenario,
    at: f64,
    change: Change,
    record: Record,
    cancel: &Cancel,
) -> Result<Option<(Scenario, Run)>, Error> {
    let clock = Clock::start();
    let stop = Simulation::replayed(scenario, at, cancel)?;
    let Some(mut started) = trials::shown_start(&stop, change, cancel)? else {
        return Ok(None);
    };
    let budget = batch_budget(std::slice::from_ref(scenario), record, 1)?;
    let end = started.time() + trials::duration(&stop, change);
    let run = advance(&mut started, end, record, (&budget, cancel), clock)?;
    Ok(Some((started.scenario().clone(), run)))
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and says whether forces can hold it there;
/// `None` if it has not stopped, or has no weight.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn balance(
    scenario: &ValidScenario,
    at: f64,
    cancel: &Cancel,
) -> Result<Option<Balance>, Error> {
    Ok(Simulation::replayed(scenario, at, cancel)?.balance())
}

/// Limits of a run: memory and cancellation.
type Limits<'a> = (&'a Budget, &'a Cancel);

/// Simulates up to the time `end` [s], or until the outcome is certain.
fn advance(
    simulation: &mut Simulation,
    end: f64,
    record: Record,
    (budget, cancel): Limits,
    clock: Clock,
) -> Result<Run, Error> {
    let mut recording = Recording::begin(simulation, record, budget, clock)?;
    while simulation.time() < end && !simulation.is_over() {
        simulation.step_until(end)?;
        recording.step(simulation)?;
        cancel.check()?;
    }
    recording.finish(simulation, cancel)
}

/// The last instant at which a robot that tipped over stood over its contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipOver {
    /// Whether it tipped over its rear, nose up.
    pub backwards: bool,
    /// [s] The instant.
    pub time: f64,
    /// [s] When the chassis tilted by more than `criteria.tip_over_angle`.
    pub end: f64,
    /// [rad] Chassis angle then.
    pub chassis_angle: f64,
    /// [m] Centre of mass of the whole robot then.
    pub center_of_mass: [f64; 2],
    /// [m] The outermost contact that bore on the side to which it fell.
    pub pivot: [f64; 2],
}

/// Simulates a scenario and says how the robot tipped over; `None` if it did not, or never stood.
///
/// # Errors
/// [`Error::Simulation`] if the state became non-finite, [`Error::Interrupted`] once `cancel` is asked.
pub fn tip_over(scenario: &ValidScenario, cancel: &Cancel) -> Result<Option<TipOver>, Error> {
    let (mut robot, end) = (Simulation::new(scenario), scenario.scenario().duration);
    // The last instants at which it stood ahead of the rearmost contact, and behind the foremost one.
    let mut stood = [None; 2];
    while robot.time() < end && !robot.is_over() {
        robot.step_until(end)?;
        for (side, kept) in stood.iter_mut().enumerate() {
            *kept = standing(&robot, side == 0).or(*kept);
        }
        cancel.check()?;
    }
    let falls_forwards = usize::from(robot.reading().chassis_angle < 0.0);
    let has_tipped = robot.monitor().ended_as() == Some(Outcome::TippedOver);
    let end = robot.time();
    let last = stood[falls_forwards].filter(|_| has_tipped);
    Ok(last.map(|last| TipOver { end, ..last }))
}

/// The robot as it stands ahead of its rearmost contact, or behind its foremost one; `None` if it does not.
fn standing(robot: &Simulation, backwards: bool) -> Option<TipOver> {
    let sign = if backwards { 1.0 } else { -1.0 };
    let bearing = robot.loaded().iter().filter(|l| l.normal_force > 0.0);
    let points = bearing.map(|l| l.point);
    let pivot = points.min_by(|a: &Vector, b| (sign * a.x).total_cmp(&(sign * b.x)))?;
    let center = robot.center_of_mass();
    (sign * (center.x - pivot.x) >= 0.0).then(|| TipOver {
        backwards,
        time: robot.time(),
        end: robot.time(),
        chassis_angle: robot.reading().chassis_angle,
        center_of_mass: [center.x, center.y],
        pivot: [pivot.x, pivot.y],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Surface, Terrain, shared};

    fn before_a_step(height: f64) -> ValidScenario {
        let mut scenario = shared("engineer_belt_step");
        scenario.terrain = Terrain::Step {
            height,
            surface: Surface::sharp(0.9),
        };
        ValidScenario::new(&scenario).expect("it is valid")
    }

    #[test]
    fn a_robot_tips_over_backwards_about_its_rear_contact() {
        let checked = before_a_step(0.11);
        let found = tip_over(&checked, &Cancel::default()).expect("the state stays finite");
        let found = found.expect("it tips over");
        assert!(found.backwards && found.chassis_angle > 0.5);
        // From there it falls on for more than a step, to the angle at which it counts as tipped over.
        assert!(found.end > found.time + 0.016, "{found:?}");
        // The weight acts through the pivot, up to the travel of one step: at most 16 ms, at 0.4 m/s.
        let [lever, height] = [0, 1].map(|i| found.center_of_mass[i] - found.pivot[i]);
        assert!((0.0..6.4e-3).contains(&lever), "{lever} m");
        assert!(height > 0.1 && found.pivot[1].abs() < 0.01);
    }

    #[test]
    fn a_robot_that_clears_has_not_tipped_over() {
        let found = tip_over(&before_a_step(0.05), &Cancel::default());
        assert_eq!(found.expect("the state stays finite"), None);
    }

    #[test]
    fn a_robot_at_rest_stands_between_its_rearmost_and_its_foremost_contact() {
        let mut robot = Simulation::new(&before_a_step(0.05));
        robot.advance(0.02).expect("the state stays finite");
        let points = robot.loaded().iter().map(|l| l.point.x);
        let ends = [
            points.clone().fold(f64::INFINITY, f64::min),
            points.fold(f64::NEG_INFINITY, f64::max),
        ];
        assert!(ends[0] < ends[1]);
        for (backwards, end) in [(true, ends[0]), (false, ends[1])] {
            let found = standing(&robot, backwards).expect("it stands");
            assert_eq!(
                (found.backwards, found.pivot[0].to_bits()),
                (backwards, end.to_bits())
            );
        }
    }
}
