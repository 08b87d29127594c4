//! The ground as the user describes it: from left to right, with the obstacle beginning at x = 0.

use serde::Serialize;

use super::fields::{Checked, Fields, Range, SIZE, SMALLEST, one_of};
use super::objects::{Choice, FromJson, choice, kinds, object};

/// Largest number of points of one profile; 100,000 are built in well under a second.
pub const MAX_POINTS: usize = 200_000;

const HEIGHT: Range = Range::above(0.0, 100.0, "m");
/// 80 degrees; with more, a barrier would lie along the track.
const YAW: Range = Range::between(-1.396_263, 1.396_263, "rad");
const LENGTH: Range = Range::between(SMALLEST, 1e4, "m");

/// Resistance of a terrain against sliding: everything that the contact law takes from the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Friction {
    /// Coulomb's coefficient.
    #[serde(rename = "friction")]
    pub coefficient: f64,
}

pub(super) const COEFFICIENT: Range = Range::between(0.0, 100.0, "");

impl Friction {
    /// Dry friction (Coulomb's law).
    pub const fn dry(coefficient: f64) -> Self {
        Self { coefficient }
    }

    /// Whether sliding meets any resistance.
    pub(crate) fn resists(self) -> bool {
        self.coefficient > 0.0
    }

    /// The friction on a part, whose own coefficient may be smaller.
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
}

impl FromJson for Friction {
    fn read(f: &mut Fields) -> Checked<Self> {
        Ok(Self {
            coefficient: f.number("friction", COEFFICIENT)?,
        })
    }
}

object! {
    /// The surface of a terrain.
    #[derive(Copy)]
    pub struct Surface {
        /// [m] Radius of every convex edge; 0 is sharp.
        edge_radius: f64 = number(Range::between(0.0, 10.0, "m")),
        /// With the robot.
        #[serde(flatten)]
        friction: Friction = flat(),
    }
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
}

