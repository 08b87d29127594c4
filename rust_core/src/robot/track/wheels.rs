//! Wheels in place of a track.
//!
//! A wheel on a fixed axle needs no body of its own: its mass belongs to the chassis, and its spin is a degree of
//! freedom of the drive.

use super::TrackModel;
use super::layout;
use crate::geometry::Gear;
use crate::robot::{BodyKind, Mount, Part, Shape};
use crate::scenario::{Robot, ScenarioError, TorqueSharing, Wheel};

/// Wheels driven by motors, together or each by itself.
pub(super) fn driven(robot: &Robot, wheel: &Wheel) -> Result<TrackModel, ScenarioError> {
    let own_motors = robot.drivetrain.torque_sharing == TorqueSharing::Wheel;
    let parts = layout::wheels(robot)?
        .iter()
        .enumerate()
        .map(|(i, disc)| {
            let shape = match wheel {
                Wheel::Round => Shape::Disc {
                    center: disc.center,
                    radius: disc.radius,
                },
                Wheel::Gear(wheel) => Shape::Gear {
                    center: disc.center,
                    gear: Gear::new(wheel, &robot.outline, disc.radius, i)?,
                },
            };
            Ok(part(shape, if own_motors { i } else { 0 }))
        })
        .collect::<Result<Vec<Part>, ScenarioError>>()?;
    let drives = if own_motors { parts.len() } else { 1 };
    Ok(TrackModel {
        parts,
        drives,
        motors: drives,
        pushes_chassis: false,
        chains: Vec::new(),
    })
}

/// Round wheels that turn freely and independently, with drives numbered from `first`.
pub(super) fn passive(robot: &Robot, first: usize) -> Result<Vec<Part>, ScenarioError> {
    let discs = layout::wheels(robot)?;
    let parts = discs.iter().enumerate().map(|(i, disc)| {
        let (center, radius) = (disc.center, disc.radius);
        part(Shape::Disc { center, radius }, first + i)
    });
    Ok(parts.collect())
}

fn part(shape: Shape, drive: usize) -> Part {
    Part {
        kind: BodyKind::Wheel,
        shape,
        drive: Some(drive),
        friction_limit: f64::INFINITY,
        lane: 0,
        mount: Mount::Chassis,
    }
}
