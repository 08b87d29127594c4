//! The solve: finds velocities that satisfy all constraints, so which contacts bear, grip and slide, and which
//! motors hold.
//!
//! The equations: docs/physics.md, "The linear system".

use super::Dynamics;
use super::action::Action;
use super::chain::Chain;
use super::damper::Damper;
use super::motor::Motor;
use super::phase::Phase;
use super::push::push_axis;
use super::row::{Admittance, Link, Row};
use super::state::State;
use super::system::Acts;
use crate::geometry::Vector;

/// [m/s] A solve ends when no constraint changes a velocity by more than this: over a step of 1 ms that
/// corresponds to a force of 1e-5 of the weight, far below anything that decides an outcome.
pub(super) const AGREEMENT: f64 = 1e-7;
/// Rounds of a search at most, unless the scenario says otherwise; most take one.
const ITERATIONS: u32 = 8;

impl Dynamics {
    /// Finds the impulses that satisfy all constraints.
    pub(super) fn solve(&mut self, state: &mut State, phase: &Phase) {
        self.effort.solves += 1;
        let agreed =
            self.search(state, phase) || (self.forget_gains() && self.search(state, phase));
        if !agreed {
            self.effort.unresolved += 1;
        }
        // From the impulses, so that momentum is conserved to the last digit; with pins, the pins matter more.
        if self.model.is_one_body() {
            self.balance(state, phase);
        } else if self.chains.is_empty() {
            self.balance_with_flippers(state, phase);
        }
    }

    /// Searches for them; returns whether they agree.
    fn search(&mut self, state: &mut State, phase: &Phase) -> bool {
        self.set_actions(state, phase);
        let guess = if self.chains.is_empty() {
            Self::solve_at_once
        } else {
            Self::solve_in_steps
        };
        for _ in 0..self.solver.iterations.unwrap_or(ITERATIONS) {
            if guess(self, state, phase) {
                return true;
            }
            match self.lower(state, phase) {
                Some(off) if off < AGREEMENT => return true,
                Some(_) => {}
                None => return false,
            }
        }
        false
    }

    /// Keeps all directions as they are in the middle of the step: contacts that jam cannot all open or slide as the
    /// robot turns. Returns whether that changes anything.
    fn forget_gains(&mut self) -> bool {
        let mut gains = self.rows.iter().flat_map(|row| row.gains);
        if gains.all(|gain| gain == 0.0) {
            return false;
        }
        for row in &mut self.rows {
            (row.gains, row.normal_impulse, row.friction_impulse) = ([0.0; 2], 0.0, 0.0);
        }
        true
    }

    /// Sets the actions of all constraints for the current state of the motors.
    pub(super) fn set_actions(&mut self, state: &State, phase: &Phase) {
        let motors = &self.motors;
        let held = (0..motors.len()).filter(|k| motors[*k].share().is_none());
        let of_held: f64 = held.map(|k| self.model.drive_inertia(k)).sum();
        self.inertia = self.model.moment_of_inertia + of_held;
        let spin_of_set_point = phase.set_point / self.model.drive_radius;
        // Ground is as stiff below an arm as below the chassis; shoes, which are light, have springs of their own.
        let (is_rigid, of_robot) = (self.chains.is_empty(), self.model.total_mass().recip());
        for i in 0..self.rows.len() {
            let row = &self.rows[i];
            let held = row.spin().is_some_and(|k| motors[k].share().is_none());
            let [n, t] = [&row.normal, &row.tangent].map(|along| match row.link {
                Link::Chassis => Action::new(along, held, spin_of_set_point),
                Link::Flipper(k) => Action::new(along, held, spin_of_set_point)
                    .of_flipper(self.flippers[k].held_rate()),
                Link::Shoe(_) => Action::of_shoe(along, 0.0),
                Link::Guide { .. } | Link::Tooth { .. } => {
                    Action::of_shoe(along, along.drive_lever)
                }
            });
            let [n, t] = [n.faster(row.gains[0]), t.faster(row.gains[1])];
            let normal = self.admittance(&n, row.link, row.drive);
            let admittance = Admittance {
                normal,
                tangent: self.admittance(&t, row.link, row.drive),
                spring: if is_rigid { of_robot } else { normal },
            };
            let row = &mut self.rows[i];
            (row.actions, row.admittance) = ([n, t], admittance);
        }
        if self.push.is_some() {
            let held = motors[0].share().is_none();
            let axis = push_axis(&self.model, state.angle);
            let action = Action::new(&axis, held, spin_of_set_point);
            let admittance = self.admittance(&action, Link::Chassis, Some(0));
            if let Some(push) = &mut self.push {
                (push.action, push.admittance) = (action, admittance);
            }
        }
    }

