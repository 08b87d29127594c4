//! Contacts between the robot's parts and the ground.
//!
//! The equations: docs/physics.md, "Contacts".

mod dents;
mod depth;
mod finder;
mod gear;
mod hull;
mod intrusion;
mod lane;
mod overlap;
mod own;
mod reach;
mod reference;

use serde::{Deserialize, Serialize};

use crate::geometry::{Vector, plausible, plausible_vectors, right_of};
use crate::robot::Model;
use crate::terrain::Profile;

use crate::units::Metres;
pub(crate) use dents::Dents;
pub(crate) use depth::depth;
pub(crate) use finder::ContactFinder;
pub use intrusion::Intrusion;
pub(crate) use intrusion::TrackEnvelope;
pub(crate) use reference::solids_of;

/// A place where a part is on the ground or about to be.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Index of the part.
    pub part: usize,
    /// Facet of the profile, from the left.
    pub facet: usize,
    /// Id of the edge that is touched, or -1 on a face.
    pub edge: i32,
    /// [m] The point halfway between both surfaces.
    pub point: Vector,
    /// Unit normal from the ground to the robot.
    pub normal: Vector,
    /// [m] Gap; negative in penetration.
    pub distance: f64,
    /// Unique number that stays the same from step to step while the contact lasts; 0 when just found.
    pub number: u64,
    /// [m] The point at which it closed.
    pub began: Vector,
}

impl Contact {
    /// Whether a robot and its lanes have the part and the ground of this contact.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let lane = model.parts.get(self.part).and_then(|p| lanes.get(p.lane));
        lane.is_some_and(|lane| {
            let edges = -1..lane.edges.len() as i32;
            self.facet + 1 < lane.points.len() && edges.contains(&self.edge)
        }) && plausible_vectors(&[self.point, self.normal, self.began])
            && plausible(&[self.distance])
    }
}

/// Removes redundant contacts: duplicates on the same part, and contacts that lie between two others with
/// the same normal and are no deeper than these, since a rigid part comes down on its outer contacts
/// first.
pub(crate) fn without_redundant(contacts: &mut Vec<Contact>) {
    /// Normals closer than this count as equal; f64 resolves about 1e-16.
    const SAME_DIRECTION: f64 = 1e-12;

    // A stable order: by part, then from the left, so that neighbours are adjacent.
    contacts.sort_by(|a, b| a.part.cmp(&b.part).then(a.point.x.total_cmp(&b.point.x)));
    let same = |a: &Contact, b: &Contact| {
        a.part == b.part && 1.0 - a.normal.dot(b.normal) < SAME_DIRECTION
    };
    contacts.dedup_by(|b, a| same(a, b) && (a.point - b.point).length() < 1e-9);
    let is_covered = |first: &Contact, middle: &Contact, last: &Contact| {
        same(first, middle) && same(middle, last) && lies_above(first, middle, last)
    };
    let mut kept = 0;
    for i in 0..contacts.len() {
        while kept >= 2 && is_covered(&contacts[kept - 2], &contacts[kept - 1], &contacts[i]) {
            kept -= 1;
        }
        contacts[kept] = contacts[i];
        kept += 1;
    }
    contacts.truncate(kept);
}

/// Whether the middle gap is at least that of the chord between its neighbours.
fn lies_above(first: &Contact, middle: &Contact, last: &Contact) -> bool {
    /// [m] A gap this close to the chord is on the same face.
    const SAME_FACE: Metres = Metres(1e-9);

    let along = right_of(middle.normal);
    let (a, b) = (
        (middle.point - first.point).dot(along),
        (last.point - middle.point).dot(along),
    );
    let chord = (first.distance * b + last.distance * a) / (a + b);
    a * b > 0.0 && middle.distance > chord - SAME_FACE.value()
}
