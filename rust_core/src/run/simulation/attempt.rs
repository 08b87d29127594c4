//! An attempted step, and the last step that was kept.

use serde::{Deserialize, Serialize};

use crate::contact::{Contact, Dents};
use crate::dynamics::{State, Trend};
use crate::robot::Running;

/// An attempted step; it does not change the simulation until it is kept.
#[derive(Default)]
pub(super) struct Attempt {
    /// The state at its end.
    pub state: State,
    /// [s] Its length.
    pub length: f64,
    /// Whether something strikes the ground in it.
    pub strikes: bool,
    /// [m/s] Set-point of the drivetrain at its end.
    pub set_point: f64,
    /// Positions of the moving parts in its middle, where contacts are searched for.
    pub running: Running,
    pub contacts: Vec<Contact>,
    /// [m] Lower bound of the gaps of contacts left out, at the velocities before the step.
    pub room: f64,
    pub dents: Dents,
    /// [m] Range of that search beyond the pose at its end.
    pub sight: f64,
}

/// The last step that was kept.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct LastStep {
    /// The state at its beginning.
    pub before: State,
    /// [s] When it began.
    pub began: f64,
    /// [s] Its length.
    pub length: f64,
    /// [s] Its length if nothing struck the ground in it, else 0: velocities do not continue like in an impact.
    pub free: f64,
    /// [m/s] Set-point of the drivetrain at its beginning.
    pub set_point: f64,
    /// [m] Range of the search for contacts beyond the pose at its end.
    pub sight: f64,
}

impl LastStep {
    /// No step: the simulation begins with a state at time 0.
    pub(super) fn none(state: &State) -> Self {
        Self {
            before: state.clone(),
            began: 0.0,
            length: 0.0,
            free: 0.0,
            set_point: 0.0,
            sight: 0.0,
        }
    }

    /// Changes of velocities in it.
    pub(super) fn trend(&self) -> Option<Trend<'_>> {
        Trend::since(&self.before, self.free)
    }
}

/// Buffers of the observation of a step.
#[derive(Default)]
pub(super) struct Scratch {
    /// A state within a step.
    pub state: State,
    pub running: Running,
    pub drive_speeds: Vec<f64>,
}
