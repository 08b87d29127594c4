//! The equations of motion: one body, drives that turn surfaces, contacts with Coulomb friction.
//!
//! A substep is symmetric: half of the weight's push, the constraints, the motion, the other half, the
//! constraints again. Free flight is exact so, and a constant load enters with the square of the step
//! only. Before the motion constraints close gaps and push out of penetration, after it they do not:
//! the soft step of Erin Catto's 2D solvers (2024). A surface speed is found together with the contact
//! forces, so that the force limit of its motor acts on the net traction inside the step.

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

/// [s] Contacts that stick can pull against each other without end, which no body that gives way at
/// all would keep up. The friction that balance does not ask for fades with this time.
const SELF_STRESS_TIME: f64 = 0.1;
/// Pieces of a substep at most; a part that strikes the ground takes three.
const MOST_PIECES: u32 = 50;
/// [m/s] A gap that closes faster is a collision; slower ones are contacts that come and go. Jammed
/// small gear wheels rattle at some mm/s: at 10 mm/s they shake themselves free too often.
const COLLISION_SPEED: f64 = 0.001;
/// [s] Substep of a collision. What motor and weight do during the substep in which a wheel strikes
/// an edge adds to the impact in proportion to its length: 0.25 ms would shift the friction at which
/// a robot just climbs by 1 %, this shifts it by less than 0.1 %.
const COLLISION_SUBSTEP: f64 = 2e-5;
/// [m] A contact carries on from the last step's if it moved less than this.
const CARRIED_OVER: f64 = 5e-3;

/// Solves the motion of one robot.
pub(crate) struct Dynamics {
    model: Model,
    /// Of each lane.
    frictions: Vec<f64>,
    gravity: f64,
    solver: Solver,
    rows: Vec<Row>,
    /// The push of a track that is modelled by a force alone.
    push: Option<Push>,
    motors: Vec<Motor>,
    /// [N m s] What the contacts turn each drive with in this piece.
    torques: Vec<f64>,
    /// [kg m^2] Of the chassis with the drives that turn with it.
    inertia: f64,
    system: System,
    /// Where the potential of a descent has kinks along a step.
    kinks: Vec<f64>,
    flippers: Vec<Arm>,
    chains: Vec<Chain>,
    shoes_a_chain: usize,
    phase: Phase,
    loaded: Vec<LoadedContact>,
    /// What the last step took.
    effort: Effort,
    /// [N] Push of the surroundings at the centre of mass.
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
            effort: Effort::default(),
            outer_force: Vector::ZERO,
        }
    }

    /// The contacts of the last step with their forces.
    pub(crate) fn loaded(&self) -> &[LoadedContact] {
        &self.loaded
    }

    /// What the last step took.
    pub(crate) fn effort(&self) -> Effort {
        self.effort
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Advances the state by one step towards the surface speed `set_point`.
    ///
    /// The contacts are those of the middle of the step, [`State::pose_after`] half of it.
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

    /// [s] How far to go in one piece, at most `left`, and whether something strikes the ground in it.
    ///
    /// A piece ends just before a part strikes the ground, and the next is short.
    fn piece(&self, state: &State, left: f64) -> (f64, bool) {
        // A chain meets its guide all the time; its shoes are light, so are their blows.
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
        // No splinter of a piece is left.
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

    /// [m/s] What weight and surroundings change of the velocity in a time [s].
    fn kick(&self, time: f64) -> Vector {
        (self.outer_force / self.model.mass - Vector::new(0.0, self.gravity)) * time
    }

    /// What a solve starts from after a time [s] in which nothing but weight and surroundings push.
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

    /// Moves chassis, drives, flippers and gaps by `h` [s] at the velocities that they have.
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

    /// Turns contacts into rows, each with the impulses of the last step's nearest one.
    fn prepare(&mut self, state: &State, contacts: &[Contact]) {
        let half = 0.5 * self.solver.time_step;
        let fading = 1.0 - self.solver.time_step / SELF_STRESS_TIME;
        self.rows.clear();
        let mut last = Last {
            contacts: &mut self.loaded,
            from: 0,
        };
        for contact in contacts {
            let last = last.take_nearest(contact);
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
                carried_over: false,
            });
        }
        self.loaded = loaded;
        self.remember_rests(contacts.len());
    }
}

/// The last step's contacts, from the left in each part as this step's are.
struct Last<'a> {
    contacts: &'a mut [LoadedContact],
    /// Those before this one lie too far left for all that come.
    from: usize,
}

impl Last<'_> {
    /// The contact of the same part that lies nearest, if near enough; each is taken once.
    fn take_nearest(&mut self, contact: &Contact) -> Option<LoadedContact> {
        let place = (contact.part, contact.point.x);
        let behind = |l: &LoadedContact| (l.contact.part, l.contact.point.x + CARRIED_OVER) < place;
        while self.contacts.get(self.from).is_some_and(behind) {
            self.from += 1;
        }
        let near = |l: &LoadedContact| (l.contact.point - contact.point).length();
        let last = self.contacts[self.from..]
            .iter_mut()
            .take_while(|l| (l.contact.part, l.contact.point.x - CARRIED_OVER) <= place)
            .filter(|l| !l.carried_over && l.contact.normal.dot(contact.normal) > 0.9)
            .filter(|l| near(l) < CARRIED_OVER)
            .min_by(|a, b| near(a).total_cmp(&near(b)))?;
        last.carried_over = true;
        Some(*last)
    }
}
