//! What a contact does at given velocities: it is open, holds or slides, and with which impulses.

use serde::{Deserialize, Serialize};

/// What a contact does in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Grip {
    /// Nothing.
    #[default]
    Open,
    /// It holds.
    Sticks,
    /// It slides; friction acts along the tangent.
    Forwards,
    /// It slides; friction acts against the tangent.
    Backwards,
}

impl Grip {
    /// The next guess: between the two directions of slip lies none.
    pub(super) fn towards(self, fitting: Self) -> Self {
        match (self, fitting) {
            (Self::Forwards, Self::Backwards) | (Self::Backwards, Self::Forwards) => Self::Sticks,
            _ => fitting,
        }
    }
}
