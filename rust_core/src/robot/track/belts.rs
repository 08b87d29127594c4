//! Tracks without wheels: a smooth closed belt, whose surface motion is prescribed along the outline (Pecka et al.,
//! IROS 2017); one with grousers that travel along it (Okada et al. 2020); and brute-force acceleration, a speed servo
//! that pushes the chassis itself.
//!
//! A belt needs no bodies: the positions of its surface and grousers follow from how far the drive has run. A grouser
//! moves with the belt on the straight runs, and turns with it round the discs.

use std::sync::Arc;

use super::TrackModel;
use super::wheels::passive;
use crate::geometry::{Disc, Envelope, Grouser, outline_discs};
use crate::robot::{BodyKind, Part, Shape};
use crate::scenario::{
    ForceSupport, ForceTrack, GrouserBeltTrack, Robot, ScenarioError, TrackOutline,
};

/// One hull round the discs, with a uniform surface speed.
pub(super) fn belt(robot: &Robot) -> TrackModel {
    TrackModel::driven(vec![hull(robot, BodyKind::Belt, Some(0))], 1)
}

/// The outline as one shape.
fn hull(robot: &Robot, kind: BodyKind, drive: Option<usize>) -> Part {
    let shape = Shape::Hull {
        discs: outline_discs(&robot.outline),
        grouser_height: 0.0,
    };
    Part::new(kind, shape, drive)
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
    let tips = outline_discs(outline);
    let (parts, length) = with_grousers(tips, height, track.grouser_count, outline)?;
    let grousers = (parts.len() - 1) as f64;
    if length <= thickness * grousers {
        let rule = format!(
            "must be few enough to fit: the belt is {length} m long, a grouser {thickness} m thick"
        );
        return error("track.grouser_count", grousers, rule);
    }
    Ok(TrackModel::driven(parts, 1))
}

/// A belt with grousers of a height [m] whose tips are on the hull of discs, these grousers, and [m] its length.
///
/// # Errors
/// The outline's pitch requires more grousers than a belt may have.
pub(in crate::robot) fn with_grousers(
    tips: Vec<Disc>,
    height: f64,
    count: Option<u32>,
    outline: &TrackOutline,
) -> Result<(Vec<Part>, f64), ScenarioError> {
    let part = |kind, shape| Part::new(kind, shape, Some(0));
    let discs: Vec<Disc> = tips.into_iter().map(|tip| tip.grown(-height)).collect();
    let line = Arc::new(Envelope::new(&discs));
    let surface = Shape::Hull {
        discs,
        grouser_height: height,
    };
    let mut parts = vec![part(BodyKind::Belt, surface)];
    if height > 0.0 {
        let grousers = Grouser::along(&line, count, height, outline)?;
        parts.extend(grousers.map(|each| part(BodyKind::Grouser, Shape::Grouser(each))));
    }
    Ok((parts, line.length()))
}

/// The force acts along the x axis of the chassis frame, in the air, too; skids or free wheels carry the robot.
pub(super) fn force(robot: &Robot, track: &ForceTrack) -> Result<TrackModel, ScenarioError> {
    let parts = match track.support {
        ForceSupport::Skids => vec![Part {
            friction_limit: track.skid_friction,
            ..hull(robot, BodyKind::Skid, None)
        }],
        ForceSupport::Wheels => passive(robot, 1)?,
    };
    let free = parts.iter().filter(|part| part.drive.is_some()).count();
    Ok(TrackModel {
        drives: 1 + free,
        pushes_chassis: true,
        ..TrackModel::driven(parts, 1)
    })
}

/// [rad] Smaller bends are rounding errors.
const LEAST_BEND: f64 = 1e-6;

/// Checks that the track bends round every disc.
///
/// # Errors
/// A disc lies inside the hull of the others, or only touches it.
pub(super) fn check_discs(outline: &TrackOutline) -> Result<(), ScenarioError> {
    if outline.discs.len() == 2 {
        return Ok(()); // neither disc is inside the other, so both bend it
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
