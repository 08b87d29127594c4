//! The bodies in a solve: what motors hold, the linear system of all constraints, and velocities from impulses.
//!
//! The equations: docs/physics.md, "The problem".

use super::contact::Admittances;
use super::motor::{Driven, MotorState};
use super::ring::Ring;
use super::row::Row;
use super::system::System;
use super::{Damper, Problem};

/// Which impulses contacts and bilaterals have in a linear system.
#[derive(Clone, Copy)]
enum Impulses {
    /// Those of their dampers in the present states.
    OfStates,
    /// The ones they have now.
    Given,
}

impl Problem {
    /// Ties what motors hold to the base, and finds the rows of all constraints that follow from that.
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
            let of_springs = contact.mass.map_or(own, |mass| [mass.recip(); 2]);
            contact.admittances = Admittances { own, of_springs };
        }
        for bilateral in &mut self.bilaterals {
            bilateral.action = system.tied(&bilateral.row);
            bilateral.admittance = admittance(&bilateral.action, system, rings);
        }
    }

    /// Solves the system of the present states; none if the constraints contradict each other.
    pub(super) fn solve_states(&mut self) -> Option<()> {
        self.effort.rounds += 1;
        self.solve_system(Impulses::OfStates)
    }

    /// Solves the linear system of all bodies with these impulses of contacts and bilaterals, and notes by how much it changes
    /// the unknowns. With rings impulses cannot be given.
    fn solve_system(&mut self, impulses: Impulses) -> Option<()> {
        self.system.start(&self.masses, &self.free);
        let (system, rings) = (&mut self.system, &mut self.rings);
        for inertia in &self.inertias {
            system.add([&inertia.action; 2], inertia.damper);
        }
        for ring in rings.iter_mut() {
            ring.start_system();
        }
        for motor in &self.motors {
            match (motor.on, motor.given()) {
                (Driven::Ring(k), _) => rings[k].drive(motor),
                (Driven::Body(at), Some(given)) if motor.state != MotorState::Absent => {
                    system.add([&Row::over_base(at, motor.lever); 2], given);
                }
                (Driven::Body(_), _) => {}
            }
        }
        let bearing = self.contacts.iter().filter(|c| c.bears);
        match impulses {
            Impulses::OfStates => {
                let mut add = |rows: [&Row; 2], damper: Damper| match rows[1].link {
                    None => system.add(rows, damper),
                    Some(link) => rings[link.ring()].add(link, rows, damper),
                };
                bearing.for_each(|contact| contact.constraints(&mut add));
                for bilateral in &self.bilaterals {
                    add([&bilateral.action; 2], bilateral.damper());
                }
            }
            Impulses::Given => {
                for contact in bearing {
                    system.push(&contact.actions[0], contact.normal_impulse);
                    system.push(&contact.actions[1], contact.friction_impulse);
                }
                for bilateral in &self.bilaterals {
                    system.push(&bilateral.action, bilateral.impulse);
                }
            }
        }
        for ring in &mut self.rings {
            ring.eliminate(&mut self.system)?;
        }
        self.system.solve(&mut self.change)?;
        for ring in &mut self.rings {
            ring.back_substitute(&mut self.change);
        }
        for (change, unknown) in self.change.iter_mut().zip(&mut self.unknowns) {
            let before = std::mem::replace(unknown, *change);
            *change -= before;
        }
        Some(())
    }

    /// Changes all unknowns by a multiple of the last change.
    pub(super) fn go(&mut self, share: f64) {
        for (unknown, change) in self.unknowns.iter_mut().zip(&self.change) {
            *unknown += change * share;
        }
    }

    /// Computes the velocities from the present impulses and the states of motors. With rings the velocities of the last
    /// system are kept, as they satisfy the hinges exactly.
    pub(super) fn find_velocities(&mut self) {
        if self.rings.is_empty() {
            self.solve_system(Impulses::Given);
        }
        self.note_loads();
    }

    /// Adds up the impulses of all constraints except motors, and of inertia along rows, on each body but the base: once for
    /// all motors, as there may be hundreds.
    pub(super) fn note_loads(&mut self) {
        self.loads.fill(0.0);
        let of_contacts = self.contacts.iter().flat_map(|c| {
            let [normal, friction] = c.impulses();
            [(&c.normal, normal), (&c.tangent, friction)]
        });
        let of_bilaterals = self.bilaterals.iter().map(|b| (&b.row, b.impulse));
        let of_inertias = self.inertias.iter();
        let of_inertias = of_inertias.map(|i| (&i.row, i.impulse(&self.unknowns)));
        let all = of_contacts.chain(of_bilaterals).chain(of_inertias);
        for (row, impulse) in all.filter(|(_, impulse)| *impulse != 0.0) {
            for (at, lever) in row.beside_base() {
                self.loads[at] += lever * impulse;
            }
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
        let weights = rings[link.ring()].weights;
        let of = |i: usize| row.on_link[i] * row.on_link[i] * weights[i];
        of(0) + of(1) + of(2)
    });
    on_base + on_link
}
