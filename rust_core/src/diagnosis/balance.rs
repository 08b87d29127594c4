//! Is a stop, in whatever engine, an equilibrium of rigid bodies with Coulomb friction?
//!
//! Only the pose, the places where the ground bears, and the surfaces that slide on it count. Forces are computed anew:
//! sliding contacts have friction at its limit against their slip, sticking contacts any friction within it, motors any
//! force within their limits, self-locking gears any force at rest, and the ground only pushes.

use super::scene::Scene;
use crate::geometry::Vector;
use crate::observe::Stance;

/// Range of factors of the friction in which a balance is searched, and their number.
const FACTORS: (f64, f64) = (0.02, 5.0);
const TRIED: u32 = 80;
/// Fraction of the weight up to which a pull is a rounding error.
const LEAST_PULL: f64 = 1e-6;
/// Bisections of an interval between two factors, which leave an error of some parts in ten thousand.
const HALVINGS: u32 = 8;

/// Whether forces can hold a stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// Smallest residual for any choice of forces, as a fraction of the weight.
    pub imbalance: f64,
    /// The fraction of the weight up to which it counts as none.
    pub tolerance: f64,
    /// The interval of friction factors, nearest to 1, in which forces can hold the pose; `None` if they can at none of
    /// those tried.
    pub holds_between: Option<[f64; 2]>,
    /// The contacts that would have to pull, in the balance with the smallest total pull; none in an equilibrium.
    pub pulls: Vec<Pull>,
}

/// A contact that would have to hold the robot down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Index of the part.
    pub body: usize,
    /// [m] Position.
    pub point: Vector,
    /// [N] Pulling force.
    pub force: f64,
}

impl Balance {
    /// Whether it is an equilibrium.
    pub fn holds(&self) -> bool {
        self.imbalance <= self.tolerance
    }
}

/// The balance of a stop; `None` without a weight.
pub(crate) fn balance(scene: &Scene, stance: &Stance, tolerance: f64) -> Option<Balance> {
    let statics = scene.statics_of_surfaces(stance)?;
    let imbalance = statics.imbalance()?;
    let weight = scene.model.mass * scene.gravity;
    let holds = |factor: f64| {
        let there = statics.with_friction(factor).imbalance();
        there.is_some_and(|imbalance| imbalance <= tolerance)
    };
    let pulls = statics.least_pulls(tolerance).unwrap_or_default();
    let pulls = stance.bearings.iter().zip(pulls);
    Some(Balance {
        imbalance,
        tolerance,
        holds_between: around(&holds),
        pulls: pulls
            .filter(|(_, pull)| *pull > LEAST_PULL)
            .map(|(bearing, pull)| Pull {
                body: bearing.contact.part,
                point: bearing.contact.point,
                force: pull * weight,
            })
            .collect(),
    })
}

/// The interval nearest to 1 in which a condition is true.
fn around(holds: &dyn Fn(f64) -> bool) -> Option<[f64; 2]> {
    let (first, last) = FACTORS;
    let at = |k: u32| first * libm::pow(last / first, f64::from(k) / f64::from(TRIED));
    let mut factors: Vec<f64> = (0..=TRIED).map(at).chain([1.0]).collect();
    factors.sort_by(f64::total_cmp);
    let is: Vec<bool> = factors.iter().map(|factor| holds(*factor)).collect();
    let far = |k: usize| libm::log(factors[k]).abs();
    let inside = (0..factors.len()).filter(|k| is[*k]);
    let nearest = inside.min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
    let low = (0..nearest).rev().find(|k| !is[*k]);
    let high = (nearest..factors.len()).find(|k| !is[*k]);
    let end = |within: usize, beyond: Option<usize>, none: f64| {
        beyond.map_or(none, |beyond| edge(holds, factors[within], factors[beyond]))
    };
    let from = low.map_or(0, |k| k + 1);
    let to = high.map_or(factors.len() - 1, |k| k - 1);
    Some([end(from, low, 0.0), end(to, high, f64::INFINITY)])
}

/// The end of that interval, between a factor inside and one outside.
fn edge(holds: &dyn Fn(f64) -> bool, mut within: f64, mut beyond: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (within + beyond);
        if holds(middle) {
            within = middle;
        } else {
            beyond = middle;
        }
    }
    within
}
