//! A pin between two shoes: it keeps their ends together in both directions.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::Matrix2x3;
use serde::{Deserialize, Serialize};

use crate::dynamics::state::Twist;
use crate::geometry::{Vector, left_of, plausible, plausible_vectors};

/// Compliance of a pin's damper, in units of its admittance: a pin joins just two bodies, and nothing else
/// carries its load.
const DAMPING: f64 = 1e-8;

/// The pin at the front of a shoe.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pin {
    /// [m] From the centre of the shoe, and from that of the next shoe, to the pin.
    arms: [Vector; 2],
    /// [m] Offset of the next shoe's end from this one's.
    pub gap: Vector,
    /// [m/s] Velocity at which the gap is to close.
    bias: Vector,
    /// [kg] Impulse per speed.
    pub stiffness: f64,
    /// [N s] Impulse on the next shoe in this piece.
    pub impulse: Vector,
    /// [N s] Impulse about which a direct solve damps it.
    center: Vector,
    /// [N] Force from which the next piece starts.
    pub force: Vector,
}

impl Pin {
    pub(super) fn is_plausible(&self) -> bool {
        let vectors = [self.gap, self.bias, self.impulse, self.center, self.force];
        plausible_vectors(&self.arms) && plausible_vectors(&vectors) && plausible(&[self.stiffness])
    }

    /// Updates arms and gap for two shoes; the pin is half of `pitch` [m] along the shoes from both centres.
    pub(super) fn follow(&mut self, centers: [Vector; 2], alongs: [Vector; 2], pitch: f64) {
        self.arms = [alongs[0] * (0.5 * pitch), alongs[1] * (-0.5 * pitch)];
        self.gap = centers[1] + self.arms[1] - centers[0] - self.arms[0];
    }

    /// Sets it to close its gap within `h` [s].
    pub(super) fn close(&mut self, h: f64, (mass, inertia): (f64, f64), pitch: f64) {
        self.bias = self.gap / h;
        let arm = 0.5 * pitch;
        let admittance = 2.0 / mass + 2.0 * arm * arm / inertia;
        self.stiffness = 1.0 / (DAMPING * admittance);
    }

    /// [N s] Its impulse at a velocity of the next shoe's end relative to this one's.
    pub(super) fn at(&self, speed: Vector) -> Vector {
        self.center - (speed + self.bias) * self.stiffness
    }

    /// Entries of the two shoes' velocities along x and along y.
    pub(super) fn rows(&self) -> [Matrix2x3<f64>; 2] {
        let [a, b] = self.arms.map(left_of);
        [
            Matrix2x3::new(-1.0, 0.0, -a.x, 0.0, -1.0, -a.y),
            Matrix2x3::new(1.0, 0.0, b.x, 0.0, 1.0, b.y),
        ]
    }

    /// [m/s] Velocity of the next shoe's end relative to this one's.
    pub(super) fn speed(&self, shoe: Twist, next: Twist) -> Vector {
        next.at(self.arms[1]) - shoe.at(self.arms[0])
    }

    /// Updates the impulse to match the velocities; returns the error of the velocity [m/s].
    pub(super) fn follow_velocities(&mut self, shoe: Twist, next: Twist) -> f64 {
        let off = self.speed(shoe, next) + self.bias;
        self.impulse = self.center - off * self.stiffness;
        off.length()
    }

    pub(super) fn settle(&mut self) {
        self.center = self.impulse;
    }

    /// Starts a piece of `h` [s] from the force of the last one.
    pub(super) fn guess(&mut self, h: f64) {
        self.impulse = self.force * h;
    }

    /// Stores the force of a piece of `h` [s].
    pub(super) fn remember(&mut self, h: f64) {
        self.force = self.impulse / h;
    }
}
