//! Validation: a valid scenario can be run, and keeps the robot and ground that were built to check it.

use std::sync::Arc;

use serde_json::Value;

use super::step_length::{FARTHEST_TURN, fastest_turn};
use crate::engine;
use crate::error::Error;
use crate::geometry::{Vector, end_discs, turned_by};
use crate::limits::Cancel;
use crate::limits::memory::{self, Budget};
use crate::robot::{Model, Part, start_position};
use crate::scenario::{Scenario, ScenarioError, Terrain, Track, Warning, parse};
use crate::terrain::Ground;

/// Longest text that is read, in bytes; three lanes with the largest number of points take half of it.
const LONGEST_TEXT: usize = 64 << 20;

/// JSON pointer to the discs of an outline.
const DISCS: &str = "/robot/outline/discs";

/// A valid scenario, with the robot and the ground that were built to check it.
#[derive(Clone, Debug)]
pub struct ValidScenario {
    scenario: Scenario,
    ground: Arc<Ground>,
    model: Arc<Model>,
    position: Vector,
    warnings: Vec<Warning>,
}

/// Checks that a text is not too long to be read.
///
/// # Errors
/// It is too long, or needs more memory than available.
fn check_text(text: &str) -> Result<(), Error> {
    if text.len() > LONGEST_TEXT {
        let rule = format!("must be at most {} MiB of JSON", LONGEST_TEXT >> 20);
        let value = format!("{} MiB", text.len() >> 20);
        return Err(ScenarioError::new("scenario", value, rule).into());
    }
    let bytes = text.len() as u64 * BYTES_A_CHARACTER;
    Ok(memory::ask("reading a scenario", bytes)?)
}

impl ValidScenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// The first broken rule, with the path of its field; a text or a ground that needs too much memory.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        Self::from_json_like(text, None)
    }

    /// The same, but a robot or ground equal to that of another scenario is not built again.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn from_json_like(text: &str, other: Option<&Self>) -> Result<Self, Error> {
        check_text(text)?;
        Self::of_value(&parse(text)?, other)
    }

    /// Checks a scenario that was made in Rust, with the same rules as for one read from JSON.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn new(scenario: &Scenario) -> Result<Self, Error> {
        Self::of_value(&to_value(scenario), None)
    }

    /// Scenarios that differ from this one in some numbers: one per row, which has a number for each field.
    ///
    /// A field is a JSON pointer such as `/robot/center_of_mass/0`, with whether its values are integers.
    ///
    /// Each may break a rule, as in [`Self::from_json`].
    ///
    /// # Errors
    /// [`Error::Interrupted`] once `cancel` is asked; their grounds need more memory than there may be.
    pub fn varied<'a>(
        &self,
        fields: &[(String, bool)],
        rows: impl IntoIterator<Item = &'a [f64]>,
        cancel: &Cancel,
    ) -> Result<Vec<Result<Self, Error>>, Error> {
        let mut value = to_value(&self.scenario);
        // Two discs have another form in JSON.
        if fields.iter().any(|(pointer, _)| pointer.starts_with(DISCS)) {
            value["robot"]["outline"] = self.scenario.robot.outline.with_discs();
        }
        let mut vary = |row: &[f64]| {
            for ((pointer, whole), number) in fields.iter().zip(row) {
                let Some(place) = place_of(&mut value, pointer) else {
                    let error = ScenarioError::new(pointer, number, "must be a known field");
                    return Err(error.into());
                };
                *place = to_number(*number, *whole);
            }
            Self::of_value(&value, Some(self))
        };
        let (mut found, mut budget) = (Vec::new(), None);
        for row in rows {
            cancel.check()?;
            let varied = vary(row);
            if let Ok(own) = &varied
                && let Some(bytes) = own.bytes_beside(self)
            {
                let budget = match &budget {
                    Some(budget) => budget,
                    None => budget.insert(Budget::new()?),
                };
                budget.take("the grounds of planned runs", bytes)?;
            }
            found.push(varied);
        }
        Ok(found)
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Its ground.
    pub fn ground(&self) -> &Arc<Ground> {
        &self.ground
    }

    /// Its robot, on that ground.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// [m] Where the chassis frame is at time 0.
    pub(crate) fn position(&self) -> Vector {
        self.position
    }

    /// Values that are legal but unlikely to be meant.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    fn of_value(value: &Value, other: Option<&Self>) -> Result<Self, Error> {
        let scenario = Scenario::of_value(value)?;
        let robot = &scenario.robot;
        scenario.drive.check(&robot.drivetrain)?;
        let twin = other.filter(|other| other.scenario.robot == *robot);
        let built = match twin {
            None => Some(Model::new(robot)?),
            Some(_) => None,
        };
        let lumped = built.as_ref().or(twin.map(|twin| &*twin.model));
        let parts = lumped.map_or(&[][..], |model| &model.parts);
        check_sizes(&scenario, parts)?;
        check_impacts(&scenario)?;
        engine::check(&scenario)?;
        let ground = if let Some(other) = other.filter(|other| other.has_ground_of(&scenario)) {
            Arc::clone(&other.ground)
        } else {
            let bytes = corners(&scenario.terrain) * BYTES_A_CORNER;
            memory::ask("the ground", bytes)?;
            Arc::new(Ground::new(&scenario.terrain, robot.gauge)?)
        };
        let model = match (built, twin) {
            (Some(model), _) => Arc::new(model.placed_on(&ground)),
            (None, Some(twin)) if twin.ground.has_lanes_of(&ground) => Arc::clone(&twin.model),
            _ => Arc::new(Model::on(robot, &ground)?),
        };
        let position =
            start_position(&scenario, &model, &ground).map_err(|e| scenario.explained(e))?;
        let [rear, _] = end_discs(&robot.outline);
        let axle = position.x + turned_by(scenario.start.angle)(rear.center).x;
        let to_goal = ground.goal_of(&scenario) + rear.radius - axle;
        let warnings = scenario.warnings(to_goal, ground.extent().1);
        Ok(Self {
            scenario,
            ground,
            model,
            position,
            warnings,
        })
    }

    /// Bytes of its ground, unless that is also the ground of another scenario.
    fn bytes_beside(&self, other: &Self) -> Option<u64> {
        if Arc::ptr_eq(&self.ground, &other.ground) {
            return None;
        }
        let lanes = self.ground.lanes.iter();
        let points: u64 = lanes.map(|lane| lane.points.len() as u64).sum();
        Some(points * BYTES_A_KEPT_CORNER)
    }

    fn has_ground_of(&self, scenario: &Scenario) -> bool {
        let [mine, other] =
            [&self.scenario, scenario].map(|s| (&s.terrain, s.robot.gauge.to_bits()));
        mine == other
    }
}

