//! A change of all velocities, from those of a state to those of a solve.
//!
//! The equations: docs/physics.md, "Lowering".

use super::Dynamics;
use super::chain::Chain;
use super::row::Row;
use super::state::{State, Twist};

impl Dynamics {
    /// Solves the system; returns the change of the chassis' velocity and stores those of all other bodies. None
    /// if the constraints contradict each other.
    pub(super) fn solve_for_change(&mut self, state: &State) -> Option<Twist> {
        let (velocity, turn) = self.solve_system()?;
        let change = Twist { velocity, turn }.less(state.twist());
        self.change_shoes(state);
        self.change_flippers(state, &change);
        for (k, spin) in self.system.spins.iter_mut().enumerate() {
            let of_sprocket = self.chains.get(k).is_some_and(Chain::has_sprocket);
            let is_free = self.motors[k].share().is_some() || of_sprocket;
            spin.change = if is_free {
                spin.value - state.drives[k].spin
            } else {
                0.0
            };
        }
        Some(change)
    }

    /// Changes all velocities by a share of the change.
    pub(super) fn move_by(&self, state: &mut State, change: &Twist, share: f64) {
        state.velocity += change.velocity * share;
        state.angular_velocity += change.turn * share;
        self.move_shoes(state, share);
        self.move_flippers(state, share);
        for (drive, spin) in state.drives.iter_mut().zip(&self.system.spins) {
            drive.spin += spin.change * share;
        }
    }

    /// [m/s] The change along a contact's normal and tangent.
    pub(super) fn changes_of(&self, row: &Row, change: &Twist) -> [f64; 2] {
        let shoe = |i: usize| self.chains[i / self.shoes_a_chain].solved[i % self.shoes_a_chain];
        let idler = |k: usize| self.chains[k].idler_rate;
        let spin = |k: usize| self.system.spins[k].change;
        row.count(*change, shoe, spin, idler, |k| self.system.changes[k])
    }
}
