//! The state at an instant as users see it, and the vibration of the chassis as an inertial sensor would measure it.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::geometry::{Vector, direction};

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
        self.velocity.dot(direction(self.chassis_angle))
    }
}

#[cfg(test)]
impl Reading {
    /// The state of a robot at rest.
    pub(super) fn at_rest(time: f64, position: Vector) -> Self {
        Self {
            time,
            position,
            velocity: Vector::ZERO,
            chassis_angle: 0.0,
            angular_velocity: 0.0,
            commanded_speed: 0.0,
            track_speed: 0.0,
            track_position: 0.0,
        }
    }
}

/// Sums over all checks of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Shaking {
    last: Option<(f64, f64)>,
    time: f64,
    acceleration: f64,
    rate: f64,
}

impl Shaking {
    /// Adds one check.
    pub(crate) fn look(&mut self, now: &Reading) {
        if let Some((time, speed)) = self.last {
            let dt = now.time - time;
            let acceleration = (now.velocity.y - speed) / dt;
            self.time += dt;
            self.acceleration += acceleration * acceleration * dt;
            self.rate += now.angular_velocity * now.angular_velocity * dt;
        }
        self.last = Some((now.time, now.velocity.y));
    }

    /// [m/s^2] Root mean square of the vertical acceleration of the chassis frame.
    pub(crate) fn vertical_acceleration(&self) -> f64 {
        self.mean_root(self.acceleration)
    }

    /// [rad/s] Root mean square of the rate of the chassis angle.
    pub(crate) fn angular_velocity(&self) -> f64 {
        self.mean_root(self.rate)
    }

    fn mean_root(&self, sum: f64) -> f64 {
        if self.time > 0.0 {
            (sum / self.time).sqrt()
        } else {
            0.0
        }
    }
}
