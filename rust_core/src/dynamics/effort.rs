//! What the solves of the motion took: nothing that moves depends on it.

use serde::{Deserialize, Serialize};

/// Numbers of solves, and of what they took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Effort {
    /// Searches for the impulses that all constraints agree on: two a piece of a substep, one with chains.
    pub solves: u64,
    /// Linear systems solved in them with the grips as they were guessed.
    pub rounds: u64,
    /// Descents, where guesses could not be mended.
    pub descents: u64,
    /// Solves that ended without agreement.
    pub unresolved: u64,
}

impl Effort {
    /// With what more was done.
    pub(crate) fn plus(self, more: Self) -> Self {
        Self {
            solves: self.solves + more.solves,
            rounds: self.rounds + more.rounds,
            descents: self.descents + more.descents,
            unresolved: self.unresolved + more.unresolved,
        }
    }
}
