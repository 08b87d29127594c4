//! What a closed belt does in the pose of a stop.

use crate::observe::Outcome;

/// How a closed belt fares from a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counterfactual {
    /// It got away.
    pub freed: bool,
    /// [m] How far it got along the command.
    pub distance: f64,
    /// [s] How long it took to get away; infinite if it did not.
    pub time: f64,
    /// How it stood in the end.
    pub outcome: Outcome,
}
