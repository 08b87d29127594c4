//! Direct search: guesses from the last solve which contacts are open, stick or slide, finds the velocities
//! from one small linear system, and corrects the guess until it fits.
//!
//! A contact enters as a stiff damper about its last impulse (the proximal point of an augmented Lagrangian),
//! so that contacts that share one load have a solution too, and the nearest one. The effect of the damping
//! vanishes as each solution becomes the centre of the next. The system has three rows for the chassis,
//! whatever the number of contacts, and one more, eliminated right away, for each drive that does not turn
//! with the chassis.
//!
//! The equations: docs/physics.md, "Direct search".

use super::Dynamics;
use super::action::Action;
use super::chain::Chain;
use super::damper::Damper;
use super::grip::Grip;
use super::phase::Phase;
use super::row::{Link, Row};
use super::solve::AGREEMENT;
use super::state::State;
use super::system::{Acts, Spin};

/// Solutions of the system in one search; since all misfits are corrected at once, corrections could
/// alternate for ever.
const AT_ONCE: u32 = 4;

impl Dynamics {
    /// Finds the impulses that satisfy all constraints, if corrected guesses lead there.
    pub(super) fn solve_at_once(&mut self, state: &mut State, phase: &Phase) -> bool {
        self.settle();
        for _ in 0..AT_ONCE {
            self.effort.rounds += 1;
            self.assemble(phase);
            let Some(change) = self.solve_for_change(state) else {
                return false;
            };
            self.move_by(state, &change, 1.0);
            let off = self.follow_velocities(state, phase);
            let fits = self.mend();
            if !fits {
                continue;
            }
            self.turn_with_chassis(state, phase);
            if self.switch_motors(state, phase) {
                self.act_with_motors(state, phase);
            } else {
                if off < AGREEMENT {
                    return true;
                }
                self.settle();
            }
        }
        self.rows.iter_mut().for_each(Row::unsettle);
        false
    }

    /// Solves the system and sets the velocities; none if the constraints contradict each other.
    pub(super) fn take_solution(&mut self, state: &mut State) -> Option<()> {
        (state.velocity, state.angular_velocity) = self.solve_system()?;
        for (drive, spin) in state.drives.iter_mut().zip(&self.system.spins) {
            drive.spin = spin.value;
        }
        self.take_flippers(state);
        Some(())
    }

    /// Updates all impulses to match the velocities; returns the largest error of a velocity [m/s].
    pub(super) fn follow_velocities(&mut self, state: &mut State, phase: &Phase) -> f64 {
        let mut off: f64 = 0.0;
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            off = off.max(row.follow_speeds(row.speeds(state)));
        }
        if let Some(push) = &mut self.push {
            off = off.max(push.follow_velocities(state));
        }
        off.max(self.chains_follow_velocities(state, phase))
    }

    /// Corrects the grips that do not fit; returns whether all fitted.
    fn mend(&mut self) -> bool {
        let mut fits = true;
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            let next = row.grip.towards(row.fitting);
            fits &= next == row.grip;
            row.grip = next;
        }
        fits
    }

    /// Makes the current impulses the ones about which constraints are damped.
    pub(super) fn settle(&mut self) {
        self.rows.iter_mut().for_each(Row::settle);
        self.chains.iter_mut().for_each(Chain::settle);
        if let Some(push) = &mut self.push {
            push.center = push.impulse;
        }
    }

    /// Assembles the system without constraints.
    pub(super) fn assemble_bodies(&mut self, phase: &Phase) {
        let m = &self.model;
        let moment = self.free_moment(phase);
        let system = &mut self.system;
        system.start(m.mass, self.inertia, phase.velocity, moment);
        for (k, motor) in self.motors.iter().enumerate() {
            let share = motor.share().unwrap_or_default();
            let of_motor = phase.motor_turn(share, m);
            // The drive of a chain has no inertia of its own.
            let drive_inertia = if k < self.chains.len() {
                1.0
            } else {
                m.drive_inertia(k)
            };
            let moment = drive_inertia * phase.spins[k] - of_motor;
            system.spins[k] = Spin::new(drive_inertia, moment);
        }
        self.assemble_chains(phase);
        self.assemble_flippers(phase);
    }

    /// Assembles the system with the constraints as guessed.
    pub(super) fn assemble(&mut self, phase: &Phase) {
        self.assemble_bodies(phase);
        for i in 0..self.rows.len() {
            let row = &self.rows[i];
            if !row.bears {
                continue;
            }
            let [normal, tangent] = row.actions;
            let [n, t] = row.dampers;
            match row.grip {
                Grip::Open => {}
                Grip::Sticks => {
                    self.add(i, &normal, &normal, n);
                    self.add(i, &tangent, &tangent, t);
                }
                Grip::Forwards => {
                    let force = normal.plus(&tangent, row.friction);
                    self.add(i, &force, &normal, n);
                }
                Grip::Backwards => {
                    let force = normal.plus(&tangent, -row.friction);
                    self.add(i, &force, &normal, n);
                }
            }
        }
        self.add_push();
    }

    /// Adds a constraint of a row: its impulse acts along `force`, with a damper along `action`.
    pub(super) fn add(&mut self, row: usize, force: &Action, action: &Action, damper: Damper) {
        let row = &self.rows[row];
        let on_body = [force.body(), action.body()];
        match row.link {
            Link::Chassis | Link::Flipper(_) => {
                let acts = Acts {
                    drive: row.drive,
                    flipper: row.flipper(),
                };
                self.system.add(force, action, acts, damper);
            }
            Link::Shoe(i) => {
                let (chain, i) = (i / self.shoes_a_chain, i % self.shoes_a_chain);
                self.chains[chain].add(i, on_body, damper);
            }
            Link::Guide { shoe, chain } => {
                let back = [force.reaction(), action.reaction()];
                self.chains[chain].add_rest(shoe % self.shoes_a_chain, on_body, back, damper);
            }
            Link::Tooth { shoe, chain } => {
                let back = [force.reaction(), action.reaction()];
                self.chains[chain].add_tooth(shoe % self.shoes_a_chain, on_body, back, damper);
            }
        }
    }

    /// Adds the push of a track that is modelled as a force only.
    pub(super) fn add_push(&mut self) {
        if let Some(push) = &self.push {
            let along = &push.action;
            let acts = Acts {
                drive: Some(0),
                ..Acts::default()
            };
            self.system.add(along, along, acts, push.damper());
        }
    }
}
