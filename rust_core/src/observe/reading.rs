//! The state of an instant as a user reads it.

use crate::geometry::Vector;

/// The state as a user reads it.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// [s] Simulated time.
    pub time: f64,
    /// [m] Origin of the chassis frame.
    pub position: Vector,
    /// [m/s] Velocity of that point.
    pub velocity: Vector,
    /// [rad] Nose up > 0.
    pub chassis_angle: f64,
    /// [rad/s] Its rate.
    pub angular_velocity: f64,
    /// [m/s] Set-point of the drivetrain.
    pub commanded_speed: f64,
    /// [m/s] Surface speed, the mean of the drives.
    pub track_speed: f64,
    /// [m] How far the surface has run, the mean of the drives.
    pub track_position: f64,
}

impl Reading {
    /// [m/s] Speed along the chassis.
    pub(crate) fn forward_speed(&self) -> f64 {
        let (sine, cosine) = libm::sincos(self.chassis_angle);
        self.velocity.x * cosine + self.velocity.y * sine
    }
}
