//! Observation of a run, which never changes the motion.

mod contact_means;
mod events;
mod monitor;
mod observations;
mod reading;

pub(crate) use contact_means::{Bearing, DriveMean, Loads, Signals, Stance};
pub(crate) use events::IntrusionWatch;
pub use events::{Event, EventKind, Outcome};
pub(crate) use monitor::Monitor;
pub(crate) use observations::Observations;
pub use reading::Reading;
pub(crate) use reading::Shaking;
