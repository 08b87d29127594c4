//! Places along a profile: facets, the points between them, and the edges there.

use std::ops::Range;

use super::Profile;
use crate::geometry::Vector;
use crate::units::Metres;

/// [m] A contact this close to a vertex touches the edge, not the face beside it.
const AT_VERTEX: Metres = Metres(1e-7);

impl Profile {
    /// Position along the profile of a point on a facet, as the index of the facet plus a share of it, and the
    /// length [m] of the facet.
    pub(crate) fn place_on(&self, facet: usize, point: Vector) -> (f64, f64) {
        let (a, b) = (self.points[facet], self.points[facet + 1]);
        let (way, length) = (b - a, (b - a).length());
        let share = (point - a).dot(way) / (length * length);
        (facet as f64 + share.clamp(0.0, 1.0), length)
    }

    /// The same for a share of a straight piece of facets.
    pub(crate) fn place_along(&self, facets: Range<usize>, share: f64) -> f64 {
        if facets.len() == 1 {
            return facets.start as f64 + share;
        }
        let (begin, end) = (self.points[facets.start], self.points[facets.end]);
        let point = begin + (end - begin) * share;
        self.place_on(facet_along(&self.points, facets, share), point)
            .0
    }

    /// The edge that a point on a facet touches, or -1 on a face.
    pub(crate) fn edge_at(&self, facet: usize, point: Vector) -> i32 {
        let (left, right) = (self.edge_of_point[facet], self.edge_of_point[facet + 1]);
        let on_arc = left == right && left >= 0;
        if on_arc || (point - self.points[facet]).length() < AT_VERTEX.value() {
            left
        } else if (point - self.points[facet + 1]).length() < AT_VERTEX.value() {
            right
        } else {
            -1
        }
    }
}

/// The facet at a share of the way along a straight piece of facets.
pub(crate) fn facet_along(points: &[Vector], facets: Range<usize>, share: f64) -> usize {
    let Range { start, end } = facets;
    if end <= start + 1 {
        return start;
    }
    let way = points[end] - points[start];
    let far = share * way.length_squared();
    let is_behind = |i: usize| (points[i] - points[start]).dot(way) <= far;
    // Pieces are often equally long.
    let guess = start + ((share * (end - start) as f64).max(0.0) as usize).min(end - start - 1);
    let is_first = guess == start || is_behind(guess);
    if is_first && (guess + 1 == end || !is_behind(guess + 1)) {
        return guess;
    }
    let (mut facet, mut behind) = (start, end);
    while facet + 1 < behind {
        let middle = facet.midpoint(behind);
        if is_behind(middle) {
            facet = middle;
        } else {
            behind = middle;
        }
    }
    facet
}
