//! The forces of one drive, as dampers of the solver.
//!
//! The equations: docs/physics.md, "Motors".

use crate::robot::Line;
use crate::solver::Damper;

/// Forces of one drive in a step, against the speed of its surface.
#[derive(Clone, Copy, Default)]
pub(super) struct Forces {
    pub limits: [Damper; 2],
    /// [m/s] Error of the speed at the beginning.
    pub error: f64,
}

impl From<Line> for Damper {
    fn from(line: Line) -> Self {
        Self::new(line.at_rest, line.slope)
    }
}
