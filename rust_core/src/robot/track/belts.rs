//! Tracks without wheels: a smooth closed belt, whose surface motion is prescribed along the outline (Pecka et al., IROS
//! 2017); one with grousers that travel along it (Okada et al. 2020); and brute-force acceleration, a speed servo that
//! pushes the chassis itself.
//!
//! A belt needs no bodies: the positions of its surface and grousers follow from how far the drive has run. A grouser moves
//! with the belt on the straight runs, and turns with it round the discs.

use std::sync::Arc;

use super::TrackModel;
use super::wheels::passive;
use crate::geometry::{Disc, Envelope, Grouser, outline_discs};
use crate::robot::{BodyKind, Mount, Part, Shape};
use crate::scenario::{
    ForceSupport, ForceTrack, GrouserBeltTrack, Robot, ScenarioError, TrackOutline,
};

/// One hull round the discs, with one speed all over its surface.
pub(super) fn belt(robot: &Robot) -> TrackModel {
    let part = hull(robot, BodyKind::Belt, Some(0), f64::INFINITY);
    TrackModel {
        parts: vec![part],
        drives: 1,
        motors: 1,
        pushes_chassis: false,
        chains: Vec::new(),
    }
}

/// The outline as one shape.
pub(super) fn hull(
    robot: &Robot,
    kind: BodyKind,
    drive: Option<usize>,
    friction_limit: f64,
) -> Part {
    let shape = Shape::Hull {
        discs: outline_discs(&robot.outline),
        grouser_height: 0.0,
    };
    Part {
        kind,
        shape,
        drive,
        friction_limit,
        lane: 0,
        mount: Mount::Chassis,
    }
}

/// The belt, which is one hull round the discs at the roots, and its grousers.
pub(super) fn grouser_belt(
    robot: &Robot,
    track: &GrouserBeltTrack,
) -> Result<TrackModel, ScenarioError> {
    let error = |field: &str, value: f64, rule: String| {
        Err(ScenarioError::new(format!("robot.{field}"), value, rule))
    };
    let outline = &robot.outline;
    let (height, thickness) = (outline.grouser_height, outline.grouser_thickness);
    for (field, value) in [("grouser_height", height), ("grouser_thickness", thickness)] {
        if value <= 0.0 {
            let rule = "must be > 0 m for a belt with grousers".to_owned();
            return error(&format!("outline.{field}"), value, rule);
        }
    }
    let discs: Vec<Disc> = outline_discs(outline)
        .iter()
        .map(|disc| Disc {
            radius: disc.radius - height,
            ..*disc
        })
        .collect();
    let line = Arc::new(Envelope::new(&discs));
    let grousers: Vec<Grouser> =
        Grouser::along(&line, track.grouser_count, height, outline)?.collect();
    let length = line.length();
    if length <= thickness * grousers.len() as f64 {
        let rule = format!(
            "must be few enough to fit: the belt is {length} m long, a grouser {thickness} m thick"
        );
        return error("track.grouser_count", grousers.len() as f64, rule);
    }
    let part = |kind, shape| Part {
        kind,
        shape,
        drive: Some(0),
        friction_limit: f64::INFINITY,
        lane: 0,
        mount: Mount::Chassis,
    };
    let surface = Shape::Hull {
        discs,
        grouser_height: height,
    };
    let grousers = grousers
        .into_iter()
        .map(|grouser| part(BodyKind::Grouser, Shape::Grouser(grouser)));
    Ok(TrackModel {
        parts: std::iter::once(part(BodyKind::Belt, surface))
            .chain(grousers)
            .collect(),
        drives: 1,
        motors: 1,
        pushes_chassis: false,
        chains: Vec::new(),
    })
}

/// The force acts along the x axis of the chassis frame, in the air, too; skids or free wheels carry the robot.
pub(super) fn force(robot: &Robot, track: &ForceTrack) -> Result<TrackModel, ScenarioError> {
    let parts = match track.support {
        ForceSupport::Skids => vec![hull(robot, BodyKind::Skid, None, track.skid_friction)],
        ForceSupport::Wheels => passive(robot, 1)?,
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

/// [rad] Smaller bends are within rounding of none.
const LEAST_BEND: f64 = 1e-6;

/// Checks that the track bends round every disc.
///
/// # Errors
/// A disc lies inside the hull of the others, or only touches it.
pub(super) fn check_discs(outline: &TrackOutline) -> Result<(), ScenarioError> {
    if outline.discs.len() == 2 {
        return Ok(()); // neither lies in the other, so both bend it
    }
    let discs: Vec<Disc> = outline.discs.iter().copied().map(Disc::from).collect();
    let bends = Envelope::new(&discs).bends(discs.len());
    let Some(idle) = bends.iter().position(|bend| *bend < LEAST_BEND) else {
        return Ok(());
    };
    let [x, y, radius] = outline.discs[idle];
    let rule =
        "must reach out of the hull of the others: a track round them would not bend round it";
    Err(ScenarioError::new(
        format!("robot.outline.discs[{idle}]"),
        format!("[{x}, {y}, {radius}]"),
        rule,
    ))
}
