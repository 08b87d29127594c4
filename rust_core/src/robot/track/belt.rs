//! A smooth closed belt: surface motion prescribed along the outline (Pecka et al., IROS 2017).

use super::TrackModel;
use crate::geometry::outline_discs;
use crate::robot::{BodyKind, Mount, Part, Shape};
use crate::scenario::Robot;

/// One hull round the discs, with one speed all over its surface.
pub(super) fn build(robot: &Robot) -> TrackModel {
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