    /// The same in the middle of a search: also updates the dampers, about their centres.
    pub(super) fn act_with_motors(&mut self, state: &State, phase: &Phase) {
        self.set_actions(state, phase);
        self.rows.iter_mut().for_each(Row::place_dampers);
    }

    /// [N m s] Angular momentum of the chassis and the drives that turn with it, without contacts.
    pub(super) fn free_moment(&self, phase: &Phase) -> f64 {
        let m = &self.model;
        let spin_of_set_point = phase.set_point / m.drive_radius;
        let of_drive = |(k, motor): (usize, &Motor)| match motor.share() {
            Some(_) if k < self.chains.len() => 0.0,
            Some(share) => phase.motor_turn(share, m),
            None => m.drive_inertia(k) * (phase.spins[k] + spin_of_set_point),
        };
        let of_drives: f64 = self.motors.iter().enumerate().map(of_drive).sum();
        m.moment_of_inertia * phase.angular_velocity + of_drives
    }

    /// Computes the velocities from all impulses so far, for the current state of the motors.
    pub(super) fn balance(&mut self, state: &mut State, phase: &Phase) {
        let m = &self.model;
        let (mut impulse, mut moment) = (Vector::ZERO, self.free_moment(phase));
        for row in &self.rows {
            let [n, t] = &row.actions;
            impulse += row.impulse();
            moment += n.lever * row.normal_impulse + t.lever * row.friction_impulse;
        }
        if let Some(push) = &self.push {
            impulse += push.action.unit * push.impulse;
            moment += push.action.lever * push.impulse;
        }
        state.velocity = phase.velocity + impulse / m.mass;
        state.angular_velocity = moment / self.inertia;
        self.turn_with_chassis(state, phase);
        let m = &self.model;
        for (k, motor) in self.motors.iter().enumerate() {
            if let Some(share) = motor.share() {
                let of_motor = phase.motor_turn(share, m);
                state.drives[k].spin =
                    phase.spins[k] + (self.torques[k] - of_motor) / self.model.drive_inertia(k);
            }
        }
    }

    /// The same for a robot with flippers, whose rates hang together with the velocities.
    fn balance_with_flippers(&mut self, state: &mut State, phase: &Phase) {
        self.assemble_bodies(phase);
        for i in 0..self.rows.len() {
            let row = &self.rows[i];
            let impulses = [row.normal_impulse, row.friction_impulse];
            for (action, impulse) in row.actions.into_iter().zip(impulses) {
                self.add(i, &action, &action, Damper::constant(impulse));
            }
        }
        if let Some(push) = &mut self.push {
            push.center = push.impulse;
            let acts = Acts {
                drive: Some(0),
                ..Acts::default()
            };
            let impulse = Damper::constant(push.impulse);
            self.system.add(&push.action, &push.action, acts, impulse);
        }
        if self.take_solution(state).is_some() {
            self.turn_with_chassis(state, phase);
        }
    }

