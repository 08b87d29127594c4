//! The solves of a step, and the forces that one step passes on to the next.
//!
//! The equations: docs/physics.md, "A step".

use super::Dynamics;
use super::push::push_axis;
use super::state::State;
use crate::solver::{ActsOn, Damper, Inertia};

impl Dynamics {
    /// Solves for the velocities after a `time` [s] in which motors push.
    pub(super) fn solve(&mut self, state: &mut State, time: f64) {
        self.problem.inertias.clear();
        self.turn_rotors();
        self.hang_flippers(time);
        for push in &mut self.problem.bilaterals {
            push.along = push_axis(&self.model, state.angle);
        }
        state.write_velocities(&mut self.problem.velocities);
        self.problem.solve();
        state.take_velocities(&self.problem.velocities);
        self.spin_with_chains(state);
    }

    /// Gives the next solve the rotors of the drives, which turn with these over the chassis.
    fn turn_rotors(&mut self) {
        let problem = &mut self.problem;
        for (k, spin) in problem.spins.iter().enumerate() {
            let free = problem.free.spins[k] - problem.free.base.turn;
            if spin.rotor == 0.0 {
                continue;
            }
            if let Some(ring) = problem.rings.get_mut(k) {
                let lever = problem.motors[k].lever;
                let mass = spin.rotor / (lever * lever);
                ring.drive.rotor = Damper::new(mass * lever * free, mass);
            } else {
                let rotor = Inertia::of_rotor(ActsOn::on_spin(k), spin.rotor, free);
                problem.inertias.push(rotor);
            }
        }
    }

    /// Ends a step with the blow of what strikes in it, on all contacts that bear.
    pub(super) fn blow(&mut self, state: &mut State) {
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            solved.bears |= touch.strikes;
        }
        self.problem.blow(self.solver.restitution);
        state.take_velocities(&self.problem.velocities);
    }

    /// Starts a step from the forces of the last one, for half its time.
    pub(super) fn guess(&mut self, half: f64) {
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            solved.normal_impulse = touch.normal_guess * half;
            solved.friction_impulse = touch.friction_guess * half;
        }
        for push in &mut self.problem.bilaterals {
            push.impulse = self.push_force.unwrap_or_default() * half;
        }
    }

    /// Starts the solve over all of the step, for contacts that bear: from the forces of its first half, in which springs
    /// shared the load. From those of the last step, wheels that share a load in many ways went on to pass it round.
    /// Where something `strikes`, what closes is left to the blow.
    pub(super) fn guess_more(&mut self, strikes: bool) {
        for (touch, solved) in self.touches.iter_mut().zip(&mut self.problem.contacts) {
            (solved.bias, solved.compliance) = (0.0, 0.0);
            solved.bears = touch.has_closed(solved);
            touch.strikes = strikes && solved.bears && touch.was_open();
            if touch.strikes {
                solved.bears = false;
                (solved.normal_impulse, solved.friction_impulse) = (0.0, 0.0);
            }
            solved.normal_impulse *= 2.0;
            solved.friction_impulse *= 2.0;
        }
        for push in &mut self.problem.bilaterals {
            push.impulse *= 2.0;
        }
    }

    /// Stores the forces of a step of `h` [s] for the next.
    pub(super) fn remember(&mut self, h: f64) {
        for (touch, solved) in self.touches.iter_mut().zip(&self.problem.contacts) {
            touch.normal_guess = solved.normal_impulse / h;
            touch.friction_guess = solved.friction_kept() / h;
        }
        for push in &self.problem.bilaterals {
            self.push_force = Some(push.impulse / h);
        }
        for (chain, ring) in self.chains.iter_mut().zip(&self.problem.rings) {
            chain.remember(ring, h);
        }
    }

    /// Stores the mean forces of the ground along the surfaces over a step of `h` [s].
    pub(super) fn collect_tractions(&self, state: &mut State, h: f64) {
        for drive in &mut state.drives {
            drive.traction = 0.0;
        }
        let per_torque = (self.model.drive_radius * h).recip();
        for (touch, solved) in self.touches.iter().zip(&self.problem.contacts) {
            if let Some(k) = touch.drive {
                state.drives[k].traction += solved.torque() * per_torque;
            }
        }
        for push in &self.problem.bilaterals {
            state.drives[0].traction += push.impulse / h;
        }
    }
}
