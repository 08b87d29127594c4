//! Overlaps of a corner of a part with a corner of the ground.
//!
//! There are up to four ways out of the overlap, one along the normal of each face that meets there, as far
//! as that face can meet the other corner. The shortest way is the contact; the others yield to it.
//!
//! The equations: docs/physics.md, "Contacts".

use super::lane::{Corner, Lane, On, ROUNDING, Touch};
use crate::geometry::{Vector, cross};

/// Cosine of the angle within which two normals of an overlap both count: faces that are nearly parallel
/// bear at both ends of their overlap.
const ALIKE: f64 = 0.94;
/// [rad] If a face is parallel to a run of a part within this angle, both ends of the run bear on it.
pub(super) const NEARLY: f64 = 0.05;

/// A sharp corner of a part.
#[derive(Clone, Copy)]
pub(super) struct Tip {
    /// [m] Its position.
    pub place: Vector,
    /// Outward normals of the runs before and behind it, counter-clockwise.
    pub normals: [Vector; 2],
}

impl Tip {
    /// Whether a direction is an outward normal of the part at the tip, within rounding.
    pub(super) fn faces(&self, direction: Vector) -> bool {
        self.faces_within(direction, ROUNDING)
    }

    /// Whether it can bear there until the part has turned on: above a face whichever way it points now, and in a face
    /// if the part lies nearly flat on it.
    pub(super) fn may_bear(&self, touch: &Touch) -> bool {
        match touch.on {
            On::Face(_) => touch.distance > 0.0 || self.faces_within(-touch.normal, NEARLY),
            On::Corner(_) => self.faces(-touch.normal),
        }
    }

    /// Whether a direction is an outward normal of the part at the tip, within an angle of this sine.
    fn faces_within(&self, direction: Vector, sine: f64) -> bool {
        let [before, behind] = self.normals;
        cross(before, direction) >= -sine
            && cross(direction, behind) >= -sine
            && direction.dot(before + behind) > 0.0
    }
}

/// Whether a tip inside a face of the ground has a shorter way out than that face.
pub(super) fn tip_yields(lane: &Lane, tip: &Tip, touch: &Touch) -> bool {
    outer_ends(lane, touch).any(|(corner, beside)| {
        let is_gap = |way: f64| is_gap(way, (tip.place - corner.center).length());
        let below = (corner.center - tip.place).dot(beside) + corner.radius;
        let leaves_face = || tip.faces(-beside);
        let leaves_run = |m: &Vector| {
            let spoke = tip.place - (corner.center - *m * corner.radius);
            let beyond = spoke.dot(*m);
            let leaves = || corner.faces(-*m);
            let holds_corner = || tip.normals.iter().all(|m| spoke.dot(*m) > 0.0);
            (is_gap(beyond) && leaves()) || (shorter(touch, -*m, beyond, leaves) && holds_corner())
        };
        // If there is a gap to a face or run that could meet them, they have not met at all.
        (is_gap(below) && leaves_face())
            || shorter(touch, beside, below, leaves_face)
            || tip.normals.iter().any(leaves_run)
    })
}

/// The convex corners at both ends of a face that something is inside of, each with the normal of the
/// adjacent face.
fn outer_ends<'a>(lane: &'a Lane, touch: &Touch) -> impl Iterator<Item = (&'a Corner, Vector)> {
    let face = match touch.on {
        On::Face(face) if touch.distance < 0.0 => Some(face),
        _ => None,
    };
    let ends = face.into_iter().flat_map(|face| [(face, 0), (face + 1, 1)]);
    let corners = ends.map(|(i, side)| (lane.corner(i), side));
    corners
        .filter(|(corner, _)| corner.stands_out)
        .map(|(corner, side)| (corner, corner.normals[side]))
}

/// Whether a corner of the ground inside a run of a part that ends in `tip` has a shorter way out than that
/// run.
pub(super) fn run_yields(lane: &Lane, outward: Vector, tip: &Tip, touch: &Touch) -> bool {
    let On::Corner(i) = touch.on else {
        return false;
    };
    let corner = lane.corner(i);
    if touch.distance >= 0.0 || !corner.stands_out {
        return false;
    }
    let [before, behind] = tip.normals;
    let beside = if outward == before { behind } else { before };
    let below = (tip.place - corner.center).dot(beside) + corner.radius;
    let is_apart = is_gap(below, (tip.place - corner.center).length());
    if is_apart && corner.faces(-beside) {
        return true;
    }
    let beyond = |normal: Vector| (corner.center - tip.place).dot(normal) + corner.radius;
    shorter(touch, -beside, below, || corner.faces(-beside))
        || corner
            .normals
            .iter()
            .any(|n| shorter(touch, *n, beyond(*n), || tip.faces(-*n)))
}

/// Whether a way out [m] of two corners so far from each other [m] is none, so that they have not met: what faces may be
/// out of a corner's cone by rounding, which is a gap over some distance.
fn is_gap(way: f64, apart: f64) -> bool {
    way < -ROUNDING * apart
}

/// Whether a way out of length `depth` along `normal` is shorter than that of `touch`, and open.
fn shorter(touch: &Touch, normal: Vector, depth: f64, open: impl Fn() -> bool) -> bool {
    0.0 < depth && depth < -touch.distance && normal.dot(touch.normal) < ALIKE && open()
}
