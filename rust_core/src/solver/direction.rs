//! A direction in which a constraint acts, and how velocities add up along it: a row of the Jacobian.
//!
//! The equations: docs/physics.md, "The problem".

use super::twist::Twist;
use crate::geometry::Vector;

/// A direction, with the levers by which velocities act along it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Direction {
    pub unit: Vector,
    /// [m] Lever of the turn of the base, or of the link.
    pub lever: f64,
    /// [m] Lever of what spins; of what slides, the share of its speed.
    pub spin_lever: f64,
    /// [m] Lever of the reaction on the base, if it takes that.
    pub back: f64,
    /// [m] Lever of the rate of what is hinged to the base; `lever` is then that of the hinge.
    pub joint_lever: f64,
    /// [m/s] Constant part of the speed.
    pub offset: f64,
}

impl Direction {
    /// The same once what spins, or what is hinged, turns with the base at these rates beside it [rad/s].
    pub(super) fn tied(self, spin: Option<f64>, joint: Option<f64>) -> Self {
        let mut tied = self;
        if let Some(rate) = spin {
            tied.lever += self.spin_lever;
            tied.offset += self.spin_lever * rate;
            tied.spin_lever = 0.0;
        }
        if let Some(rate) = joint {
            tied.lever += self.joint_lever;
            tied.offset += self.joint_lever * rate;
            tied.joint_lever = 0.0;
        }
        tied
    }

    /// [m/s] The part of the speed that a body has along it.
    pub(super) fn on(&self, body: Twist) -> f64 {
        self.unit.dot(body.velocity) + self.lever * body.turn
    }

    /// Its entries for x, y and angle.
    pub(super) fn body(&self) -> [f64; 3] {
        [self.unit.x, self.unit.y, self.lever]
    }

    /// Entries of the reaction for x, y and angle of the base, and for what spins or slides.
    pub(super) fn reaction(&self) -> [f64; 4] {
        [-self.unit.x, -self.unit.y, -self.back, self.spin_lever]
    }

    /// The sum of this and a share of another one.
    pub(super) fn plus(&self, other: &Self, share: f64) -> Self {
        Self {
            unit: self.unit + other.unit * share,
            lever: self.lever + other.lever * share,
            spin_lever: self.spin_lever + other.spin_lever * share,
            back: self.back + other.back * share,
            joint_lever: self.joint_lever + other.joint_lever * share,
            offset: self.offset + other.offset * share,
        }
    }
}
