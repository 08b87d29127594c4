//! The door: every scenario that passes it can be built and run.

use serde_json::Value;

use super::needs;
use crate::error::Error;
use crate::robot::{Model, Part, start_position};
use crate::scenario::{Doubt, Scenario, ScenarioError, parse};
use crate::terrain::Ground;

/// Bytes of the longest text that is read: three lanes of the most points that there can be take half of it.
const LONGEST_TEXT: usize = 64 << 20;

/// Whether a text is not too long to be read.
///
/// # Errors
/// It is, or more than memory holds.
pub fn check_text(text: &str) -> Result<(), Error> {
    if text.len() > LONGEST_TEXT {
        let rule = format!("must be at most {} MiB of JSON", LONGEST_TEXT >> 20);
        let value = format!("{} MiB", text.len() >> 20);
        return Err(ScenarioError::new("scenario", value, rule).into());
    }
    Ok(needs::ask_for_text(text)?)
}

impl Scenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field; a text or a ground beyond what memory holds.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        Self::examined(text).map(|(scenario, _)| scenario)
    }

    /// The same, with what is legal but unlikely to be meant.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn examined(text: &str) -> Result<(Self, Vec<Doubt>), Error> {
        check_text(text)?;
        Self::checked(&parse(text)?)
    }

    /// Checks a scenario that was put together in Rust by the same rules as one read from JSON.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn validate(&self) -> Result<(), Error> {
        let value = serde_json::to_value(self)
            .unwrap_or_else(|e| unreachable!("plain data serialises: {e}"));
        Self::checked(&value).map(|_| ())
    }

    fn checked(value: &Value) -> Result<(Self, Vec<Doubt>), Error> {
        let scenario = Self::read(value)?;
        let to_goal = scenario.check()?;
        let doubts = scenario.doubts(to_goal);
        Ok((scenario, doubts))
    }

    /// Rules that join several branches of the tree; how far [m] the robot has to go to leave its goal behind.
    fn check(&self) -> Result<f64, Error> {
        self.drive.check(&self.robot.drivetrain)?;
        let limit = self.robot.drivetrain.max_speed;
        let model = Model::new(&self.robot)?;
        let (tip, root) = model.parts.iter().flat_map(Part::discs).fold(
            (f64::INFINITY, f64::INFINITY),
            |(tip, root), (circumscribed, inner)| {
                (tip.min(circumscribed.radius), root.min(inner.radius))
            },
        );
        let rate_of_arms = self.robot.flippers.as_ref().map_or(0.0, |f| f.rate_limit);
        self.check_turn("max_speed / radius", limit / tip)?;
        self.check_turn("robot.flippers.rate_limit", rate_of_arms)?;
        if self.criteria.intrusion_depth >= root {
            let rule = format!("must be below the smallest radius of the track model, {root} m");
            return Err(ScenarioError::new(
                "criteria.intrusion_depth",
                self.criteria.intrusion_depth,
                rule,
            )
            .into());
        }
        needs::ask_for_ground(&self.terrain)?;
        let ground = Ground::new(&self.terrain, self.robot.gauge)?;
        let start = start_position(self, &model.placed_on(&ground), &ground)?;
        let outline = &self.robot.outline;
        let rear = start.x - 0.5 * outline.axle_distance * libm::cos(self.start.angle);
        Ok(ground.goal_of(self) + outline.rear_radius - rear)
    }

    /// What turns farther than this between two collision checks passes over corners unseen.
    fn check_turn(&self, name: &str, rate: f64) -> Result<(), ScenarioError> {
        const FARTHEST: f64 = 0.7; // [rad]
        let (path, step) = ("solver.time_step", self.solver.time_step);
        let turn = rate * step;
        if turn <= FARTHEST {
            return Ok(());
        }
        let rule = format!("must keep {name} x time_step <= {FARTHEST} rad a step, here {turn:.3}");
        Err(ScenarioError::new(path, step, rule))
    }
}
