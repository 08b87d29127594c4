//! A pin between two shoes: two directions in which neither moves over the other.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::Matrix2x3;
use serde::{Deserialize, Serialize};

use crate::dynamics::state::Twist;
use crate::geometry::{Vector, left_of, plausible, plausible_vectors};

/// Compliance of a pin's damper, in units of its admittance: pins are two bodies' only, and nothing else
/// takes their load.
const DAMPING: f64 = 1e-8;

/// The pin at the front of a shoe.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Pin {
    /// [m] From the shoe's centre, and from that of the next shoe.
    arms: [Vector; 2],
    /// [m] How far the next shoe's end is off this one's.
    pub gap: Vector,
    /// [m/s] Speed that the gap closes with.
    bias: Vector,
    /// [kg]
    pub stiffness: f64,
    /// [N s] On the next shoe, in this piece; ...
    pub impulse: Vector,
    /// ... what a direct solve starts from, ...
    center: Vector,
    /// ... and [N] what the next piece starts from.
    pub force: Vector,
}

impl Pin {
    pub(super) fn is_plausible(&self) -> bool {
        let vectors = [self.gap, self.bias, self.impulse, self.center, self.force];
        plausible_vectors(&self.arms) && plausible_vectors(&vectors) && plausible(&[self.stiffness])
    }

    /// Takes its place between two centres, half of `pitch` [m] along the shoes from both of them.
    pub(super) fn follow(&mut self, centers: [Vector; 2], alongs: [Vector; 2], pitch: f64) {
        self.arms = [alongs[0] * (0.5 * pitch), alongs[1] * (-0.5 * pitch)];
        self.gap = centers[1] + self.arms[1] - centers[0] - self.arms[0];
    }

    /// Lets it close its gap within `h` [s].
    pub(super) fn close(&mut self, h: f64, (mass, inertia): (f64, f64), pitch: f64) {
        self.bias = self.gap / h;
        let arm = 0.5 * pitch;
        let admittance = 2.0 / mass + 2.0 * arm * arm / inertia;
        self.stiffness = 1.0 / (DAMPING * admittance);
    }

    /// [N s] Its impulse at a velocity of the next shoe's end over this one's.
    pub(super) fn at(&self, speed: Vector) -> Vector {
        self.center - (speed + self.bias) * self.stiffness
    }

    /// How the velocities of the two shoes count along x and along y.
    pub(super) fn rows(&self) -> [Matrix2x3<f64>; 2] {
        let [a, b] = self.arms.map(left_of);
        [
            Matrix2x3::new(-1.0, 0.0, -a.x, 0.0, -1.0, -a.y),
            Matrix2x3::new(1.0, 0.0, b.x, 0.0, 1.0, b.y),
        ]
    }

    /// [m/s] Velocity of the next shoe's end over this one's.
    pub(super) fn speed(&self, shoe: Twist, next: Twist) -> Vector {
        next.at(self.arms[1]) - shoe.at(self.arms[0])
    }

    /// Takes the impulse that belongs to the velocities; how far these are from what they should be [m/s].
    pub(super) fn follow_velocities(&mut self, shoe: Twist, next: Twist) -> f64 {
        let off = self.speed(shoe, next) + self.bias;
        self.impulse = self.center - off * self.stiffness;
        off.length()
    }

    pub(super) fn settle(&mut self) {
        self.center = self.impulse;
    }

    /// Starts from the force of the last piece in a time [s].
    pub(super) fn guess(&mut self, h: f64) {
        self.impulse = self.force * h;
    }

    /// Keeps the force of a piece of `h` [s].
    pub(super) fn remember(&mut self, h: f64) {
        self.force = self.impulse / h;
    }
}
