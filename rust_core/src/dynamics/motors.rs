//! Motors: each holds its surface at the set-point, as far as its force limit lets it.
//!
//! A drive whose motor holds turns with the chassis but for the set-point: it is inertia of the chassis,
//! wherever its wheel is, and nothing to solve for. Only drives at their limit, or without a motor, have
//! a spin of their own.

use super::Dynamics;
use super::motor::{AT_LIMIT, Motor, PAST};
use super::phase::Phase;
use super::state::State;

impl Dynamics {
    /// Lets motors beyond their limit go, and those past the set-point take hold; whether any did.
    pub(super) fn switch_motors(&mut self, state: &State, phase: &Phase) -> bool {
        let mut switched = self.switch_flippers(state, phase, true);
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

    /// Lets motors beyond their limit go; whether any did.
    pub(super) fn limit_motors(&mut self, state: &State, phase: &Phase) -> bool {
        let mut switched = self.switch_flippers(state, phase, false);
        for k in 0..self.motors.len() {
            if self.motors[k] == Motor::Holds {
                self.motors[k] = self.at_limit(state, phase, k);
                switched |= self.motors[k] != Motor::Holds;
            }
        }
        switched
    }

    /// [m/s] What the surface of a drive is ahead of the set-point.
    fn ahead(&self, state: &State, phase: &Phase, k: usize) -> f64 {
        match self.chains.get(k) {
            Some(chain) => chain.ahead(state, phase.set_point),
            None => state.track_speed(&self.model, k) - phase.set_point,
        }
    }

    /// What a motor that holds has to do.
    fn at_limit(&self, state: &State, phase: &Phase, k: usize) -> Motor {
        let limit = self.model.drive_force * phase.elapsed * (1.0 + AT_LIMIT);
        Motor::within(self.motor_impulse(state, phase, k), limit)
    }

    /// [N s] What a motor has given so far.
    pub(super) fn motor_impulse(&self, state: &State, phase: &Phase, k: usize) -> f64 {
        if let Some(chain) = self.chains.get(k) {
            return chain.drive_impulse();
        }
        if let Some(share) = self.motors[k].share() {
            return phase.motor_impulse(share, &self.model);
        }
        // What the contacts have not, the motor has changed of the spin.
        let change = self.model.drive_inertia(k) * (state.drives[k].spin - phase.spins[k]);
        (self.torques[k] - change) / self.model.drive_radius
    }
}
