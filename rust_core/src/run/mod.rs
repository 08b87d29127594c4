//! Runs: scenarios are checked and built, then simulated step by step or to the end, alone or in batches.

mod batch;
mod metrics;
mod poses;
mod record;
mod simulate;
mod simulation;
mod step_length;
#[cfg(test)]
mod tests;
mod trials;
mod valid_scenario;

pub use batch::{Finished, Progress, simulate_many};
pub use metrics::{Metric, Metrics};
pub use poses::{Poses, poses};
pub use record::{ContactTable, Record, Trace};
pub use simulate::{
    Run, TipOver, balance, branch, diagnose, escape_force, make_trials, outcome_of, run_of_trial,
    simulate, tip_over, what_if,
};
pub use simulation::Simulation;
pub use trials::EscapeForce;
pub use valid_scenario::ValidScenario;
