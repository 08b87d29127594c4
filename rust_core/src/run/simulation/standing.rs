//! A robot put in a pose with its drives running.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::clear::{Displacement, nearest_beyond};
use super::{LastStep, Simulation};
use crate::geometry::{Vector, cross};
use crate::jams::Jam;
use crate::run::ValidScenario;

impl Simulation {
    /// The robot of a scenario at rest, its chassis frame at a position [m] and an angle [rad], its surfaces at the
    /// speed that the scenario commands first.
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

    /// The same in a jam, pressed onto its contacts so deep that they carry it at rest. If they only touched, rounding
    /// would decide which of them carries first, and some robots could slip out of the jam.
    pub(in crate::run) fn pressed(mut self, jam: &Jam) -> Self {
        let omega = TAU * self.scenario.solver.contact_frequency;
        let deepest = self.scenario.gravity / (omega * omega);
        let (center, half) = (self.state.center, self.half_length());
        let walls: Vec<(Displacement, f64)> = jam
            .contacts
            .iter()
            .map(|contact| {
                let into = -contact.normal;
                let lever = cross(contact.point - center, into) / half;
                ([into.x, into.y, lever], deepest * contact.load)
            })
            .collect();
        self.displace(nearest_beyond(&walls));
        self.last = LastStep::none(&self.state);
        self
    }
}
