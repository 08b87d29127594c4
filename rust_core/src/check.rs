//! The door: every scenario that passes it can be built and run.

use serde_json::Value;

use crate::error::ScenarioError;
use crate::robot::{Model, Part};
use crate::scenario::Scenario;
use crate::start::start_position;
use crate::terrain::Ground;

impl Scenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field.
    pub fn from_json(text: &str) -> Result<Self, ScenarioError> {
        let value: Value = serde_json::from_str(text)
            .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
        Self::checked(&value)
    }

    /// Checks a scenario that was put together in Rust by the same rules as one read from JSON.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let value = serde_json::to_value(self)
            .unwrap_or_else(|e| unreachable!("plain data serialises: {e}"));
        Self::checked(&value).map(|_| ())
    }

    fn checked(value: &Value) -> Result<Self, ScenarioError> {
        let scenario = Self::read(value)?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Rules that join several branches of the tree.
    fn check(&self) -> Result<(), ScenarioError> {
        let limit = self.robot.drivetrain.max_speed;
        let (path, speed) = self.drive.fastest();
        if speed.abs() > limit {
            let rule = format!("must not exceed robot.drivetrain.max_speed = {limit} m/s");
            return Err(ScenarioError::new(path, speed, rule));
        }
        if self.drive.gait.is_some() && self.robot.flippers.is_none() {
            let rule = "must be null: the robot has no flippers";
            return Err(ScenarioError::new("drive.gait", "a gait", rule));
        }
        let model = Model::new(&self.robot)?;
        let (tip, root) = model.parts.iter().flat_map(Part::discs).fold(
            (f64::INFINITY, f64::INFINITY),
            |(tip, root), (circumscribed, inner)| {
                (tip.min(circumscribed.radius), root.min(inner.radius))
            },
        );
        // A surface that turns further than this between two collision checks rolls over corners unseen.
        let turn = limit * self.solver.time_step / tip;
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
        if self.criteria.intrusion_depth >= root {
            let rule = format!("must be below the smallest radius of the track model, {root} m");
            return Err(ScenarioError::new(
                "criteria.intrusion_depth",
                self.criteria.intrusion_depth,
                rule,
            ));
        }
        let ground = Ground::new(&self.terrain, self.robot.gauge)?;
        start_position(self, &model.placed_on(&ground), &ground)?;
        Ok(())
    }
}
