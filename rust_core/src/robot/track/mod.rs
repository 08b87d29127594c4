//! Track models: the shapes that meet the ground, and the drive that moves each of them.

mod belt;
mod discs;
mod flipper;
mod force;
mod grouser_belt;
mod layout;
mod running_gear;
mod segmental;
mod wheels;

use crate::robot::{ChainOfShoes, Part};
use crate::scenario::{
    CircumferentialWheels, HybridWheels, LineOfWheels, Robot, ScenarioError, Track,
};

/// What a track model adds to the chassis.
pub(crate) struct TrackModel {
    /// Shapes that meet the ground.
    pub parts: Vec<Part>,
    /// Number of independent drives, those with a motor first; except for chains, they share the mass evenly.
    pub drives: usize,
    /// Number of drives with a motor; except for chains, they share the force evenly.
    pub motors: usize,
    /// The drive pushes the chassis itself instead of the ground under the parts.
    pub pushes_chassis: bool,
    /// Chains of shoes, which have all of the track's mass.
    pub chains: Vec<ChainOfShoes>,
}

/// Builds the track model of a robot, including those of its flippers; of a closed track, the one that is to be closed.
///
/// # Errors
/// Discs that no track would touch; wheels that do not fit the robot.
pub(crate) fn build(robot: &Robot) -> Result<TrackModel, ScenarioError> {
    discs::check(&robot.outline)?;
    let mut track = match &robot.track {
        Track::Line(LineOfWheels { wheel, .. })
        | Track::Circumferential(CircumferentialWheels { wheel, .. })
        | Track::Hybrid(HybridWheels { wheel, .. }) => wheels::driven(robot, wheel),
        Track::Belt(_) => Ok(belt::build(robot)),
        Track::GrouserBelt(belt) => grouser_belt::build(robot, belt),
        Track::Segmental(track) => segmental::build(robot, track),
        Track::Force(force) => force::build(robot, force),
        Track::Closed(closed) => {
            let open = Robot {
                track: (*closed.of).clone(),
                ..robot.clone()
            };
            return build(&open).map_err(|error| ScenarioError {
                path: error.path.replacen("robot.track", "robot.track.of", 1),
                ..error
            });
        }
    }?;
    if let Some(flippers) = &robot.flippers {
        flipper::add(robot, flippers, &mut track)?;
    }
    Ok(track)
}
