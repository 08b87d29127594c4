//! The equations of motion: chassis, drives that turn surfaces, arms, chains, and contacts with Coulomb friction.
//!
//! A step is symmetric: half of the weight's impulse, the constraints, the motion, the other half, the
//! constraints again. Free flight is therefore exact, and a constant load causes only a second-order error.
//! Before the motion, constraints close gaps and push out of penetration; after it they do not: this is the "soft step"
//! of Erin Catto's 2D solvers (2024). The speed of a surface is found together with the contact forces, so that the force
//! limit of its motor acts on the net traction within the step.
//!
//! The equations: docs/physics.md, "A step".

mod approach;
mod arm;
mod arrival;
mod between;
mod build;
mod chain;
mod chains;
mod closing;
mod course;
mod face;
mod flippers;
mod forces;
mod identity;
mod impulses;
mod levers;
mod local_error;
mod meeting;
mod motors;
mod push;
mod set_point;
mod softness;
mod solve;
mod state;
mod strike;
#[cfg(test)]
mod tests;
mod touch;
mod trend;

use arm::Arm;
pub use arm::FlipperCommand;
use build::built;
use chain::Chain;
use forces::Forces;
use identity::{Identity, Numbered};
use softness::Softness;
use touch::{Start, Touch};

use crate::contact::Contact;
use crate::geometry::Vector;
use crate::robot::{Model, Mount};
use crate::scenario::Solver;
use crate::solver::{Effort, Problem};
use crate::terrain::GroundFriction;

use crate::units::Seconds;
pub use chains::ChainReading;
pub(crate) use impulses::Impulses;
pub(crate) use levers::{Direction, Levers};
pub(crate) use local_error::SHORTEST;
pub(crate) use push::push_axis;
pub(crate) use set_point::SetPoint;
pub(crate) use state::{
    Carrier, DriveState, Shoe, State, flippers_at_rest, idlers_at_rest, shoes_at_rest,
};
pub(crate) use trend::Trend;

/// [s] Sticking contacts can pull against each other for ever, which no body with any compliance would sustain. Friction
/// that equilibrium does not require fades with this time constant; but not on robots with chains, whose contacts are
/// springs: if these faded, a robot held by them would creep.
const SELF_STRESS_TIME: Seconds = Seconds(0.1);

/// Solves the motion of one robot.
pub(crate) struct Dynamics {
    model: Model,
    /// Friction of each lane.
    frictions: Vec<GroundFriction>,
    gravity: f64,
    solver: Solver,
    /// The robot's bodies, motors and contacts as the solver sees them, ...
    problem: Problem,
    /// ... and what else a step knows of these contacts: those with the ground in the order in which they were found, then
    /// the rests of chains.
    touches: Vec<Touch>,
    /// [N] The last force of a track that is modelled as a force only.
    push_force: Option<f64>,
    /// Forces of the drives in this step, if they depend on their speeds.
    forces: Vec<Forces>,
    flippers: Vec<Arm>,
    chains: Vec<Chain>,
    /// Speed of the fastest tip relative to its carrier, in units of the surface speed.
    tip_speed: f64,
    loaded: Vec<Contact>,
    /// The state at the beginning of the last motion, with the velocities of that motion.
    motion: State,
    identity: Identity,
    /// [m/s] Speeds that motors and friction may bring to 0 within the step: of the drives, then of the contacts.
    lags: Vec<f64>,
    /// [N] External force at the centre of mass.
    pub outer_force: Vector,
}

