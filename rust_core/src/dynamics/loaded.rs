//! A contact with the forces and the grip that a step has found.
//!
//! The equations: docs/physics.md, "State".

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::geometry::{Vector, plausible, right_of};
use crate::robot::Model;
use crate::solver::Grip;
use crate::terrain::Profile;

/// A contact as the solver keeps it from step to step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct LoadedContact {
    /// The contact itself.
    pub contact: Contact,
    /// [N] Mean normal force over the step.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface over the ground in the same direction.
    pub surface_speed: f64,
    /// [N] Normal force from which the next step starts.
    pub normal_guess: f64,
    /// [N] Friction from which the next step starts.
    pub friction_guess: f64,
    /// Its last grip.
    pub grip: Grip,
}

impl LoadedContact {
    /// [N] Force on the robot.
    pub(crate) fn force(&self) -> Vector {
        let normal = self.contact.normal;
        normal * self.normal_force + right_of(normal) * self.friction_force
    }

    /// A contact that has not carried a load yet.
    pub(crate) fn open(contact: Contact) -> Self {
        Self {
            contact,
            normal_force: 0.0,
            friction_force: 0.0,
            surface_speed: 0.0,
            normal_guess: 0.0,
            friction_guess: 0.0,
            grip: Grip::Open,
        }
    }

    /// Whether a robot and its lanes have this contact, and its forces are plausible.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let forces = [
            self.normal_force,
            self.friction_force,
            self.surface_speed,
            self.normal_guess,
            self.friction_guess,
        ];
        self.contact.fits(model, lanes) && plausible(&forces)
    }
}
