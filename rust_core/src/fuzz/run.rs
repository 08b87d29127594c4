//! Scenarios that are accepted: their first steps lead to numbers, and no contact pulls.

use super::scenario::accepted;
use crate::{Error, Simulation, ValidScenario};

/// [s] and steps of a run, at most.
const SHORT: (f64, u64) = (5e-3, 16);

/// Reads bytes as a scenario, and steps it if it is one.
///
/// # Panics
/// If a rule is broken.
pub fn run(data: &[u8]) {
    if let Some(scenario) = accepted(data) {
        step(&scenario);
    }
}

fn step(scenario: &ValidScenario) {
    let mut simulation = Simulation::new(scenario);
    while simulation.time() < SHORT.0 && simulation.steps() < SHORT.1 && !simulation.is_over() {
        match simulation.step_until(SHORT.0) {
            Ok(()) => {}
            Err(Error::Simulation(_)) => return,
            Err(other) => panic!("{other}"),
        }
        let now = simulation.reading();
        let numbers = [
            now.time,
            now.position.x,
            now.position.y,
            now.velocity.x,
            now.velocity.y,
            now.chassis_angle,
            now.angular_velocity,
            now.track_speed,
        ];
        assert!(numbers.iter().all(|number| number.is_finite()), "{now:?}");
        assert!(simulation.energy().is_finite());
        for contact in simulation.loaded() {
            assert!(contact.normal_force.is_finite() && contact.normal_force >= 0.0);
        }
    }
}
