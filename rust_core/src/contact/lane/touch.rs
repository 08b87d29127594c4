//! Faces of a lane, and touches: where something bears on a face or a corner.
//!
//! The equations: docs/physics.md, "Contacts".

use std::ops::Range;

use crate::contact::Contact;
use crate::geometry::Vector;

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
    /// [m] The same with the arcs that take up the rest of the described face.
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
