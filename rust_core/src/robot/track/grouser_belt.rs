//! A closed belt with grousers that travel along it (Okada et al. 2020).
//!
//! The belt needs no bodies: the positions of its surface and grousers follow from how far the drive has run. A
//! grouser moves with the belt on the straight runs, and turns with it round the discs.

use std::sync::Arc;

use super::TrackModel;
use crate::geometry::{Disc, Envelope, Grouser, outline_discs};
use crate::robot::{BodyKind, Mount, Part, Shape};
use crate::scenario::{GrouserBeltTrack, Robot, ScenarioError};

/// The belt, which is one hull round the discs at the roots, and its grousers.
pub(super) fn build(robot: &Robot, belt: &GrouserBeltTrack) -> Result<TrackModel, ScenarioError> {
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
        Grouser::along(&line, belt.grouser_count, height, outline)?.collect();
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
