//! The ground as the user describes it: from left to right, with the obstacle beginning at x = 0.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, Range, SIZE, SMALLEST, one_of};

/// Largest number of points of one profile; 100,000 are built in well under a second.
pub const MAX_POINTS: usize = 200_000;

const EDGE_RADIUS: Range = Range::between(0.0, 10.0, "m");
const HEIGHT: Range = Range::above(0.0, 100.0, "m");
/// 80 degrees; with more, a barrier would lie along the track.
const YAW: Range = Range::between(-1.396_263, 1.396_263, "rad");
const LENGTH: Range = Range::between(SMALLEST, 1e4, "m");

/// How a terrain resists a robot that slides on it: all that the law of a contact takes from the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Friction {
    /// Coulomb's coefficient.
    #[serde(rename = "friction")]
    pub coefficient: f64,
}

impl Friction {
    /// Dry, as Coulomb has it.
    pub const fn dry(coefficient: f64) -> Self {
        Self { coefficient }
    }

    /// Whether sliding meets any resistance.
    pub(crate) fn resists(self) -> bool {
        self.coefficient > 0.0
    }

    /// That on a part whose own coefficient may be smaller.
    #[must_use]
    pub const fn at_most(mut self, limit: f64) -> Self {
        self.coefficient = self.coefficient.min(limit);
        self
    }

    /// The larger of two.
    pub(crate) const fn or_larger(self, other: Self) -> Self {
        Self {
            coefficient: self.coefficient.max(other.coefficient),
        }
    }

    fn read(f: &mut Fields) -> Result<Self, ScenarioError> {
        Ok(Self {
            coefficient: f.number("friction", Range::between(0.0, 100.0, ""))?,
        })
    }
}

/// What the robot touches of a terrain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Surface {
    /// [m] Radius of every convex edge; 0 is sharp.
    pub edge_radius: f64,
    /// With the robot.
    #[serde(flatten)]
    pub friction: Friction,
}

impl Surface {
    /// With sharp edges and dry friction.
    pub const fn sharp(friction: f64) -> Self {
        Self::rounded(0.0, friction)
    }

    /// With round edges and dry friction.
    pub const fn rounded(edge_radius: f64, friction: f64) -> Self {
        Self {
            edge_radius,
            friction: Friction::dry(friction),
        }
    }

    fn read(f: &mut Fields) -> Result<Self, ScenarioError> {
        Ok(Self {
            edge_radius: f.number("edge_radius", EDGE_RADIUS)?,
            friction: Friction::read(f)?,
        })
    }
}

