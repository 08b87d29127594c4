//! What kind of stop is it, and what holds the ground inside the track? From what was observed only.
//!
//! No track model is known here: contacts, forces, surface speeds, torques and the geometry of the envelope decide.
//! Whether the ground inside is the reason is tried afterwards (`run/trials`). docs/decisions/0012 explains how,
//! docs/conventions.md defines the words.

mod balance;
mod hinges;
mod linear_program;
mod mechanism;
mod pinch;
mod scene;
mod statics;
mod surfaces;
#[cfg(test)]
mod tests;
mod trial;

use statics::Statics;

use crate::contact::Intrusion;
use crate::geometry::Vector;
use crate::observe::{Outcome, Stance};
use crate::robot::BodyKind;
use crate::scenario::SeizureCriteria;
use crate::terrain::Side;

pub use balance::{Balance, Pull};
pub use mechanism::Mechanism;
pub use trial::{Change, Trial, Wanted};

pub(crate) use balance::balance;
pub(crate) use scene::Scene;

/// Why a robot stopped although commanded to move.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// Which kind of stop it is, after what was tried.
    pub outcome: Outcome,
    /// What is seen of it, before anything is tried: cycling, hung up, stalled or slipping.
    pub symptom: Outcome,
    /// What was tried, and what came of it.
    pub trials: Vec<Trial>,
    /// Ground between two bodies of a track, deeper than their root circles, bears on that track.
    pub jammed: bool,
    /// How the ground inside the track is held, if there is any.
    pub mechanism: Option<Mechanism>,
    /// [s] When the stop was examined.
    pub time: f64,
    /// [s] When the stop began.
    pub since: f64,
    /// [m] Mean position of the chassis frame.
    pub position: [f64; 2],
    /// [rad] Mean chassis angle.
    pub chassis_angle: f64,
    /// The most loaded ground inside the track: where it is jammed, or else anywhere.
    pub intrusion: Option<LoadedIntrusion>,
    /// The contacts that bear, averaged over the last one to two stop windows.
    pub contacts: Vec<StopContact>,
    /// Share of the load that the belly carries, 0 to 1.
    pub belly_share: f64,
    /// Share of the normal force that is at sliding contacts.
    pub sliding_share: f64,
    /// Share of the motors with ground contact that are at their torque limit.
    pub stalled_share: f64,
    /// Share of the commanded distance made in the last stop window.
    pub progress: f64,
    /// The pose did not change.
    pub stationary: bool,
    /// Smallest residual that any choice of forces leaves, as a share of the weight; `None` if it is unknown.
    pub imbalance: Option<f64>,
    /// The imbalance is within the criteria: the pose may be an equilibrium.
    pub certified: bool,
}

impl Diagnosis {
    /// Whether the stop would not have lasted: a control left it.
    pub fn is_passing(&self) -> bool {
        let left =
            |trial: &Trial| trial.freed && Change::CONTROLS.iter().any(|c| c.name() == trial.name);
        self.trials.iter().any(left)
    }
}

/// A connected piece of ground inside the track, with what bears on it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedIntrusion {
    /// Its place and size.
    pub place: Intrusion,
    /// Kinds of the bodies on either side of it.
    pub kinds: [BodyKind; 2],
    /// Name of what carries them.
    pub carrier: &'static str,
    /// [N] Mean normal force on it.
    pub force: f64,
}

/// A contact of a stop, averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopContact {
    /// Its number.
    pub number: u64,
    /// Its lane.
    pub side: Side,
    /// Index of the part.
    pub body: usize,
    /// Kind of the part.
    pub kind: BodyKind,
    /// Facet of the ground, counted from the left.
    pub segment: usize,
    /// Edge, or -1.
    pub edge: i32,
    /// [m] Position.
    pub point: Vector,
    /// Direction from the ground to the robot.
    pub normal: Vector,
    /// [N] Normal force.
    pub normal_force: f64,
    /// [N] Friction on the robot, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Slip velocity: that of the robot's surface relative to the ground, in that direction.
    pub surface_speed: f64,
    /// It slides at its friction limit.
    pub slides: bool,
    /// It bears on the most loaded ground inside the track.
    pub in_pocket: bool,
}

/// When a stop was observed.
pub(crate) struct Seen {
    pub time: f64,
    pub since: f64,
    pub progress: f64,
}

/// The share of the weight up to which an imbalance counts as none.
pub(crate) fn tolerance(criteria: &SeizureCriteria, stationary: bool) -> f64 {
    if stationary {
        criteria.imbalance
    } else {
        criteria.mean_imbalance
    }
}

/// Examines a stop; its outcome is the symptom until something has been tried.
pub(crate) fn examine(scene: &Scene, stance: &Stance, seen: &Seen) -> Diagnosis {
    let criteria = scene.criteria;
    let inside = scene.loaded_intrusions(stance);
    let most_loaded = |pieces: &mut dyn Iterator<Item = &LoadedIntrusion>| {
        let most = pieces.reduce(|most, i| if i.force > most.force { i } else { most });
        most.cloned()
    };
    let jam = most_loaded(&mut inside.iter().filter(|i| scene.is_pocket(i)));
    let jammed = jam.is_some();
    let intrusion = jam.or_else(|| most_loaded(&mut inside.iter()));
    let facts = scene.facts(stance, intrusion.as_ref());

    let range = stance.range[0].max(stance.range[1]);
    let range = range.max(stance.range[2] * scene.half_length);
    let stationary = range <= criteria.stationary_distance;
    let tolerance = tolerance(criteria, stationary);
    let statics = scene.statics(stance);
    let imbalance = statics.as_ref().and_then(Statics::imbalance);
    let symptom = if range > criteria.cycling_distance {
        Outcome::Cycling
    } else if facts.belly_share >= criteria.belly_load {
        Outcome::HungUp
    } else if facts.stalled_share >= 0.5 {
        Outcome::Stalled
    } else {
        Outcome::Slipping
    };
    let weight = scene.model.mass * scene.gravity;
    let held = intrusion.as_ref();
    Diagnosis {
        outcome: symptom,
        symptom,
        trials: Vec::new(),
        jammed,
        mechanism: held.and_then(|_| Mechanism::of(&facts, criteria, weight)),
        time: seen.time,
        since: seen.since,
        position: [stance.position.x, stance.position.y],
        chassis_angle: stance.angle,
        intrusion,
        belly_share: facts.belly_share,
        sliding_share: facts.sliding_share,
        stalled_share: facts.stalled_share,
        contacts: facts.contacts,
        progress: seen.progress,
        stationary,
        imbalance,
        certified: imbalance.is_some_and(|i| i <= tolerance),
    }
}
