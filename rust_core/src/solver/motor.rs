//! A motor: it holds a speed, or corrects it, up to the limits of its impulse.
//!
//! While a motor holds its speed, what it turns moves with the base at a known rate: it is no unknown, and only adds to the
//! base's moment of inertia. While a motor corrects its speed or is at a limit, or where there is none, the rate is an
//! unknown.
//!
//! The equations: docs/physics.md, "Motors".

use serde::{Deserialize, Serialize};

use super::Problem;
use super::damper::Damper;
use super::row::TURN;
use super::system::System;
use crate::units::MetresPerSecond;

/// The state of a motor in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum MotorState {
    /// Holds the speed, or corrects it.
    Holds,
    /// At its limit, forwards.
    LimitForwards,
    /// At its limit, backwards.
    LimitBackwards,
    /// Its gear, which locks itself, holds it at rest against a load that it cannot move.
    Locked,
    /// There is no motor.
    Absent,
}

/// Relative tolerance at the limit; a smaller excess is rounding.
const AT_LIMIT: f64 = 1e-12;
/// [m/s] A motor at its limit holds its speed again once it has overshot it by this.
const PAST: MetresPerSecond = MetresPerSecond(1e-9);

/// What a motor drives relative to the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Driven {
    /// A body that spins on the base or is hinged to it, by the index of its rate.
    Body(usize),
    /// The links of a ring.
    Ring(usize),
}

/// A motor. Its speed is a lever times the rate of what it turns, relative to the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motor {
    pub on: Driven,
    /// [m] The lever; negative if what it turns spins clockwise while it runs forwards; 1 for an arm, where speeds are in rad/s
    /// and impulses in N m s.
    pub lever: f64,
    /// [m/s] The speed that it holds.
    pub target: f64,
    /// The limits of its impulse, forwards and backwards, as functions of its speed.
    pub limits: [Damper; 2],
    /// Its impulse within these limits, as a function of its speed, if it corrects that; if not, it holds it.
    pub correction: Option<Damper>,
    /// Whether its gear is self-locking: its speed stays between 0 and the target whatever the load, as the gear bears what
    /// the motor cannot.
    pub locks: bool,
    pub state: MotorState,
    /// [N s] By how much its limits are widened on the path to a solution.
    pub(super) relaxed: f64,
}

impl Motor {
    /// A motor at rest; `is_there` is false if it has no impulse to give.
    pub(crate) fn new(on: Driven, lever: f64, is_there: bool) -> Self {
        Self {
            on,
            lever,
            target: 0.0,
            limits: [Damper::default(); 2],
            correction: None,
            locks: false,
            state: if is_there {
                MotorState::Holds
            } else {
                MotorState::Absent
            },
            relaxed: 0.0,
        }
    }

    /// Whether there is no motor.
    pub(crate) fn is_none(&self) -> bool {
        self.state == MotorState::Absent
    }

    /// The same with a self-locking gear, which holds it at rest whether the motor has an impulse to give or not.
    pub(crate) fn behind_lock(self) -> Self {
        Self {
            locks: true,
            state: MotorState::Holds,
            ..self
        }
    }

    /// Holds a target with an impulse of at most `most` [N s] either way.
    pub(crate) fn aim(&mut self, target: f64, most: f64) {
        self.limits = [most, -most].map(Damper::constant);
        self.turn_to(target);
    }

    /// Changes the target.
    pub(crate) fn turn_to(&mut self, target: f64) {
        self.target = target;
        // With a self-locking gear a motor is at its limit only in the direction in which it turns.
        let turns = match self.state {
            MotorState::LimitForwards => target > 0.0,
            MotorState::LimitBackwards => target < 0.0,
            _ => true,
        };
        if self.locks && !turns {
            self.state = MotorState::Holds;
        }
    }

    /// [m/s] The speed that it holds in a state in which it holds one.
    pub(super) fn held_speed(&self) -> f64 {
        if self.state == MotorState::Locked {
            0.0
        } else {
            self.target
        }
    }

    /// [rad/s] The rate, relative to the base, at which it holds what it turns, if it does.
    pub(super) fn held_rate(&self) -> Option<f64> {
        (self.given().is_none()).then(|| self.held_speed() / self.lever)
    }

    /// Its impulse as a function of its speed; none if the impulse is whatever holds the speed.
    pub(super) fn given(&self) -> Option<Damper> {
        match self.state {
            MotorState::Holds => self.correction,
            MotorState::LimitForwards => Some(self.limits[0]),
            MotorState::LimitBackwards => Some(self.limits[1]),
            MotorState::Locked => None,
            MotorState::Absent => Some(Damper::default()),
        }
    }

    /// [1/kg] Its change of speed per impulse, as far as that turns the base.
    pub(super) fn admittance(&self, system: &System) -> f64 {
        self.lever * self.lever * system.weights[TURN]
    }

    /// [N s] The part of its impulse that the motor itself can have given, without what its gear bears.
    pub(crate) fn without_lock(&self, impulse: f64) -> f64 {
        if !self.locks || self.given().is_some() {
            return impulse;
        }
        let [most, least] = self.limits.map(|limit| limit.at(self.held_speed()));
        // A limit that is linear in speed has the wrong sign at a speed that is far enough away.
        impulse.clamp(least.min(0.0), most.max(0.0))
    }

