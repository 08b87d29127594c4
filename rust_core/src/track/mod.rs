//! Track models: which shapes meet the ground, and which drive turns each of them.

mod belt;
mod force;
mod wheels;

use crate::robot::Part;
use crate::scenario::{Robot, Track};

/// What a track model adds to the chassis.
pub(crate) struct TrackModel {
    /// Shapes that meet the ground.
    pub parts: Vec<Part>,
    /// Number of independent drives; they share mass and force evenly.
    pub drives: usize,
    /// The drive pushes the chassis itself instead of the ground under the parts.
    pub pushes_chassis: bool,
}

/// Builds the model of a robot's track.
pub(crate) fn build(robot: &Robot) -> TrackModel {
    match &robot.track {
        Track::Line(line) => wheels::line(robot, line),
        Track::Belt(_) => belt::build(robot),
        Track::Force(force) => force::build(robot, force),
    }
}
