//! What a closed belt does in the pose of a stop.

use crate::observe::Outcome;

/// How a closed belt fares from a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counterfactual {
    /// It escaped.
    pub freed: bool,
    /// [m] How far it advanced in the commanded direction.
    pub distance: f64,
    /// [s] How long it took to escape; infinite if it did not.
    pub time: f64,
    /// Its outcome at the end of that time.
    pub outcome: Outcome,
}