    /// Its next state after a solve in which it gave this impulse [N s] at this speed [m/s].
    fn next(&self, impulse: f64, speed: f64) -> MotorState {
        let mut next = self.state;
        self.conditions(impulse, speed, |hold, value| {
            // A smaller excess is rounding.
            let slack = match (self.state, self.correction) {
                (MotorState::Holds | MotorState::Locked, _) | (_, Some(_)) => {
                    AT_LIMIT * impulse.abs()
                }
                _ => PAST.value(),
            };
            if value < -slack {
                next = hold;
            }
        });
        next
    }

    /// Calls `each` with the conditions for its state at an impulse [N s] and a speed [m/s]: the state that follows where the
    /// condition fails, and the value, which must not be below 0.
    fn conditions(&self, impulse: f64, speed: f64, mut each: impl FnMut(MotorState, f64)) {
        let [most, least] = self.limits.map(|limit| limit.at(speed));
        let wanted = self.correction.map(|correction| correction.at(speed));
        let ahead = speed - self.held_speed();
        match self.state {
            MotorState::Holds => {
                let impulse = wanted.unwrap_or(impulse);
                if !self.locks || self.target > 0.0 {
                    each(MotorState::LimitForwards, most - impulse);
                }
                if !self.locks || self.target < 0.0 {
                    each(MotorState::LimitBackwards, impulse - least);
                }
            }
            MotorState::LimitForwards => {
                each(
                    MotorState::Holds,
                    wanted.map_or(-ahead, |wanted| wanted - most),
                );
                if self.locks {
                    each(MotorState::Locked, speed);
                }
            }
            MotorState::LimitBackwards => {
                each(
                    MotorState::Holds,
                    wanted.map_or(ahead, |wanted| least - wanted),
                );
                if self.locks {
                    each(MotorState::Locked, -speed);
                }
            }
            MotorState::Locked if self.target > 0.0 => {
                each(MotorState::LimitForwards, impulse - most);
            }
            MotorState::Locked if self.target < 0.0 => {
                each(MotorState::LimitBackwards, least - impulse);
            }
            MotorState::Locked | MotorState::Absent => {}
        }
    }

    /// By how much wider limits relax the condition that leads from its state to another one.
    pub(super) fn relaxed_by(&self, next: MotorState) -> f64 {
        // The same impulse decides whether it reaches its limit and whether it holds again.
        let is_soft = self.correction.is_some();
        match (self.state, next) {
            (MotorState::Holds, _) => self.relaxed,
            (MotorState::Locked, _) => -self.relaxed,
            (_, MotorState::Holds) if is_soft => -self.relaxed,
            (_, MotorState::Locked) if is_soft => self.relaxed,
            _ => 0.0,
        }
    }
}

