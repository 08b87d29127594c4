//! Start, solver and criteria: the small parts of a scenario.

use serde::Serialize;

use super::fields::{Checked, Fields, Range, SHORTEST, is_zero};
use super::objects::{Choice, FromJson, choice, object};

object! {
    /// How the robot stands at time 0: at rest, touching the ground.
    pub struct Start {
        /// [m] From the robot's foremost point to the first edge at or beyond x = 0.
        approach: f64 = number(Range::between(0.0, 1e4, "m")),
        /// [m] Initial advance of all wheels or of the belt.
        track_phase: f64 = number(Range::between(-1e4, 1e4, "m")),
        /// [rad] Chassis angle, nose up > 0.
        angle: f64 = number(Range::between(-1.5, 1.5, "rad")),
    }
}

choice! {
    /// How contacts are found.
    pub enum ContactMethod {
        /// Own exact geometry: outlines against the faces and corners of the lane.
        "own" Own,
        /// The engine's geometric queries, on one oriented polyline per lane.
        "reference" Reference,
    }
}

choice! {
    /// What moves the robot.
    #[derive(Default)]
    pub enum Engine {
        /// Our own dynamics.
        #[default]
        "own" Own,
        /// rapier's bodies, joints, motors and contacts.
        "rapier" Rapier,
    }
}

impl Engine {
    /// JSON leaves it out if it is the engine of files older than this choice.
    #[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
    fn is_own(&self) -> bool {
        *self == Self::Own
    }
}

object! {
    /// How the equations of motion are solved; docs/decisions says how the defaults were found.
    pub struct Solver {
        /// What moves the robot.
        #[serde(skip_serializing_if = "Engine::is_own")]
        engine: Engine = if_given(Fields::choice),
        /// How contacts are found.
        contact: ContactMethod = choice(),
        /// [m] Local error of a step; `None` if steps are of a given length.
        accuracy: Option<f64> = optional_number(Range::between(1e-10, 1e-2, "m")),
        /// [s] Length of a step; `None` if its accuracy is given.
        time_step: Option<f64> = optional_number(Range::between(SHORTEST, 1.0 / 30.0, "s")),
        /// Largest number of rounds in the search for forces that satisfy all constraints of a step; each round pivots
        /// until the states of all contacts and motors fit. `None` takes the solver's default.
        iterations: Option<u32> = optional_integer(1, 1000),
        /// [Hz] Natural frequency of the contact softness.
        contact_frequency: f64 = number(Range::between(1.0, 1e5, "Hz")),
        /// Damping ratio of the contact softness.
        contact_damping_ratio: f64 = number(Range::above(0.0, 100.0, "")),
        /// [m/s] Largest speed at which a penetration is pushed out.
        max_push_speed: f64 = number(Range::above(0.0, 100.0, "m/s")),
        /// [m] Gap up to which contacts are searched for.
        prediction_distance: f64 = number(Range::between(1e-5, 0.1, "m")),
        /// Coefficient of restitution: fraction of the impulses of an impact that contacts return.
        #[serde(skip_serializing_if = "is_zero")]
        restitution: f64 = number_or_zero(Range::between(0.0, 1.0, "")),
    }
    then check
}

object! {
    /// When a run ends, and what counts as a stop.
    pub struct SeizureCriteria {
        /// [s] Shortest time without progress that counts as a stop.
        stop_window: f64 = number(Range::between(0.01, 1e4, "s")),
        /// Grouser pitches at the commanded speed that must pass without progress.
        stop_pitches: f64 = number(Range::between(0.0, 1e3, "")),
        /// Share of the commanded distance below which there is no progress.
        stop_progress: f64 = number(Range::above(0.0, 1.0, "")),
        /// [m] Largest change of pose that still counts as stationary.
        stationary_distance: f64 = number(Range::above(0.0, 1.0, "m")),
        /// Number of stop windows for which a state must be stationary to end the run early.
        stationary_windows: u32 = integer(1, 1000),
        /// [s] Time that the robot must stay beyond the goal.
        clear_time: f64 = number(Range::between(0.0, 1e4, "s")),
        /// [rad] Largest angle between chassis and ground at which the goal counts.
        clear_angle: f64 = number(Range::above(0.0, 3.15, "rad")),
        /// [rad] Chassis angle at which the robot has tipped over.
        tip_over_angle: f64 = number(Range::above(0.0, 3.15, "rad")),
        /// [m] Depth inside the envelope of the track from which ground is an intrusion.
        intrusion_depth: f64 = number(Range::between(0.0, 0.1, "m")),
        /// Share of the weight from which an intrusion counts as loaded.
        intrusion_load: f64 = number(Range::above(0.0, 1.0, "")),
        /// Share of the weight on the belly from which a stop without a seizure is a hang-up.
        belly_load: f64 = number(Range::above(0.0, 1.0, "")),
        /// Share of the commanded speed from which a surface slides, or a drive turns.
        sliding_speed: f64 = number(Range::above(0.0, 1.0, "")),
        /// Share of the torque limit from which a motor counts as at its limit.
        torque_limit: f64 = number(Range::above(0.0, 1.0, "")),
        /// [m] A robot that moves to and fro by this much during a stop window is cycling.
        cycling_distance: f64 = number(Range::above(0.0, 10.0, "m")),
        /// Share of the weight that may stay unbalanced in the equilibrium of a stationary state.
        imbalance: f64 = number(Range::above(0.0, 1.0, "")),
        /// The same for the mean forces of a state that is not stationary.
        mean_imbalance: f64 = number(Range::above(0.0, 1.0, "")),
        /// Share of the commanded distance from which the robot counts as creeping.
        creep_from: f64 = number(Range::between(0.0, 1.0, "")),
        /// Share of the commanded distance up to which the robot counts as creeping.
        creep_to: f64 = number(Range::between(0.0, 1.0, "")),
        /// [m] Advance that counts as escaping from a stop.
        escape_distance: f64 = number(Range::above(0.0, 10.0, "m")),
        /// [s] Time that a closed belt has to escape from a stop.
        escape_time: f64 = number(Range::between(0.01, 60.0, "s")),
    }
}

impl Solver {
    /// Checks that either the length of steps is given or their error.
    fn check(&self, f: &Fields) -> Checked<()> {
        match (self.accuracy, self.time_step) {
            (None, None) => Err(f.error("accuracy", "null", "must be given if time_step is not")),
            (Some(_), Some(step)) => {
                let rule = "must not be given together with accuracy, which decides the length of each step";
                Err(f.error("time_step", step, rule))
            }
            _ => Ok(()),
        }
    }
}
