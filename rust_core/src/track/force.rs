//! Brute-force acceleration: a speed servo that pushes the chassis itself.

use super::{TrackModel, belt};
use crate::robot::BodyKind;
use crate::scenario::{ForceSupport, ForceTrack, Robot};

/// Skids of the outline's shape; the force acts along the chassis at axle height, in the air too.
pub(super) fn build(robot: &Robot, force: &ForceTrack) -> TrackModel {
    let parts = match force.support {
        ForceSupport::Skids => vec![belt::hull(robot, BodyKind::Skid, None, force.skid_friction)],
    };
    TrackModel {
        parts,
        drives: 1,
        pushes_chassis: true,
    }
}
