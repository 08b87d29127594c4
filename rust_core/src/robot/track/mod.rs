//! Track models: the shapes that meet the ground, and the drive of each; on flippers, any model that suits a tapering
//! outline, on a pivoting arm.

use crate::robot::{ChainOfShoes, Mount, Part};
use crate::scenario::{
    CircumferentialWheels, End, Flippers, HybridWheels, LineOfWheels, MAX_WHEELS, Robot,
    ScenarioError, TorqueSharing, Track,
};

mod belts;
mod segmental;
mod wheels;

pub(super) use belts::with_grousers;

/// The parts that a track model adds to the chassis.
pub(crate) struct TrackModel {
    /// Shapes that meet the ground.
    pub parts: Vec<Part>,
    /// Number of independent drives, those with a motor first; except for chains, they share the mass evenly.
    pub drives: usize,
    /// Number of drives with a motor; except for chains, they share the force evenly.
    pub motors: usize,
    /// Whether the drive pushes the chassis itself instead of the ground under the parts.
    pub pushes_chassis: bool,
    /// Chains of shoes, which have all of the track's mass.
    pub chains: Vec<ChainOfShoes>,
}

impl TrackModel {
    /// Parts on drives with a motor each.
    fn driven(parts: Vec<Part>, drives: usize) -> Self {
        Self {
            parts,
            drives,
            motors: drives,
            pushes_chassis: false,
            chains: Vec::new(),
        }
    }
}

/// Builds the track model of a robot, including those of its flippers; for a closed track, the model to be closed.
///
/// # Errors
/// Discs that no track would touch; wheels that do not fit the robot.
pub(crate) fn build(robot: &Robot) -> Result<TrackModel, ScenarioError> {
    belts::check_discs(&robot.outline)?;
    let mut track = match &robot.track {
        Track::Line(LineOfWheels { wheel, .. })
        | Track::Circumferential(CircumferentialWheels { wheel, .. })
        | Track::Hybrid(HybridWheels { wheel, .. }) => wheels::driven(robot, wheel),
        Track::Belt(_) => Ok(belts::belt(robot)),
        Track::GrouserBelt(belt) => belts::grouser_belt(robot, belt),
        Track::Segmental(track) => segmental::build(robot, track),
        Track::Force(force) => belts::force(robot, force),
        Track::Closed(closed) => {
            let open = Robot {
                track: (*closed.of).clone(),
                ..robot.clone()
            };
            return build(&open).map_err(|error| moved(error, "robot.track.of"));
        }
    }?;
    if let Some(flippers) = &robot.flippers {
        add_flipper_tracks(robot, flippers, &mut track)?;
    }
    Ok(track)
}

/// Replaces the path of an error about a field of a track; others, such as one about the track's mass, stay.
fn moved(error: ScenarioError, to: &str) -> ScenarioError {
    let field = error.path.strip_prefix("robot.track.");
    let path = field.map(|field| format!("{to}.{field}"));
    ScenarioError {
        path: path.unwrap_or(error.path),
        ..error
    }
}

/// Adds the tracks of the arms to the track of a robot, whose motors drive them.
fn add_flipper_tracks(
    robot: &Robot,
    flippers: &Flippers,
    track: &mut TrackModel,
) -> Result<(), ScenarioError> {
    for (number, end) in flippers.ends().enumerate() {
        let own =
            of_arm(robot, flippers, end).map_err(|error| moved(error, "robot.flippers.track"))?;
        let with_own_motors = robot.drivetrain.torque_sharing == TorqueSharing::Wheel;
        // One motor per track also drives its flippers; free wheels turn independently. A chain cannot share a motor
        // with a belt, because its motor has no spin that could turn one.
        let with_own_motors = with_own_motors || !track.chains.is_empty();
        let shared = if with_own_motors { 0 } else { own.motors };
        let first = track.drives;
        let of_robot = |drive: usize| {
            if drive < shared {
                drive
            } else {
                first + drive - shared
            }
        };
        track.parts.extend(own.parts.into_iter().map(|part| Part {
            drive: part.drive.map(of_robot),
            mount: Mount::Flipper(number),
            ..part
        }));
        track.drives += own.drives - shared;
        track.motors += own.motors - shared;
    }
    Ok(())
}

/// The track of the arms at an end. If the robot has small wheels all round and the arms have no model of their own,
/// their number is increased as needed, because the wheels are smaller at a tip.
fn of_arm(robot: &Robot, flippers: &Flippers, end: End) -> Result<TrackModel, ScenarioError> {
    let mut arm = arm_as_robot(robot, flippers, end);
    loop {
        let built = build(&arm);
        let too_few = matches!(&built, Err(error) if error.path == "robot.track.count");
        match &mut arm.track {
            Track::Circumferential(wheels)
                if flippers.track.is_none() && too_few && wheels.count < MAX_WHEELS =>
            {
                wheels.count += 1;
            }
            _ => return built,
        }
    }
}

/// An arm treated as a robot, to build its track.
fn arm_as_robot(robot: &Robot, flippers: &Flippers, end: End) -> Robot {
    Robot {
        outline: flippers.outline(end, &robot.outline),
        track: flippers.track_model(&robot.track),
        flippers: None,
        ..robot.clone()
    }
}
