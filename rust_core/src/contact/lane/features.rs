//! Faces and corners of a lane, and touches, where something bears on one of them.
//!
//! Two faces meet at a corner, which is an arc, of radius 0 if the corner is sharp.
//!
//! The equations: docs/physics.md, "Contacts".

use std::ops::Range;

use crate::contact::Contact;
use crate::geometry::{Vector, cross, is_between, left_of};
use crate::terrain::{Edge, Profile};

/// Sine of the angle by which a side of the robot may turn in a step. By this angle beyond its last normal, the arc of
/// a rounded corner protrudes from the ground by less than 4 um.
pub(super) const TURN_IN_A_STEP: f64 = 0.02;

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
    pub is_convex: bool,
    /// Its edge id.
    pub edge: i32,
    /// First facet of its arc, or the facet that begins at a sharp corner.
    pub(super) facet: usize,
    /// Number of facets of its arc.
    pub(super) facets: usize,
}

impl Corner {
    /// [m] Length of its arc.
    pub(super) fn arc_length(&self) -> f64 {
        self.radius * turn(self.normals[0], self.normals[1])
    }

    /// Whether a direction is a normal of the ground at the corner, within rounding.
    pub(crate) fn has_normal(&self, direction: Vector) -> bool {
        self.has_normal_within(direction, ROUNDING)
    }

    /// Whether a straight side with this opposite normal bears on the corner, or would after a small turn at an edge,
    /// where no other ground would bear instead.
    pub(crate) fn nearly_has_normal(&self, direction: Vector) -> bool {
        let is_edge = self.edge >= 0;
        self.has_normal_within(direction, if is_edge { TURN_IN_A_STEP } else { ROUNDING })
    }

    /// Whether a direction is within an angle, of this sine, of the normals of the ground at the corner.
    fn has_normal_within(&self, direction: Vector, within: f64) -> bool {
        let [before, behind] = self.normals;
        is_between(direction, [behind, before], within)
    }

    /// The facet of the profile at a normal of the arc.
    fn facet_at(&self, normal: Vector) -> usize {
        if self.facets == 0 {
            return self.facet;
        }
        let [from, to] = self.normals;
        let fraction = turn(from, normal) / turn(from, to);
        self.facet + ((fraction * self.facets as f64).max(0.0) as usize).min(self.facets - 1)
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

/// [rad] Clockwise turn from one direction to another.
fn turn(from: Vector, to: Vector) -> f64 {
    libm::atan2(cross(to, from), from.dot(to))
}

/// The corners of a profile from left to right, including both ends. Two that share a point have no face between them.
pub(super) fn corners_of(profile: &Profile) -> Vec<Corner> {
    let bends = profile.bends();
    let mut edges = profile.edges.iter().peekable();
    let mut corners = Vec::new();
    for (i, bend) in bends.iter().enumerate() {
        // Edges that do not bend straight ground are skipped.
        while edges.next_if(|edge| edge.span[0] < *bend).is_some() {}
        if profile.edge_of_point[*bend as usize] < 0 {
            corners.push(sharp(profile, i, -1));
        }
        while let Some(edge) = edges.next_if(|edge| edge.span[0] == *bend) {
            corners.push(if edge.radius > 0.0 {
                rounded(profile, edge)
            } else {
                sharp(profile, i, edge.id)
            });
        }
    }
    // An arc leaves a shared point along its own tangent, not along its first facet.
    for i in 1..corners.len() {
        let (before, behind) = (corners[i - 1], corners[i]);
        if before.facet + before.facets < behind.facet {
            continue;
        }
        if before.radius > 0.0 && behind.radius <= 0.0 {
            corners[i].normals[0] = before.normals[1];
        } else if behind.radius > 0.0 && before.radius <= 0.0 {
            corners[i - 1].normals[1] = behind.normals[0];
        }
    }
    corners
}

/// A sharp corner at a bend of the profile.
fn sharp(profile: &Profile, bend: usize, edge: i32) -> Corner {
    let bends = profile.bends();
    let last = bends.len() - 1;
    let point = |i: usize| profile.points[bends[i] as usize];
    let normal_of = |a: usize, b: usize| left_of((point(b) - point(a)).normalize());
    // Each end of the ground has only one normal, and so is not convex.
    let normals = [
        normal_of(bend.saturating_sub(1), bend.max(1)),
        normal_of(bend.min(last - 1), (bend + 1).min(last)),
    ];
    Corner {
        center: point(bend),
        radius: 0.0,
        is_convex: cross(normals[1], normals[0]) > 0.0,
        normals,
        edge,
        facet: bends[bend] as usize,
        facets: 0,
    }
}

/// The corner of a rounded edge.
fn rounded(profile: &Profile, edge: &Edge) -> Corner {
    let [first, last] = edge.span.map(|i| i as usize);
    let normal = |i: usize| (profile.points[i] - edge.center) / edge.radius;
    let normals = [normal(first), normal(last)];
    Corner {
        center: edge.center,
        radius: edge.radius,
        is_convex: cross(normals[1], normals[0]) > 0.0,
        normals,
        edge: edge.id,
        facet: first,
        facets: last - first,
    }
}

/// Sine of the angle by which rounding may turn a normal out of a corner's cone.
pub(in crate::contact) const ROUNDING: f64 = 1e-9;
/// A straight piece of the ground; the solid is on its right.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// [m] Its left end.
    pub begin: Vector,
    /// Unit vector to its right end.
    pub along: Vector,
    /// Unit vector out of the ground.
    pub normal: Vector,
    /// [m] Length; 0 where an arc takes up all of it.
    pub length: f64,
    /// [m] Length including the arcs that take up the rest of the described face.
    pub extent: f64,
    /// Facets of the profile that make it up.
    pub facets: Range<usize>,
    /// Edge ids at both ends.
    pub edges: [i32; 2],
}

/// Where something bears on the ground, or nearly does.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Touch {
    /// [m] The point on the ground.
    pub place: Vector,
    /// Unit vector out of the ground.
    pub normal: Vector,
    /// [m] Gap; negative in penetration.
    pub distance: f64,
    /// Facet of the profile.
    pub facet: usize,
    /// Id of the edge that is touched, or -1 on a face.
    pub edge: i32,
    /// The face or corner.
    pub on: On,
}

/// The feature of the ground that is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::contact) enum On {
    Face(usize),
    Corner(usize),
}

impl Touch {
    /// The touch as a contact of a part.
    pub(in crate::contact) fn contact(&self, part: usize) -> Contact {
        let point = self.place + self.normal * (0.5 * self.distance);
        Contact::new(
            part,
            (self.facet, self.edge),
            (point, self.normal),
            self.distance,
        )
    }
}
