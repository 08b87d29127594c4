//! The arms at one end in the equations of motion.
//!
//! The equations: docs/physics.md, "Arms".

use serde::{Deserialize, Serialize};

use super::approach::Approach;
use crate::geometry::{Twist, Vector, left_of};
use crate::robot::Flipper;
use crate::solver::{Inertia, Row};

/// What the flippers at one end are commanded to do; angles and rates are relative to the chassis, positive upwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FlipperCommand {
    /// \[rad\] Turn to an angle.
    Angle(f64),
    /// \[rad\] Turn to an angle, and against the chassis as fast as that turns: this keeps their angle to the ground, to which
    /// they would otherwise lag behind.
    Level(f64),
    /// \[rad/s\] Turn at a rate.
    Rate(f64),
}

impl Default for FlipperCommand {
    fn default() -> Self {
        Self::Angle(0.0)
    }
}

impl FlipperCommand {
    /// \[rad\] or \[rad/s\] The commanded angle or rate.
    pub fn value(self) -> f64 {
        let (Self::Angle(value) | Self::Level(value) | Self::Rate(value)) = self;
        value
    }
}

/// The arms at one end of the robot.
pub(super) struct Arm {
    pub rule: Flipper,
    /// [rad/s] Target rate relative to the chassis in this solve.
    pub rate: f64,
    /// How it approaches the angle that it is to hold, in this step.
    pub approach: Approach,
    /// Whether it turns as fast as the chassis, the other way round, to keep its angle to the ground.
    pub keeps_level: bool,
    /// [m] From the chassis' centre of mass to the pivot, in the middle of the step.
    pub pivot: Vector,
    /// [m] From the pivot to the arm's centre of mass, in the middle of the step.
    pub center: Vector,
    /// The velocity that it would have in this step without its pivot.
    pub free: Twist,
}

impl Arm {
    pub(super) fn new(rule: Flipper) -> Self {
        Self {
            rule,
            rate: 0.0,
            approach: Approach::default(),
            keeps_level: false,
            pivot: Vector::ZERO,
            center: Vector::ZERO,
            free: Twist::default(),
        }
    }

    /// [kg m^2] Moment of inertia about the pivot.
    pub(super) fn inertia_about_pivot(&self) -> f64 {
        self.rule.moment_of_inertia + self.rule.mass * self.rule.arm.length_squared()
    }

    /// [rad/s^2] Deceleration that its motor can give it in the air.
    pub(super) fn deceleration(&self) -> f64 {
        self.rule.torque_limit / (self.inertia_about_pivot() + self.rule.rotor_inertia)
    }

    /// [rad/s] Rate, relative to the chassis, of the angle that it is to hold, if the chassis turns at `of_chassis` [rad/s].
    pub(super) fn follows(&self, of_chassis: f64) -> f64 {
        if self.keeps_level { -of_chassis } else { 0.0 }
    }

    /// Sets the target rate to a rate relative to that angle [rad/s], within the limit of the motor.
    pub(super) fn aim(&mut self, rate: f64, of_chassis: f64) {
        let limit = self.rule.rate_limit;
        self.rate = (rate + self.follows(of_chassis)).clamp(-limit, limit);
    }

    /// [m/s] Velocity of its centre of mass.
    pub(super) fn velocity(&self, chassis: Twist, rate: f64) -> Vector {
        chassis.at(self.pivot) + rate * left_of(self.center)
    }

    /// Its inertia along x, along y and in rotation; `joint` is the index of its rate among the solver's unknowns.
    pub(super) fn inertias(&self, joint: usize) -> [Inertia; 3] {
        let [pivot, arm] = [self.pivot, self.center].map(left_of);
        let Flipper {
            mass,
            moment_of_inertia: inertia,
            ..
        } = self.rule;
        let Vector { x, y } = self.free.velocity;
        [
            ([1.0, 0.0, pivot.x], arm.x, mass, x),
            ([0.0, 1.0, pivot.y], arm.y, mass, y),
            ([0.0; 3], 1.0, inertia, self.free.turn),
        ]
        .map(|(on_base, lever, inertia, free)| {
            Inertia::new(Row::on_base(on_base).and(joint, lever), inertia, free)
        })
    }
}
