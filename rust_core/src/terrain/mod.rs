//! Builds the profiles on which contacts are computed from the described terrain.

mod field;
mod obstacle;
mod place;
mod profile;
mod skyline;
mod straight;
mod upper;

use obstacle::RUN_OUT;
use skyline::Skyline;
use straight::COLLINEAR;

pub(crate) use place::facet_along;
pub(crate) use straight::{FINE, STRAIGHT};

use crate::scenario::{Scenario, ScenarioError, Surface, Terrain};
pub use profile::{Edge, Profile, Side};

/// The ground of a scenario.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Profiles under the tracks, the left first, or one under both; then that of the belly, if it has its own.
    pub lanes: Vec<Profile>,
    /// Number of profiles under tracks: 1 if both meet the same, else 2.
    pub tracks: usize,
    /// [m] The x that the whole robot must pass.
    pub goal: f64,
    /// [m] Where the obstacle begins: the first edge at or beyond x = 0, else the first of all, else 0.
    pub first_edge: f64,
}

/// The description of one lane.
struct Described {
    profile: Profile,
    goal: f64,
}

impl Ground {
    /// Builds the ground of a terrain for a robot whose tracks are `gauge` [m] apart.
    ///
    /// # Errors
    /// An impossible profile: overhang, too few points, an edge radius that does not fit; lanes without a common
    /// stretch of x.
    pub fn new(terrain: &Terrain, gauge: f64) -> Result<Self, ScenarioError> {
        match terrain {
            Terrain::Lanes {
                left,
                right,
                middle,
            } => Self::lanes(left, right, middle.as_deref()),
            Terrain::DiagonalBarrier {
                yaw,
                height,
                thickness,
                surface,
            } => {
                let lanes = field::barrier((*height, *thickness), *yaw, 0.0, gauge);
                Self::skylines(&lanes, *surface)
            }
            Terrain::RandomStepfield(field) => {
                let lanes = field::stepfield(field, gauge);
                Self::skylines(&lanes, field.surface)
            }
            _ => {
                let lane = Described::new("terrain", terrain)?;
                Ok(Self::of(vec![lane.profile], 1, lane.goal))
            }
        }
    }

    /// The description of each track's ground, and of the belly's if it has its own.
    fn lanes(
        left: &Terrain,
        right: &Terrain,
        middle: Option<&Terrain>,
    ) -> Result<Self, ScenarioError> {
        let first = Described::new("terrain.left", left)?;
        let second = Described::new("terrain.right", right)?;
        let third = middle
            .map(|lane| Described::new("terrain.middle", lane))
            .transpose()?
            .map(|lane| lane.profile);
        let goal = first.goal.max(second.goal);
        let ground = if left == right {
            // If both tracks meet the same profile, they are simulated as one.
            let own = third.filter(|_| middle != Some(left));
            let own = own.map(|profile| profile.under(Side::Middle));
            let lanes = std::iter::once(first.profile).chain(own).collect();
            Self::of(lanes, 1, goal)
        } else {
            Self::apart([first.profile, second.profile], third, goal)?
        };
        let (low, high) = ground.extent();
        if !(low..=high).contains(&goal) {
            let rule = format!("must have lanes that all reach its goal at {goal} m");
            let value = format!("x from {low} to {high} m");
            return Err(ScenarioError::new("terrain", value, rule));
        }
        Ok(ground)
    }

    /// Level tops and vertical faces under the left track, the right one and the belly.
    fn skylines(lanes: &[Skyline; 3], surface: Surface) -> Result<Self, ScenarioError> {
        let end = lanes[2].end();
        let profile = |skyline: &Skyline| {
            let points = skyline.points(-RUN_OUT.value(), end + RUN_OUT.value());
            let Surface {
                edge_radius,
                friction,
            } = surface;
            Profile::new("terrain", &points, edge_radius, friction, true)
        };
        if lanes[0] == lanes[1] {
            return Ok(Self::of(vec![profile(&lanes[0])?], 1, end));
        }
        let [left, right, middle] = lanes;
        let tracks = [profile(left)?, profile(right)?];
        Self::apart(tracks, Some(profile(middle)?), end)
    }

