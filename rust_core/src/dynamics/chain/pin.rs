//! A pin between two shoes: it keeps their ends together in both directions.
//!
//! The equations: docs/physics.md, "Chains".

use serde::{Deserialize, Serialize};

use crate::geometry::{Vector, plausible_vectors};

/// The pin at the front of a shoe.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pin {
    /// [m] From the centre of the shoe, and from that of the next shoe, to the pin.
    pub arms: [Vector; 2],
    /// [m] Offset of the next shoe's end from this one's.
    pub gap: Vector,
    /// [N] Mean force on the next shoe in the last step.
    pub force: Vector,
}

impl Pin {
    pub(super) fn is_plausible(&self) -> bool {
        plausible_vectors(&self.arms) && plausible_vectors(&[self.gap, self.force])
    }

    /// Measures its gap between shoes with these centres.
    pub(super) fn measure(&mut self, centers: [Vector; 2]) {
        self.gap = centers[1] + self.arms[1] - centers[0] - self.arms[0];
    }

    /// Turns its arms: it is half of `pitch` [m] along the shoes from both centres.
    pub(super) fn turn(&mut self, alongs: [Vector; 2], pitch: f64) {
        self.arms = [alongs[0] * (0.5 * pitch), alongs[1] * (-0.5 * pitch)];
    }

    /// [N m] Torque per radian with which its force turns each of the two shoes back: under tension, a shoe comes back into
    /// line.
    pub(super) fn straightens(&self) -> [f64; 2] {
        [-self.arms[0].dot(self.force), self.arms[1].dot(self.force)]
    }
}
