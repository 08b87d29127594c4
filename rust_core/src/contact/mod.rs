//! Contacts between the robot's parts and the ground.
//!
//! The equations: docs/physics.md, "Contacts", and what a step has found: docs/physics.md, "State".

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
use crate::solver::Grip;
use crate::terrain::Profile;

use crate::units::Metres;
pub(crate) use dents::Dents;
pub(crate) use depth::depth;
pub(crate) use finder::ContactFinder;
pub use intrusion::Intrusion;
pub(crate) use intrusion::TrackEnvelope;
pub(crate) use reference::solids_of;

/// A place where a part is on the ground or about to be, and what a step has found there.
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
    /// [N] Mean normal force over the step; 0 when just found, as all that follows.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface over the ground in the same direction.
    pub surface_speed: f64,
    /// [N] Normal force from which the next step starts.
    pub normal_guess: f64,
    /// [N] Friction from which the next step starts.
    pub friction_guess: f64,
    /// Its last grip.
    pub grip: Grip,
}

impl Contact {
    /// One that has not carried a load yet.
    pub(crate) fn new(
        part: usize,
        (facet, edge): (usize, i32),
        (point, normal): (Vector, Vector),
        distance: f64,
    ) -> Self {
        Self {
            part,
            facet,
            edge,
            point,
            normal,
            distance,
            number: 0,
            began: point,
            normal_force: 0.0,
            friction_force: 0.0,
            surface_speed: 0.0,
            normal_guess: 0.0,
            friction_guess: 0.0,
            grip: Grip::Open,
        }
    }

    /// [N] Force on the robot.
    pub(crate) fn force(&self) -> Vector {
        self.normal * self.normal_force + right_of(self.normal) * self.friction_force
    }

    /// Whether a robot and its lanes have the part and the ground of this contact, and its forces are plausible.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let lane = model.parts.get(self.part).and_then(|p| lanes.get(p.lane));
        lane.is_some_and(|lane| {
            let edges = -1..lane.edges.len() as i32;
            self.facet + 1 < lane.points.len() && edges.contains(&self.edge)
        }) && plausible_vectors(&[self.point, self.normal, self.began])
            && plausible(&[
                self.distance,
                self.normal_force,
                self.friction_force,
                self.surface_speed,
                self.normal_guess,
                self.friction_guess,
            ])
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
