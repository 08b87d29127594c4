//! Corners of the ground, where two faces meet: an arc, of radius 0 if the corner is sharp.
//!
//! The equations: docs/physics.md, "Contacts".

use super::{On, ROUNDING, Touch};
use crate::geometry::{Vector, cross, left_of};
use crate::terrain::Profile;

/// Sine of the angle by which a side of the robot may turn in a step: beyond its last normal by this angle, the arc of
/// a rounded corner reaches out of the ground by less than 4 um.
const NEARLY: f64 = 0.02;
/// [m] A point this close to an arc is on it.
const SHARED: f64 = 1e-10;

/// Where two faces meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// [m] Centre of its arc.
    pub center: Vector,
    /// [m] Radius of its arc.
    pub radius: f64,
    /// Normals of the faces before and behind it; the arc turns clockwise from the first to the second.
    pub normals: [Vector; 2],
    /// Whether it is convex, so that something can bear on it.
    pub stands_out: bool,
    /// Its edge id.
    pub edge: i32,
    /// First facet of its arc, or the facet that begins at a sharp corner.
    pub(super) facet: usize,
    /// Number of facets of its arc.
    pub(super) facets: usize,
}

impl Corner {
    /// Whether a direction is a normal of the ground at the corner, within rounding.
    pub(crate) fn faces(&self, direction: Vector) -> bool {
        self.is_normal(direction, ROUNDING)
    }

    /// Whether a straight side with this opposite normal bears on the corner, or would after a small turn: at an edge,
    /// where no other ground would bear in its place.
    pub(crate) fn faces_side(&self, direction: Vector) -> bool {
        self.is_normal(direction, if self.edge >= 0 { NEARLY } else { ROUNDING })
    }

    /// Whether a direction is within an angle, of this sine, of the normals of the ground at the corner.
    fn is_normal(&self, direction: Vector, within: f64) -> bool {
        let [before, behind] = self.normals;
        cross(direction, before) >= -within
            && cross(behind, direction) >= -within
            && direction.dot(before + behind) > 0.0
    }

    /// The facet of the profile at a normal of the arc.
    fn facet_at(&self, normal: Vector) -> usize {
        if self.facets == 0 {
            return self.facet;
        }
        let [from, to] = self.normals;
        let angle = |a: Vector, b: Vector| libm::atan2(cross(b, a), a.dot(b));
        let share = angle(from, normal) / angle(from, to);
        self.facet + ((share * self.facets as f64).max(0.0) as usize).min(self.facets - 1)
    }

    /// A touch on the corner along one of its normals.
    pub(crate) fn touch(&self, corner: usize, normal: Vector, distance: f64) -> Touch {
        Touch {
            place: self.center + normal * self.radius,
            normal,
            distance,
            facet: self.facet_at(normal),
            edge: self.edge,
            on: On::Corner(corner),
        }
    }
}

/// The corners of a profile, both ends included; the points of one arc are one corner.
pub(super) fn corners_of(profile: &Profile) -> Vec<Corner> {
    let bends = profile.bends();
    let point = |i: usize| profile.points[bends[i] as usize];
    let edge_of = |i: usize| profile.edge_of_point[bends[i] as usize];
    let last = bends.len() - 1;
    let mut corners = Vec::new();
    let mut i = 0;
    while i <= last {
        let edge = edge_of(i);
        let rounded = usize::try_from(edge)
            .ok()
            .map(|e| &profile.edges[e])
            .filter(|e| e.radius > 0.0);
        // An arc adjacent to the last one shares its end point.
        let shares_point = rounded.is_some_and(|e| {
            let on_arc = |p: Vector| ((p - e.center).length() - e.radius).abs() < SHARED;
            i > 0 && edge != edge_of(i - 1) && on_arc(point(i - 1))
        });
        let first = i - usize::from(shares_point);
        while rounded.is_some() && i < last && edge_of(i + 1) == edge {
            i += 1;
        }
        let normal_of = |a: usize, b: usize| left_of((point(b) - point(a)).normalize());
        let (center, normals) = match rounded {
            Some(e) => {
                let normal = |p: Vector| (p - e.center) / e.radius;
                (e.center, [normal(point(first)), normal(point(i))])
            }
            // Each end of the ground has one normal only.
            None => (
                point(i),
                [
                    normal_of(i.saturating_sub(1), i.max(1)),
                    normal_of(i.min(last - 1), (i + 1).min(last)),
                ],
            ),
        };
        corners.push(Corner {
            center,
            radius: rounded.map_or(0.0, |e| e.radius),
            stands_out: 0 < first && i < last && cross(normals[1], normals[0]) > 0.0,
            normals,
            edge,
            facet: bends[first] as usize,
            facets: i - first,
        });
        i += 1;
    }
    corners
}
