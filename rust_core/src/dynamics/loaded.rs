//! A contact with what a step found that it does.
//!
//! The equations: docs/physics.md, "State".

use serde::{Deserialize, Serialize};

use super::Grip;
use crate::contact::Contact;
use crate::geometry::plausible;
use crate::robot::Model;
use crate::terrain::Profile;

/// A contact as the solver keeps it from step to step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct LoadedContact {
    /// Where and what.
    pub contact: Contact,
    /// [N] Mean normal force over the step.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface over ground in the same direction.
    pub surface_speed: f64,
    /// [N] Force that the next step starts from.
    pub normal_guess: f64,
    /// [N] The same along the tangent.
    pub friction_guess: f64,
    /// What it did last.
    pub grip: Grip,
}

impl LoadedContact {
    /// One that has not borne yet.
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

    /// The same, with its forces.
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
