//! Shaking of the chassis, as an inertial sensor with the bandwidth of the checks would measure it.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::Reading;

/// Sums over the checks of a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Shaking {
    last: Option<(f64, f64)>,
    time: f64,
    acceleration: f64,
    rate: f64,
}

impl Shaking {
    /// Takes one check.
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
