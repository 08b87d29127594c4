//! Contacts between the robot's parts and the ground.

mod dents;
mod finder;
mod gear;
mod hull;
mod intrusion;
mod lane;
mod overlap;
mod own;
mod reading;
mod reference;

use rapier2d_f64::math::{Pose, Vector};
use serde::{Deserialize, Serialize};

use crate::bounds::{plausible, plausible_vectors};
use crate::chain::ChainOfShoes;
use crate::dynamics::Grip;
use crate::flipper::{Flipper, Mounted};
use crate::plane::right_of;
use crate::robot::{Model, Mount};
use crate::terrain::Profile;
pub(crate) use dents::Dents;
pub(crate) use finder::ContactFinder;
pub use intrusion::Intrusion;
pub(crate) use intrusion::TrackEnvelope;
pub(crate) use reading::Readings;

/// How far what moves over the chassis has moved.
#[derive(Clone, Debug, Default)]
pub(crate) struct Running {
    /// [m] How far the surface of each drive has run.
    pub drives: Vec<f64>,
    /// Frames of the shoes in that of the chassis.
    pub shoes: Vec<Pose>,
    /// Places of the flippers.
    pub flippers: Vec<Mounted>,
}

impl Running {
    /// All of a robot at time 0, when its tracks have run by `track_phase` [m].
    pub(crate) fn at_start(model: &Model, track_phase: f64) -> Self {
        let places = |chain: &ChainOfShoes| chain.path.places(track_phase);
        let mounted = |arm: &Flipper| arm.mounted(arm.sign() * arm.start_angle, model.drive_radius);
        Self {
            drives: vec![track_phase; model.drives],
            shoes: model.chains.iter().flat_map(places).collect(),
            flippers: model.flippers.iter().map(mounted).collect(),
        }
    }

    /// Frame of a mount on a robot whose chassis frame is `pose`.
    pub(crate) fn mounted(&self, mount: Mount, pose: Pose) -> Pose {
        match mount {
            Mount::Chassis => pose,
            Mount::Shoe(shoe) => pose * self.shoes[shoe],
            Mount::Flipper(k) => pose * self.flippers[k].pose,
        }
    }

    /// [m] How far the surface of a drive has run over a mount.
    pub(crate) fn run(&self, mount: Mount, drive: usize) -> f64 {
        let over_chassis = self.drives[drive];
        match mount {
            Mount::Flipper(k) => over_chassis + self.flippers[k].run,
            Mount::Chassis | Mount::Shoe(_) => over_chassis,
        }
    }
}

/// One place where a part is on the ground or about to be.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Index of the part.
    pub part: usize,
    /// Facet of the profile, from the left.
    pub facet: usize,
    /// Edge that is touched, or -1 on a face.
    pub edge: i32,
    /// [m] Where, halfway between both surfaces.
    pub point: Vector,
    /// Unit normal from the ground to the robot.
    pub normal: Vector,
    /// [m] Gap; negative in penetration.
    pub distance: f64,
}

impl Contact {
    /// Whether a robot and its lanes have what it is between.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let lane = model.parts.get(self.part).and_then(|p| lanes.get(p.lane));
        lane.is_some_and(|lane| {
            let edges = -1..lane.edges.len() as i32;
            self.facet + 1 < lane.points.len() && edges.contains(&self.edge)
        }) && plausible_vectors(&[self.point, self.normal])
            && plausible(&[self.distance])
    }
}

/// A contact as the solver keeps it from step to step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct LoadedContact {
    /// Where and what.
    pub contact: Contact,
    /// [N] Mean normal force over the step.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface over ground in the same direction.
    pub surface_speed: f64,
    /// [N] Force that the next step starts from.
    pub normal_guess: f64,
    /// [N] The same along the tangent.
    pub friction_guess: f64,
    /// What it did last.
    pub grip: Grip,
    pub carried_over: bool,
}

impl LoadedContact {
    /// The same, with its forces.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let forces = [
            self.normal_force,
            self.friction_force,
            self.surface_speed,
            self.normal_guess,
            self.friction_guess,
        ];
        self.contact.fits(model, lanes) && plausible(&forces)
    }
}

/// Leaves out contacts that add nothing: those that repeat another of the same part, and those that lie
/// between two others of the same direction and no deeper than these: a rigid part comes down on its
/// neighbours first.
pub(crate) fn without_redundant(contacts: &mut Vec<Contact>) {
    /// Normals closer than this are one direction; f64 keeps about 1e-16.
    const SAME_DIRECTION: f64 = 1e-12;

    // A stable order: by part, then from the left, so that neighbours lie side by side.
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

/// Whether the gap in the middle is no smaller than that of the chord of its neighbours.
fn lies_above(first: &Contact, middle: &Contact, last: &Contact) -> bool {
    /// [m] Gaps closer than this to the chord lie on one face.
    const SAME_FACE: f64 = 1e-9;

    let along = right_of(middle.normal);
    let (a, b) = (
        (middle.point - first.point).dot(along),
        (last.point - middle.point).dot(along),
    );
    let chord = (first.distance * b + last.distance * a) / (a + b);
    a * b > 0.0 && middle.distance > chord - SAME_FACE
}
