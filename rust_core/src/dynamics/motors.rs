//! The motors of the drives in a step.
//!
//! A force that depends on the speed is integrated by the trapezoidal rule up to the middle of a step, and from there by
//! the backward differentiation formula of second order: accurate to second order and L-stable (Bank et al. 1985).
//!
//! The equations: docs/physics.md, "Motors".

use super::Dynamics;
use super::forces::Forces;
use super::set_point::SetPoint;
use super::state::State;
use crate::solver::{Damper, MotorState};

impl Dynamics {
    /// Sets the motors up for the solve in the middle of a step, `half` [s] from its beginning.
    pub(super) fn drive_to_middle(&mut self, state: &State, set_point: SetPoint, half: f64) {
        let rule = &self.model.motor;
        let target = rule.target(set_point.middle);
        if !rule.depends_on_speed() {
            return self.hold_speed(target, half);
        }
        let motors = &mut self.problem.motors[self.model.drive_motors()];
        self.forces.clear();
        for (k, motor) in motors.iter_mut().enumerate() {
            let speed = state.track_speed(&self.model, k);
            let limits = rule.limits(speed);
            let forces = Forces {
                limits: limits.map(|limit| limit.line.into()),
                ends: limits.map(|limit| limit.ends),
                speed,
                error: set_point.start() - speed,
            };
            let [most, least] = forces.limits.map(|limit| limit.at(speed));
            let over = |force: Damper, now: f64| {
                force
                    .times(0.5 * half)
                    .plus(Damper::constant(0.5 * half * now))
            };
            motor.limits = [over(forces.limits[0], most), over(forces.limits[1], least)];
            motor.turn_to(target);
            motor.correction = rule.correction.map(|rule| {
                let now = rule.gain * forces.error + state.drives[k].integral;
                let later = rule.force(target, forces.error, state.drives[k].integral, half);
                over(later.into(), now.clamp(least, most))
            });
            self.forces.push(forces);
        }
    }

    /// Sets them up for the solve at its end, `h` [s] from its beginning, once that of its middle is done.
    pub(super) fn drive_to_end(&mut self, state: &State, set_point: SetPoint, h: f64) {
        let rule = &self.model.motor;
        let target = rule.target(set_point.end);
        if !rule.depends_on_speed() {
            return self.hold_speed(target, h);
        }
        let so_far: Vec<f64> = self.problem.motor_impulses().collect();
        let motors = &mut self.problem.motors[self.model.drive_motors()];
        for ((k, motor), so_far) in motors.iter_mut().enumerate().zip(so_far) {
            let forces = self.forces[k];
            let so_far = motor.without_lock(so_far);
            let over = |force: Damper| {
                force
                    .times(h / 3.0)
                    .plus(Damper::constant(4.0 / 3.0 * so_far))
            };
            motor.limits = forces.limits.map(over);
            motor.turn_to(target);
            let integral = state.drives[k].integral;
            motor.correction = (rule.correction)
                .map(|rule| over(rule.force(target, forces.error, integral, h).into()));
        }
    }

    /// Makes motors whose force does not depend on the speed hold a target [m/s] for a time [s].
    fn hold_speed(&mut self, target: f64, time: f64) {
        let most = self.model.motor.force * time;
        for motor in &mut self.problem.motors[self.model.drive_motors()] {
            motor.aim(target, most);
        }
    }

    /// Stores the mean forces of the motors over a step of `h` [s], and the integrals of their speed errors, which do not grow
    /// while a motor is at its limit.
    pub(super) fn collect_motors(&mut self, state: &mut State, set_point: SetPoint, h: f64) {
        for k in 0..self.forces.len() {
            let error = set_point.end - state.track_speed(&self.model, k);
            let correction = self.model.motor.correction;
            if let (Some(rule), MotorState::Holds) = (correction, self.problem.motors[k].state) {
                let mean = 0.5 * (self.forces[k].error + error);
                state.drives[k].integral += rule.integral * mean * h;
            }
        }
        let first_flipper = self.model.flipper_motors().start;
        for (k, impulse) in self.problem.motor_impulses().enumerate() {
            match k.checked_sub(first_flipper) {
                None => state.drives[k].force = impulse / h,
                Some(flipper) => state.flippers[flipper].torque = impulse / h,
            }
        }
    }
}
