//! The forces of one drive, as dampers of the solver.
//!
//! The equations: docs/physics.md, "Motors".

use crate::robot::Line;
use crate::solver::Damper;

/// Forces of one drive in a step, as functions of the speed of its surface.
#[derive(Clone, Copy, Default)]
pub(super) struct Forces {
    pub limits: [Damper; 2],
    /// [m/s] The ranges of speed in which these are its limits.
    pub ends: [[f64; 2]; 2],
    /// [m/s] The speed at the beginning of the step, and how far it is below the set-point.
    pub speed: f64,
    pub error: f64,
}

impl From<Line> for Damper {
    fn from(line: Line) -> Self {
        Self::new(line.at_rest, line.slope)
    }
}
