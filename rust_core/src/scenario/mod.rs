//! What is simulated: plain data with one set of rules, read from JSON and written back without losing a bit.

mod fields;
mod robot;
mod settings;
mod terrain;
mod track;

use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};

pub use robot::{Drivetrain, Robot, TorqueSharing, TrackOutline};
pub use settings::{ContactMethod, Drive, SeizureCriteria, Solver, Start};
pub use terrain::{MAX_POINTS, Terrain};
pub use track::{BeltTrack, ForceSupport, ForceTrack, LineOfWheels, Track, Wheel};

use crate::error::ScenarioError;
use crate::terrain::Ground;
use fields::{Fields, Range};

/// The only version of the format so far.
pub const SCHEMA: u32 = 1;

/// One run, complete: the same scenario and build give the same bits.
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
    /// [m] The x that must be left behind; none takes the terrain's.
    pub goal: Option<f64>,
    /// [m/s^2] Gravity, downwards.
    pub gravity: f64,
    /// [s] Longest simulated time.
    pub duration: f64,
    /// How the equations are solved.
    pub solver: Solver,
    /// When a stop counts as one.
    pub criteria: SeizureCriteria,
}

impl Scenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field.
    pub fn from_json(text: &str) -> Result<Self, ScenarioError> {
        let value: Value = serde_json::from_str(text)
            .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
        Self::read(&value)
    }

    /// The one canonical text of this scenario: fixed order of fields, shortest exact numbers.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|e| unreachable!("plain data serialises: {e}"))
    }

    /// The identity of a run: SHA-256 of the canonical JSON, in hexadecimal.
    pub fn identity(&self) -> String {
        let digest = Sha256::digest(self.to_json().as_bytes());
        digest
            .iter()
            .fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
    }

    /// Checks a scenario that was put together in Rust by the same rules as one read from JSON.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let value = serde_json::to_value(self)
            .unwrap_or_else(|e| unreachable!("plain data serialises: {e}"));
        Self::read(&value).map(|_| ())
    }

    /// [m] The x that the rear axle must leave behind.
    pub fn goal(&self, ground: &Ground) -> f64 {
        self.goal.unwrap_or(ground.goal)
    }

    /// Number of steps of the whole run; a remainder counts as one more step.
    pub fn step_count(&self) -> u64 {
        // The tolerance takes 15 s / 1 ms as 15,000 steps although neither number is exact.
        (self.duration / self.solver.time_step - 1e-9)
            .ceil()
            .max(0.0) as u64
    }

    fn read(value: &Value) -> Result<Self, ScenarioError> {
        let mut f = Fields::new("", value)?;
        let schema = f.integer("schema", SCHEMA, SCHEMA)?;
        let scenario = Self {
            schema,
            robot: Robot::read(f.child("robot")?)?,
            terrain: Terrain::read(f.child("terrain")?)?,
            drive: Drive::read(f.child("drive")?)?,
            start: Start::read(f.child("start")?)?,
            goal: f.optional_number("goal", Range::between(-1e7, 1e7, "m"))?,
            gravity: f.number("gravity", Range::between(0.0, 1e3, "m/s^2"))?,
            duration: f.number("duration", Range::between(0.0, 1e5, "s"))?,
            solver: Solver::read(f.child("solver")?)?,
            criteria: SeizureCriteria::read(f.child("criteria")?)?,
        };
        f.finish()?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Rules that join several branches of the tree.
    fn check(&self) -> Result<(), ScenarioError> {
        let limit = self.robot.drivetrain.max_speed;
        if self.drive.speed.abs() > limit {
            let rule = format!("must not exceed robot.drivetrain.max_speed = {limit} m/s");
            return Err(ScenarioError::new("drive.speed", self.drive.speed, rule));
        }
        // A surface that turns further than this between two collision checks rolls over corners unseen.
        let turn = limit * self.solver.time_step / crate::outline::smallest_radius(&self.robot);
        if turn > 0.7 {
            let rule = format!(
                "must keep max_speed x time_step / radius <= 0.7 rad a step, here {turn:.3}"
            );
            return Err(ScenarioError::new(
                "solver.time_step",
                self.solver.time_step,
                rule,
            ));
        }
        let ground = Ground::new(&self.terrain)?;
        crate::robot::start_pose(self, &ground)?;
        Ok(())
    }
}
