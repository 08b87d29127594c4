//! The set-point of the drives in a step.
//!
//! The equations: docs/physics.md, "Motors".

/// [m/s] Set-points of the surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SetPoint {
    /// In the middle of the step, where its motion is solved for.
    pub middle: f64,
    /// At the end of the step.
    pub end: f64,
}

impl SetPoint {
    /// At the beginning of the step.
    pub(super) fn start(self) -> f64 {
        2.0 * self.middle - self.end
    }

    /// A constant set point.
    #[cfg(test)]
    pub(super) fn constant(speed: f64) -> Self {
        Self {
            middle: speed,
            end: speed,
        }
    }
}
