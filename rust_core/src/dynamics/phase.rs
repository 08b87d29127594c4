//! What a solve starts from.

use crate::geometry::Vector;
use crate::robot::Model;

/// What a solve starts from: the velocities as they would be without contacts and motors.
#[derive(Default)]
pub(super) struct Phase {
    /// [m/s] Of the centre of mass, with the weight's push.
    pub velocity: Vector,
    /// [rad/s] Of the chassis.
    pub angular_velocity: f64,
    /// [rad/s] Of the drives.
    pub spins: Vec<f64>,
    /// [m/s] For the surfaces.
    pub set_point: f64,
    /// [s] Time in which motors can push.
    pub elapsed: f64,
    /// [m/s] Velocity over the ground of the frame that velocities are measured in.
    pub frame: Vector,
}

impl Phase {
    /// [N s] What a motor at that share of its limit has given so far, ...
    pub(super) fn motor_impulse(&self, share: f64, model: &Model) -> f64 {
        share * model.drive_force * self.elapsed
    }

    /// [N m s] ... and what that has turned its drive back with.
    pub(super) fn motor_turn(&self, share: f64, model: &Model) -> f64 {
        self.motor_impulse(share, model) * model.drive_radius
    }
}
