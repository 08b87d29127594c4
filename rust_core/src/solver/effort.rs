//! Counts of the solver's work, on which the motion does not depend.
//!
//! The equations: docs/physics.md, "Settling".

use serde::{Deserialize, Serialize};

/// Number of solves, and of their parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Effort {
    /// Steps taken.
    pub steps: u64,
    /// Steps taken again with a shorter one, because their error was too large or a force jumped in them.
    pub repeated_steps: u64,
    /// Searches for impulses that satisfy all constraints: two a step, and those of an impact.
    pub solves: u64,
    /// Linear systems solved in them.
    pub rounds: u64,
    /// How often corrections of states did not lead to a solution, so that a path was followed.
    pub paths: u64,
    /// Solves that found no solution: impulses are those about which dampers acted last.
    pub unresolved: u64,
}

impl Effort {
    /// The sum of this and further work.
    pub(crate) fn plus(self, more: Self) -> Self {
        Self {
            steps: self.steps + more.steps,
            repeated_steps: self.repeated_steps + more.repeated_steps,
            solves: self.solves + more.solves,
            rounds: self.rounds + more.rounds,
            paths: self.paths + more.paths,
            unresolved: self.unresolved + more.unresolved,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_counts_all_work() {
        let one = Effort {
            steps: 2,
            repeated_steps: 3,
            solves: 5,
            rounds: 7,
            paths: 11,
            unresolved: 13,
        };
        let both = Effort {
            steps: 4,
            repeated_steps: 6,
            solves: 10,
            rounds: 14,
            paths: 22,
            unresolved: 26,
        };
        assert_eq!(one.plus(one), both);
        assert_eq!(both.plus(Effort::default()), both);
    }
}
