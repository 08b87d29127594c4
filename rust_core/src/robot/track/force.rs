//! Brute-force acceleration: a speed servo that pushes the chassis itself.

use super::{TrackModel, belt, wheels};
use crate::robot::BodyKind;
use crate::scenario::{ForceSupport, ForceTrack, Robot, ScenarioError};

/// The force acts along the x axis of the chassis frame, in the air, too; skids or free wheels carry the robot.
pub(super) fn build(robot: &Robot, force: &ForceTrack) -> Result<TrackModel, ScenarioError> {
    let parts = match force.support {
        ForceSupport::Skids => vec![belt::hull(robot, BodyKind::Skid, None, force.skid_friction)],
        ForceSupport::Wheels => wheels::passive(robot, 1)?,
    };
    let free = parts.iter().filter(|part| part.drive.is_some()).count();
    Ok(TrackModel {
        parts,
        drives: 1 + free,
        motors: 1,
        pushes_chassis: true,
        chains: Vec::new(),
    })
}
