//! The arms at one end in the equations of motion.
//!
//! The equations: docs/physics.md, "Arms".

use super::action::Action;
use super::approach::Approach;
use super::damper::Damper;
use super::motor::Motor;
use super::phase::Phase;
use super::state::Twist;
use crate::geometry::{Vector, left_of};
use crate::robot::Flipper;

/// The arms at one end of the robot.
pub(super) struct Arm {
    pub rule: Flipper,
    pub motor: Motor,
    /// [rad/s] Rate relative to the chassis at which this solve aims.
    pub rate: f64,
    /// Its approach to the angle that it is to hold, in this step.
    pub approach: Approach,
    /// Whether this angle changes against the chassis, as fast as that turns.
    pub keeps_level: bool,
    /// [m] From the chassis' centre of mass to the pivot, in the middle of the step.
    pub pivot: Vector,
    /// [m] From the pivot to the arm's own centre of mass, in the middle of the step.
    pub center: Vector,
    /// Its velocity in this step if there were no pivot.
    pub free: Twist,
}

impl Arm {
    pub(super) fn new(rule: Flipper) -> Self {
        let has_motor = rule.torque_limit > 0.0;
        Self {
            rule,
            motor: if has_motor { Motor::Holds } else { Motor::Free },
            rate: 0.0,
            approach: Approach::default(),
            keeps_level: false,
            pivot: Vector::ZERO,
            center: Vector::ZERO,
            free: Twist::default(),
        }
    }

    /// [rad/s] Its rate relative to the chassis, if its motor holds it.
    pub(super) fn held_rate(&self) -> Option<f64> {
        self.motor.share().is_none().then_some(self.rate)
    }

    /// [kg m^2] Moment of inertia about the pivot.
    pub(super) fn inertia_about_pivot(&self) -> f64 {
        self.rule.moment_of_inertia + self.rule.mass * self.rule.arm.length_squared()
    }

    /// [rad/s^2] How fast its motor can slow it down in the air.
    pub(super) fn deceleration(&self) -> f64 {
        self.rule.torque_limit / self.inertia_about_pivot()
    }

    /// [rad/s] Rate relative to the chassis at which the angle changes that it is to hold, if the chassis turns at this
    /// rate [rad/s].
    pub(super) fn follows(&self, of_chassis: f64) -> f64 {
        if self.keeps_level { -of_chassis } else { 0.0 }
    }

    /// Aims at a rate relative to that angle, as far as the motor can turn so fast [rad/s].
    pub(super) fn aim(&mut self, rate: f64, of_chassis: f64) {
        let limit = self.rule.rate_limit;
        self.rate = (rate + self.follows(of_chassis)).clamp(-limit, limit);
    }

    /// [m/s] Velocity of its centre of mass.
    pub(super) fn velocity(&self, chassis: Twist, rate: f64) -> Vector {
        chassis.at(self.pivot) + rate * left_of(self.center)
    }

    /// [N m s] Angular impulse of its motor at a share of its limit.
    pub(super) fn given(&self, share: f64, phase: &Phase) -> f64 {
        share * self.rule.torque_limit * phase.elapsed
    }

    /// Its inertia along x, along y and in rotation, and its motor: the directions in which they act, and
    /// their dampers.
    pub(super) fn dampers(&self, phase: &Phase) -> [(Action, Damper); 4] {
        let [pivot, arm] = [self.pivot, self.center].map(left_of);
        let Flipper {
            mass,
            moment_of_inertia: inertia,
            ..
        } = self.rule;
        let action = |unit: Vector, lever: f64, flipper_lever: f64| {
            let action = Action {
                unit,
                lever,
                flipper_lever,
                ..Action::default()
            };
            action.of_flipper(self.held_rate())
        };
        let free = self.free.velocity;
        let share = self.motor.share().unwrap_or_default();
        [
            (
                action(Vector::X, pivot.x, arm.x),
                Damper::new(mass * free.x, mass),
            ),
            (
                action(Vector::Y, pivot.y, arm.y),
                Damper::new(mass * free.y, mass),
            ),
            (
                action(Vector::ZERO, 0.0, 1.0),
                Damper::new(inertia * self.free.turn, inertia),
            ),
            (
                action(Vector::ZERO, -1.0, 1.0),
                Damper::constant(self.given(share, phase)),
            ),
        ]
    }
}
