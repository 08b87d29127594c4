//! How a robot tipped over: when its centre of mass left what bore it, and about which contact it turned.

use super::{Checked, Simulation};
use crate::error::Error;
use crate::geometry::Vector;
use crate::limits::Cancel;
use crate::observe::Outcome;

/// The last instant at which a robot that tipped over stood over its contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipOver {
    /// It went over its rear, nose up.
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
pub fn tip_over(scenario: &Checked, cancel: &Cancel) -> Result<Option<TipOver>, Error> {
    let (mut robot, end) = (Simulation::new(scenario), scenario.scenario().duration);
    // The last instants of standing ahead of the rearmost contact, and behind the foremost one.
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
    use crate::scenario::{Scenario, Surface, Terrain};

    fn before_a_step(height: f64) -> Checked {
        let text = include_str!("../../../tests/scenarios/engineer_belt_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        scenario.terrain = Terrain::Step {
            height,
            surface: Surface::sharp(0.9),
        };
        Checked::new(&scenario).expect("it is valid")
    }

    #[test]
    fn a_robot_tips_over_backwards_about_its_rear_contact() {
        let checked = before_a_step(0.11);
        let found = tip_over(&checked, &Cancel::default()).expect("the state stays finite");
        let found = found.expect("it tips over");
        assert!(found.backwards && found.chassis_angle > 0.5);
        // The weight acts through the pivot, up to the way of one step: of 16 ms at the most, at the 0.4 m/s of the tracks.
        let [lever, height] = [0, 1].map(|i| found.center_of_mass[i] - found.pivot[i]);
        assert!((0.0..6.4e-3).contains(&lever), "{lever} m");
        assert!(height > 0.1 && found.pivot[1].abs() < 0.01);
    }

    #[test]
    fn a_robot_that_clears_has_not_tipped_over() {
        let found = tip_over(&before_a_step(0.05), &Cancel::default());
        assert_eq!(found.expect("the state stays finite"), None);
    }
}
