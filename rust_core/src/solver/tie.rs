//! Ties: what motors hold turns with the base, and is no unknown.
//!
//! The equations: docs/physics.md, "The problem".

use super::Problem;
use super::bodies::{Joint, Spin};
use super::direction::Direction;
use super::motor::Driven;
use super::velocities::{ActsOn, Link};

impl Problem {
    /// Ties what motors hold to the base, and finds the directions of all constraints with that.
    pub(super) fn tie(&mut self) {
        for motor in &self.motors {
            match motor.on {
                Driven::Spin(k) => self.spins[k].held = motor.held_rate(),
                Driven::Joint(k) => self.joints[k].held = motor.held_rate(),
                Driven::Ring(_) => {}
            }
        }
        let held = self.spins.iter().filter(|spin| spin.held.is_some());
        self.inertia = self.base.inertia + held.map(|spin| spin.inertia).sum::<f64>();
        for i in 0..self.contacts.len() {
            let contact = &self.contacts[i];
            let acts = contact.acts;
            let actions = [contact.normal, contact.tangent].map(|along| self.tied(acts, along));
            let [normal, tangent] = actions.map(|action| self.admittance(acts, &action));
            let contact = &mut self.contacts[i];
            contact.actions = actions;
            (contact.admittance.normal, contact.admittance.tangent) = (normal, tangent);
            contact.admittance.spring = self.mass_on_springs.map_or(normal, f64::recip);
        }
        for i in 0..self.bilaterals.len() {
            let row = &self.bilaterals[i];
            let action = self.tied(row.acts, row.along);
            let admittance = self.admittance(row.acts, &action);
            let row = &mut self.bilaterals[i];
            (row.action, row.admittance) = (action, admittance);
        }
    }

    /// A direction with the motors in their present state.
    pub(super) fn tied(&self, acts: ActsOn, along: Direction) -> Direction {
        match acts {
            ActsOn::Base { joint, spin } => along.tied(
                spin.and_then(|k| self.spins[k].held),
                joint.and_then(|k| self.joints[k].held),
            ),
            _ => along,
        }
    }

    /// Sets what turns with the base to do so, and sums the angular impulses on what spins.
    pub(super) fn turn_with_base(&mut self) {
        let turn = self.velocities.base.turn;
        for (rate, spin) in self.velocities.spins.iter_mut().zip(&self.spins) {
            if let Some(held) = spin.held {
                *rate = turn + held;
            }
        }
        for (rate, joint) in self.velocities.joints.iter_mut().zip(&self.joints) {
            if let Some(held) = joint.held {
                *rate = turn + held;
            }
        }
        self.sum_torques();
    }

    fn sum_torques(&mut self) {
        self.torques.fill(0.0);
        for contact in &self.contacts {
            if let Some(k) = contact.acts.spin() {
                self.torques[k] += contact.torque();
            }
        }
        for row in &self.bilaterals {
            if let Some(k) = row.acts.spin() {
                self.torques[k] += row.along.spin_lever * row.impulse;
            }
        }
    }

    /// [1/kg] Speed along a direction per unit impulse along it.
    fn admittance(&self, acts: ActsOn, along: &Direction) -> f64 {
        let of_body = |mass: f64, inertia: f64, lever: f64| {
            along.unit.length_squared() / mass + lever * lever / inertia
        };
        let of_base = |lever: f64| of_body(self.base.mass, self.inertia, lever);
        let of_spin = |k: usize| along.spin_lever * along.spin_lever / self.spins[k].inertia;
        let of_rotor = |k: usize| {
            let Spin { inertia, rotor, .. } = self.spins[k];
            if rotor == 0.0 || along.spin_lever == 0.0 {
                return 0.0;
            }
            // It turns with the difference of spin and base (Sherman and Morrison 1950).
            let turned = along.spin_lever / inertia - along.lever / self.inertia;
            turned * turned / (rotor.recip() + inertia.recip() + self.inertia.recip())
        };
        let of_link = |link: Link| {
            let ring = &self.rings[link.ring];
            of_body(ring.mass, ring.inertia, along.lever)
        };
        match acts {
            ActsOn::Base { joint, spin } => {
                let of_joint = joint.map_or(0.0, |k| {
                    let Joint { mass, inertia, .. } = self.joints[k];
                    of_body(mass, inertia, along.joint_lever)
                });
                of_base(along.lever) + spin.map_or(0.0, |k| of_spin(k) - of_rotor(k)) + of_joint
            }
            ActsOn::Link(link) => of_link(link),
            ActsOn::LinkAndSlide(link) => of_link(link) + of_base(along.back),
            ActsOn::LinkAndSpin { link, spin } => {
                of_link(link) + of_base(along.back) + of_spin(spin)
            }
        }
    }
}
