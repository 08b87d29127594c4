//! The ground as the user describes it: parametric, left to right, the obstacle beginning at x = 0.

use serde::Serialize;

use super::fields::{Fields, Range, one_of};
use crate::error::ScenarioError;

/// Largest number of points of one profile; 100,000 build in well under a second.
pub const MAX_POINTS: usize = 200_000;

const FRICTION: Range = Range::between(0.0, 100.0, "");
const EDGE_RADIUS: Range = Range::between(0.0, 10.0, "m");
const LENGTH: Range = Range::between(1e-3, 1e4, "m");

/// One terrain.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Terrain {
    /// Level ground.
    Flat {
        /// [m] Where the goal lies.
        length: f64,
        /// Coulomb friction with the robot.
        friction: f64,
    },
    /// One step up with a vertical face at x = 0.
    Step {
        /// [m] Height of the step.
        height: f64,
        /// [m] Radius of the convex edge; 0 is sharp.
        edge_radius: f64,
        /// Coulomb friction with the robot.
        friction: f64,
    },
    /// A slope from x = 0, then a level top.
    Ramp {
        /// [rad] Angle of the slope.
        angle: f64,
        /// [m] Horizontal extent of the slope.
        length: f64,
        /// [m] Radius of the convex edge; 0 is sharp.
        edge_radius: f64,
        /// Coulomb friction with the robot.
        friction: f64,
    },
    /// A profile of the user's own.
    Points {
        /// [m] Points (x, y) from left to right or right to left; vertical faces are allowed.
        points: Vec<[f64; 2]>,
        /// [m] The x that must be left behind.
        goal: f64,
        /// [m] Radius of every convex edge; 0 is sharp.
        edge_radius: f64,
        /// Coulomb friction with the robot.
        friction: f64,
    },
    /// A profile for each track and one for the belly.
    Lanes {
        /// Under the left track.
        left: Box<Terrain>,
        /// Under the right track.
        right: Box<Terrain>,
        /// Under the belly; none takes the upper envelope of the two.
        middle: Option<Box<Terrain>>,
    },
}

impl Terrain {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let kind = f.text("kind")?;
        let terrain = match kind {
            "flat" => Self::Flat {
                length: f.number("length", LENGTH)?,
                friction: f.number("friction", FRICTION)?,
            },
            "step" => Self::Step {
                height: f.number("height", Range::above(0.0, 100.0, "m"))?,
                edge_radius: f.number("edge_radius", EDGE_RADIUS)?,
                friction: f.number("friction", FRICTION)?,
            },
            "ramp" => Self::Ramp {
                angle: f.number("angle", Range::between(-1.553_343, 1.553_343, "rad"))?,
                length: f.number("length", LENGTH)?,
                edge_radius: f.number("edge_radius", EDGE_RADIUS)?,
                friction: f.number("friction", FRICTION)?,
            },
            "points" => Self::Points {
                points: f.points("points", Range::between(-1e7, 1e7, "m"), MAX_POINTS)?,
                goal: f.number("goal", Range::between(-1e7, 1e7, "m"))?,
                edge_radius: f.number("edge_radius", EDGE_RADIUS)?,
                friction: f.number("friction", FRICTION)?,
            },
            "lanes" => {
                let left = Self::read_lane(&mut f, "left")?;
                let right = Self::read_lane(&mut f, "right")?;
                let middle = if f.value("middle")?.is_null() {
                    None
                } else {
                    Some(Self::read_lane(&mut f, "middle")?)
                };
                Self::Lanes {
                    left,
                    right,
                    middle,
                }
            }
            other => {
                let kinds = ["flat", "step", "ramp", "points", "lanes"];
                return Err(f.error("kind", other, one_of(Some(other), &kinds)));
            }
        };
        f.finish()?;
        Ok(terrain)
    }

    fn read_lane(f: &mut Fields, name: &'static str) -> Result<Box<Self>, ScenarioError> {
        let lane = Self::read(f.child(name)?)?;
        if matches!(lane, Self::Lanes { .. }) {
            return Err(f.error(name, "lanes", "must be a terrain of one lane"));
        }
        Ok(Box::new(lane))
    }
}
