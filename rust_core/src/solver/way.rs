//! The line along which a step of Newton's method moves a contact.
//!
//! The equations: docs/physics.md, "Chains".

/// A row between two solutions: its speeds along normal and tangent [m/s], and the impulses along them that
/// balance these velocities [N s].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    pub speeds: [f64; 2],
    pub held: [f64; 2],
    /// The same at the end of the step.
    pub to_speeds: [f64; 2],
    pub to_held: [f64; 2],
}

impl Way {
    /// Speeds and impulses at a share of the step.
    pub(super) fn after(&self, share: f64) -> [[f64; 2]; 2] {
        let between =
            |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| from[i] + (to[i] - from[i]) * share);
        [
            between(self.speeds, self.to_speeds),
            between(self.held, self.to_held),
        ]
    }
}
