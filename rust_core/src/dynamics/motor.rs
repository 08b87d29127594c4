//! The state of a motor.
//!
//! The equations: docs/physics.md, "Motors".

use serde::{Deserialize, Serialize};

/// The state of a motor in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Motor {
    /// Holds the surface at the set-point.
    Holds,
    /// At its limit, forwards.
    Pushes,
    /// At its limit, backwards.
    Brakes,
    /// There is no motor.
    Free,
}

/// Relative tolerance of the limit; a smaller excess is rounding.
pub(super) const AT_LIMIT: f64 = 1e-12;
/// [m/s] A motor at its limit holds again once its surface is past the set-point by this.
pub(super) const PAST: f64 = 1e-9;

impl Motor {
    /// Share of the limit with which it pushes; none if it holds.
    pub(super) fn share(self) -> Option<f64> {
        match self {
            Self::Holds => None,
            Self::Pushes => Some(1.0),
            Self::Brakes => Some(-1.0),
            Self::Free => Some(0.0),
        }
    }

    /// A motor that holds with this impulse, or is at its limit if the impulse exceeds that.
    pub(super) fn within(impulse: f64, limit: f64) -> Self {
        if impulse > limit {
            Self::Pushes
        } else if impulse < -limit {
            Self::Brakes
        } else {
            Self::Holds
        }
    }
}
