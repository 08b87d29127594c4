//! How velocities changed in the last step: the next one expects them to go on.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::state::State;
use crate::solver::Layout;

/// The last step, for how fast velocities change.
#[derive(Clone, Copy)]
pub(crate) struct Trend<'a> {
    /// The state at its beginning.
    before: &'a State,
    /// [s] Its length, above 0.
    time: f64,
}

impl<'a> Trend<'a> {
    /// That of a last step of a `time` [s] from a state; none if that is 0.
    pub(crate) fn since(before: &'a State, time: f64) -> Option<Self> {
        (time > 0.0).then_some(Self { before, time })
    }

    /// Writes the velocities at its beginning down as the unknowns of a solve.
    pub(super) fn write_velocities(&self, layout: Layout, into: &mut [f64]) {
        self.before.write_velocities(layout, into);
    }

    /// How fast a velocity has come to what it is `now` from what it was `before`.
    pub(super) fn gain(&self, now: f64, before: f64) -> f64 {
        (now - before) / self.time
    }

    /// [rad/s] How much faster the chassis turns after a time [s] than in a state at the step's end, if that goes on.
    pub(super) fn turn_gained(&self, state: &State, time: f64) -> f64 {
        self.gain(state.angular_velocity, self.before.angular_velocity) * time
    }
}