impl Dynamics {
    pub(crate) fn new(
        model: Model,
        frictions: Vec<GroundFriction>,
        gravity: f64,
        solver: Solver,
    ) -> Self {
        let motion = State::at_rest(&model, Vector::ZERO, 0.0, 0.0);
        let arms: Vec<Arm> = model.flippers.iter().cloned().map(Arm::new).collect();
        let chains: Vec<Chain> = model.chains.iter().cloned().map(Chain::new).collect();
        Self {
            problem: built(&model, &chains, &arms, &solver),
            touches: Vec::new(),
            push_force: model.pushes_chassis.then_some(0.0),
            forces: Vec::new(),
            flippers: arms,
            chains,
            tip_speed: model.tip_speed(),
            model,
            frictions,
            gravity,
            solver,
            loaded: Vec::new(),
            motion,
            identity: Identity::default(),
            lags: Vec::new(),
            outer_force: Vector::ZERO,
        }
    }

    /// The contacts of the last step with their forces.
    pub(crate) fn loaded(&self) -> &[Contact] {
        &self.loaded
    }

    /// The solver's work in the last step.
    pub(crate) fn effort(&self) -> Effort {
        self.problem.effort
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// Whether a contact of the last step was not found again after a `time` [s] in which its gap may have closed, so that its
    /// part may have passed through the ground. Nothing moves farther than `travel` [m] in that time, and forces move nothing
    /// farther than `strays` [m] from where the velocities of the state take it.
    pub(crate) fn has_lost(&self, state: &State, (time, travel): (f64, f64), strays: f64) -> bool {
        let mut gone = self.identity.gone(&self.loaded);
        gone.any(|l| {
            let closes = || self.closing(l, (state, 0.0)).within(time) + strays;
            (0.0..travel).contains(&l.distance) && l.distance < closes()
        })
    }

    /// Gives the contacts of a step in which nothing moves farther than `travel` [m] their numbers.
    pub(crate) fn recognise(&mut self, contacts: &mut [Contact], travel: f64) {
        self.identity.recognise(&self.loaded, contacts, travel);
    }

    /// Numbers the contacts of another model of the robot; the next step continues from them, without forces.
    pub(crate) fn take_over(&mut self, contacts: &mut [Contact]) {
        self.recognise(contacts, 0.0);
        self.identity.keep(&self.loaded, 0.0);
        self.loaded = contacts.to_vec();
    }

    /// Takes the contacts that another engine found in a step of `h` [s] in which nothing moved farther than `travel` [m], and
    /// numbers them.
    pub(crate) fn take_contacts(&mut self, mut found: Vec<Contact>, travel: f64, h: f64) {
        self.recognise(&mut found, travel);
        self.identity.keep(&self.loaded, h);
        self.loaded = found;
    }

    /// Prepares a step of `h` [s] in which nothing moves farther than `travel` [m]. The contacts are those in the middle of the
    /// step ([`State::pose_after`] half of it), numbered by [`Dynamics::recognise`].
    pub(crate) fn prepare(&mut self, state: &State, contacts: &[Contact], (h, travel): (f64, f64)) {
        let half = 0.5 * h;
        let fading = if self.chains.is_empty() {
            libm::exp(-h / SELF_STRESS_TIME.value())
        } else {
            1.0
        };
        self.touches.clear();
        let problem = &mut self.problem;
        problem.contacts.clear();
        state.write_velocities(problem.layout, &mut problem.unknowns);
        let velocities = (problem.layout, problem.unknowns.as_slice());
        let start = Start::new((state, &self.model), velocities, half);
        let mut last = Numbered::new(&self.loaded);
        for contact in contacts {
            let last = last.get(contact.number);
            let part = &self.model.parts[contact.part];
            let (mut touch, mut solved) = match part.mount {
                Mount::Shoe(shoe) => Touch::of_shoe(contact, last, shoe, &start),
                Mount::Chassis | Mount::Flipper(_) => Touch::new(contact, last, &start),
            };
            let ground = self.frictions[part.lane].at(contact.point);
            solved.friction = ground.at_most(part.friction_limit);
            solved.mass = mass_on_spring(&self.model, part.mount);
            touch.friction_guess *= fading;
            self.touches.push(touch);
            problem.contacts.push(solved);
        }
        self.rest_on_guides(state, half, travel);
    }

    /// Advances the state by the prepared step of `h` [s]; `strikes` tells whether something strikes the ground in it. If the
    /// step should end at a jump of a force instead, fails with the time [s] until that.
    pub(crate) fn advance(
        &mut self,
        state: &mut State,
        set_point: SetPoint,
        (h, strikes): (f64, bool),
    ) -> Result<(), f64> {
        self.problem.effort = Effort::default();
        let half = 0.5 * h;
        let before = (!self.model.is_one_body()).then(|| self.momentum_at(state));
        let began = state.angular_velocity;
        self.place_flippers(state, half);
        self.set_free_velocities(state, half);
        self.start_chains(state, h);
        self.close_gaps(h, strikes);
        self.guess(half);
        self.drive_to_middle(state, set_point, half);
        // Steps of a given length, those of chains and those that end with an impact are not cut.
        let cut_to = (self.solver.accuracy).filter(|_| self.chains.is_empty() && !strikes);
        if cut_to.is_some() {
            self.note_lags(set_point);
        }
        self.solve(state, half);
        if let Some(time) = cut_to.and_then(|accuracy| self.first_arrival(half, accuracy)) {
            return Err(time);
        }
        self.motion.copy(state);
        self.move_on(state, h);
        self.move_chains(state, h);
        self.fall(half);
        self.accelerate_flippers(state, began, half);
        self.aim_at_end(state, began);
        self.hold_chains(state, h);
        self.guess_more(strikes);
        self.keep_closed(h);
        self.drive_to_end(state, set_point, h);
        self.solve(state, h);
        self.collect_motors(state, set_point, h);
        if strikes {
            self.impact(state);
        }
        self.collect_tractions(state, h);
        if let Some(before) = before {
            self.balance_momentum(state, before, h);
        }
        Ok(())
    }

    /// Keeps what a step of `h` [s] has found as the start for the next one. After an impact the next step starts from the
    /// forces before it, as the impact is over.
    pub(crate) fn keep(&mut self, contacts: &[Contact], h: f64, strikes: bool) {
        self.identity.keep(&self.loaded, h);
        if !strikes {
            self.remember(h);
        }
        self.report(contacts, h);
    }

    /// Sets the contacts up for the solve before a motion of `h` [s], in which something may strike the ground; it finds the
    /// impulses of half the step.
    fn close_gaps(&mut self, h: f64, strikes: bool) {
        let (soft, most) = (self.softness(h), self.solver.max_push_speed);
        let times = (h, 0.5 * h);
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            if !self.chains.is_empty() {
                touch.close_softly(solved, times, soft, most);
                continue;
            }
            touch.close(solved, times, soft, most);
            if strikes && touch.gap > 0.0 {
                solved.compliance = 0.0; // an impact must not compress what is open yet
            }
        }
    }

