//! A solver of rigid bodies with contacts in the plane; it knows no robot.
//!
//! A problem is a base, bodies that are hinged to it or spin on it, and rings of links, with the velocities that all
//! of them would have without constraints; and the constraints: contacts with Coulomb friction, directions along
//! which nothing moves, and motors with limits. A solve finds the velocities and impulses that satisfy all of them.
//!
//! The equations: docs/physics.md, "The problem".

mod balance;
mod bilateral;
mod blow;
mod bodies;
mod change;
mod condition;
mod conditions;
mod contact;
mod damper;
mod direct;
mod direction;
mod effort;
mod grip;
mod law;
mod lowering;
mod motor;
mod motors;
mod ring;
mod settling;
mod steps;
mod system;
#[cfg(test)]
mod tests;
mod tie;
mod twist;
mod velocities;
mod way;

pub(crate) use bilateral::Bilateral;
pub(crate) use bodies::{Base, Inertia, Joint, Spin};
pub(crate) use contact::Contact;
pub(crate) use damper::Damper;
pub(crate) use direction::Direction;
pub(crate) use effort::Effort;
pub(crate) use grip::Grip;
pub(crate) use motor::{Driven, Hold, Motor};
pub(crate) use ring::{Drive, Grasp, Hinge, Ring};
pub(crate) use twist::Twist;
pub(crate) use velocities::{ActsOn, HasVelocities, Link, Velocities};

use crate::units::MetresPerSecond;
use condition::Condition;
use system::System;

/// [m/s] A solve ends when no constraint changes a velocity by more than this: over a step of 1 ms that
/// corresponds to a force of 1e-5 of the weight, far below anything that decides an outcome.
const AGREEMENT: MetresPerSecond = MetresPerSecond(1e-7);
/// Rounds of a search at most, unless told otherwise; most need none.
const ITERATIONS: u32 = 8;

/// Bodies, what constrains them, and the velocities that a solve finds.
pub(crate) struct Problem {
    pub base: Base,
    pub spins: Vec<Spin>,
    pub joints: Vec<Joint>,
    pub inertias: Vec<Inertia>,
    pub rings: Vec<Ring>,
    pub contacts: Vec<Contact>,
    pub bilaterals: Vec<Bilateral>,
    pub motors: Vec<Motor>,
    /// [kg] The mass on the springs of contacts; none if each has that of its own bodies.
    pub mass_on_springs: Option<f64>,
    /// Rounds of a search at most.
    pub iterations: Option<u32>,
    /// Velocities without constraints: of the base, of what spins, and of links.
    pub free: Velocities,
    /// The velocities; a solve starts from them.
    pub velocities: Velocities,
    /// The work done.
    pub effort: Effort,
    /// [kg m^2] Moment of inertia of the base with what turns with it.
    inertia: f64,
    /// [N m s] Angular impulse of the constraints on what spins.
    torques: Vec<f64>,
    system: System,
    /// The change to the last solution of the linear system.
    change: Velocities,
    /// Conditions of the states on the way down to the ground.
    conditions: Vec<Condition>,
}

impl Problem {
    /// Bodies without constraints.
    pub(crate) fn new(base: Base, spins: Vec<Spin>, joints: Vec<Joint>, rings: Vec<Ring>) -> Self {
        let velocities = Velocities {
            spins: vec![0.0; spins.len()],
            links: vec![Twist::default(); rings.last().map_or(0, |ring| ring.links.end)],
            slides: vec![0.0; rings.len()],
            ..Velocities::default()
        };
        Self {
            inertia: base.inertia,
            torques: vec![0.0; spins.len()],
            system: System::new(spins.len(), joints.len()),
            conditions: Vec::new(),
            free: velocities.clone(),
            change: velocities.clone(),
            velocities,
            base,
            spins,
            joints,
            inertias: Vec::new(),
            rings,
            contacts: Vec::new(),
            bilaterals: Vec::new(),
            motors: Vec::new(),
            mass_on_springs: None,
            iterations: None,
            effort: Effort::default(),
        }
    }

    /// Finds the velocities and impulses that satisfy all constraints.
    pub(crate) fn solve(&mut self) {
        self.effort.solves += 1;
        let agreed =
            (self.search() && !self.offsets_throw()) || (self.forget_offsets() && self.search());
        if !agreed {
            self.effort.unresolved += 1;
        }
        // From the impulses, so that momentum is conserved to the last digit.
        self.balance();
    }

    /// Searches for them; returns whether they agree.
    fn search(&mut self) -> bool {
        self.tie();
        if self.guess() {
            return true;
        }
        // What no guess finds can be close to a jam, where constraints agree before the bodies stand.
        for _ in 0..self.iterations.unwrap_or(ITERATIONS) {
            if !self.lower() {
                return false;
            }
            if self.close_in() || (self.guess() && self.close_in()) {
                return true;
            }
        }
        // Contacts that share a load may pass it round, and agree all the same.
        self.lower() && self.follow_velocities() < AGREEMENT.value()
    }

    /// Finds them from those of the last solve, if corrected guesses lead there.
    fn guess(&mut self) -> bool {
        if self.rings.is_empty() {
            self.solve_at_once()
        } else {
            self.solve_in_steps()
        }
    }

    /// Whether contacts that jam give more energy by how they move along their directions than there was. Wedged together
    /// almost exactly, bodies would have to move fast to follow contacts that hardly move.
    fn offsets_throw(&self) -> bool {
        let given: f64 = (self.contacts.iter())
            .map(|c| {
                (c.normal.offset * c.normal_impulse).abs()
                    + (c.tangent.offset * c.friction_impulse).abs()
            })
            .sum();
        let Twist { velocity, turn } = self.free.base;
        let of_base = self.base.mass * velocity.length_squared() + self.inertia * turn * turn;
        let spins = self.spins.iter().zip(&self.free.spins);
        let of_spins: f64 = spins.map(|(spin, rate)| spin.inertia * rate * rate).sum();
        given > 0.5 * (of_base + of_spins)
    }

    /// Lets all contacts move along their directions as these are: contacts that jam cannot all open or slide on their
    /// own. Returns whether that changes anything.
    fn forget_offsets(&mut self) -> bool {
        let offsets = |c: &Contact| c.normal.offset != 0.0 || c.tangent.offset != 0.0;
        if !self.contacts.iter().any(offsets) {
            return false;
        }
        for contact in &mut self.contacts {
            (contact.normal.offset, contact.tangent.offset) = (0.0, 0.0);
            (contact.normal_impulse, contact.friction_impulse) = (0.0, 0.0);
        }
        true
    }

    /// Adopts the motors' present states in the middle of a search, and updates the dampers about their centres.
    fn act_with_motors(&mut self) {
        self.tie();
        self.contacts.iter_mut().for_each(Contact::place_dampers);
    }
}
