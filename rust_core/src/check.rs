//! The door: every scenario that passes it can be built and run.

use serde_json::Value;

use crate::error::{Error, ScenarioError};
use crate::needs;
use crate::robot::{Model, Part};
use crate::scenario::Scenario;
use crate::start::start_position;
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
        check_text(text)?;
        let value: Value = serde_json::from_str(text)
            .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
        Self::checked(&value)
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

    fn checked(value: &Value) -> Result<Self, Error> {
        let scenario = Self::read(value)?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Rules that join several branches of the tree.
    fn check(&self) -> Result<(), Error> {
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
        start_position(self, &model.placed_on(&ground), &ground)?;
        Ok(())
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
