//! Start, solver and criteria: the small parts of a scenario.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, Range, SHORTEST, is_zero};

/// How the robot stands at time 0: at rest, touching the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start {
    /// [m] From the robot's foremost point to the first edge at or beyond x = 0.
    pub approach: f64,
    /// [m] Initial advance of all wheels or of the belt.
    pub track_phase: f64,
    /// [rad] Chassis angle, nose up > 0.
    pub angle: f64,
}

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactMethod {
    /// Own exact geometry: outlines against the faces and corners of the lane.
    Own,
    /// The engine's geometric queries, on one oriented polyline per lane.
    Reference,
}

/// What moves the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// Our own dynamics.
    #[default]
    Own,
    /// rapier's bodies, joints, motors and contacts.
    Rapier,
}

impl Engine {
    /// Texts leave it out, as those have it that are older than the choice.
    #[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
    fn is_own(&self) -> bool {
        *self == Self::Own
    }
}

/// How the equations of motion are solved; docs/decisions says how the defaults were found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// What moves the robot.
    #[serde(skip_serializing_if = "Engine::is_own")]
    pub engine: Engine,
    /// How contacts are found.
    pub contact: ContactMethod,
    /// [m] Local error of a step; `None` if steps are of a given length.
    pub accuracy: Option<f64>,
    /// [s] Length of a step; `None` if its accuracy is given.
    pub time_step: Option<f64>,
    /// Largest number of rounds in the search for forces that satisfy all constraints of a step; each is a few
    /// guesses, and a lowering if none is right. `None` takes the solver's own.
    pub iterations: Option<u32>,
    /// [Hz] Natural frequency of the contact softness.
    pub contact_frequency: f64,
    /// Damping ratio of the contact softness.
    pub contact_damping_ratio: f64,
    /// [m/s] Largest speed at which a penetration is pushed out.
    pub max_push_speed: f64,
    /// [m] Gap up to which contacts are searched for.
    pub prediction_distance: f64,
    /// Share of the impulses of a blow that contacts give back.
    #[serde(skip_serializing_if = "is_zero")]
    pub restitution: f64,
}

/// When a run ends, and what counts as a stop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeizureCriteria {
    /// [s] Shortest time without progress that counts as a stop.
    pub stop_window: f64,
    /// Grouser pitches at the commanded speed that must pass without progress.
    pub stop_pitches: f64,
    /// Share of the commanded distance below which there is no progress.
    pub stop_progress: f64,
    /// [m] Largest change of pose that still counts as stationary.
    pub stationary_distance: f64,
    /// Stop windows for which a state must be stationary to end the run early.
    pub stationary_windows: u32,
    /// [s] How long the robot must stay beyond the goal.
    pub clear_time: f64,
    /// [rad] Largest angle between chassis and ground at which the goal counts.
    pub clear_angle: f64,
    /// [rad] Chassis angle at which the robot has tipped over.
    pub tip_over_angle: f64,
    /// [m] Depth inside the envelope of the track from which ground is an intrusion.
    pub intrusion_depth: f64,
    /// Share of the weight from which an intrusion counts as loaded.
    pub intrusion_load: f64,
    /// Share of the weight on the belly from which a stop without a seizure is a hang-up.
    pub belly_load: f64,
    /// Share of the commanded speed from which a surface slides, or a drive turns.
    pub sliding_speed: f64,
    /// Share of the torque limit from which a motor counts as at its limit.
    pub torque_limit: f64,
    /// [m] A robot that moves to and fro by this much during a stop window is cycling.
    pub cycling_distance: f64,
    /// Share of the weight that may stay unbalanced in the equilibrium of a stationary state.
    pub imbalance: f64,
    /// The same for the mean forces of a state that is not stationary.
    pub mean_imbalance: f64,
    /// Share of the commanded distance from which the robot counts as creeping.
    pub creep_from: f64,
    /// Share of the commanded distance up to which the robot counts as creeping.
    pub creep_to: f64,
    /// [m] Advance that counts as escaping from a stop.
    pub escape_distance: f64,
    /// [s] Time that a closed belt has to escape from a stop.
    pub escape_time: f64,
}