kinds! {
    /// One terrain.
    pub enum Terrain {
        /// Level ground.
        "flat" Flat {
            /// [m] Distance from x = 0 to the goal.
            length: f64 = number(LENGTH),
            /// With the robot.
            #[serde(flatten)]
            friction: Friction = flat(),
        },
        /// One step up with a vertical face at x = 0.
        "step" Step {
            /// [m] Height of the step.
            height: f64 = number(HEIGHT),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// A slope from x = 0, then a level top.
        "ramp" Ramp {
            /// [rad] Angle of the slope.
            angle: f64 = number(Range::between(-1.553_343, 1.553_343, "rad")),
            /// [m] Horizontal length of the slope.
            length: f64 = number(LENGTH),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// A parallelepiped on level ground, its front face at x = 0.
        "barrier" Barrier {
            /// [m] Height.
            height: f64 = number(HEIGHT),
            /// [m] Thickness along x.
            thickness: f64 = number(LENGTH),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// A triangular prism on level ground, from x = 0.
        "ridge" Ridge {
            /// [m] Height of its edge.
            height: f64 = number(HEIGHT),
            /// [rad] Angle between its flanks.
            edge_angle: f64 = number(Range::between(0.01, 3.13, "rad")),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// A trench with vertical walls, from x = 0.
        "gap" Gap {
            /// [m] Width along x.
            width: f64 = number(LENGTH),
            /// [m] Depth.
            depth: f64 = number(HEIGHT),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// Steps up, the first face at x = 0, then a level top.
        "stairs" Stairs {
            /// Number of steps.
            count: u32 = integer(1, 1000),
            /// [m] Height of each step.
            rise: f64 = number(HEIGHT),
            /// [m] Depth of each step along x.
            run: f64 = number(LENGTH),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// Half a pipe on level ground, from x = 0.
        "half_round" HalfRound {
            /// [m] Radius.
            radius: f64 = number(SIZE),
            /// With the robot.
            #[serde(flatten)]
            friction: Friction = flat(),
        },
        /// A barrier whose front face is turned about the vertical, so that the tracks reach it one after the other.
        "diagonal_barrier" DiagonalBarrier {
            /// [rad] Turn, counter-clockwise seen from above; above 0 the left track meets it first.
            yaw: f64 = number(YAW),
            /// [m] Height.
            height: f64 = number(HEIGHT),
            /// [m] Thickness at right angles to its front face.
            thickness: f64 = number(LENGTH),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
        },
        /// Square posts of random heights from x = 0, a row under each track.
        "random_stepfield" RandomStepfield(Stepfield),
        /// A user-defined profile.
        "points" Points {
            /// [m] Points (x, y) from left to right or right to left; vertical faces are allowed.
            points: Vec<[f64; 2]> = points(Range::between(-1e7, 1e7, "m"), MAX_POINTS),
            /// [m] The x that the whole robot must pass.
            goal: f64 = number(Range::between(-1e7, 1e7, "m")),
            /// Of its faces and edges.
            #[serde(flatten)]
            surface: Surface = flat(),
            /// Friction of each segment between two points; `None` is the same everywhere.
            #[serde(skip_serializing_if = "Option::is_none")]
            segment_friction: Option<Vec<f64>> = if_given(|f, name| f.numbers(name, COEFFICIENT, MAX_POINTS)),
        },
        /// A profile for each track and one for the belly.
        "lanes" Lanes {
            /// Under the left track.
            left: Box<Terrain> = lane(),
            /// Under the right track.
            right: Box<Terrain> = lane(),
            /// Under the belly; `None` takes the higher of the two.
            middle: Option<Box<Terrain>> = optional_lane(),
        },
    }
}

choice! {
    /// Where the high posts of a field are.
    pub enum FieldPattern {
        /// Anywhere.
        "flat" Flat,
        /// On a ridge across the field.
        "hill" Hill,
        /// On an oblique ridge, met first by the left track.
        "diagonal" Diagonal,
    }
}

object! {
    /// A random step field (Jacoff et al. 2008).
    pub struct Stepfield {
        /// Seed of the heights.
        seed: u32 = integer(0, u32::MAX),
        /// Where the high posts are.
        pattern: FieldPattern = choice(),
        /// Posts in a row.
        posts: u32 = integer(1, 1000),
        /// [m] Side length of a post.
        post: f64 = number(LENGTH),
        /// [m] Height of one level.
        rise: f64 = number(HEIGHT),
        /// Number of levels above the ground.
        levels: u32 = integer(1, 1000),
        /// [m] Height of a barrier across its middle; 0 for none.
        barrier_height: f64 = number(Range::between(0.0, 100.0, "m")),
        /// [m] Thickness of that barrier at right angles to its front face.
        barrier_thickness: f64 = number(LENGTH),
        /// [rad] Turn of that barrier, as for a diagonal barrier.
        barrier_yaw: f64 = number(YAW),
        /// Of its faces and edges.
        #[serde(flatten)]
        surface: Surface = flat(),
    }
}

impl Terrain {
    /// Path of the friction of each segment in the first lane that has it, if any.
    pub(crate) fn path_of_segments(&self, path: &str) -> Option<String> {
        match self {
            Self::Points {
                segment_friction: Some(_),
                ..
            } => Some(format!("{path}.segment_friction")),
            Self::Lanes {
                left,
                right,
                middle,
            } => {
                let lanes = [("left", left), ("right", right)].into_iter();
                let lanes = lanes.chain(middle.iter().map(|lane| ("middle", lane)));
                let mut found =
                    lanes.map(|(name, lane)| lane.path_of_segments(&format!("{path}.{name}")));
                found.find_map(|each| each)
            }
            _ => None,
        }
    }

    /// The friction of its surface; each lane has its own.
    pub(crate) fn friction(&self) -> Option<f64> {
        let friction = match self {
            Self::Flat { friction, .. } | Self::HalfRound { friction, .. } => friction,
            Self::Step { surface, .. }
            | Self::Ramp { surface, .. }
            | Self::Barrier { surface, .. }
            | Self::Ridge { surface, .. }
            | Self::Gap { surface, .. }
            | Self::Stairs { surface, .. }
            | Self::DiagonalBarrier { surface, .. }
            | Self::RandomStepfield(Stepfield { surface, .. })
            | Self::Points { surface, .. } => &surface.friction,
            Self::Lanes { .. } => return None,
        };
        Some(friction.coefficient)
    }

    /// Multiplies the friction of all its lanes, up to the largest allowed.
    pub(crate) fn scale_friction(&mut self, factor: f64) {
        let scale = |coefficient: &mut f64| *coefficient = scaled_friction(*coefficient, factor);
        match self {
            Self::Flat { friction, .. } | Self::HalfRound { friction, .. } => {
                scale(&mut friction.coefficient);
            }
            Self::Step { surface, .. }
            | Self::Ramp { surface, .. }
            | Self::Barrier { surface, .. }
            | Self::Ridge { surface, .. }
            | Self::Gap { surface, .. }
            | Self::Stairs { surface, .. }
            | Self::DiagonalBarrier { surface, .. }
            | Self::RandomStepfield(Stepfield { surface, .. }) => {
                scale(&mut surface.friction.coefficient);
            }
            Self::Points {
                surface,
                segment_friction,
                ..
            } => {
                let segments = segment_friction.iter_mut().flatten();
                let all = segments.chain(std::iter::once(&mut surface.friction.coefficient));
                all.for_each(scale);
            }
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
}

/// A coefficient of friction times a factor, up to the largest allowed.
pub(crate) fn scaled_friction(coefficient: f64, factor: f64) -> f64 {
    COEFFICIENT.cut(coefficient * factor)
}

impl Fields<'_> {
    fn lane(&mut self, name: &'static str) -> Checked<Box<Terrain>> {
        let lane = self.object(name)?;
        let lanes = match lane {
            Terrain::Lanes { .. } => "lanes",
            Terrain::DiagonalBarrier { .. } => "diagonal_barrier",
            Terrain::RandomStepfield(_) => "random_stepfield",
            _ => return Ok(Box::new(lane)),
        };
        Err(self.error(name, lanes, "must be a terrain with a single profile"))
    }

    fn optional_lane(&mut self, name: &'static str) -> Checked<Option<Box<Terrain>>> {
        self.unless_null(name, Self::lane)
    }
}
