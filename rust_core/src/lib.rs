//! A simulator of tracked robots in the sagittal plane.
//!
//! The same robot can have any track model and drives over ground with edges; the run says whether it got
//! over and at what cost. A [`Scenario`] goes in, a [`Run`] comes out:
//!
//! ```no_run
//! use crawler2d_core::{ValidScenario, Record, simulate};
//!
//! let text = std::fs::read_to_string("scenario.json").unwrap();
//! let scenario = ValidScenario::from_json(&text).unwrap();
//! let run = simulate(&scenario, Record::default()).unwrap();
//! println!("{} after {} s", run.outcome, run.metrics.time);
//! ```
//!
//! Frame: x forward, y up, angles counter-clockwise, SI units. A speed above 0 drives towards +x.

// What tests compare with may differ in its last digit.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod contact;
mod diagnosis;
#[cfg(any(test, fuzzing))]
mod draw;
mod dynamics;
mod engine;
mod error;
#[cfg(any(test, fuzzing))]
pub mod fuzz;
mod geometry;
mod jams;
mod limits;
mod names;
mod observe;
mod robot;
mod run;
mod scenario;
mod solver;
mod terrain;
mod units;
mod version;

pub use contact::Intrusion;
pub use diagnosis::{
    Balance, Change, Diagnosis, LoadedIntrusion, Mechanism, Pull, StopContact, Trial, Wanted,
};
pub use dynamics::{ChainReading, FlipperCommand};
pub use engine::OWN_SETTINGS;
pub use error::{Error, LimitError, MEMORY_VARIABLE, SimulationError, caught};
pub use geometry::{Disc, Gear, Grouser, ShoeLoop, Teeth, Vector};
pub use jams::{
    Certificate, ExcludedCell, Exclusion, Jam, JamContact, JamRange, Region, RegionStatus,
    SearchEffort,
};
pub use limits::{Cancel, check_rounding};
pub use observe::{Event, EventKind, Outcome, Reading};
pub use robot::{
    Body, BodyKind, ChainOfShoes, ChassisBody, Circuit, Flipper, Model, MotorRule, Mount, Part,
    Shape, Sprocket, Tensioner, WheelBody,
};
pub use run::{
    ByHand, ContactTable, EscapeForce, Finished, FoundJam, JamRanges, Log, Metric, Metrics, Poses,
    Progress, Record, Run, Simulation, TipOver, Trace, ValidScenario, WorldState, Worlds, balance,
    branch, certify, diagnose, escape_force, find_jams, jam_ranges, make_trials, outcome_of, poses,
    run_of_trial, simulate, simulate_many, tip_over, what_if,
};
pub use scenario::{
    BeltTrack, ChainMechanism, CircumferentialWheels, Climb, ClosedSurface, ClosedTrack,
    ContactMethod, Drive, Drivetrain, End, Ends, Engine, FieldPattern, Flippers, ForceSupport,
    ForceTrack, Friction, Gait, GearWheel, GrouserBeltTrack, Hold, HybridWheels, LineOfWheels,
    MAX_POINTS, Pi, Robot, SCHEMA, Scenario, ScenarioError, SegmentalTrack, SeizureCriteria,
    ShoeShape, Solver, Start, Stepfield, Surface, Terrain, TorqueSharing, Track, TrackOutline,
    Warning, Wheel,
};
pub use terrain::{Edge, Ground, GroundFriction, Profile, Side};
pub use version::{BUILD_ID, ENGINE};
