//! A solver of rigid bodies with contacts in the plane; it knows no robot.
//!
//! A problem consists of bodies, each with the velocity that it would have without constraints: a base, bodies that are
//! hinged to it or spin on it, and rings of links; and of constraints: contacts with Coulomb friction, directions in
//! which nothing moves, and motors with limits. A solve finds the velocities and impulses that satisfy all of them.
//!
//! The equations: docs/physics.md, "The problem".

mod bodies;
mod contact;
mod damper;
mod effort;
mod impact;
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
/// Maximum number of rounds of a search by default; most searches need none.
const ITERATIONS: u32 = 8;

/// Where a search starts: from the states of the last solve, or with all contacts open.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    LastStates,
    Air,
}

/// Bodies, their constraints, and the velocities that a solve finds.
pub(crate) struct Problem {
    /// The index of each body's unknowns.
    pub layout: Layout,
    /// [kg, kg, kg m^2] Inertia of the base in x, y and rotation, without what turns with it; then [kg m^2] that of each
    /// hinged body, except for what is among `inertias`, and of each spinning body.
    pub masses: Vec<f64>,
    pub inertias: Vec<Inertia>,
    pub rings: Vec<Ring>,
    pub contacts: Vec<Contact>,
    pub bilaterals: Vec<Bilateral>,
    pub motors: Vec<Motor>,
    /// Maximum number of rounds of a search.
    pub iterations: Option<u32>,
    /// Velocities without constraints.
    pub free: Vec<f64>,
    /// The velocities, and the impulses of the drives of rings; a solve starts from them.
    pub unknowns: Vec<f64>,
    /// Counts of the work done.
    pub effort: Effort,
    /// [N s or N m s] Impulse of all constraints except motors, and of inertia along rows, on each body but the base.
    loads: Vec<f64>,
    system: System,
    /// By how much the last solution of the linear system has changed the unknowns.
    change: Vec<f64>,
}

impl Problem {
    /// Bodies without constraints: a base with a mass [kg] and a moment of inertia [kg m^2], `joints` bodies hinged to it,
    /// bodies that spin on it with moments of inertia `spins` [kg m^2], and rings.
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

    /// Searches from the states of the last solve; if that fails, or the offsets do too much work, with all contacts open.
    fn find(&mut self) -> bool {
        let mut starts = [Start::LastStates, Start::Air].into_iter();
        starts.any(|start| self.search(start) && !self.offsets_do_too_much())
    }

    /// Searches for velocities and impulses; returns whether they satisfy all constraints.
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
        // Contacts that share a load may keep passing it among themselves, and that is a solution, too.
        (self.follow_path(start)).is_some_and(|off| off < AGREEMENT.value())
    }

    /// Whether the offsets of contacts do more work than the kinetic energy of the bodies without constraints: bodies that
    /// are almost exactly wedged together would have to move fast to follow contacts that hardly move.
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

    /// Sets all offsets to 0, as contacts that jam cannot all open or slide by themselves. Returns whether any was not 0.
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
