//! The push of a track that is modelled as a force only: it drives the chassis along its axis as if on a rail without
//! slip, up to the limit of the motor.
//!
//! The equations: docs/physics.md, "Motors".

use super::levers::Direction;
use crate::geometry::{Rotation, Vector, cross};
use crate::robot::Model;
use crate::solver::{Layout, Row};

/// Direction of a force along the x axis of the chassis frame, at a chassis angle [rad].
pub(crate) fn push_axis(model: &Model, angle: f64) -> Direction {
    let rotation = Rotation::new(angle);
    let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
    // One drive radius above the line of action, as for a contact: the motor's reaction adds the rest.
    let arm = model.drive_radius * up - rotation * model.center_of_mass;
    Direction {
        unit: axis,
        lever: cross(arm, axis),
        spin_lever: model.drive_radius,
        ..Direction::default()
    }
}

/// The row of the push of a model that pushes the chassis, at a chassis angle [rad].
pub(super) fn push_row(model: &Model, layout: Layout, angle: f64) -> Row {
    push_axis(model, angle).row(layout, model.push_drive(), None)
}