    /// Sets them up for the solve after it, which finds the impulses of the whole step. Only the contacts of robots with
    /// chains still close, as these stand on springs.
    fn keep_closed(&mut self, h: f64) {
        if self.chains.is_empty() {
            return;
        }
        let (soft, most) = (self.softness(h), self.solver.max_push_speed);
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            touch.close_softly(solved, (h, h), soft, most);
        }
    }

    /// [N s] Momentum of the robot, with its arms where they are now.
    fn momentum_at(&mut self, state: &State) -> Vector {
        self.place_flippers(state, 0.0);
        self.momentum(state)
    }

    /// Gives a robot of several bodies exactly the momentum that weight and ground have given it in a step of `h` [s]. The
    /// solve places its arms where they are in the middle of the step, a third-order error, and the elimination of its chains
    /// loses the last few digits.
    fn balance_momentum(&mut self, state: &mut State, before: Vector, h: f64) {
        let mass = self.model.total_mass();
        let of_weight = Vector::new(0.0, -mass * self.gravity);
        let given = before + (self.outer_force + of_weight) * h + self.impulse_of_ground(state);
        let lost = (given - self.momentum_at(state)) / mass;
        state.velocity += lost;
        for shoe in &mut state.shoes {
            shoe.twist.velocity += lost;
        }
    }

    /// [N s] Impulse of the ground in this step.
    fn impulse_of_ground(&self, state: &State) -> Vector {
        let contacts = self.touches.iter().zip(&self.problem.contacts);
        let on_ground = contacts.filter(|(touch, _)| touch.is_on_ground());
        let of_contacts: Vector = on_ground.map(|(touch, solved)| touch.impulse(solved)).sum();
        let axis = push_axis(&self.model, state.angle).unit;
        let pushes = self.problem.bilaterals.iter();
        of_contacts + axis * pushes.map(|push| push.impulse).sum::<f64>()
    }

    /// Undoes the counts of chains in a step that was not kept. Motors keep the states that it found, as a start.
    pub(crate) fn rewind(&mut self) {
        self.chains.iter_mut().for_each(Chain::rewind);
    }

    /// [m/s] Upper bound of the speed of any point of the outline; `reach` is the farthest from the centre of mass [m].
    pub(crate) fn fastest(&self, state: &State, reach: f64) -> f64 {
        let over =
            |mount| (0..state.drives.len()).map(move |k| state.speed_over(mount, k, &self.model));
        let surface = self.model.mounts().flat_map(over);
        let surface = surface.fold(0.0, |fastest: f64, speed| fastest.max(speed.abs()));
        let shoes = state.shoes.iter().map(|shoe| {
            let pitch = self.model.chains[0].path.pitch;
            shoe.twist.velocity.length() + pitch * shoe.twist.turn.abs()
        });
        let body = state.fastest(reach) + self.tip_speed * surface;
        shoes.fold(body, f64::max)
    }

    fn softness(&self, h: f64) -> Softness {
        let (frequency, damping) = (
            self.solver.contact_frequency,
            self.solver.contact_damping_ratio,
        );
        Softness::new(frequency, damping, h)
    }

    /// Starts a step with the velocities after a time [s] in which only weight and external force act.
    fn set_free_velocities(&mut self, state: &State, time: f64) {
        let problem = &mut self.problem;
        problem.free.copy_from_slice(&problem.unknowns);
        self.fall(time);
        self.start_flippers(state, time);
    }

    /// Lets weight and external force act on the chassis for a time [s].
    fn fall(&mut self, time: f64) {
        let Vector { x, y } = self.outer_force / self.model.mass;
        self.problem.free[0] += x * time;
        self.problem.free[1] += (y - self.gravity) * time;
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
        for (touch, solved) in self.touches.iter_mut().zip(&mut self.problem.contacts) {
            let now = (&*state, self.problem.unknowns.as_slice());
            touch.move_gap(solved, now, &self.model, h);
        }
    }

    fn report(&mut self, contacts: &[Contact], h: f64) {
        self.loaded.clear();
        let found = self.touches.iter().zip(&self.problem.contacts);
        for ((touch, solved), contact) in found.zip(contacts) {
            self.loaded.push(Contact {
                distance: touch.gap,
                normal_force: solved.normal_impulse / h,
                friction_force: solved.friction_impulse / h,
                surface_speed: solved.tangent.along(&self.problem.unknowns),
                normal_guess: touch.normal_guess,
                friction_guess: touch.friction_guess,
                grip: solved.grip,
                ..*contact
            });
        }
        self.remember_rests();
    }
}

/// [kg] The mass that sets the stiffness of a contact with the ground; none: the contact's own effective mass. The ground is
/// as stiff below an arm as below the chassis. Shoes are light and have softer springs, and so have arms on robots with
/// shoes: otherwise the grip of these arms would keep changing with that of the shoes.
fn mass_on_spring(model: &Model, mount: Mount) -> Option<f64> {
    match (model.chains.first(), mount) {
        (None, _) => Some(model.total_mass()),
        (Some(chain), Mount::Flipper(_)) => Some(chain.shoe_mass),
        (Some(_), _) => None,
    }
}
