//! Observation of a run, which never changes the motion.

mod contact_means;
mod events;
mod monitor;
mod reading;
mod seen;

pub(crate) use contact_means::{Bearing, DriveMean, Loads, Signals, Stance};
pub(crate) use events::IntrusionWatch;
pub use events::{Event, EventKind, Outcome};
pub(crate) use monitor::Monitor;
pub use reading::Reading;
pub(crate) use reading::Shaking;
pub(crate) use seen::Seen;
