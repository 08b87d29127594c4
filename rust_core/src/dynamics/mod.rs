//! The equations of motion: one body, drives that turn surfaces, and contacts with Coulomb friction.
//!
//! A substep is symmetric: half of the weight's impulse, the constraints, the motion, the other half, the
//! constraints again. Free flight is therefore exact, and a constant load causes only a second-order error.
//! Before the motion, constraints close gaps and push out of penetration; after it they do not: the soft step
//! of Erin Catto's 2D solvers (2024). The speed of a surface is found together with the contact forces, so
//! that its motor's force limit acts on the net traction within the step.
//!
//! The equations: docs/physics.md, "A substep".

mod action;
mod arm;
mod chain;
mod chains;
mod change;
mod damper;
mod descent;
mod direct;
mod effort;
mod flippers;
mod grip;
mod identity;
mod impulses;
mod law;
mod levers;
mod loaded;
mod motor;
mod motors;
mod newton;
mod phase;
mod push;
mod row;
mod softness;
mod solve;
mod state;
mod system;
#[cfg(test)]
mod tests;
mod way;

use arm::Arm;
use chain::Chain;
use identity::{Identity, Numbered};
use motor::Motor;
use phase::Phase;
use push::Push;
use row::Row;
use softness::Softness;
use system::System;

use crate::contact::Contact;
use crate::error::SimulationError;
use crate::geometry::Vector;
use crate::robot::{Model, Mount};
use crate::scenario::Solver;

pub use chains::ChainReading;
pub(crate) use effort::Effort;
pub(crate) use grip::Grip;
pub(crate) use impulses::Impulses;
pub(crate) use levers::{Direction, Levers};
pub(crate) use loaded::LoadedContact;
pub(crate) use push::push_axis;
pub(crate) use state::{
    Carrier, DriveState, Shoe, State, flippers_at_rest, idlers_at_rest, shoes_at_rest,
};

/// [s] Sticking contacts can pull against each other without end, which no body with any compliance would
/// sustain. Friction that balance does not require fades with this time constant.
const SELF_STRESS_TIME: f64 = 0.1;
/// Pieces of a substep at most; a part that strikes the ground takes three.
const MOST_PIECES: u32 = 50;
/// [m/s] A gap that closes faster is a collision; slower ones are contacts that open and close. Jammed small
/// gear wheels rattle at some mm/s: with 10 mm/s they would shake themselves free too often.
const COLLISION_SPEED: f64 = 0.001;
/// [s] Length of the piece with a collision. What motor and weight do in the piece in which a wheel strikes an
/// edge adds to the impact in proportion to its length: 0.25 ms would shift the friction at which a robot just
/// climbs by 1 %, this value shifts it by less than 0.1 %.
const COLLISION_SUBSTEP: f64 = 2e-5;

/// Solves the motion of one robot.
pub(crate) struct Dynamics {
    model: Model,
    /// Friction of each lane.
    frictions: Vec<f64>,
    gravity: f64,
    solver: Solver,
    rows: Vec<Row>,
    /// The push of a track that is modelled as a force only.
    push: Option<Push>,
    motors: Vec<Motor>,
    /// [N m s] Angular impulse of the contacts on each drive in this piece.
    torques: Vec<f64>,
    /// [kg m^2] Moment of inertia of the chassis with the drives that turn with it.
    inertia: f64,
    system: System,
    /// Shares of a descent step at which the potential has kinks.
    kinks: Vec<f64>,
    flippers: Vec<Arm>,
    chains: Vec<Chain>,
    shoes_a_chain: usize,
    phase: Phase,
    loaded: Vec<LoadedContact>,
    identity: Identity,
    /// The solver's work in the last step.
    effort: Effort,
    /// [N] External force at the centre of mass.
    pub outer_force: Vector,
}

