//! A face of a lane, and where something touches it or a corner.

use crate::contact::Contact;
use crate::geometry::Vector;

/// Sine of the angle by which rounding may turn a normal out of the cone of a corner.
pub(in crate::contact) const ROUNDING: f64 = 1e-9;
/// A straight piece of the ground; the solid lies on its right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// [m] Its left end.
    pub begin: Vector,
    /// Unit vector to its right end.
    pub along: Vector,
    /// Unit vector out of the ground.
    pub normal: Vector,
    /// [m] Length; 0 between two arcs that adjoin.
    pub length: f64,
    /// Facet of the profile.
    pub facet: usize,
    /// Edges at both ends.
    pub edges: [i32; 2],
}

/// Where something bears on the ground, or nearly.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Touch {
    /// [m] The place on the ground.
    pub place: Vector,
    /// Unit vector out of the ground.
    pub normal: Vector,
    /// [m] Gap; negative in penetration.
    pub distance: f64,
    /// Facet of the profile.
    pub facet: usize,
    /// Edge that is touched, or -1 on a face.
    pub edge: i32,
    /// The face or the corner.
    pub on: On,
}

/// What of the ground a touch is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::contact) enum On {
    Face(usize),
    Corner(usize),
}

impl Touch {
    /// The same as a contact of a part.
    pub(in crate::contact) fn contact(&self, part: usize) -> Contact {
        Contact {
            part,
            facet: self.facet,
            edge: self.edge,
            point: self.place + self.normal * (0.5 * self.distance),
            normal: self.normal,
            distance: self.distance,
        }
    }
}
