//! What one motor does.

use serde::{Deserialize, Serialize};

/// What a motor does in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Motor {
    /// Its force gives the surface the set-point.
    Holds,
    /// At its limit, forwards.
    Pushes,
    /// At its limit, backwards.
    Brakes,
    /// There is none.
    Free,
}

/// Of the limit: less beyond it is rounding.
pub(super) const AT_LIMIT: f64 = 1e-12;
/// [m/s] A motor at its limit takes hold again when its surface is past the set-point by this.
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

    /// One that holds with an impulse, if that is within its limit.
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
