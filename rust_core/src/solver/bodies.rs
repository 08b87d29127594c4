//! The bodies in a solve: what motors hold, the system of all constraints, and velocities from impulses.
//!
//! The equations: docs/physics.md, "The problem".

use super::contact::Admittances;
use super::motor::Driven;
use super::ring::Ring;
use super::row::Row;
use super::system::System;
use super::{Damper, Problem};

impl Problem {
    /// Ties what motors hold to the base, and finds the directions of all constraints with that.
    pub(super) fn tie(&mut self) {
        for motor in &self.motors {
            if let Driven::Body(at) = motor.on {
                self.system.hold(at, motor.held_rate());
            }
        }
        for inertia in &mut self.inertias {
            inertia.action = self.system.tied(&inertia.row);
        }
        self.system.weigh(&self.masses, &self.inertias);
        let (system, rings) = (&self.system, &self.rings);
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            contact.actions[0] = system.tied(&contact.normal);
            contact.actions[1] = system.tied(&contact.tangent);
            let own = [0, 1].map(|i| admittance(&contact.actions[i], system, rings));
            let springs = contact.mass.map_or(own, |mass| [mass.recip(); 2]);
            contact.admittances = Admittances { own, springs };
        }
        for bilateral in &mut self.bilaterals {
            bilateral.action = system.tied(&bilateral.row);
            bilateral.admittance = admittance(&bilateral.action, system, rings);
        }
    }

    /// Starts the system with what has inertia, and the motors.
    fn start_system(&mut self) {
        self.system.start(&self.masses, &self.free);
        for inertia in &self.inertias {
            self.system.add([&inertia.action; 2], inertia.damper);
        }
        for ring in &mut self.rings {
            ring.start_system();
        }
        for motor in &self.motors {
            match (motor.on, motor.given()) {
                (Driven::Ring(k), _) => self.rings[k].drive(motor),
                (Driven::Body(at), Some(given)) => {
                    self.system
                        .add([&Row::over_base(at, motor.lever); 2], given);
                }
                (Driven::Body(_), None) => {}
            }
        }
    }

    /// Solves the system of the present states, and goes to its solution; none if the constraints contradict each other.
    pub(super) fn solve_states(&mut self) -> Option<()> {
        self.effort.rounds += 1;
        self.start_system();
        let (system, rings) = (&mut self.system, &mut self.rings);
        let mut add = |rows: [&Row; 2], damper: Damper| match rows[1].link {
            None => system.add(rows, damper),
            Some(link) => rings[link.ring()].add(link, rows, damper),
        };
        for contact in self.contacts.iter().filter(|c| c.bears) {
            contact.constraints(&mut add);
        }
        for bilateral in &self.bilaterals {
            add([&bilateral.action; 2], bilateral.damper());
        }
        self.solve_system()
    }

    /// Solves the system as it is, goes to its solution, and notes how that changes the unknowns.
    fn solve_system(&mut self) -> Option<()> {
        for ring in &mut self.rings {
            ring.eliminate(&mut self.system)?;
        }
        self.system.solve(&mut self.change)?;
        for ring in &mut self.rings {
            ring.follow(&mut self.change);
        }
        for (change, unknown) in self.change.iter_mut().zip(&mut self.unknowns) {
            let before = std::mem::replace(unknown, *change);
            *change -= before;
        }
        Some(())
    }

    /// Changes all unknowns by a share of the last change.
    pub(super) fn go(&mut self, share: f64) {
        for (unknown, change) in self.unknowns.iter_mut().zip(&self.change) {
            *unknown += change * share;
        }
    }

    /// Computes the velocities from all impulses so far, for the current state of the motors. With rings the velocities
    /// that keep links together matter more.
    pub(super) fn balance(&mut self) {
        self.sum_pushes();
        if !self.rings.is_empty() {
            return;
        }
        self.start_system();
        for contact in self.contacts.iter().filter(|c| c.bears) {
            let [normal, tangent] = &contact.actions;
            self.system.push(normal, contact.normal_impulse);
            self.system.push(tangent, contact.friction_impulse);
        }
        for bilateral in &self.bilaterals {
            self.system.push(&bilateral.action, bilateral.impulse);
        }
        self.solve_system();
    }

    /// Sums the impulses of contacts and bilaterals on each unknown besides those of the base.
    pub(super) fn sum_pushes(&mut self) {
        let pushes = &mut self.pushes;
        pushes.fill(0.0);
        let mut add = |row: &Row, impulse: f64| {
            if impulse != 0.0 {
                for (at, lever) in row.beside_base() {
                    pushes[at] += lever * impulse;
                }
            }
        };
        for contact in &self.contacts {
            add(&contact.normal, contact.normal_impulse);
            add(&contact.tangent, contact.friction_impulse);
        }
        for bilateral in &self.bilaterals {
            add(&bilateral.row, bilateral.impulse);
        }
    }
}

/// [1/kg] Speed along a row per unit impulse along it.
fn admittance(row: &Row, system: &System, rings: &[Ring]) -> f64 {
    let on_base = row.entries();
    let on_base: f64 = on_base
        .map(|(at, lever)| lever * lever * system.weights[at])
        .sum();
    let on_link = row.link.map_or(0.0, |link| {
        let weights = rings[link.ring()].weights();
        let of = |i: usize| row.on_link[i] * row.on_link[i] * weights[i];
        of(0) + of(1) + of(2)
    });
    on_base + on_link
}
