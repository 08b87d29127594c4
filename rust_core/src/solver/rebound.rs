//! What contacts give back after a blow.
//!
//! The equations: docs/physics.md, "Impacts".

use super::damper::Damper;
use super::{Inertia, Problem};

impl Problem {
    /// Goes on from the velocities of a solve that was a blow: contacts give back a share of its impulses, along normals
    /// and tangents, and motors have no time to do anything.
    pub(crate) fn rebound(&mut self, share: f64) {
        let blow: Vec<[f64; 2]> = self.contacts.iter().map(super::Contact::impulses).collect();
        self.start_from_here();
        for contact in &mut self.contacts {
            contact.normal_impulse *= share;
            contact.friction_impulse *= share;
        }
        self.tie();
        self.balance();
        self.start_from_here();
        for contact in &mut self.contacts {
            (contact.normal_impulse, contact.friction_impulse) = (0.0, 0.0);
        }
        self.solve();
        for (contact, [normal, friction]) in self.contacts.iter_mut().zip(blow) {
            contact.normal_impulse += (1.0 + share) * normal;
            contact.friction_impulse += (1.0 + share) * friction;
        }
    }

    /// Takes the present velocities as those without constraints.
    fn start_from_here(&mut self) {
        self.free.base = self.velocities.base;
        self.free.spins.clone_from(&self.velocities.spins);
        for inertia in &mut self.inertias {
            let Inertia {
                acts,
                along,
                damper,
            } = *inertia;
            let free = acts.speed(&along, &self.velocities);
            *inertia = Inertia::new(acts, along, damper.stiffness, free);
        }
        for motor in &mut self.motors {
            motor.aim(motor.target, 0.0);
            motor.correction = motor.correction.map(|_| Damper::default());
        }
        for row in &mut self.bilaterals {
            row.impulse = 0.0;
        }
    }
}
