//! The arms at one end in the equations of motion.
//!
//! The equations: docs/physics.md, "Arms".

use serde::{Deserialize, Serialize};

use super::approach::Approach;
use crate::geometry::{Twist, Vector, left_of};
use crate::robot::Flipper;
use crate::solver::{Inertia, Row};

/// What the flippers at one end are to do; angles and rates are relative to the chassis, upwards > 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FlipperCommand {
    /// \[rad\] To turn to an angle.
    Angle(f64),
    /// \[rad\] The same, and to turn against the chassis as fast as it turns, to keep their angle to the ground;
    /// otherwise they would lag behind.
    Level(f64),
    /// \[rad/s\] To turn at a rate.
    Rate(f64),
}

impl Default for FlipperCommand {
    fn default() -> Self {
        Self::Angle(0.0)
    }
}

impl FlipperCommand {
    /// \[rad\] or \[rad/s\] Its number.
    pub fn value(self) -> f64 {
        let (Self::Angle(value) | Self::Level(value) | Self::Rate(value)) = self;
        value
    }
}

/// The arms at one end of the robot.
pub(super) struct Arm {
    pub rule: Flipper,
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

    /// [rad/s^2] How fast its motor can slow it down in the air.
    pub(super) fn deceleration(&self) -> f64 {
        self.rule.torque_limit / (self.inertia_about_pivot() + self.rule.rotor_inertia)
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

    /// Its inertia along x, along y and in rotation; its rate stands at `joint` among the solver's unknowns.
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
