//! The push of a track that is modelled by a force alone.

use super::action::Action;
use super::damper::{DAMPING, Damper};
use super::levers::Direction;
use super::state::State;
use crate::geometry::{Rotation, Vector, cross};
use crate::robot::Model;

/// The push of a track that is modelled by a force alone: its axis runs on a rail without slip, and the
/// motor limits it.
#[derive(Default)]
pub(super) struct Push {
    /// [N] As it was last.
    pub force: f64,
    /// [N s] In this piece.
    pub impulse: f64,
    /// [N s] What a direct solve starts from.
    pub center: f64,
    pub action: Action,
    pub admittance: f64,
}

impl Push {
    pub(super) fn damper(&self) -> Damper {
        Damper::new(self.center, 1.0 / (DAMPING * self.admittance))
    }

    /// [m/s] Of the rail that its axis runs on.
    pub(super) fn slip(&self, state: &State) -> f64 {
        let spin = state.drives[0].spin;
        self.action
            .speed(state.velocity, state.angular_velocity, spin)
    }

    /// Takes the impulse that belongs to the velocities; how far these are from what they should be [m/s].
    pub(super) fn follow_velocities(&mut self, state: &State) -> f64 {
        let slip = self.slip(state);
        self.impulse = self.damper().at(slip);
        slip.abs()
    }
}

/// Direction of a force along the chassis at axle height, at a chassis angle [rad].
pub(crate) fn push_axis(model: &Model, angle: f64) -> Direction {
    let rotation = Rotation::new(angle);
    let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
    // As for a contact, one drive radius above the line of action: the motor's reaction does the rest.
    let arm = model.drive_radius * up - rotation * model.center_of_mass;
    Direction {
        unit: axis,
        lever: cross(arm, axis),
        drive_lever: model.drive_radius,
        back: 0.0,
        flipper_lever: 0.0,
    }
}
