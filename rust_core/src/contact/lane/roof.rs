//! Lines above finely cut ground. What lies between two corners that bear on one straight run of a part,
//! and no higher than the line through both, does not bear.

use rapier2d_f64::math::Vector;

use super::{Corner, Touch};
use crate::plane::left_of;

/// [m] Ground that rises above a chord by less bears no more than the chord's ends: a thousandth of the
/// deepest overlap there should ever be.
const SAME_FACE: f64 = 1e-6;

/// Both ends of a line that no corner of a stretch of ground rises above, about parallel to it.
pub(super) type Roof = [Vector; 2];

/// The roof of a few neighbouring corners.
pub(super) fn roof(corners: &[Corner]) -> Roof {
    let (first, last) = (corners[0].center, corners[corners.len() - 1].center);
    let (way, steepest) = (last - first, 10.0);
    let slope = if way.y.abs() < steepest * way.x {
        way.y / way.x
    } else {
        0.0
    };
    let above = |c: &Corner| {
        let rise = c.radius * (1.0 + slope * slope).sqrt();
        c.center.y + rise - slope * (c.center.x - first.x)
    };
    let most = corners.iter().map(above).fold(f64::NEG_INFINITY, f64::max);
    let reach = corners.iter().map(|c| c.radius).fold(0.0, f64::max);
    [first.x - reach, last.x + reach].map(|x| Vector::new(x, most + slope * (x - first.x)))
}

/// The line through two corners that bear on the same straight run.
pub(super) struct Chord {
    ends: [Vector; 2],
    up: Vector,
}

impl Chord {
    /// From left to right, if both bear on the same run.
    pub(super) fn new(first: &Touch, last: &Touch) -> Option<Self> {
        let [a, b] = [first.place, last.place];
        let is_one_run = first.normal.dot(last.normal) > 1.0 - 1e-12;
        (is_one_run && a.x < b.x).then(|| Self {
            ends: [a, b],
            up: left_of((b - a).normalize()),
        })
    }

    /// Whether a point lies between its ends and no higher.
    fn hides(&self, point: Vector) -> bool {
        let [a, b] = self.ends;
        a.x <= point.x && point.x <= b.x && (point - a).dot(self.up) < SAME_FACE
    }

    /// Whether a corner does.
    pub(super) fn hides_corner(&self, corner: &Corner) -> bool {
        self.hides(corner.center + self.up * corner.radius)
    }

    /// Whether all below a roof does.
    pub(super) fn hides_all(&self, roof: &Roof) -> bool {
        roof.iter().all(|end| self.hides(*end))
    }
}