impl Start {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let start = Self {
            approach: f.number("approach", Range::between(0.0, 1e4, "m"))?,
            track_phase: f.number("track_phase", Range::between(-1e4, 1e4, "m"))?,
            angle: f.number("angle", Range::between(-1.5, 1.5, "rad"))?,
        };
        f.finish()?;
        Ok(start)
    }
}

impl Solver {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let engine = if f.has("engine") {
            f.choice(
                "engine",
                &[("own", Engine::Own), ("rapier", Engine::Rapier)],
            )?
        } else {
            Engine::Own
        };
        let solver = Self {
            engine,
            contact: f.choice(
                "contact",
                &[
                    ("own", ContactMethod::Own),
                    ("reference", ContactMethod::Reference),
                ],
            )?,
            accuracy: f.optional_number("accuracy", Range::between(1e-10, 1e-2, "m"))?,
            time_step: f.optional_number("time_step", Range::between(SHORTEST, 1.0 / 30.0, "s"))?,
            iterations: f.optional_integer("iterations", 1, 1000)?,
            contact_frequency: f.number("contact_frequency", Range::between(1.0, 1e5, "Hz"))?,
            contact_damping_ratio: f
                .number("contact_damping_ratio", Range::above(0.0, 100.0, ""))?,
            max_push_speed: f.number("max_push_speed", Range::above(0.0, 100.0, "m/s"))?,
            prediction_distance: f.number("prediction_distance", Range::between(1e-5, 0.1, "m"))?,
            restitution: f.number_or_zero("restitution", Range::between(0.0, 1.0, ""))?,
        };
        f.finish()?;
        match (solver.accuracy, solver.time_step) {
            (None, None) => {
                let rule = "must be given if time_step is not";
                Err(ScenarioError::new("solver.accuracy", "null", rule))
            }
            (Some(_), Some(step)) => {
                let rule = "must not be given together with accuracy, which decides the length of each step";
                Err(ScenarioError::new("solver.time_step", step, rule))
            }
            _ => Ok(solver),
        }
    }
}

impl SeizureCriteria {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let criteria = Self {
            stop_window: f.number("stop_window", Range::between(0.01, 1e4, "s"))?,
            stop_pitches: f.number("stop_pitches", Range::between(0.0, 1e3, ""))?,
            stop_progress: f.number("stop_progress", Range::above(0.0, 1.0, ""))?,
            stationary_distance: f.number("stationary_distance", Range::above(0.0, 1.0, "m"))?,
            stationary_windows: f.integer("stationary_windows", 1, 1000)?,
            clear_time: f.number("clear_time", Range::between(0.0, 1e4, "s"))?,
            clear_angle: f.number("clear_angle", Range::above(0.0, 3.15, "rad"))?,
            tip_over_angle: f.number("tip_over_angle", Range::above(0.0, 3.15, "rad"))?,
            intrusion_depth: f.number("intrusion_depth", Range::between(0.0, 0.1, "m"))?,
            intrusion_load: f.number("intrusion_load", Range::above(0.0, 1.0, ""))?,
            belly_load: f.number("belly_load", Range::above(0.0, 1.0, ""))?,
            sliding_speed: f.number("sliding_speed", Range::above(0.0, 1.0, ""))?,
            torque_limit: f.number("torque_limit", Range::above(0.0, 1.0, ""))?,
            cycling_distance: f.number("cycling_distance", Range::above(0.0, 10.0, "m"))?,
            imbalance: f.number("imbalance", Range::above(0.0, 1.0, ""))?,
            mean_imbalance: f.number("mean_imbalance", Range::above(0.0, 1.0, ""))?,
            creep_from: f.number("creep_from", Range::between(0.0, 1.0, ""))?,
            creep_to: f.number("creep_to", Range::between(0.0, 1.0, ""))?,
            escape_distance: f.number("escape_distance", Range::above(0.0, 10.0, "m"))?,
            escape_time: f.number("escape_time", Range::between(0.01, 60.0, "s"))?,
        };
        f.finish()?;
        Ok(criteria)
    }
}
