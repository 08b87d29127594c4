//! Why did it stop? Outcome, mechanism and cause of a stop, from what was observed only.
//!
//! No track model is known here: contacts, forces, surface speeds, torques and the geometry of
//! the envelope decide. docs/decisions/0005 explains how, docs/conventions.md defines the words.

mod counterfactual;
mod escape;
mod forces;
mod hinges;
mod linear_program;
mod mechanism;
mod pinch;
mod scene;
mod statics;
mod surfaces;
#[cfg(test)]
mod tests;

use statics::Statics;

use crate::contact::Intrusion;
use crate::geometry::Vector;
use crate::observe::{Outcome, Stance};
use crate::robot::BodyKind;
use crate::terrain::Side;

pub use counterfactual::Counterfactual;
pub use mechanism::Mechanism;
pub use statics::Condition;

pub(crate) use scene::Scene;

/// Why a robot stopped although commanded to move.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// Which kind of stop it is.
    pub outcome: Outcome,
    /// How the most loaded ground inside the track is held, if there is any.
    pub mechanism: Option<Mechanism>,
    /// The smallest sets of conditions without which there is no equilibrium; more than one set is a tie.
    pub cause: Vec<Vec<Condition>>,
    /// Whether closing the pockets would end the equilibrium if the track reached out to the circumscribed circles.
    /// Ground between the grousers of one wheel then counts as in a pocket.
    pub seized_at_tips: bool,
    /// [s] When the stop was examined.
    pub time: f64,
    /// [s] When the stop began.
    pub since: f64,
    /// [m] Mean position of the chassis frame.
    pub position: [f64; 2],
    /// [rad] Mean chassis angle.
    pub chassis_angle: f64,
    /// The most loaded ground inside the track.
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
    /// [N] Largest push at the centre of mass, along the command, that can still be balanced here or within the next
    /// 5 mm, while surfaces keep sliding and motors keep pushing; infinite if any can. `None` without a
    /// certificate, and for a state that keeps rattling.
    pub escape_force: Option<f64>,
    /// [N] The same, here, with every contact and motor free to hold within its limits.
    pub free_escape_force: Option<f64>,
    /// How a closed belt fares from this pose, if that was asked for.
    pub counterfactual: Option<Counterfactual>,
}

/// A connected piece of ground inside the track, with what bears on it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedIntrusion {
    /// Its place and size.
    pub place: Intrusion,
    /// Kinds of the bodies on either side of it.
    pub kinds: [BodyKind; 2],
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

/// Diagnoses a stop.
pub(crate) fn diagnose(scene: &Scene, stance: &Stance, seen: &Seen) -> Diagnosis {
    let criteria = scene.criteria;
    let weight = scene.model.mass * scene.gravity;
    let inside = scene.loaded_intrusions(stance);
    let most_loaded = inside
        .iter()
        .reduce(|most, i| if i.force > most.force { i } else { most });
    let facts = scene.facts(stance, most_loaded);

    let range = stance.range[0].max(stance.range[1]);
    let range = range.max(stance.range[2] * scene.half_length);
    let stationary = range <= criteria.stationary_distance;
    let tolerance = if stationary {
        criteria.imbalance
    } else {
        criteria.mean_imbalance
    };
    let pockets: Vec<&LoadedIntrusion> = inside.iter().filter(|i| scene.is_pocket(i)).collect();
    let statics = scene.statics(stance, &pockets);
    let imbalance = statics.as_ref().and_then(Statics::imbalance);
    let certified = imbalance.is_some_and(|i| i <= tolerance);
    let certificate = statics.as_ref().filter(|_| certified);

    let given = scene.conditions(stance, &facts, !pockets.is_empty());
    let cause = certificate.map_or(Vec::new(), |s| s.cause(tolerance, &given));
    let seized = cause.contains(&vec![Condition::Pocket]);
    let at_tips = || {
        let statics = scene.statics(stance, &inside.iter().collect::<Vec<_>>());
        statics.is_some_and(|s| s.ends(&[Condition::Pocket], tolerance))
    };
    let seized_at_tips = certified && !inside.is_empty() && (seized || at_tips());
    let outcome = if range > criteria.cycling_distance {
        Outcome::Cycling
    } else if seized {
        Outcome::Seized
    } else if facts.belly_share >= criteria.belly_load {
        Outcome::HungUp
    } else if facts.stalled_share >= 0.5 {
        Outcome::Stalled
    } else {
        Outcome::Slipping
    };

    // A state that keeps rattling has no pose to start a push from.
    let resting = certificate.filter(|_| stationary);
    let escape_force = resting.and_then(|s| escape::force(scene, stance, s, tolerance));
    let free_escape = resting.and_then(|s| s.free_escape(scene.direction(), tolerance));
    Diagnosis {
        outcome,
        mechanism: most_loaded.and_then(|_| Mechanism::of(&facts, criteria, weight)),
        cause,
        seized_at_tips,
        time: seen.time,
        since: seen.since,
        position: [stance.position.x, stance.position.y],
        chassis_angle: stance.angle,
        intrusion: most_loaded.cloned(),
        belly_share: facts.belly_share,
        sliding_share: facts.sliding_share,
        stalled_share: facts.stalled_share,
        contacts: facts.contacts,
        progress: seen.progress,
        stationary,
        imbalance,
        certified,
        escape_force: escape_force.map(|push| push * weight),
        free_escape_force: free_escape.map(|push| push.force * weight),
        counterfactual: None,
    }
}