    /// [1/kg] Velocity along an action per unit impulse along it.
    fn admittance(&self, action: &Action, link: Link, drive: Option<usize>) -> f64 {
        let of_body = |mass: f64, inertia: f64, lever: f64| {
            action.unit.length_squared() / mass + lever * lever / inertia
        };
        let of_shoe = |chain: &Chain| {
            let rule = &chain.rule;
            of_body(rule.shoe_mass, rule.shoe_inertia, action.lever)
        };
        let of_reaction = || of_body(self.model.mass, self.inertia, action.back);
        let of_chassis_and_drive = || {
            let of_spin = drive.map_or(0.0, |k| {
                action.spin_lever * action.spin_lever / self.model.drive_inertia(k)
            });
            of_body(self.model.mass, self.inertia, action.lever) + of_spin
        };
        match link {
            Link::Chassis => of_chassis_and_drive(),
            Link::Flipper(k) => of_chassis_and_drive() + self.admittance_of_flipper(k, action),
            Link::Shoe(shoe) => of_shoe(&self.chains[shoe / self.shoes_a_chain]),
            Link::Guide { chain, .. } => of_shoe(&self.chains[chain]) + of_reaction(),
            Link::Tooth { chain, .. } => {
                let chain = &self.chains[chain];
                of_shoe(chain) + of_reaction() + chain.admittance(action.spin_lever)
            }
        }
    }

    /// Sets the spins of drives and the rates of flippers held by motors, and sums the angular impulses on the drives.
    pub(super) fn turn_with_chassis(&mut self, state: &mut State, phase: &Phase) {
        let back = phase.set_point / self.model.drive_radius;
        // A chain is held at its driving end, and has a speed of its own.
        let drives = state.drives.iter_mut().zip(&self.motors);
        for (drive, motor) in drives.skip(self.chains.len()) {
            if motor.share().is_none() {
                drive.spin = state.angular_velocity - back;
            }
        }
        self.turn_flippers_with_chassis(state);
        self.sum_torques();
    }

    /// Sums the angular impulses of the contacts on the drives.
    pub(super) fn sum_torques(&mut self) {
        self.torques.fill(0.0);
        for row in &self.rows {
            if let Some(k) = row.drive {
                self.torques[k] += row.torque();
            }
        }
        if let Some(push) = &self.push {
            self.torques[0] += self.model.drive_radius * push.impulse;
        }
    }

    /// Starts a step from the forces of the last one, for half its time.
    pub(super) fn guess(&mut self, half: f64) {
        for row in &mut self.rows {
            row.normal_impulse = row.normal_guess * half;
            row.friction_impulse = row.friction_guess * half;
        }
        if let Some(push) = &mut self.push {
            push.impulse = push.force * half;
        }
    }

    /// Starts the solve over all of the step, for contacts that bear: from the forces of its first half, in which springs
    /// shared the load. From those of the last step, wheels that share a load in many ways went on to pass it round.
    pub(super) fn guess_more(&mut self) {
        for row in &mut self.rows {
            row.bears = row.has_closed();
            (row.bias, row.compliance) = (0.0, 0.0);
            row.normal_impulse *= 2.0;
            row.friction_impulse *= 2.0;
        }
        if let Some(push) = &mut self.push {
            push.impulse *= 2.0;
        }
    }

    /// Stores the forces of a step of `h` [s] for the next.
    pub(super) fn remember(&mut self, h: f64) {
        for row in &mut self.rows {
            row.normal_guess = row.normal_impulse / h;
            row.friction_guess = row.friction_kept() / h;
        }
        if let Some(push) = &mut self.push {
            push.force = push.impulse / h;
        }
        for chain in &mut self.chains {
            chain.remember(h);
        }
    }

    /// Stores the mean forces of the motors over a step.
    pub(super) fn collect(&mut self, state: &mut State, phase: &Phase) {
        let h = phase.elapsed;
        for k in 0..state.drives.len() {
            let impulse = self.motor_impulse(state, phase, k);
            state.drives[k].force = impulse / h;
            state.drives[k].traction = self.torques[k] / (self.model.drive_radius * h);
        }
        self.collect_flippers(state, phase);
    }
}