/// One terrain.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Terrain {
    /// Level ground.
    Flat {
        /// [m] Distance from x = 0 to the goal.
        length: f64,
        /// With the robot.
        #[serde(flatten)]
        friction: Friction,
    },
    /// One step up with a vertical face at x = 0.
    Step {
        /// [m] Height of the step.
        height: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// A slope from x = 0, then a level top.
    Ramp {
        /// [rad] Angle of the slope.
        angle: f64,
        /// [m] Horizontal length of the slope.
        length: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// A parallelepiped on level ground, its front face at x = 0.
    Barrier {
        /// [m] Height.
        height: f64,
        /// [m] Thickness along x.
        thickness: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// A triangular prism on level ground, from x = 0.
    Ridge {
        /// [m] Height of its edge.
        height: f64,
        /// [rad] Angle between its flanks.
        edge_angle: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// A trench with vertical walls, from x = 0.
    Gap {
        /// [m] Width along x.
        width: f64,
        /// [m] Depth.
        depth: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// Steps up, the first face at x = 0, then a level top.
    Stairs {
        /// Number of steps.
        count: u32,
        /// [m] Height of each step.
        rise: f64,
        /// [m] Depth of each step along x.
        run: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// Half a pipe on level ground, from x = 0.
    HalfRound {
        /// [m] Radius.
        radius: f64,
        /// With the robot.
        #[serde(flatten)]
        friction: Friction,
    },
    /// A barrier whose front face is turned about the vertical, so that the tracks meet it one after the other.
    DiagonalBarrier {
        /// [rad] Turn, counter-clockwise seen from above; above 0 the left track meets it first.
        yaw: f64,
        /// [m] Height.
        height: f64,
        /// [m] Thickness at right angles to its front face.
        thickness: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// Square posts of random heights from x = 0, a row under each track.
    RandomStepfield(Stepfield),
    /// A user-defined profile.
    Points {
        /// [m] Points (x, y) from left to right or right to left; vertical faces are allowed.
        points: Vec<[f64; 2]>,
        /// [m] The x that the whole robot must pass.
        goal: f64,
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface,
    },
    /// A profile for each track and one for the belly.
    Lanes {
        /// Under the left track.
        left: Box<Terrain>,
        /// Under the right track.
        right: Box<Terrain>,
        /// Under the belly; `None` takes the higher of the two.
        middle: Option<Box<Terrain>>,
    },
}

/// Where the high posts of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FieldPattern {
    /// Anywhere.
    Flat,
    /// On a ridge across the field.
    Hill,
    /// On an oblique ridge, met first by the left track.
    Diagonal,
}

/// A random step field (Jacoff et al. 2008).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stepfield {
    /// Seed of the heights.
    pub seed: u32,
    /// Where the high posts are.
    pub pattern: FieldPattern,
    /// Posts in a row.
    pub posts: u32,
    /// [m] Side length of a post.
    pub post: f64,
    /// [m] Height of one level.
    pub rise: f64,
    /// Number of levels above the ground.
    pub levels: u32,
    /// [m] Height of a barrier across its middle; 0 for none.
    pub barrier_height: f64,
    /// [m] Thickness of that barrier at right angles to its front face.
    pub barrier_thickness: f64,
    /// [rad] Turn of that barrier, as for a diagonal barrier.
    pub barrier_yaw: f64,
    /// Of its faces and edges.
    #[serde(flatten)]
    pub surface: Surface,
}

impl Terrain {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const KINDS: [&str; 12] = [
            "flat",
            "step",
            "ramp",
            "barrier",
            "ridge",
            "gap",
            "stairs",
            "half_round",
            "diagonal_barrier",
            "random_stepfield",
            "points",
            "lanes",
        ];
        let terrain = match f.text("kind")? {
            "flat" => Self::Flat {
                length: f.number("length", LENGTH)?,
                friction: Friction::read(&mut f)?,
            },
            "step" => Self::Step {
                height: f.number("height", HEIGHT)?,
                surface: Surface::read(&mut f)?,
            },
            "ramp" => Self::Ramp {
                angle: f.number("angle", Range::between(-1.553_343, 1.553_343, "rad"))?,
                length: f.number("length", LENGTH)?,
                surface: Surface::read(&mut f)?,
            },
            "barrier" => Self::Barrier {
                height: f.number("height", HEIGHT)?,
                thickness: f.number("thickness", LENGTH)?,
                surface: Surface::read(&mut f)?,
            },
            "ridge" => Self::Ridge {
                height: f.number("height", HEIGHT)?,
                edge_angle: f.number("edge_angle", Range::between(0.01, 3.13, "rad"))?,
                surface: Surface::read(&mut f)?,
            },
            "gap" => Self::Gap {
                width: f.number("width", LENGTH)?,
                depth: f.number("depth", HEIGHT)?,
                surface: Surface::read(&mut f)?,
            },
            "stairs" => Self::Stairs {
                count: f.integer("count", 1, 1000)?,
                rise: f.number("rise", HEIGHT)?,
                run: f.number("run", LENGTH)?,
                surface: Surface::read(&mut f)?,
            },
            "half_round" => Self::HalfRound {
                radius: f.number("radius", SIZE)?,
                friction: Friction::read(&mut f)?,
            },
            "diagonal_barrier" => Self::DiagonalBarrier {
                yaw: f.number("yaw", YAW)?,
                height: f.number("height", HEIGHT)?,
                thickness: f.number("thickness", LENGTH)?,
                surface: Surface::read(&mut f)?,
            },
            "random_stepfield" => Self::RandomStepfield(Stepfield::read(&mut f)?),
            "points" => Self::Points {
                points: f.points("points", Range::between(-1e7, 1e7, "m"), MAX_POINTS)?,
                goal: f.number("goal", Range::between(-1e7, 1e7, "m"))?,
                surface: Surface::read(&mut f)?,
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
                return Err(f.error("kind", other, one_of(Some(other), &KINDS)));
            }
        };
        f.finish()?;
        Ok(terrain)
    }

    /// Multiplies the friction of all its lanes.
    pub(crate) fn scale_friction(&mut self, factor: f64) {
        match self {
            Self::Flat { friction, .. } | Self::HalfRound { friction, .. } => {
                friction.coefficient *= factor;
            }
            Self::Step { surface, .. }
            | Self::Ramp { surface, .. }
            | Self::Barrier { surface, .. }
            | Self::Ridge { surface, .. }
            | Self::Gap { surface, .. }
            | Self::Stairs { surface, .. }
            | Self::DiagonalBarrier { surface, .. }
            | Self::RandomStepfield(Stepfield { surface, .. })
            | Self::Points { surface, .. } => surface.friction.coefficient *= factor,
            Self::Lanes {
                left,
                right,
                middle,
            } => {
                let lanes = [left, right].into_iter().chain(middle);
                lanes.for_each(|lane| lane.scale_friction(factor));
            }
        }
    }

    fn read_lane(f: &mut Fields, name: &'static str) -> Result<Box<Self>, ScenarioError> {
        let lane = Self::read(f.child(name)?)?;
        let lanes = match lane {
            Self::Lanes { .. } => "lanes",
            Self::DiagonalBarrier { .. } => "diagonal_barrier",
            Self::RandomStepfield(_) => "random_stepfield",
            _ => return Ok(Box::new(lane)),
        };
        Err(f.error(name, lanes, "must be a terrain with a single profile"))
    }
}

impl Stepfield {
    fn read(f: &mut Fields) -> Result<Self, ScenarioError> {
        let patterns = [
            ("flat", FieldPattern::Flat),
            ("hill", FieldPattern::Hill),
            ("diagonal", FieldPattern::Diagonal),
        ];
        Ok(Self {
            seed: f.integer("seed", 0, u32::MAX)?,
            pattern: f.choice("pattern", &patterns)?,
            posts: f.integer("posts", 1, 1000)?,
            post: f.number("post", LENGTH)?,
            rise: f.number("rise", HEIGHT)?,
            levels: f.integer("levels", 1, 1000)?,
            barrier_height: f.number("barrier_height", Range::between(0.0, 100.0, "m"))?,
            barrier_thickness: f.number("barrier_thickness", LENGTH)?,
            barrier_yaw: f.number("barrier_yaw", YAW)?,
            surface: Surface::read(f)?,
        })
    }
}
