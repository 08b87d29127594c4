//! The motors in a descent: servos in their place, so that the potential decides which of them hold together with
//! which contacts grip.
//!
//! The equations: docs/physics.md, "Descent".

use super::Dynamics;
use super::action::Action;
use super::motor::Motor;
use super::phase::Phase;
use super::servo::Servo;
use super::state::{State, Twist};
use super::system::Acts;

impl Dynamics {
    /// Puts a servo in the place of each motor of a drive or a flipper.
    pub(super) fn set_servos(&mut self, state: &State, phase: &Phase) {
        self.sum_torques();
        let m = &self.model;
        self.servos.clear();
        for k in self.chains.len()..self.motors.len() {
            if self.motors[k] == Motor::Free {
                continue;
            }
            let radius = m.drive_radius;
            let action = Action {
                lever: radius,
                spin_lever: -radius,
                offset: -phase.set_point,
                ..Action::default()
            };
            let acts = Acts {
                drive: Some(k),
                flipper: None,
            };
            let inertias = 1.0 / m.moment_of_inertia + 1.0 / m.drive_inertia(k);
            let impulse = self.motor_impulse(state, phase, k);
            let limits = (
                impulse,
                phase.motor_impulse(1.0, m),
                radius * radius * inertias,
            );
            self.servos.push(Servo::new(action, acts, limits));
        }
        for (k, arm) in self.flippers.iter().enumerate() {
            if arm.motor == Motor::Free {
                continue;
            }
            let action = Action {
                lever: -1.0,
                flipper_lever: 1.0,
                offset: -arm.rate,
                ..Action::default()
            };
            let acts = Acts {
                drive: None,
                flipper: Some(k),
            };
            let inertias = 1.0 / m.moment_of_inertia + 1.0 / arm.inertia_about_pivot();
            let impulse = self.flipper_impulse(state, phase, k);
            let limits = (impulse, arm.given(1.0, phase), inertias);
            self.servos.push(Servo::new(action, acts, limits));
        }
        self.set_motors(|_| Motor::Servo);
        self.set_actions(state, phase);
    }

    /// Gives each motor the state of its servo.
    pub(super) fn end_servos(&mut self, state: &State, phase: &Phase) {
        self.set_motors(Servo::motor);
        self.set_actions(state, phase);
    }

    fn set_motors(&mut self, motor: impl Fn(&Servo) -> Motor) {
        for servo in &self.servos {
            let motor = motor(servo);
            match servo.acts {
                Acts { drive: Some(k), .. } => self.motors[k] = motor,
                Acts {
                    flipper: Some(k), ..
                } => self.flippers[k].motor = motor,
                Acts { .. } => {}
            }
        }
    }

    /// Sets the dampers of the servos for the current velocities; returns whether none has changed.
    pub(super) fn choose_servos(&mut self, state: &State) -> bool {
        let mut same = true;
        for servo in &mut self.servos {
            let damper = servo.damper_at(servo.speed(state));
            same &= damper == servo.damper;
            servo.damper = damper;
        }
        same
    }

    pub(super) fn add_servos(&mut self) {
        for servo in &self.servos {
            self.system
                .add(&servo.action, &servo.action, servo.acts, servo.damper);
        }
    }

    /// The change of a servo's speed with a change of all velocities.
    fn change_of(&self, servo: &Servo, change: &Twist) -> f64 {
        let spin = servo
            .acts
            .drive
            .map_or(0.0, |k| self.system.spins[k].change);
        let rate = servo.acts.flipper.map_or(0.0, |k| self.system.changes[k]);
        let of_body = servo.action.change(change.velocity, change.turn, spin);
        of_body + servo.action.flipper_lever * rate
    }

    /// The servos' part of the slope of the potential along a change, at a share of it.
    pub(super) fn slope_of_servos(&self, state: &State, change: &Twist, share: f64) -> f64 {
        let of_servo = |servo: &Servo| {
            let of_change = self.change_of(servo, change);
            let speed = servo.speed(state) + of_change * share;
            -servo.damper_at(speed).at(speed) * of_change
        };
        self.servos.iter().map(of_servo).sum()
    }

    /// Calls `found` with the shares of a change at which a servo reaches or leaves its limit.
    pub(super) fn kinks_of_servos(
        &self,
        state: &State,
        change: &Twist,
        mut found: impl FnMut(f64),
    ) {
        for servo in &self.servos {
            let (speed, of_change) = (servo.speed(state), self.change_of(servo, change));
            for limit in [-servo.limit, servo.limit] {
                found((servo.holding.speed_for(limit) - speed) / of_change);
            }
        }
    }
}
