//! A constraint that holds both ways, whatever impulse that takes.
//!
//! The equations: docs/physics.md, "The problem".

use super::damper::{COMPLIANCE, Damper};
use super::direction::Direction;
use super::velocities::{ActsOn, Velocities};

/// A direction along which nothing moves.
pub(crate) struct Bilateral {
    pub acts: ActsOn,
    pub along: Direction,
    /// [N s] Impulse along it.
    pub impulse: f64,
    /// [N s] Impulse about which a solve damps it.
    pub(super) center: f64,
    /// The direction with the motors in their state in this solve.
    pub(super) action: Direction,
    /// [1/kg] Velocity per unit impulse along it.
    pub(super) admittance: f64,
}

impl Bilateral {
    pub(crate) fn new(acts: ActsOn, along: Direction) -> Self {
        Self {
            acts,
            along,
            impulse: 0.0,
            center: 0.0,
            action: along,
            admittance: 0.0,
        }
    }

    pub(super) fn damper(&self) -> Damper {
        Damper::new(self.center, 1.0 / (COMPLIANCE * self.admittance))
    }

    /// Updates the impulse to match the velocities; returns the error of the velocity [m/s].
    pub(super) fn follow(&mut self, velocities: &Velocities) -> f64 {
        let slip = self.acts.speed(&self.action, velocities) + self.action.offset;
        self.impulse = self.damper().at(slip);
        slip.abs()
    }
}
