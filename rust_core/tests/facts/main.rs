//! Facts of mechanics that every model must keep, each with its closed form.

// Each test prints the figures that it found beside the bounds; `--nocapture` shows them.
#![allow(clippy::print_stdout)]
// A helper that fails fails its test; samples of one instant have exactly one time.
#![allow(clippy::unwrap_used, clippy::float_cmp)]
// Nor need what facts compare with be the same to the last digit on each system.
#![allow(clippy::disallowed_methods)]

mod common;
mod judge;

mod accuracy;
mod another_engine;
mod basics;
mod belt;
mod candidates;
mod certificates;
mod climbing;
mod detracking;
mod discs;
mod drawn;
mod drive;
mod energy;
mod extremes;
mod flank;
mod flippers;
mod gears;
mod ghosts;
mod grouser_belt;
mod impacts;
mod jams;
mod judged;
mod lanes;
mod locking;
mod motors;
mod rapier;
mod rapier_oracles;
mod repeat;
mod representation;
mod robustness;
mod rotor;
mod segmental;
mod seizure;
mod sinkage;
mod slopes;
mod snapshots;
mod stops;
mod worlds;
