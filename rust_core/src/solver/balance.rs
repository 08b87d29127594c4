//! Velocities from impulses: what balances them exactly.
//!
//! The equations: docs/physics.md, "The problem".

use super::Problem;
use super::bodies::Spin;
use super::damper::Damper;
use super::motor::{Driven, Motor};
use crate::geometry::Vector;

impl Problem {
    /// Computes the velocities from all impulses so far, for the current state of the motors. With rings the velocities
    /// that keep links together matter more.
    pub(super) fn balance(&mut self) {
        if self.rings.is_empty() {
            if self.inertias.is_empty() && !self.motors.iter().any(Motor::has_slope) {
                self.balance_base();
            } else {
                self.balance_bodies();
            }
        }
    }

    /// [N m s] Angular momentum of the base and of what turns with it, without contacts.
    pub(super) fn free_moment(&self) -> f64 {
        let of_spin = |motor: &Motor| match (motor.on, motor.given()) {
            (Driven::Spin(_), Some(given)) => -motor.lever * given.at(0.0),
            (Driven::Spin(k), None) => {
                let Spin { inertia, .. } = self.spins[k];
                inertia * (self.free.spins[k] - motor.held_rate().unwrap_or_default())
            }
            _ => 0.0,
        };
        let of_spins: f64 = self.motors.iter().map(of_spin).sum();
        self.base.inertia * self.free.base.turn + of_spins
    }

    fn balance_base(&mut self) {
        let (mut impulse, mut moment) = (Vector::ZERO, self.free_moment());
        for contact in &self.contacts {
            let [n, t] = &contact.actions;
            impulse += contact.impulse();
            moment += n.lever * contact.normal_impulse + t.lever * contact.friction_impulse;
        }
        for row in &self.bilaterals {
            impulse += row.action.unit * row.impulse;
            moment += row.action.lever * row.impulse;
        }
        self.velocities.base.velocity = self.free.base.velocity + impulse / self.base.mass;
        self.velocities.base.turn = moment / self.inertia;
        self.turn_with_base();
        for motor in &self.motors {
            if let (Driven::Spin(k), Some(given)) = (motor.on, motor.given()) {
                let change = self.torques[k] + motor.lever * given.at(0.0);
                self.velocities.spins[k] = self.free.spins[k] + change / self.spins[k].inertia;
            }
        }
    }

    /// The same where inertias or motors act between base and spins, so that all velocities hang together.
    fn balance_bodies(&mut self) {
        self.assemble_bodies();
        for contact in &self.contacts {
            for (action, impulse) in contact.actions.iter().zip(contact.impulses()) {
                let impulse = Damper::constant(impulse);
                self.system.add(contact.acts, [action; 2], impulse);
            }
        }
        for row in &self.bilaterals {
            let impulse = Damper::constant(row.impulse);
            self.system.add(row.acts, [&row.action; 2], impulse);
        }
        if self.solve_for_change().is_some() {
            self.go(1.0);
            self.turn_with_base();
        }
    }
}
