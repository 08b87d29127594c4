//! Counts of the solver's work; the motion does not depend on them.
//!
//! The equations: docs/physics.md, "Direct search".

use serde::{Deserialize, Serialize};

/// Number of solves, and of their parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Effort {
    /// Searches for impulses that satisfy all constraints: two per piece of a substep.
    pub solves: u64,
    /// Linear systems solved in direct searches.
    pub rounds: u64,
    /// Descents, where no guess could be corrected.
    pub descents: u64,
    /// Solves that ended without a solution.
    pub unresolved: u64,
}

impl Effort {
    /// The sum with further work.
    pub(crate) fn plus(self, more: Self) -> Self {
        Self {
            solves: self.solves + more.solves,
            rounds: self.rounds + more.rounds,
            descents: self.descents + more.descents,
            unresolved: self.unresolved + more.unresolved,
        }
    }
}
