//! Motors: each holds its surface at the set-point, up to its force limit.
//!
//! A drive whose motor holds turns with the chassis, apart from the set-point: it adds to the inertia of the
//! chassis, wherever its wheel is, and is not an unknown. Only drives at their limit or without a motor have a
//! spin to solve for.
//!
//! The equations: docs/physics.md, "Motors".

use super::Dynamics;
use super::motor::{AT_LIMIT, Motor, PAST};
use super::phase::Phase;
use super::state::State;

impl Dynamics {
    /// Releases motors beyond their limit, and lets those past the set-point hold again; returns whether any changed.
    pub(super) fn switch_motors(&mut self, state: &State, phase: &Phase) -> bool {
        let mut switched = self.switch_flippers(state, phase);
        for k in 0..self.motors.len() {
            let next = match self.motors[k] {
                Motor::Free => Motor::Free,
                Motor::Holds => self.at_limit(state, phase, k),
                at_limit => {
                    let ahead = self.ahead(state, phase, k);
                    let past = ahead * at_limit.share().unwrap_or_default();
                    if past > PAST { Motor::Holds } else { at_limit }
                }
            };
            switched |= next != self.motors[k];
            self.motors[k] = next;
        }
        switched
    }

    /// [m/s] How far the surface speed of a drive exceeds the set-point.
    pub(super) fn ahead(&self, state: &State, phase: &Phase, k: usize) -> f64 {
        let speed = match self.chains.get(k) {
            Some(chain) => chain.drive_speed(state),
            None => state.track_speed(&self.model, k),
        };
        speed - phase.set_point
    }

    /// The next state of a motor that holds.
    fn at_limit(&self, state: &State, phase: &Phase, k: usize) -> Motor {
        let limit = self.model.drive_force * phase.elapsed * (1.0 + AT_LIMIT);
        Motor::within(self.motor_impulse(state, phase, k), limit)
    }

    /// [N s] Impulse of a motor so far.
    pub(super) fn motor_impulse(&self, state: &State, phase: &Phase, k: usize) -> f64 {
        if let Some(chain) = self.chains.get(k) {
            return chain.drive_impulse();
        }
        if let Some(share) = self.motors[k].share() {
            return phase.motor_impulse(share, &self.model);
        }
        // The motor has made the change of spin that the contacts have not.
        let change = self.model.drive_inertia(k) * (state.drives[k].spin - phase.spins[k]);
        (self.torques[k] - change) / self.model.drive_radius
    }
}
