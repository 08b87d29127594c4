//! The push of a track that is modelled as a force only.
//!
//! The equations: docs/physics.md, "Motors".

use super::action::Action;
use super::damper::{DAMPING, Damper};
use super::levers::Direction;
use super::state::State;
use crate::geometry::{Rotation, Vector, cross};
use crate::robot::Model;

/// The push of a track that is modelled as a force only: as if its axis ran on a rail without slip, up to the
/// limit of the motor.
#[derive(Default)]
pub(super) struct Push {
    /// [N] The last force.
    pub force: f64,
    /// [N s] Impulse in this step.
    pub impulse: f64,
    /// [N s] Impulse about which a direct solve damps it.
    pub center: f64,
    pub action: Action,
    pub admittance: f64,
}

impl Push {
    pub(super) fn damper(&self) -> Damper {
        Damper::new(self.center, 1.0 / (DAMPING * self.admittance))
    }

    /// [m/s] Slip on the rail.
    pub(super) fn slip(&self, state: &State) -> f64 {
        let spin = state.drives[0].spin;
        self.action
            .speed(state.velocity, state.angular_velocity, spin)
    }

    /// Updates the impulse to match the velocities; returns the error of the velocity [m/s].
    pub(super) fn follow_velocities(&mut self, state: &State) -> f64 {
        let slip = self.slip(state);
        self.impulse = self.damper().at(slip);
        slip.abs()
    }
}

/// Direction of a force along the x axis of the chassis frame, at a chassis angle [rad].
pub(crate) fn push_axis(model: &Model, angle: f64) -> Direction {
    let rotation = Rotation::new(angle);
    let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
    // One drive radius above the line of action, as for a contact: the motor's reaction does the rest.
    let arm = model.drive_radius * up - rotation * model.center_of_mass;
    Direction {
        unit: axis,
        lever: cross(arm, axis),
        drive_lever: model.drive_radius,
        back: 0.0,
        flipper_lever: 0.0,
    }
}
