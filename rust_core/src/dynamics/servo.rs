//! A motor in a descent: a stiff damper about its last impulse, up to its limit.
//!
//! The equations: docs/physics.md, "Descent".

use super::action::Action;
use super::damper::{DAMPING, Damper};
use super::motor::Motor;
use super::state::State;
use super::system::Acts;

/// One motor in a descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Servo {
    /// The speed beyond the set-point.
    pub(super) action: Action,
    pub(super) acts: Acts,
    /// Its damper while it holds, the limit of its impulse, and its damper at the current speed.
    pub(super) holding: Damper,
    pub(super) limit: f64,
    pub(super) damper: Damper,
}

impl Servo {
    pub(super) fn new(
        action: Action,
        acts: Acts,
        (impulse, limit, admittance): (f64, f64, f64),
    ) -> Self {
        Self {
            action,
            acts,
            holding: Damper::new(impulse.clamp(-limit, limit), 1.0 / (DAMPING * admittance)),
            limit,
            damper: Damper::default(),
        }
    }

    /// Its speed beyond the set-point.
    pub(super) fn speed(&self, state: &State) -> f64 {
        let of_drive = self.acts.drive.map_or(0.0, |k| state.drives[k].spin);
        let of_flipper = self.acts.flipper.map_or(0.0, |k| state.flippers[k].rate);
        self.action
            .speed(state.velocity, state.angular_velocity, of_drive)
            + self.action.flipper_lever * of_flipper
    }

    /// Its damper at a speed: beyond a limit, a constant impulse.
    pub(super) fn damper_at(&self, speed: f64) -> Damper {
        self.holding.up_to(self.limit, speed)
    }

    /// The state of a motor with this impulse.
    pub(super) fn motor(&self) -> Motor {
        let impulse = self.damper.at(0.0);
        match self.damper.stiffness {
            0.0 if impulse > 0.0 => Motor::Pushes,
            0.0 if impulse < 0.0 => Motor::Brakes,
            _ => Motor::Holds,
        }
    }
}
