//! How velocities changed in the last step: the next one expects them to go on.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::state::State;

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

    /// Rate at which a velocity has come to what it is `now` from what it is `of` the state before.
    pub(super) fn rate(&self, now: f64, of: impl Fn(&State) -> f64) -> f64 {
        (now - of(self.before)) / self.time
    }

    /// [rad/s] How much faster the chassis turns after a time [s] than in a state at the step's end, if that goes on.
    pub(super) fn turn_gained(&self, state: &State, time: f64) -> f64 {
        self.rate(state.angular_velocity, |before| before.angular_velocity) * time
    }
}
