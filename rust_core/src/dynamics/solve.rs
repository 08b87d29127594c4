//! The solves of a step, and the forces that one step passes on to the next.
//!
//! The equations: docs/physics.md, "A step".

use super::Dynamics;
use super::push::push_row;
use super::state::State;
use crate::solver::{Damper, Driven, Inertia, Row, TURN};

impl Dynamics {
    /// Solves for the velocities after a `time` [s] in which motors push.
    pub(super) fn solve(&mut self, state: &mut State, time: f64) {
        self.problem.inertias.clear();
        self.add_rotors();
        self.add_flippers(time);
        let layout = self.problem.layout;
        for push in &mut self.problem.bilaterals {
            push.row = push_row(&self.model, layout, state.angle);
        }
        self.problem.solve();
        state.take_velocities(layout, &self.problem.unknowns);
        self.spin_with_chains(state);
    }

    /// Adds the rotors of the drives to the next solve; they turn with the drives relative to the chassis.
    fn add_rotors(&mut self) {
        let problem = &mut self.problem;
        for (k, motor) in problem.motors.iter().take(self.model.drives).enumerate() {
            let rotor = self.model.rotor_inertia(k);
            if rotor == 0.0 {
                continue;
            }
            let at = problem.layout.spin(k);
            let free = problem.free[at] - problem.free[TURN];
            match motor.on {
                Driven::Ring(ring) => {
                    let mass = rotor / (motor.lever * motor.lever);
                    problem.rings[ring].rotor = Damper::new(mass * motor.lever * free, mass);
                }
                Driven::Body(_) => {
                    let over_base = Inertia::new(Row::over_base(at, 1.0), rotor, free);
                    problem.inertias.push(over_base);
                }
            }
        }
    }

    /// Ends a step with the impact of contacts that strike in it, on all contacts that bear.
    pub(super) fn impact(&mut self, state: &mut State) {
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            solved.bears |= touch.strikes;
        }
        self.problem.impact(self.solver.restitution);
        state.take_velocities(self.problem.layout, &self.problem.unknowns);
    }

    /// Starts the first solve of a step from the forces of the last step, acting for half of this one.
    pub(super) fn guess(&mut self, half: f64) {
        for (touch, solved) in self.touches.iter().zip(&mut self.problem.contacts) {
            solved.normal_impulse = touch.normal_guess * half;
            solved.friction_impulse = touch.friction_guess * half;
        }
        for push in &mut self.problem.bilaterals {
            push.impulse = self.push_force.unwrap_or_default() * half;
        }
    }

    /// Starts the second solve from the forces of the first one, in which springs shared the load: from the forces of the last
    /// step, wheels that can share a load in many ways did not settle. Only contacts that have closed bear; if something
    /// `strikes`, those that close in this step are left to the impact.
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
                state.drives[k].traction += touch.torque(solved) * per_torque;
            }
        }
        for push in &self.problem.bilaterals {
            state.drives[0].traction += push.impulse / h;
        }
    }
}
