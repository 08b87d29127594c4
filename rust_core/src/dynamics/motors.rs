//! Motors: each holds its surface at the set-point, as far as its force limit lets it.
//!
//! A drive whose motor holds turns with the chassis but for the set-point: it is inertia of the chassis,
//! wherever its wheel is, and nothing to solve for. Only drives at their limit, or without a motor, have
//! a spin of their own.

use serde::{Deserialize, Serialize};

use super::Dynamics;
use super::levers::Direction;
use super::solve::Phase;
use super::state::State;
use crate::geometry::{Rotation, Vector, cross};
use crate::robot::Model;

/// What a motor does in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Motor {
    /// Its force gives the surface the set-point.
    Holds,
    /// At its limit, forwards.
    Pushes,
    /// At its limit, backwards.
    Brakes,
    /// There is none.
    Free,
}

/// Of the limit: less beyond it is rounding.
pub(super) const AT_LIMIT: f64 = 1e-12;
/// [m/s] A motor at its limit takes hold again when its surface is past the set-point by this.
pub(super) const PAST: f64 = 1e-9;

impl Motor {
    /// Share of the limit with which it pushes; none if it holds.
    pub(super) fn share(self) -> Option<f64> {
        match self {
            Self::Holds => None,
            Self::Pushes => Some(1.0),
            Self::Brakes => Some(-1.0),
            Self::Free => Some(0.0),
        }
    }

    /// One that holds with an impulse, if that is within its limit.
    pub(super) fn within(impulse: f64, limit: f64) -> Self {
        if impulse > limit {
            Self::Pushes
        } else if impulse < -limit {
            Self::Brakes
        } else {
            Self::Holds
        }
    }
}

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

/// Direction of a force along the chassis at axle height, at a chassis angle [rad].
pub(crate) fn push_axis(model: &Model, angle: f64) -> Direction {
    let rotation = Rotation::new(angle);
    let (axis, up) = (rotation * Vector::X, rotation * Vector::Y);
    // As for a contact, one drive radius above the line of action: the motor's reaction does the rest.
    let arm = model.drive_radius * up - rotation * model.center_of_mass;
    Direction {
        unit: axis,
        lever: cross(arm, axis),
        drive_lever: model.drive_radius,
        back: 0.0,
        flipper_lever: 0.0,
    }
}
