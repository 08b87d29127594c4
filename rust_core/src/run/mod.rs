//! Runs: a scenario is checked and built, simulated step by step or to its end, alone or with many others.

mod batch;
mod budget;
mod checked;
mod contact_table;
mod metrics;
mod needs;
mod poses;
mod record;
mod simulate;
mod simulation;
mod trace;

pub use batch::{Progress, simulate_many};
pub use checked::Checked;
pub use contact_table::ContactTable;
pub use metrics::Metrics;
pub use poses::{Poses, poses};
pub use record::Record;
pub use simulate::{Run, branch, counterfactual, simulate};
pub use simulation::Simulation;
pub use trace::Trace;
