//! Where a step of a search leads a contact.

/// A row on the way between two solutions: its speeds along normal and tangent [m/s], and the impulses
/// along them that balance these velocities [N s].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    pub speeds: [f64; 2],
    pub held: [f64; 2],
    /// The same at its end.
    pub to_speeds: [f64; 2],
    pub to_held: [f64; 2],
}

impl Way {
    /// Speeds and impulses after a share of it.
    pub(super) fn after(&self, share: f64) -> [[f64; 2]; 2] {
        let between =
            |from: [f64; 2], to: [f64; 2]| [0, 1].map(|i| from[i] + (to[i] - from[i]) * share);
        [
            between(self.speeds, self.to_speeds),
            between(self.held, self.to_held),
        ]
    }
}
