//! The starting point of a solve.
//!
//! The equations: docs/physics.md, "A step".

use crate::geometry::Vector;
use crate::robot::Model;

/// The starting point of a solve: the velocities without contacts and motors.
#[derive(Default)]
pub(super) struct Phase {
    /// [m/s] Velocity of the centre of mass, with the impulse of the weight.
    pub velocity: Vector,
    /// [rad/s] Angular velocity of the chassis.
    pub angular_velocity: f64,
    /// [rad/s] Spins of the drives.
    pub spins: Vec<f64>,
    /// [m/s] Set-point of the surfaces.
    pub set_point: f64,
    /// [s] Time for which motors push.
    pub elapsed: f64,
}

impl Phase {
    /// [N s] Impulse of a motor at a share of its limit.
    pub(super) fn motor_impulse(&self, share: f64, model: &Model) -> f64 {
        share * model.drive_force * self.elapsed
    }

    /// [N m s] Angular impulse of that on its drive, against the spin.
    pub(super) fn motor_turn(&self, share: f64, model: &Model) -> f64 {
        self.motor_impulse(share, model) * model.drive_radius
    }
}
