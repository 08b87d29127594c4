//! Classifies a stop, and how the ground inside the track is held, from observations only.
//!
//! No track model is known here: contacts, forces, surface speeds, torques and the geometry of the envelope decide.
//! Trials find out later whether the ground inside is the reason (`run/trials`). docs/decisions/0012 explains how,
//! docs/conventions.md defines the terms.

mod balance;
mod findings;
mod scene;
mod statics;
#[cfg(test)]
mod tests;

use statics::Statics;

use crate::observe::{Outcome, Stance};
use crate::scenario::SeizureCriteria;

pub(crate) use balance::balance;
pub use balance::{Balance, Pull};
pub use findings::{Change, Diagnosis, LoadedIntrusion, Mechanism, StopContact, Trial, Wanted};
pub(crate) use scene::Scene;

/// When a stop was observed.
pub(crate) struct StopTimes {
    pub time: f64,
    pub since: f64,
    pub progress: f64,
}

/// The fraction of the weight up to which an imbalance counts as none.
pub(crate) fn tolerance(criteria: &SeizureCriteria, stationary: bool) -> f64 {
    if stationary {
        criteria.imbalance
    } else {
        criteria.mean_imbalance
    }
}

/// Examines a stop; its outcome is the symptom until trials have been made.
pub(crate) fn examine(scene: &Scene, stance: &Stance, times: &StopTimes) -> Diagnosis {
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

    let farthest = |[x, y, angle]: [f64; 3]| x.max(y).max(angle * scene.half_length);
    let stationary = farthest(stance.range) <= criteria.stationary_distance;
    let tolerance = tolerance(criteria, stationary);
    let statics = scene.statics(stance);
    let imbalance = statics.as_ref().and_then(Statics::imbalance);
    let symptom = if farthest(stance.swing) > criteria.cycling_distance {
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
        time: times.time,
        since: times.since,
        position: [stance.position.x, stance.position.y],
        chassis_angle: stance.angle,
        intrusion,
        belly_share: facts.belly_share,
        sliding_share: facts.sliding_share,
        stalled_share: facts.stalled_share,
        contacts: facts.contacts,
        progress: times.progress,
        stationary,
        imbalance,
        certified: imbalance.is_some_and(|i| i <= tolerance),
    }
}
