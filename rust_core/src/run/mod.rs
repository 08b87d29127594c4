//! Runs: scenarios are checked and built, then simulated step by step or to the end, alone or in batches.

mod batch;
mod clock;
mod escape_force;
mod jams;
mod metrics;
mod poses;
mod record;
mod recording;
mod replay;
mod simulate;
mod simulation;
mod step_length;
#[cfg(test)]
mod tests;
mod trials;
mod valid_scenario;
mod worlds;

pub use batch::{Finished, Progress, simulate_many};
pub use escape_force::{EscapeForce, escape_force};
pub use jams::{FoundJam, JamRanges, certify, find_jams, jam_ranges};
pub use metrics::{Metric, Metrics};
pub use poses::{Poses, poses};
pub use record::{ContactTable, Record, Trace};
pub use recording::Run;
pub use replay::Log;
pub use simulate::{TipOver, balance, branch, run_of_trial, simulate, tip_over};
pub use simulation::{ByHand, Simulation};
pub use trials::{diagnose, make_trials, outcome_of, what_if};
pub use valid_scenario::ValidScenario;
pub use worlds::{WorldState, Worlds};