impl Dynamics {
    pub(crate) fn new(model: Model, frictions: Vec<f64>, gravity: f64, solver: Solver) -> Self {
        let has_motor = |k| k < model.motors && model.drive_force > 0.0;
        let motor = |k| {
            if has_motor(k) {
                Motor::Holds
            } else {
                Motor::Free
            }
        };
        Self {
            motors: (0..model.drives).map(motor).collect(),
            torques: vec![0.0; model.drives],
            inertia: model.moment_of_inertia,
            system: System::new(model.drives, model.flippers.len()),
            kinks: Vec::new(),
            shoes_a_chain: model.chains.first().map_or(1, |chain| chain.path.count),
            flippers: model.flippers.iter().cloned().map(Arm::new).collect(),
            chains: model.chains.iter().cloned().map(Chain::new).collect(),
            phase: Phase::default(),
            push: model.pushes_chassis.then(Push::default),
            model,
            frictions,
            gravity,
            solver,
            rows: Vec::new(),
            loaded: Vec::new(),
            identity: Identity::default(),
            effort: Effort::default(),
            outer_force: Vector::ZERO,
        }
    }

    /// The contacts of the last step with their forces.
    pub(crate) fn loaded(&self) -> &[LoadedContact] {
        &self.loaded
    }

    /// The solver's work in the last step.
    pub(crate) fn effort(&self) -> Effort {
        self.effort
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Gives the contacts of the next step their numbers.
    pub(crate) fn recognise(&mut self, contacts: &mut [Contact]) {
        let dt = self.solver.time_step;
        self.identity.recognise(&self.loaded, contacts, dt);
    }

    /// Numbers contacts that another model of the robot takes over; the next step continues them, without
    /// forces.
    pub(crate) fn take_over(&mut self, contacts: &mut [Contact]) {
        self.recognise(contacts);
        self.loaded = contacts.iter().copied().map(LoadedContact::open).collect();
    }

    /// Advances the state by one step towards the surface speed `set_point`.
    ///
    /// The contacts are those in the middle of the step ([`State::pose_after`] half of it), numbered by
    /// [`Dynamics::recognise`].
    pub(crate) fn advance(
        &mut self,
        state: &mut State,
        contacts: &[Contact],
        set_point: f64,
        step: u64,
    ) -> Result<(), SimulationError> {
        let dt = self.solver.time_step;
        self.effort = Effort::default();
        self.prepare(state, contacts);
        for drive in &mut state.drives {
            (drive.force, drive.traction) = (0.0, 0.0);
        }
        for flipper in &mut state.flippers {
            flipper.torque = 0.0;
        }
        let substep = dt / f64::from(self.solver.substeps);
        for _ in 0..self.solver.substeps {
            let (mut left, mut pieces) = (substep, 0);
            while left > 0.0 {
                pieces += 1;
                let (h, strikes) = if pieces < MOST_PIECES {
                    self.piece(state, left)
                } else {
                    (left, false)
                };
                self.substep(state, set_point, h);
                if !strikes {
                    self.remember(h);
                }
                left -= h;
            }
        }
        self.report(state, contacts, dt);
        if state.is_finite() {
            Ok(())
        } else {
            Err(SimulationError {
                step,
                body: "the robot".to_owned(),
            })
        }
    }

    /// [s] Length of the next piece, at most `left`, and whether something strikes the ground in it.
    ///
    /// A piece ends just before a part strikes the ground; the next, with the impact, is short.
    fn piece(&self, state: &State, left: f64) -> (f64, bool) {
        // A chain hits its guide all the time, but its shoes are light and so are their impacts.
        if !self.chains.is_empty() {
            return (left, false);
        }
        let until_contact = |row: &Row| {
            let speed = -row.opening_speed(state);
            (speed > COLLISION_SPEED).then(|| row.gap / speed)
        };
        let times = self.rows.iter().filter_map(until_contact);
        let first = times.fold(f64::INFINITY, f64::min);
        if first > left {
            return (left, false);
        }
        let before = first - 0.5 * COLLISION_SUBSTEP;
        let (h, strikes) = if before > COLLISION_SUBSTEP {
            (before, false)
        } else {
            (COLLISION_SUBSTEP, true)
        };
        // Leaves no remainder shorter than a collision.
        if left - h < COLLISION_SUBSTEP {
            (left, strikes)
        } else {
            (h, strikes)
        }
    }

    /// Advances by a piece of `h` [s].
    fn substep(&mut self, state: &mut State, set_point: f64, h: f64) {
        if !self.chains.is_empty() {
            self.substep_of_chains(state, set_point, h);
            return;
        }
        let (soft, half) = (self.softness(h), 0.5 * h);
        let mut phase = self.start_phase(state, set_point, half);
        for row in &mut self.rows {
            row.close(h, soft, self.solver.max_push_speed);
        }
        self.guess(half);
        self.solve(state, &phase);
        self.move_on(state, h);
        phase.velocity += self.kick(half);
        self.pull_flippers(state, phase.angular_velocity, half);
        phase.elapsed = h;
        self.guess_more(half);
        self.solve(state, &phase);
        self.end_phase(state, phase);
    }

    fn softness(&self, h: f64) -> Softness {
        let (frequency, damping) = (
            self.solver.contact_frequency,
            self.solver.contact_damping_ratio,
        );
        Softness::new(frequency, damping, h)
    }

    /// [m/s] Change of velocity by weight and external force in a time [s].
    fn kick(&self, time: f64) -> Vector {
        (self.outer_force / self.model.mass - Vector::new(0.0, self.gravity)) * time
    }

    /// The start of a solve after a time [s] in which only weight and external force act.
    fn start_phase(&mut self, state: &State, set_point: f64, time: f64) -> Phase {
        let mut phase = std::mem::take(&mut self.phase);
        phase.velocity = state.velocity + self.kick(time);
        phase.angular_velocity = state.angular_velocity;
        phase.spins.clear();
        phase.spins.extend(state.drives.iter().map(|d| d.spin));
        (phase.set_point, phase.elapsed) = (set_point, time);
        self.start_flippers(state, time);
        phase
    }

    /// Moves chassis, drives, flippers and gaps by `h` [s] at their velocities.
    fn move_on(&mut self, state: &mut State, h: f64) {
        state.center += state.velocity * h;
        state.angle += state.angular_velocity * h;
        for k in 0..state.drives.len() {
            state.drives[k].position += state.track_speed(&self.model, k) * h;
        }
        for flipper in &mut state.flippers {
            flipper.angle += flipper.rate * h;
        }
        for row in &mut self.rows {
            row.follow(state, &self.model, h);
        }
    }

    fn end_phase(&mut self, state: &mut State, phase: Phase) {
        self.collect(state, &phase, self.solver.time_step);
        self.phase = phase;
    }

    /// Turns contacts into rows, with the impulses that they had in the last step.
    fn prepare(&mut self, state: &State, contacts: &[Contact]) {
        let half = 0.5 * self.solver.time_step;
        let fading = 1.0 - self.solver.time_step / SELF_STRESS_TIME;
        self.rows.clear();
        let mut last = Numbered::new(&self.loaded);
        for contact in contacts {
            let last = last.get(contact.number);
            let mut row = match self.model.parts[contact.part].mount {
                Mount::Shoe(shoe) => Row::of_shoe(contact, last, state, &self.model, (shoe, half)),
                Mount::Chassis | Mount::Flipper(_) => {
                    Row::new(contact, last, state, &self.model, half)
                }
            };
            let lane = self.model.parts[contact.part].lane;
            row.friction = row.friction.min(self.frictions[lane]);
            row.friction_guess *= fading;
            self.rows.push(row);
        }
        self.rest_on_guides(state, half);
        self.place_flippers(state, half);
    }

    fn report(&mut self, state: &State, contacts: &[Contact], dt: f64) {
        let mut loaded = std::mem::take(&mut self.loaded);
        loaded.clear();
        for (row, contact) in self.rows.iter().zip(contacts) {
            loaded.push(LoadedContact {
                contact: Contact {
                    distance: row.gap,
                    ..*contact
                },
                normal_force: row.normal_total / dt,
                friction_force: row.friction_total / dt,
                surface_speed: row.slip(state),
                normal_guess: row.normal_guess,
                friction_guess: row.friction_guess,
                grip: row.grip,
            });
        }
        self.loaded = loaded;
        self.remember_rests(contacts.len());
    }
}
