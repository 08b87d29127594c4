//! A simulator of tracked robots in the sagittal plane.
//!
//! The same robot takes every track model, meets edged ground, and the run says whether it got
//! over and at what cost. A [`Scenario`] goes in, a [`Run`] comes out:
//!
//! ```no_run
//! use crawler2d_core::{Record, Scenario, simulate};
//!
//! let text = std::fs::read_to_string("scenario.json").unwrap();
//! let scenario = Scenario::from_json(&text).unwrap();
//! let run = simulate(&scenario, Record::default()).unwrap();
//! println!("{} after {} s", run.outcome, run.metrics.time);
//! ```
//!
//! Frame: x forward, y up, angles counter-clockwise, SI units. A speed above 0 drives towards +x.

mod batch;
mod bodies;
mod bounds;
mod cancel;
mod chain;
mod check;
mod closed;
mod contact;
mod diagnosis;
#[cfg(test)]
mod draw;
mod drive;
mod dynamics;
mod error;
mod events;
mod flipper;
mod gait;
mod memory;
mod monitor;
mod needs;
mod outcome;
mod outline;
mod part;
mod plane;
mod reading;
mod robot;
mod rounding;
mod run;
mod scenario;
mod shaking;
mod sides;
mod simulation;
mod start;
mod terrain;
mod trace;
mod track;

pub use batch::{Progress, caught, simulate_many};
pub use bodies::{ChassisBody, WheelBody};
pub use cancel::Cancel;
pub use chain::{ChainOfShoes, Sprocket, Tensioner};
pub use check::check_text;
pub use contact::Intrusion;
pub use diagnosis::{Condition, Diagnosis, LoadedIntrusion, Mechanism, StopContact};
pub use dynamics::ChainReading;
pub use error::{Error, LimitError, ScenarioError, SimulationError};
pub use events::{Event, EventKind};
pub use flipper::Flipper;
pub use memory::MEMORY_VARIABLE;
pub use outcome::Outcome;
pub use outline::{Disc, Gear, Grouser, ShoeLoop, Teeth};
pub use reading::Reading;
pub use robot::{BodyKind, Model, Mount, Part, Shape};
pub use rounding::check_rounding;
pub use run::{Metrics, Run, branch, counterfactual, simulate};
pub use scenario::{
    BeltTrack, ChainMechanism, CircumferentialWheels, Climb, ContactMethod, Doubt, Drive,
    Drivetrain, End, Ends, FieldPattern, Flippers, ForceSupport, ForceTrack, Gait, GearWheel,
    GrouserBeltTrack, Hold, HybridWheels, LineOfWheels, MAX_POINTS, Robot, SCHEMA, Scenario,
    SegmentalTrack, SeizureCriteria, ShoeShape, Solver, Start, Stepfield, Terrain, TorqueSharing,
    Track, TrackOutline, Wheel,
};
pub use simulation::{Counterfactual, Simulation};
pub use terrain::{Edge, Ground, Profile, Side};
pub use trace::{ContactTable, Record, Trace};

/// The engine that finds the contacts, with its exact version.
pub const ENGINE: &str = "rapier2d-f64 0.36.1";

/// Names the sources that this core was built from.
pub const BUILD_ID: &str = env!("CRAWLER2D_BUILD_ID");

/// A point or a direction in the plane.
pub use rapier2d_f64::math::Vector;
