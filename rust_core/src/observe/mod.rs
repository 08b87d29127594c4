//! Observation of a run, which never changes the motion.

mod bearing;
mod contacts;
mod events;
mod monitor;
mod outcome;
mod progress;
mod reading;
mod seen;
mod shaking;
mod signals;

pub(crate) use contacts::Loads;
pub(crate) use events::IntrusionWatch;
pub use events::{Event, EventKind};
pub(crate) use monitor::Monitor;
pub use outcome::Outcome;
pub use reading::Reading;
pub(crate) use seen::Seen;
pub(crate) use shaking::Shaking;
pub(crate) use signals::{Bearing, DriveMean, Signals, Stance};
