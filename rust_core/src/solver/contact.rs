//! A contact as a solve sees it: two directions, a law, and what it has found of it.
//!
//! The equations: docs/physics.md, "Coulomb's law".

use super::damper::Damper;
use super::direction::Direction;
use super::grip::Grip;
use super::velocities::{ActsOn, HasVelocities, Velocities};
use super::way::Way;
use crate::geometry::Vector;
use crate::scenario::Friction;

/// [1/kg] Velocity along normal and tangent per unit impulse along them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Admittance {
    pub normal: f64,
    pub tangent: f64,
    /// That of the mass on its spring.
    pub spring: f64,
}

/// A contact: it can only push along its normal, and its friction along the tangent is limited by that.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub acts: ActsOn,
    pub normal: Direction,
    pub tangent: Direction,
    pub friction: Friction,
    /// Whether it can carry a load in this solve.
    pub bears: bool,
    /// [m/s] Speed at which it may close or, if negative, must open.
    pub bias: f64,
    /// Compliance in units of the admittance of its spring.
    pub compliance: f64,
    /// The same of a grip that gives way elastically; it is damped about its impulse of the last step.
    pub give: f64,
    /// Share of a change of the friction of an elastic grip that its spring keeps; the rest is damping.
    pub springs: f64,
    /// [N s] Impulse along the normal.
    pub normal_impulse: f64,
    /// [N s] Impulse along the tangent.
    pub friction_impulse: f64,
    /// The guessed state.
    pub grip: Grip,
    /// [N s] Impulses about which it is damped.
    pub(super) center: (f64, f64),
    /// The state that fits the last velocities.
    pub(super) fitting: Grip,
    /// Normal and tangent, with the motors in their state in this solve.
    pub(super) actions: [Direction; 2],
    pub(super) admittance: Admittance,
    /// Dampers of normal and tangent in this solve while no limit is reached.
    pub(super) dampers: [Damper; 2],
    /// Its line in a step of Newton's method.
    pub(super) way: Way,
}

impl Contact {
    /// A contact along these directions, without friction or history.
    pub(crate) fn new(acts: ActsOn, [normal, tangent]: [Direction; 2]) -> Self {
        Self {
            acts,
            normal,
            tangent,
            friction: Friction::dry(0.0),
            bears: false,
            bias: 0.0,
            compliance: 0.0,
            give: 0.0,
            springs: 1.0,
            normal_impulse: 0.0,
            friction_impulse: 0.0,
            grip: Grip::Open,
            center: (0.0, 0.0),
            fitting: Grip::Open,
            actions: [Direction::default(); 2],
            admittance: Admittance::default(),
            dampers: [Damper::default(); 2],
            way: Way::default(),
        }
    }

    /// [m/s] Speed at which it opens.
    pub(crate) fn opening_speed(&self, of: &impl HasVelocities) -> f64 {
        self.acts.speed(&self.normal, of)
    }

    /// [m/s] Velocity along the tangent.
    pub(crate) fn slip(&self, of: &impl HasVelocities) -> f64 {
        self.acts.speed(&self.tangent, of)
    }

    /// [m/s] Speeds along normal and tangent in this solve, offsets included.
    pub(super) fn speeds(&self, velocities: &Velocities) -> [f64; 2] {
        let [n, t] = self.changes(velocities);
        [n + self.actions[0].offset, t + self.actions[1].offset]
    }

    /// [m/s] Changes of these speeds with changes of the velocities; without friction that of slip makes no difference, and
    /// is left out.
    pub(super) fn changes(&self, changes: &Velocities) -> [f64; 2] {
        let [n, t] = &self.actions;
        let slip = if self.friction.resists() {
            self.acts.speed(t, changes)
        } else {
            0.0
        };
        [self.acts.speed(n, changes), slip]
    }

    /// Softens its grip by a compliance, about the friction [N s] of the last step; its spring keeps a share of a change.
    pub(crate) fn give_way(&mut self, compliance: f64, springs: f64, last: f64) {
        (self.give, self.springs) = (compliance, springs);
        self.center.1 = last;
    }

    /// [N s] Impulse along the tangent without the part of the damper, from which the next step starts.
    pub(crate) fn friction_kept(&self) -> f64 {
        if self.give == 0.0 || self.grip != Grip::Sticks {
            return self.friction_impulse;
        }
        self.center.1 + (self.friction_impulse - self.center.1) * self.springs
    }

    /// [N s] Its impulses along normal and tangent.
    pub(super) fn impulses(&self) -> [f64; 2] {
        [self.normal_impulse, self.friction_impulse]
    }

    /// [N s] Impulse on the body that it touches.
    pub(crate) fn impulse(&self) -> Vector {
        self.normal.unit * self.normal_impulse + self.tangent.unit * self.friction_impulse
    }

    /// [N m s] Angular impulse on what spins.
    pub(crate) fn torque(&self) -> f64 {
        self.normal.spin_lever * self.normal_impulse
            + self.tangent.spin_lever * self.friction_impulse
    }

    /// [N m s] Angular impulse on what is hinged to the base.
    pub(super) fn torque_on_joint(&self) -> f64 {
        self.normal.joint_lever * self.normal_impulse
            + self.tangent.joint_lever * self.friction_impulse
    }
}
