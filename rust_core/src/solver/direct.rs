//! Direct search: guesses from the last solve which contacts are open, stick or slide, finds the velocities
//! from one small linear system, and corrects the guess until it fits.
//!
//! A contact enters as a stiff damper about its last impulse (the proximal point of an augmented Lagrangian),
//! so that contacts that share one load have a solution too, and the nearest one. The effect of the damping
//! vanishes as each solution becomes the centre of the next. The system has three rows for the base,
//! whatever the number of contacts, and one more, eliminated right away, for each body that spins on its own.
//!
//! The equations: docs/physics.md, "Direct search".

use super::damper::Damper;
use super::direction::Direction;
use super::motor::Driven;
use super::ring::{Beside, Ring};
use super::system::System;
use super::velocities::ActsOn;
use super::{AGREEMENT, Contact, Inertia, Problem};

/// Solutions of the system in one search; since all misfits are corrected at once, corrections could
/// alternate for ever.
const MOST_SOLUTIONS: u32 = 4;

impl Problem {
    /// Finds the impulses that satisfy all constraints, if corrected guesses lead there.
    pub(super) fn solve_at_once(&mut self) -> bool {
        self.settle();
        let mut last = None;
        for _ in 0..MOST_SOLUTIONS {
            let before = last.take();
            self.effort.rounds += 1;
            self.assemble();
            if self.solve_for_change().is_none() {
                return false;
            }
            self.go(1.0);
            let off = self.follow_velocities();
            let fits = self.mend();
            if !fits {
                continue;
            }
            self.turn_with_base();
            if self.switch_motors() {
                self.act_with_motors();
            } else {
                if off < AGREEMENT.value() {
                    return true;
                }
                last = self.settle_after(before, off);
            }
        }
        self.contacts.iter_mut().for_each(Contact::unsettle);
        false
    }

    /// Updates all impulses to match the velocities; returns the largest error of a velocity [m/s].
    pub(super) fn follow_velocities(&mut self) -> f64 {
        let mut off: f64 = 0.0;
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            off = off.max(contact.follow_speeds(contact.speeds(&self.velocities)));
        }
        off.max(self.others_follow_velocities())
    }

    /// The same for what is no contact.
    pub(super) fn others_follow_velocities(&mut self) -> f64 {
        let mut off: f64 = 0.0;
        for row in &mut self.bilaterals {
            off = off.max(row.follow(&self.velocities));
        }
        for motor in &self.motors {
            if let Driven::Ring(k) = motor.on {
                let (ahead, ring) = (self.ahead(motor), &self.rings[k]);
                let given = ring
                    .given(motor)
                    .map(|given| given.at(ahead + motor.held_speed()));
                off = off.max(self.rings[k].drive.follow(ahead, given));
            }
        }
        off
    }

    /// Corrects the grips that do not fit; returns whether all fitted.
    fn mend(&mut self) -> bool {
        let mut fits = true;
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            let next = contact.grip.towards(contact.fitting);
            fits &= next == contact.grip;
            contact.grip = next;
        }
        fits
    }

    /// Assembles the system without constraints.
    pub(super) fn assemble_bodies(&mut self) {
        let moment = self.free_moment();
        let system = &mut self.system;
        system.start(
            self.base.mass,
            self.inertia,
            self.free.base.velocity,
            moment,
        );
        for (k, spin) in self.spins.iter().enumerate() {
            system.spin(k, spin.inertia, self.free.spins[k]);
        }
        for motor in &self.motors {
            let given = motor.given();
            match motor.on {
                Driven::Spin(k) => {
                    let given = given.unwrap_or_default();
                    system.turn(k, motor.lever * given.at(0.0));
                    if given.stiffness != 0.0 {
                        let acts = ActsOn::on_spin(k);
                        let along = acts.over_base(motor.lever);
                        system.add(acts, [&along; 2], Damper::new(0.0, given.stiffness));
                    }
                }
                Driven::Ring(k) => {
                    let ring = &mut self.rings[k];
                    let spin = ring
                        .spin
                        .map(|k| [self.spins[k].inertia, self.free.spins[k]]);
                    ring.assemble(motor, spin);
                }
                Driven::Joint(k) => match given {
                    None => system.hold(k),
                    Some(given) => {
                        let acts = ActsOn::on_joint(k);
                        let along = acts.over_base(motor.lever);
                        system.add(acts, [&along; 2], given);
                    }
                },
            }
        }
        for i in 0..self.inertias.len() {
            let Inertia {
                acts,
                along,
                damper,
            } = self.inertias[i];
            let action = self.tied(acts, along);
            self.system.add(acts, [&action; 2], damper);
        }
    }

    /// Assembles the system with the constraints as guessed.
    pub(super) fn assemble(&mut self) {
        self.assemble_bodies();
        let (system, rings) = (&mut self.system, &mut self.rings);
        for contact in self.contacts.iter().filter(|c| c.bears) {
            contact.constraints(|along, damper| add(system, rings, contact.acts, along, damper));
        }
        for row in &self.bilaterals {
            add(system, rings, row.acts, [&row.action; 2], row.damper());
        }
    }
}

/// Adds a constraint: its impulse acts along the first of two directions, with a damper along the second.
pub(super) fn add(
    system: &mut System,
    rings: &mut [Ring],
    acts: ActsOn,
    along: [&Direction; 2],
    damper: Damper,
) {
    match acts {
        ActsOn::Base { .. } => system.add(acts, along, damper),
        ActsOn::Link(link) => rings[link.ring].add(link, along, damper),
        ActsOn::LinkAndSlide(link) => {
            rings[link.ring].add_between(link, Beside::Slide, along, damper);
        }
        ActsOn::LinkAndSpin { link, .. } => {
            rings[link.ring].add_between(link, Beside::Spin, along, damper);
        }
    }
}
