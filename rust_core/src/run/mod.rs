//! Runs: scenarios are checked and built, then simulated step by step or to the end, alone or in batches.

mod batch;
mod budget;
mod checked;
mod contact_table;
mod metrics;
mod needs;
mod poses;
mod record;
#[cfg(test)]
mod scale;
mod simulate;
mod simulation;
mod sinkage;
mod step_length;
mod tip;
mod trace;
mod trials;

pub use batch::{Finished, Progress, simulate_many};
pub use checked::Checked;
pub use contact_table::ContactTable;
pub use metrics::{Metric, Metrics};
pub use poses::{Poses, poses};
pub use record::Record;
pub use simulate::{
    Run, balance, branch, diagnose, escape_force, make_trials, outcome_of, run_of_trial, simulate,
    what_if,
};
pub use simulation::Simulation;
pub use tip::{TipOver, tip_over};
pub use trace::Trace;
pub use trials::EscapeForce;