    /// A profile under each track; without a profile of its own, the belly meets the higher of the two.
    ///
    /// # Errors
    /// They have no common stretch of x.
    pub fn apart(
        [left, right]: [Profile; 2],
        middle: Option<Profile>,
        goal: f64,
    ) -> Result<Self, ScenarioError> {
        let middle = match middle {
            Some(middle) => middle,
            None => upper::envelope("terrain", &left, &right)?,
        };
        let lanes = vec![
            left.under(Side::Left),
            right.under(Side::Right),
            middle.under(Side::Middle),
        ];
        Ok(Self::of(lanes, 2, goal))
    }

    fn of(lanes: Vec<Profile>, tracks: usize, goal: f64) -> Self {
        let first = |profile: &Profile| {
            let edges = &profile.edges;
            let ahead = edges.iter().find(|edge| edge.x >= -COLLINEAR.value());
            ahead.or(edges.first()).map(|edge| edge.x)
        };
        let first_edge = lanes.iter().filter_map(first).reduce(f64::min);
        Self {
            lanes,
            tracks,
            goal,
            first_edge: first_edge.unwrap_or(0.0),
        }
    }

    /// The corners of all lanes.
    pub fn edges(&self) -> Vec<Edge> {
        let edges = self.lanes.iter().flat_map(|lane| &lane.edges);
        edges.copied().collect()
    }

    /// Whether another ground has its lanes under the same parts of a robot.
    pub(crate) fn has_lanes_of(&self, other: &Self) -> bool {
        (self.tracks, self.lanes.len()) == (other.tracks, other.lanes.len())
    }

    /// Index of the lane under the belly.
    pub fn middle(&self) -> usize {
        self.lanes.len() - 1
    }

    /// [m] Smallest and largest x common to all lanes.
    pub fn extent(&self) -> (f64, f64) {
        let extents = self.lanes.iter().map(Profile::extent);
        extents.fold((f64::NEG_INFINITY, f64::INFINITY), |(low, high), (a, b)| {
            (low.max(a), high.min(b))
        })
    }

    /// [rad] Angle of the ground at x, mean of both tracks.
    pub(crate) fn angle_at(&self, x: f64) -> f64 {
        let angles = self.lanes[..self.tracks]
            .iter()
            .map(|lane| lane.angle_at(x));
        angles.sum::<f64>() / self.tracks as f64
    }

    /// [m] Height of the lowest point of all lanes.
    pub(crate) fn lowest(&self) -> f64 {
        let heights = self.lanes.iter().map(Profile::lowest);
        heights.fold(f64::INFINITY, f64::min)
    }

    /// [m] Height of the highest point of all lanes.
    pub(crate) fn highest(&self) -> f64 {
        let points = self.lanes.iter().flat_map(|lane| &lane.points);
        points.fold(f64::NEG_INFINITY, |high, point| high.max(point.y))
    }

    /// [m] The scenario's goal, or else the terrain's.
    pub fn goal_of(&self, scenario: &Scenario) -> f64 {
        scenario.goal.unwrap_or(self.goal)
    }
}

impl Described {
    fn new(path: &str, terrain: &Terrain) -> Result<Self, ScenarioError> {
        let obstacle = obstacle::of(terrain);
        let goal = obstacle.goal;
        let profile = Profile::new(
            path,
            &obstacle.points,
            obstacle.surface.edge_radius,
            obstacle.surface.friction,
            true,
        )?;
        let (low, high) = profile.extent();
        if !(low..=high).contains(&goal) {
            let rule = format!("must lie on the terrain, from {low} to {high} m");
            return Err(ScenarioError::new(format!("{path}.goal"), goal, rule));
        }
        Ok(Self { profile, goal })
    }
}
