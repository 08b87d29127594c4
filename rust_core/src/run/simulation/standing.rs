//! A robot put in a pose with its drives running.

use std::sync::Arc;

use super::{LastStep, Simulation};
use crate::geometry::Vector;
use crate::run::ValidScenario;

impl Simulation {
    /// The robot of a scenario at rest, its chassis frame at a position [m] and an angle [rad], its surfaces at the speed that
    /// the scenario commands first.
    pub(in crate::run) fn driven_at(checked: &ValidScenario, position: Vector, angle: f64) -> Self {
        let mut scenario = checked.scenario().clone();
        scenario.start.angle = angle;
        let ground = Arc::clone(checked.ground());
        let model = checked.model().clone();
        let mut robot = Self::at_rest(&scenario, ground, model, position);
        let speed = robot.commands.speed;
        let model = robot.dynamics.model();
        let spin = -speed / model.drive_radius;
        for drive in model.driven() {
            robot.state.drives[drive].spin = spin;
        }
        robot.last = LastStep::none(&robot.state);
        (robot.set_point, robot.last.set_point) = (speed, speed);
        robot
    }
}
