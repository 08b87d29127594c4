//! What can go wrong besides a broken rule of a scenario: a run that diverges, a request for too much memory.

use std::panic::{AssertUnwindSafe, catch_unwind};

use thiserror::Error;

use crate::scenario::ScenarioError;

/// The environment variable that sets the limit of memory, in GiB.
pub const MEMORY_VARIABLE: &str = "CRAWLER2D_MEMORY";

/// The state of a run became non-finite, or faster than light; everything after `step` would be meaningless.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the state of {body} became non-finite, or faster than light, in step {step}")]
pub struct SimulationError {
    /// The step, counted from 1.
    pub step: u64,
    /// Which body.
    pub body: String,
}

/// A request needs more memory than it may have; nothing has been done.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LimitError {
    /// It needs more than is left of the limit, or than the system has.
    #[error(
        "{what} needs about {} MiB of memory, but only {} MiB are available: the limit is {} GiB (environment variable {MEMORY_VARIABLE}), or less if the system has less",
        mebibytes(*needed), available >> 20, gibibytes(*limit)
    )]
    Memory {
        /// What needs it and, if possible, what would need less.
        what: String,
        /// \[bytes\] Memory that it needs.
        needed: u64,
        /// \[bytes\] Memory available.
        available: u64,
        /// \[bytes\] Limit of memory.
        limit: u64,
    },
    /// The environment variable that sets the limit is invalid.
    #[error("environment variable {MEMORY_VARIABLE} must be a number of GiB > 0, got {0:?}")]
    Setting(String),
}

/// Why a run gave no result.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Error {
    /// See [`ScenarioError`].
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// See [`SimulationError`].
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// See [`LimitError`].
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// A fault of the program or of the process it runs in.
    #[error("{0}")]
    Internal(String),
    /// The caller asked to stop.
    #[error("the run was interrupted")]
    Interrupted,
}

/// Turns a panic, which is a fault of the program, into an error, so that it ends only its own run.
///
/// # Errors
/// Those of the call, and [`Error::Internal`] with the text of a panic.
pub fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        let text = text.unwrap_or("unknown panic");
        Err(Error::Internal(format!(
            "the core failed: {text}; please report this with the scenario"
        )))
    })
}

fn mebibytes(bytes: u64) -> u64 {
    bytes.div_ceil(1 << 20)
}

fn gibibytes(bytes: u64) -> f64 {
    bytes as f64 / (1_u64 << 30) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_text() {
        let failed: Result<(), Error> = caught(|| panic!("wheel {} came off", 3));
        let Err(Error::Internal(message)) = failed else {
            panic!("{failed:?}")
        };
        assert!(message.contains("wheel 3 came off"), "{message}");
        assert!(caught(|| Ok(1)).is_ok_and(|one| one == 1));
    }
}
