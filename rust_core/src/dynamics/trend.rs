//! How velocities changed in the last step: they are expected to go on changing like that.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::state::State;
use crate::solver::Layout;

/// The last step, from which rates of change are taken.
#[derive(Clone, Copy)]
pub(crate) struct Trend<'a> {
    /// The state at its beginning.
    before: &'a State,
    /// [s] Its length, above 0.
    time: f64,
}

impl<'a> Trend<'a> {
    /// The trend of a last step of `time` [s] that began at a state; none if the time is 0.
    pub(crate) fn since(before: &'a State, time: f64) -> Option<Self> {
        (time > 0.0).then_some(Self { before, time })
    }

    /// Writes the velocities at its beginning as the unknowns of a solve.
    pub(super) fn write_velocities(&self, layout: Layout, into: &mut [f64]) {
        self.before.write_velocities(layout, into);
    }

    /// The rate of change of a quantity that was `before` at its beginning and is `now` at its end.
    pub(super) fn gain(&self, now: f64, before: f64) -> f64 {
        (now - before) / self.time
    }

    /// [rad/s] How much faster than in a state at the step's end the chassis will turn after a time [s].
    pub(super) fn turn_gained(&self, state: &State, time: f64) -> f64 {
        self.gain(state.angular_velocity, self.before.angular_velocity) * time
    }
}