fn to_value(scenario: &Scenario) -> Value {
    serde_json::to_value(scenario).unwrap_or_else(|e| unreachable!("plain data serialises: {e}"))
}

/// A number as in JSON; a non-finite one becomes a string, which breaks a rule.
fn to_number(number: f64, whole: bool) -> Value {
    if whole && number >= 0.0 && number.fract() == 0.0 {
        return Value::from(number as u64);
    }
    serde_json::Number::from_f64(number)
        .map_or_else(|| Value::from(number.to_string()), Value::Number)
}

impl Scenario {
    /// Reads and checks a scenario, so that it can be changed before it runs; [`ValidScenario`] keeps what was built.
    ///
    /// # Errors
    /// As [`ValidScenario::from_json`].
    pub fn from_json(text: &str) -> Result<Self, Error> {
        ValidScenario::from_json(text).map(|checked| checked.scenario)
    }
}

/// Checks that restitution is possible: contacts of chains are damped springs that return no energy.
fn check_impacts(scenario: &Scenario) -> Result<(), ScenarioError> {
    let share = scenario.solver.restitution;
    if share > 0.0 && matches!(scenario.robot.track, Track::Segmental(_)) {
        let rule =
            "must be 0 where robot.track.kind is segmental: contacts of shoes are damped springs";
        return Err(ScenarioError::new("solver.restitution", share, rule));
    }
    Ok(())
}

/// Rules that relate the sizes of a track model's parts to speeds, time step and criteria.
fn check_sizes(scenario: &Scenario, parts: &[Part]) -> Result<(), ScenarioError> {
    let radii = parts.iter().flat_map(Part::discs);
    let root = radii.fold(f64::INFINITY, |root, (_, inner)| root.min(inner.radius));
    if let Some(step) = scenario.solver.time_step {
        let turn = fastest_turn(scenario, parts) * step;
        // Larger turns would pass over corners without contact.
        if turn > FARTHEST_TURN {
            let rule = format!(
                "must be so short that no wheel or flipper turns by more than {FARTHEST_TURN} rad (here {turn:.3} rad)"
            );
            return Err(ScenarioError::new("solver.time_step", step, rule));
        }
    }
    let depth = scenario.criteria.intrusion_depth;
    if depth >= root {
        let rule = format!("must be less than the smallest radius of the track model, {root} m");
        return Err(ScenarioError::new("criteria.intrusion_depth", depth, rule));
    }
    Ok(())
}

/// A field of a JSON value, also one that is left out because it has its default.
fn place_of<'a>(text: &'a mut Value, pointer: &str) -> Option<&'a mut Value> {
    if text.pointer(pointer).is_some() {
        return text.pointer_mut(pointer);
    }
    let (object, name) = pointer.rsplit_once('/')?;
    let members = text.pointer_mut(object)?.as_object_mut()?;
    Some(members.entry(name).or_insert(Value::Null))
}

/// Bytes per corner of the ground and its index during a run; measured: 250, and the same again while they are built.
pub(super) const BYTES_A_CORNER: u64 = 600;
/// Bytes per corner of a ground that is kept for a run.
const BYTES_A_KEPT_CORNER: u64 = 300;
/// Largest number of bytes per character that a parsed text takes: `[0],` is a row of one number.
const BYTES_A_CHARACTER: u64 = 40;

/// Largest possible number of corners of a ground, all lanes together, including facets of rounded edges.
pub(super) fn corners(terrain: &Terrain) -> u64 {
    /// Facets of a rounded edge that turns by a right angle, and the maximum of a lane.
    const FACETS: (u64, u64) = (90, 1_000_000);

    let rounded = |corners: u64, radius: f64| {
        if radius > 0.0 {
            corners + (corners * FACETS.0).min(FACETS.1)
        } else {
            corners
        }
    };
    match terrain {
        Terrain::Points {
            points, surface, ..
        } => rounded(points.len() as u64, surface.edge_radius),
        Terrain::Lanes {
            left,
            right,
            middle,
        } => {
            let own = [left, right].map(|lane| corners(lane));
            let of_belly = middle.as_ref().map_or(own[0] + own[1], |m| corners(m));
            own[0] + own[1] + of_belly
        }
        Terrain::Stairs { count, surface, .. } => {
            rounded(2 * u64::from(*count), surface.edge_radius)
        }
        Terrain::RandomStepfield(field) => {
            3 * rounded(2 * u64::from(field.posts), field.surface.edge_radius)
        }
        _ => 1000,
    }
}

#[cfg(test)]
mod tests;
