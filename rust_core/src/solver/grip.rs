//! The state of a contact: open, sticking or sliding.
//!
//! The equations: docs/physics.md, "Coulomb's law".

use serde::{Deserialize, Serialize};

/// The state of a contact in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Grip {
    /// No contact force.
    #[default]
    Open,
    /// It sticks.
    Sticks,
    /// It slides; friction acts along the tangent.
    Forwards,
    /// It slides; friction acts against the tangent.
    Backwards,
}

impl Grip {
    /// The next guess: a change of the direction of slip goes through sticking.
    pub(super) fn towards(self, fitting: Self) -> Self {
        match (self, fitting) {
            (Self::Forwards, Self::Backwards) | (Self::Backwards, Self::Forwards) => Self::Sticks,
            _ => fitting,
        }
    }
}
