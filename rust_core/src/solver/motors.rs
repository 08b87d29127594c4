//! The motors in a solve: their impulses, and which of them hold.
//!
//! The equations: docs/physics.md, "Motors".

use super::direction::Direction;
use super::motor::{Driven, Motor};
use super::{Inertia, Problem};

impl Problem {
    /// Releases motors beyond their limit, and lets those past their speed hold again; returns whether any changed.
    pub(super) fn switch_motors(&mut self) -> bool {
        let mut switched = false;
        for k in 0..self.motors.len() {
            let motor = &self.motors[k];
            let next = motor.next(self.motor_impulse(motor), self.ahead(motor));
            switched |= next != motor.hold;
            self.motors[k].hold = next;
        }
        switched
    }

    /// [m/s] How much faster a motor is than the speed that it holds, if it does.
    pub(super) fn ahead(&self, motor: &Motor) -> f64 {
        self.motor_speed(motor) - motor.held_speed()
    }

    /// [m/s] The speed of a motor.
    pub(super) fn motor_speed(&self, motor: &Motor) -> f64 {
        let over_base = |rate: f64| motor.lever * (rate - self.velocities.base.turn);
        match motor.on {
            Driven::Spin(k) => over_base(self.velocities.spins[k]),
            Driven::Joint(k) => over_base(self.velocities.joints[k]),
            Driven::Ring(k) => self.rings[k].drive_speed(&self.velocities),
        }
    }

    /// [N s] The impulses of all motors.
    pub(crate) fn motor_impulses(&self) -> impl Iterator<Item = f64> + '_ {
        self.motors.iter().map(|motor| self.motor_impulse(motor))
    }

    /// [N s] Impulse of a motor so far.
    pub(super) fn motor_impulse(&self, motor: &Motor) -> f64 {
        if let Driven::Ring(k) = motor.on {
            return self.rings[k].drive.impulse;
        }
        if let Some(given) = motor.given() {
            return given.at(self.ahead(motor) + motor.held_speed());
        }
        // It has made the change of momentum that the contacts have not.
        let made = match motor.on {
            Driven::Spin(k) => {
                let change = self.velocities.spins[k] - self.free.spins[k];
                let gained = self.gained(|i| i.acts.spin() == Some(k), |d| d.spin_lever);
                self.spins[k].inertia * change - self.torques[k] + gained
            }
            Driven::Joint(k) => {
                let gained = self.gained(|i| i.acts.joint() == Some(k), |d| d.joint_lever);
                gained - self.torque_on_joint(k)
            }
            Driven::Ring(_) => 0.0,
        };
        made / motor.lever
    }

    /// [N m s] Momentum that the inertias of one body have gained over what it would have without constraints.
    fn gained(&self, own: impl Fn(&Inertia) -> bool, lever: impl Fn(&Direction) -> f64) -> f64 {
        let own = self.inertias.iter().filter(|inertia| own(inertia));
        own.map(|inertia| lever(&inertia.along) * inertia.gained(&self.velocities))
            .sum()
    }

    fn torque_on_joint(&self, joint: usize) -> f64 {
        let on_it = self
            .contacts
            .iter()
            .filter(|c| c.acts.joint() == Some(joint));
        on_it.map(super::Contact::torque_on_joint).sum()
    }
}
