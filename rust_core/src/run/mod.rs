//! Runs: a scenario is checked and built, simulated step by step or to its end, alone or with many others.

mod batch;
mod check;
mod metrics;
mod needs;
mod poses;
mod simulate;
mod simulation;
mod trace;

pub use batch::{Progress, caught, simulate_many};
pub use check::check_text;
pub use metrics::Metrics;
pub use poses::{Poses, poses};
pub use simulate::{Run, branch, counterfactual, simulate};
pub use simulation::Simulation;
pub use trace::{ContactTable, Record, Trace};
