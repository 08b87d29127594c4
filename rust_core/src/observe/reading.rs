//! The state at an instant as users see it.

use crate::geometry::Vector;

/// The state as users see it.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// [s] Simulated time.
    pub time: f64,
    /// [m] Position of the origin of the chassis frame.
    pub position: Vector,
    /// [m/s] Velocity of the origin of the chassis frame.
    pub velocity: Vector,
    /// [rad] Chassis angle, nose up > 0.
    pub chassis_angle: f64,
    /// [rad/s] Rate of the chassis angle.
    pub angular_velocity: f64,
    /// [m/s] Set-point of the drivetrain.
    pub commanded_speed: f64,
    /// [m/s] Surface speed, mean of the drives.
    pub track_speed: f64,
    /// [m] Travel of the surface, mean of the drives.
    pub track_position: f64,
}

impl Reading {
    /// [m/s] Speed along the chassis.
    pub(crate) fn forward_speed(&self) -> f64 {
        let (sine, cosine) = libm::sincos(self.chassis_angle);
        self.velocity.x * cosine + self.velocity.y * sine
    }
}
