//! A solver of rigid bodies with contacts in the plane; it knows no robot.
//!
//! A problem is a base, bodies that are hinged to it or spin on it, and rings of links, with the velocities that all
//! of them would have without constraints; and the constraints: contacts with Coulomb friction, directions along
//! which nothing moves, and motors with limits. A solve finds the velocities and impulses that satisfy all of them.
//!
//! The equations: docs/physics.md, "The problem".

mod blow;
mod bodies;
mod contact;
mod damper;
mod effort;
#[cfg(any(test, fuzzing))]
pub(crate) mod judge;
mod motor;
mod path;
mod ring;
mod row;
mod settling;
mod system;
#[cfg(test)]
mod tests;

pub(crate) use contact::{Contact, Grip};
pub(crate) use damper::{Bilateral, Damper, Inertia};
pub(crate) use effort::Effort;
pub(crate) use motor::{Driven, Motor, MotorState};
pub(crate) use ring::{Grasp, Hinge, Ring, RingSpec};
pub(crate) use row::{Layout, Link, Row, TURN};

use crate::units::MetresPerSecond;
use row::BASE;
use system::System;

/// [m/s] A solve ends when no constraint changes a velocity by more than this: over a step of 1 ms that
/// corresponds to a force of 1e-5 of the weight, far below anything that decides an outcome.
const AGREEMENT: MetresPerSecond = MetresPerSecond(1e-7);
/// Rounds of a search at most, unless told otherwise; most need none.
const ITERATIONS: u32 = 8;

/// Where a search starts: from the states of the last solve, or from where all contacts are open.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    LastStates,
    Air,
}

/// Bodies, what constrains them, and the velocities that a solve finds.
pub(crate) struct Problem {
    /// Where the unknowns of each body stand.
    pub layout: Layout,
    /// [kg, kg, kg m^2] Inertia of the base for x, y and turn, without what turns with it; then [kg m^2] that of each body
    /// hinged to it, as far as it is not among `inertias`, and of each that spins.
    pub masses: Vec<f64>,
    pub inertias: Vec<Inertia>,
    pub rings: Vec<Ring>,
    pub contacts: Vec<Contact>,
    pub bilaterals: Vec<Bilateral>,
    pub motors: Vec<Motor>,
    /// Rounds of a search at most.
    pub iterations: Option<u32>,
    /// Velocities without constraints.
    pub free: Vec<f64>,
    /// The velocities, and the impulses of the drives of rings; a solve starts from them.
    pub unknowns: Vec<f64>,
    /// The work done.
    pub effort: Effort,
    /// [N s or N m s] What all constraints but motors have done to each body beside the base, and inertia along rows.
    loads: Vec<f64>,
    system: System,
    /// The change to the last solution of the linear system.
    change: Vec<f64>,
}

impl Problem {
    /// Bodies without constraints: a base with a mass [kg] and a moment of inertia [kg m^2], so many bodies hinged to it,
    /// bodies that spin on it with these moments of inertia [kg m^2], and rings.
    pub(crate) fn new(
        [mass, inertia]: [f64; 2],
        joints: usize,
        spins: &[f64],
        rings: &[RingSpec],
    ) -> Self {
        let layout = Layout {
            joints,
            spins: spins.len(),
            rings: rings.len(),
            links: rings.iter().map(|ring| ring.links).sum(),
        };
        let mut masses = vec![mass, mass, inertia];
        masses.resize(BASE + joints, 0.0);
        masses.extend(spins);
        let nothing = vec![0.0; layout.count()];
        Self {
            masses,
            inertias: Vec::new(),
            rings: Ring::all(layout, rings),
            contacts: Vec::new(),
            bilaterals: Vec::new(),
            motors: Vec::new(),
            iterations: None,
            free: nothing.clone(),
            unknowns: nothing.clone(),
            effort: Effort::default(),
            loads: nothing.clone(),
            system: System::new(layout),
            change: nothing,
            layout,
        }
    }

    /// Finds the velocities and impulses that satisfy all constraints.
    pub(crate) fn solve(&mut self) {
        self.effort.solves += 1;
        let solved = self.find() || (self.forget_offsets() && self.find());
        self.effort.unresolved += u64::from(!solved);
        // From the impulses, so that momentum is conserved to the last digit.
        self.find_velocities();
    }

    /// Searches from the states of the last solve and, where that finds nothing, or its offsets do too much work, from where
    /// all contacts are open.
    fn find(&mut self) -> bool {
        let mut starts = [Start::LastStates, Start::Air].into_iter();
        starts.any(|start| self.search(start) && !self.offsets_do_too_much())
    }

    /// Searches for them; returns whether they agree.
    fn search(&mut self, start: Start) -> bool {
        self.tie();
        if start == Start::LastStates && self.settle(false) {
            return true;
        }
        for _ in 0..self.iterations.unwrap_or(ITERATIONS) {
            let Some(off) = self.follow_path(start) else {
                return false;
            };
            if off == 0.0 || self.settle(true) {
                return true;
            }
        }
        // Contacts that share a load may pass it round, and agree all the same.
        (self.follow_path(start)).is_some_and(|off| off < AGREEMENT.value())
    }

    /// Whether the offsets of contacts do more work than the kinetic energy that bodies have without constraints. Wedged
    /// together almost exactly, they would have to move fast to follow contacts that hardly move.
    fn offsets_do_too_much(&self) -> bool {
        let of_contact = |c: &Contact| {
            (c.normal.offset * c.normal_impulse).abs()
                + (c.tangent.offset * c.friction_impulse).abs()
        };
        let given: f64 = self.contacts.iter().map(of_contact).sum();
        let of_body = |(mass, v): (&f64, &f64)| 0.5 * mass * v * v;
        let mut bodies = self.masses.iter().zip(&self.free);
        let of_base: f64 = bodies.by_ref().take(BASE).map(of_body).sum();
        if given <= of_base {
            return false;
        }
        // The drive of a ring has no inertia of its own.
        let is_of_ring = |at: usize| {
            let mut on = self.motors.iter().map(|motor| motor.on);
            on.any(|on| matches!(on, Driven::Ring(k) if self.layout.spin(k) == at))
        };
        let beside = (BASE..).zip(bodies).filter(|(at, _)| !is_of_ring(*at));
        let of_bodies: f64 = beside.map(|(_, body)| of_body(body)).sum();
        let of_inertias: f64 = self.inertias.iter().map(Inertia::energy).sum();
        let of_rings: f64 = self.rings.iter().map(|ring| ring.energy(&self.free)).sum();
        given > of_base + of_bodies + of_inertias + of_rings
    }

    /// Sets all offsets to 0: contacts that jam cannot all open or slide on their own. Returns whether that changes
    /// anything.
    fn forget_offsets(&mut self) -> bool {
        let has_offset = |c: &Contact| c.normal.offset != 0.0 || c.tangent.offset != 0.0;
        if !self.contacts.iter().any(has_offset) {
            return false;
        }
        for contact in &mut self.contacts {
            (contact.normal.offset, contact.tangent.offset) = (0.0, 0.0);
            contact.set_impulses([0.0; 2]);
        }
        true
    }
}
