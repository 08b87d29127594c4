//! The flippers in the equations of motion.
//!
//! An arm is a body that is hinged to the chassis at its pivot, so it adds one unknown, its rate, and none while its motor
//! holds the commanded rate.
//!
//! The equations: docs/physics.md, "Arms".

#[cfg(test)]
mod tests;

use super::Dynamics;
use super::approach::Approach;
use super::arm::{Arm, FlipperCommand};
use super::state::{State, Turn};
use super::trend::Trend;
use crate::geometry::{Twist, Vector};
use crate::robot::held_speed;
use crate::scenario::End;
use crate::solver::{Inertia, Row, TURN};

impl Dynamics {
    /// Commands the flippers, front and rear, for a step of `h` [s]. The chassis is expected to go on turning as in the
    /// last step.
    pub(crate) fn command_flippers(
        &mut self,
        state: &State,
        commands: [FlipperCommand; 2],
        h: f64,
        trend: Option<Trend>,
    ) {
        let gained = trend.map_or(0.0, |trend| trend.turn_gained(state, 0.5 * h));
        let of_chassis = state.angular_velocity + gained;
        for (k, arm) in self.flippers.iter_mut().enumerate() {
            let end = usize::from(arm.rule.end == End::Rear);
            let command = commands[end];
            let value = arm.rule.sign() * command.value();
            arm.keeps_level = matches!(command, FlipperCommand::Level(_));
            if matches!(command, FlipperCommand::Rate(_)) {
                arm.approach = Approach::going_on(value);
            } else if arm.rule.torque_limit > 0.0 {
                let way = value - state.over_chassis(k);
                let closing = arm.rule.rate_limit - arm.follows(of_chassis) * 1.0_f64.copysign(way);
                arm.approach = Approach::new(way, [closing, arm.deceleration()], h);
            }
            arm.aim(arm.approach.mean, of_chassis);
        }
    }

    /// Sets the motors' targets to those at the end of a step. `began` is the angular velocity of the chassis at its
    /// beginning [rad/s], and the state has half of its change.
    pub(super) fn aim_at_end(&mut self, state: &State, began: f64) {
        let of_chassis = 2.0 * state.angular_velocity - began;
        for arm in self.flippers.iter_mut().filter(|arm| !arm.approach.goes_on) {
            arm.aim(arm.approach.end, of_chassis);
        }
    }

    /// Places the arms as they are in the middle of a step, `half` [s] from now.
    pub(super) fn place_flippers(&mut self, state: &State, half: f64) {
        let center = self.model.center_of_mass;
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            let angles = [state.mass_pose_after(half).1, turn.angle + turn.rate * half];
            [arm.pivot, arm.center] = arm.rule.spokes(center, angles);
        }
    }

    /// Starts a step with the velocities that the arms have after a time [s] under weight alone.
    pub(super) fn start_flippers(&mut self, state: &State, time: f64) {
        let chassis = state.twist();
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            arm.free = Twist {
                velocity: arm.velocity(chassis, turn.rate),
                turn: turn.rate,
            };
        }
        self.accelerate_flippers(state, state.angular_velocity, time);
    }

    /// Accelerates the arms for a time [s] by weight and centripetal acceleration: the pivot turns with the chassis and the
    /// arm about the pivot, which changes no rate. `began` is the angular velocity of the chassis at the beginning of the step
    /// [rad/s]. In the middle of the step rates have made half of their change; they are extrapolated to its end.
    pub(super) fn accelerate_flippers(&mut self, state: &State, began: f64, time: f64) {
        let (center, gravity) = (self.model.center_of_mass, self.gravity);
        for (arm, turn) in self.flippers.iter_mut().zip(&state.flippers) {
            let [pivot, out] = arm.rule.spokes(center, [state.angle, turn.angle]);
            let of_chassis = 2.0 * state.angular_velocity - began;
            let of_arm = 2.0 * turn.rate - arm.free.turn;
            let inwards = pivot * of_chassis * of_chassis + out * of_arm * of_arm;
            arm.free.velocity += (inwards - Vector::new(0.0, gravity)) * time;
        }
    }

    /// Adds the arms as they are now to the next solve, with the impulses that their motors can give in a `time` [s].
    pub(super) fn add_flippers(&mut self, time: f64) {
        let arms = self.flippers.iter().enumerate();
        let (layout, turn) = (self.problem.layout, self.problem.free[TURN]);
        let inertias = &mut self.problem.inertias;
        inertias.extend(
            arms.clone()
                .flat_map(|(k, arm)| arm.inertias(layout.joint(k))),
        );
        let with_rotor = arms.filter(|(_, arm)| arm.rule.rotor_inertia > 0.0);
        inertias.extend(with_rotor.map(|(k, arm)| {
            let row = Row::over_base(layout.joint(k), 1.0);
            Inertia::new(row, arm.rule.rotor_inertia, arm.free.turn - turn)
        }));
        let motors = &mut self.problem.motors[self.model.flipper_motors()];
        for (motor, arm) in motors.iter_mut().zip(&self.flippers) {
            let most = arm.rule.torque_limit;
            let rate = held_speed(arm.rate, most, arm.rule.self_locking);
            motor.aim(rate, most * time);
        }
    }

    /// [N s] Momentum of the flippers.
    pub(super) fn momentum_of_flippers(&self, state: &State) -> Vector {
        let of =
            |(arm, turn): (&Arm, &Turn)| arm.velocity(state.twist(), turn.rate) * arm.rule.mass;
        self.flippers.iter().zip(&state.flippers).map(of).sum()
    }
}
