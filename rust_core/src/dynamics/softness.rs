//! How contacts give way: as a damped spring that a step integrates implicitly.

/// Coefficients of a damped spring integrated implicitly.
#[derive(Clone, Copy)]
pub(super) struct Softness {
    /// [1/s] Share of a penetration that is pushed out in a second.
    pub push_rate: f64,
    /// Compliance in units of the contact's own admittance.
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
