//! What is simulated: plain data with one set of rules, read from JSON and written back exactly.

mod doubts;
mod drive;
mod drivetrain;
mod error;
mod fields;
mod flippers;
mod outline;
mod robot;
mod settings;
mod terrain;
mod text;
mod track;
mod wheel;

use fields::{Fields, GRAVITY, Range};
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

pub use doubts::Doubt;
pub use drive::{Climb, Drive, Gait, Hold};
pub use drivetrain::{Drivetrain, Pi, TorqueSharing};
pub use error::ScenarioError;
pub use flippers::{End, Ends, Flippers};
pub use outline::TrackOutline;
pub use robot::Robot;
pub use settings::{ContactMethod, Engine, SeizureCriteria, Solver, Start};
pub use terrain::{FieldPattern, MAX_POINTS, Stepfield, Surface, Terrain};
pub(crate) use text::parse;
pub use track::{
    BeltTrack, ChainMechanism, CircumferentialWheels, ClosedSurface, ClosedTrack, ForceSupport,
    ForceTrack, GrouserBeltTrack, HybridWheels, LineOfWheels, SegmentalTrack, ShoeShape, Track,
};
pub(crate) use track::{MAX_SHOES, MAX_WHEELS};
pub(crate) use wheel::MAX_GROUSERS;
pub use wheel::{GearWheel, Wheel};

/// Version of the format.
pub const SCHEMA: u32 = 2;
/// What a file of version 1 lacks.
const OF_VERSION_1: &str = "must be 2; in a file of version 1, solver.accuracy takes the place of solver.substeps, and \
                            is null where solver.time_step is kept";

/// Everything that defines a run: the same scenario and build give the same bits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scenario {
    /// Version of the format.
    pub schema: u32,
    /// The robot.
    pub robot: Robot,
    /// The ground.
    pub terrain: Terrain,
    /// The command.
    pub drive: Drive,
    /// How the robot stands at time 0.
    pub start: Start,
    /// [m] The x that the whole robot must pass; `None` takes the terrain's.
    pub goal: Option<f64>,
    /// [m/s^2] Acceleration of gravity, downwards.
    pub gravity: f64,
    /// [s] Longest simulated time.
    pub duration: f64,
    /// How the equations are solved.
    pub solver: Solver,
    /// When a run ends, and what counts as a stop.
    pub criteria: SeizureCriteria,
}

impl Scenario {
    /// The canonical JSON of this scenario: fields in a fixed order, shortest exact numbers.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|e| unreachable!("plain data serialises: {e}"))
    }

    /// The identity of a scenario: SHA-256 of the canonical JSON, in hexadecimal.
    pub fn identity(&self) -> String {
        let digest = Sha256::digest(self.to_json().as_bytes());
        digest
            .iter()
            .fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
    }

    /// Reads the fields; rules that need the built robot and ground are checked elsewhere.
    pub(crate) fn read(value: &Value) -> Result<Self, ScenarioError> {
        let mut f = Fields::new("", value)?;
        if value.get("schema").is_some_and(|version| version == 1) {
            return Err(ScenarioError::new("schema", 1, OF_VERSION_1));
        }
        let schema = f.integer("schema", SCHEMA, SCHEMA)?;
        let scenario = Self {
            schema,
            robot: Robot::read(f.child("robot")?)?,
            terrain: Terrain::read(f.child("terrain")?)?,
            drive: Drive::read(f.child("drive")?)?,
            start: Start::read(f.child("start")?)?,
            goal: f.optional_number("goal", Range::between(-1e7, 1e7, "m"))?,
            gravity: f.number("gravity", GRAVITY)?,
            duration: f.number("duration", Range::between(0.0, 1e5, "s"))?,
            solver: Solver::read(f.child("solver")?)?,
            criteria: SeizureCriteria::read(f.child("criteria")?)?,
        };
        f.finish()?;
        Ok(scenario)
    }
}
