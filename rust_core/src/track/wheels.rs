//! Wheels in place of a track.
//!
//! A round wheel on a fixed axle needs no body of its own: turning does not change its shape, so
//! its mass rides with the chassis and its spin is a degree of freedom of the drive.

use super::TrackModel;
use crate::outline;
use crate::robot::{BodyKind, Part, Shape};
use crate::scenario::{LineOfWheels, Robot, TorqueSharing, Wheel};

/// Wheels on the straight line between the end axles.
pub(super) fn line(robot: &Robot, line: &LineOfWheels) -> TrackModel {
    let own_motors = robot.drivetrain.torque_sharing == TorqueSharing::Wheel;
    let discs = outline::line_of_wheels(&robot.outline, line);
    let parts = discs.iter().enumerate().map(|(i, disc)| Part {
        kind: BodyKind::Wheel,
        shape: match line.wheel {
            Wheel::Round => Shape::Disc {
                center: disc.center,
                radius: disc.radius,
            },
        },
        drive: Some(if own_motors { i } else { 0 }),
        friction_limit: f64::INFINITY,
    });
    TrackModel {
        parts: parts.collect(),
        drives: if own_motors { discs.len() } else { 1 },
        pushes_chassis: false,
    }
}