impl Problem {
    /// [N s] The impulses of all motors.
    pub(crate) fn motor_impulses(&self) -> impl Iterator<Item = f64> + '_ {
        self.motors.iter().map(|motor| self.motor_impulse(motor))
    }

    /// [m/s] The speed of a motor.
    pub(crate) fn motor_speed(&self, motor: &Motor) -> f64 {
        match motor.on {
            Driven::Body(at) => motor.lever * (self.unknowns[at] - self.unknowns[TURN]),
            Driven::Ring(k) => self.rings[k].drive_speed(&self.unknowns),
        }
    }

    /// [N s] The impulse of a motor at the present velocities.
    pub(crate) fn motor_impulse(&self, motor: &Motor) -> f64 {
        if let Some(given) = motor.given() {
            return given.at(self.motor_speed(motor));
        }
        match motor.on {
            Driven::Body(at) => {
                // It accounts for the change of momentum that nothing else explains.
                let change = self.masses[at] * (self.unknowns[at] - self.free[at]);
                (change - self.loads[at]) / motor.lever
            }
            Driven::Ring(k) => self.rings[k].drive_impulse(&self.unknowns),
        }
    }

    /// The impulse of a motor, as a share of its limit in that direction.
    pub(crate) fn motor_load(&self, motor: &Motor) -> f64 {
        let impulse = self.motor_impulse(motor);
        let limit = motor.limits[usize::from(impulse < 0.0)];
        impulse / limit.at(self.motor_speed(motor))
    }

    /// Calls `each` with the conditions for the state of a motor.
    pub(super) fn conditions_of(&self, motor: &Motor, each: impl FnMut(MotorState, f64)) {
        motor.conditions(self.motor_impulse(motor), self.motor_speed(motor), each);
    }

    /// The state of a motor after a solve.
    pub(super) fn next_of(&self, motor: &Motor) -> MotorState {
        motor.next(self.motor_impulse(motor), self.motor_speed(motor))
    }

    /// Releases motors that exceed their limit, and lets those that overshoot their speed hold again; returns whether any
    /// changed.
    pub(super) fn switch_motors(&mut self) -> bool {
        self.note_loads();
        let mut switched = false;
        for k in 0..self.motors.len() {
            let next = self.next_of(&self.motors[k]);
            switched |= next != self.motors[k].state;
            self.motors[k].state = next;
        }
        switched
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // limits and impulses are handed on

    use super::*;

    fn behind_lock(hold: MotorState) -> Motor {
        let mut motor = Motor::new(Driven::Body(3), 0.1, true).behind_lock();
        motor.state = hold;
        motor
    }

    #[test]
    fn behind_a_lock_a_motor_gives_its_limit_only_the_way_that_it_turns() {
        for (hold, target, expected) in [
            (MotorState::LimitForwards, 0.5, MotorState::LimitForwards),
            (MotorState::LimitForwards, 0.0, MotorState::Holds),
            (MotorState::LimitForwards, -0.5, MotorState::Holds),
            (MotorState::LimitBackwards, -0.5, MotorState::LimitBackwards),
            (MotorState::LimitBackwards, 0.0, MotorState::Holds),
            (MotorState::LimitBackwards, 0.5, MotorState::Holds),
            (MotorState::Locked, 0.0, MotorState::Locked),
        ] {
            let mut motor = behind_lock(hold);
            motor.aim(target, 1.0);
            assert_eq!(motor.state, expected, "{hold:?} at {target} m/s");
            let mut free = Motor {
                locks: false,
                ..behind_lock(hold)
            };
            free.aim(target, 1.0);
            assert_eq!(free.state, hold);
        }
    }

    /// The conditions of a state at an impulse of 3 N s and a speed of 0.5 m/s, with limits of 2 and -1 N s.
    fn conditions(motor: &Motor) -> Vec<(MotorState, f64)> {
        let mut found = Vec::new();
        let limits = [2.0, -1.0].map(Damper::constant);
        let motor = Motor { limits, ..*motor };
        motor.conditions(3.0, 0.5, |state, value| found.push((state, value)));
        found
    }

    #[test]
    fn a_motor_stays_in_its_state_by_conditions() {
        use MotorState::{Holds, LimitBackwards, LimitForwards, Locked};
        let mut motor = Motor::new(Driven::Body(3), 0.1, true);
        motor.target = 0.2;
        for (state, expected) in [
            (Holds, vec![(LimitForwards, -1.0), (LimitBackwards, 4.0)]),
            (LimitForwards, vec![(Holds, -0.3)]),
            (LimitBackwards, vec![(Holds, 0.3)]),
            (MotorState::Absent, vec![]),
        ] {
            assert_eq!(conditions(&Motor { state, ..motor }), expected);
        }
        // It would give 2.5 N s: that is held against its limits, whatever it gives.
        motor.correction = Some(Damper::constant(2.5));
        for (state, expected) in [
            (Holds, vec![(LimitForwards, -0.5), (LimitBackwards, 3.5)]),
            (LimitForwards, vec![(Holds, 0.5)]),
            (LimitBackwards, vec![(Holds, -3.5)]),
        ] {
            assert_eq!(conditions(&Motor { state, ..motor }), expected);
        }
        motor.correction = None;
        for (target, of_hold, of_lock) in [
            (0.2, vec![(LimitForwards, -1.0)], vec![(LimitForwards, 1.0)]),
            (0.0, vec![], vec![]),
            (
                -0.2,
                vec![(LimitBackwards, 4.0)],
                vec![(LimitBackwards, -4.0)],
            ),
        ] {
            let locks = Motor {
                target,
                ..motor.behind_lock()
            };
            assert_eq!(
                conditions(&Motor {
                    state: Holds,
                    ..locks
                }),
                of_hold
            );
            assert_eq!(
                conditions(&Motor {
                    state: Locked,
                    ..locks
                }),
                of_lock
            );
            let at_limit = |state| conditions(&Motor { state, ..locks })[1];
            assert_eq!(at_limit(LimitForwards), (Locked, 0.5));
            assert_eq!(at_limit(LimitBackwards), (Locked, -0.5));
        }
    }

    #[test]
    fn a_lock_bears_what_the_motor_cannot_give() {
        let mut motor = behind_lock(MotorState::Holds);
        motor.aim(0.0, 2.0);
        for (impulse, of_motor) in [(-5.0, -2.0), (-1.0, -1.0), (1.5, 1.5), (7.0, 2.0)] {
            assert_eq!(motor.without_lock(impulse), of_motor);
        }
        // A line of the limit that is below 0 there leaves nothing to give.
        motor.limits = [Damper::constant(-3.0), Damper::constant(-2.0)];
        assert_eq!(
            [-5.0, -1.0, 1.0].map(|impulse| motor.without_lock(impulse)),
            [-2.0, -1.0, 0.0]
        );
        motor.aim(0.0, 2.0);
        // At its limit the motor gives all of it, and without a lock always.
        motor.state = MotorState::LimitForwards;
        assert_eq!(motor.without_lock(7.0), 7.0);
        (motor.state, motor.locks) = (MotorState::Holds, false);
        assert_eq!(motor.without_lock(7.0), 7.0);
    }
}
