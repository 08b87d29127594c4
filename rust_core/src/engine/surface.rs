//! The shapes of parts as the engine has them: convex pieces whose union is the part.

use rapier2d_f64::prelude::{Pose, SharedShape};

use crate::contact::solids_of;
use crate::geometry::{Disc, Envelope, Vector};
use crate::robot::{Part, Shape};

/// [rad] How an arc is divided in a polygon; the discs fill what it leaves out.
const TURN: f64 = 0.5;

/// The convex pieces of a part, in its own frame; together they are exactly the part.
pub(super) fn pieces(part: &Part) -> Vec<(Pose, SharedShape)> {
    match &part.shape {
        Shape::Disc { .. } | Shape::Gear { .. } => solids_of(part)
            .into_iter()
            .map(|solid| (Pose::IDENTITY, solid))
            .collect(),
        Shape::Hull { discs, .. } => hull(discs),
        Shape::Polygon { corners } => polygon(corners.clone()),
        Shape::Grouser(grouser) => polygon(grouser.corners().to_vec()),
    }
}

/// The hull of discs: the discs, and the polygon of the points where its straight runs touch them.
fn hull(discs: &[Disc]) -> Vec<(Pose, SharedShape)> {
    let mut corners = Envelope::new(discs).polyline(TURN);
    corners.reverse(); // counter-clockwise
    corners.dedup();
    if corners.first() == corners.last() {
        corners.pop();
    }
    let round = discs.iter().map(|disc| {
        let place = Pose::from_translation(disc.center);
        (place, SharedShape::ball(disc.radius))
    });
    round.chain(polygon(corners)).collect()
}

fn polygon(corners: Vec<Vector>) -> Vec<(Pose, SharedShape)> {
    SharedShape::convex_polyline(corners)
        .map(|shape| (Pose::IDENTITY, shape))
        .into_iter()
        .collect()
}
