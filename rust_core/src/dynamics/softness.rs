//! Softness of contacts: that of a damped spring, integrated implicitly.
//!
//! The equations: docs/physics.md, "Softness".

/// Coefficients of a damped spring integrated implicitly.
#[derive(Clone, Copy)]
pub(super) struct Softness {
    /// [1/s] Rate at which a penetration is pushed out.
    pub push_rate: f64,
    /// Compliance in units of the admittance of the mass on the spring.
    pub compliance: f64,
}

impl Softness {
    pub(super) fn new(frequency: f64, damping_ratio: f64, h: f64) -> Self {
        let omega = std::f64::consts::TAU * frequency;
        let a1 = 2.0 * damping_ratio + h * omega;
        Self {
            push_rate: omega / a1,
            compliance: 1.0 / (h * omega * a1),
        }
    }
}
