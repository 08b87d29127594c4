//! Builds the profiles on which contacts are computed from the described terrain.

mod friction;
mod obstacle;
mod profile;
mod straight;

use obstacle::{Obstacle, RUN_OUT, Skyline};
use straight::COLLINEAR;

pub(crate) use profile::facet_along;
pub(crate) use straight::{FINE, STRAIGHT};

use crate::geometry::Vector;
use crate::scenario::{Scenario, ScenarioError, Surface, Terrain};
pub use friction::GroundFriction;
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
    /// [m] The x at which the obstacle begins: the first edge at or beyond x = 0, or an earlier beginning of a field;
    /// otherwise the first edge of all, otherwise 0.
    pub first_edge: f64,
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
                let lanes = obstacle::barrier((*height, *thickness), *yaw, 0.0, gauge);
                Self::skylines(&lanes, *surface)
            }
            Terrain::RandomStepfield(field) => {
                let lanes = obstacle::stepfield(field, gauge);
                Self::skylines(&lanes, field.surface)
            }
            _ => {
                let (lane, goal) = described("terrain", terrain)?;
                Ok(Self::of(vec![lane], 1, goal))
            }
        }
    }

    /// The description of each track's ground, and of the belly's if it has its own.
    fn lanes(
        left: &Terrain,
        right: &Terrain,
        middle: Option<&Terrain>,
    ) -> Result<Self, ScenarioError> {
        let (first, goal) = described("terrain.left", left)?;
        let (second, other) = described("terrain.right", right)?;
        let third = middle.map(|lane| described("terrain.middle", lane));
        let third = third.transpose()?.map(|(lane, _)| lane);
        let goal = goal.max(other);
        let ground = if left == right {
            // If both tracks meet the same profile, they are simulated as one.
            let own = third.filter(|_| middle != Some(left));
            let own = own.map(|profile| profile.under(Side::Middle));
            let lanes = std::iter::once(first).chain(own).collect();
            Self::of(lanes, 1, goal)
        } else {
            Self::apart([first, second], third, goal)?
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
        // A barrier longer than its field begins before that.
        let begin = lanes[2].begin().min(0.0);
        let profile = |skyline: &Skyline| {
            let points = skyline.points(begin - RUN_OUT.value(), end + RUN_OUT.value());
            Profile::new("terrain", &points, surface, true)
        };
        let mut ground = if lanes[0] == lanes[1] {
            Self::of(vec![profile(&lanes[0])?], 1, end)
        } else {
            let [left, right, middle] = lanes;
            let tracks = [profile(left)?, profile(right)?];
            Self::apart(tracks, Some(profile(middle)?), end)?
        };
        ground.first_edge = first_edge(&ground.lanes, begin);
        Ok(ground)
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
        let first_edge_of_tracks = first_edge([&left, &right], 0.0);
        let is_given = middle.is_some();
        let middle = match middle {
            Some(middle) => middle,
            None => upper_envelope("terrain", &left, &right)?,
        };
        let lanes = vec![
            left.under(Side::Left),
            right.under(Side::Right),
            middle.under(Side::Middle),
        ];
        let mut ground = Self::of(lanes, 2, goal);
        if !is_given {
            // The envelope also has corners where lanes cross, and all along their arcs.
            ground.first_edge = first_edge_of_tracks;
        }
        Ok(ground)
    }

    fn of(lanes: Vec<Profile>, tracks: usize, goal: f64) -> Self {
        Self {
            first_edge: first_edge(&lanes, 0.0),
            lanes,
            tracks,
            goal,
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

    /// [m] The height under the first track at an x: of the upper end at a vertical face, and of the end of the ground
    /// beyond that.
    pub(crate) fn height(&self, x: f64) -> f64 {
        let profile = &self.lanes[0];
        let [first, last] = [0, profile.points.len() - 1].map(|i| profile.points[i].x);
        let [before, behind] = heights_at(profile, x.clamp(first, last));
        before.max(behind)
    }

    /// [m] The goal of the scenario, or else of the terrain.
    pub fn goal_of(&self, scenario: &Scenario) -> f64 {
        scenario.goal.unwrap_or(self.goal)
    }
}

/// [m] The first edge at or beyond the x [m] where an obstacle begins, else the first of all, else 0.
fn first_edge<'a>(lanes: impl IntoIterator<Item = &'a Profile>, begin: f64) -> f64 {
    let first = |profile: &Profile| {
        let edges = &profile.edges;
        let ahead = (edges.iter()).find(|edge| edge.x >= begin - COLLINEAR.value());
        ahead.or(edges.first()).map(|edge| edge.x)
    };
    let all = lanes.into_iter().filter_map(first);
    all.reduce(f64::min).unwrap_or(0.0)
}

/// One lane of the terrain at a path, with its goal [m].
fn described(path: &str, terrain: &Terrain) -> Result<(Profile, f64), ScenarioError> {
    let Obstacle {
        points,
        goal,
        surface,
    } = obstacle::of(terrain);
    let mut profile = Profile::new(path, &points, surface, true)?;
    if let Terrain::Points {
        segment_friction: Some(frictions),
        ..
    } = terrain
    {
        let segments = points.len() - 1;
        if frictions.len() != segments {
            let path = format!("{path}.segment_friction");
            let value = format!("{} numbers", frictions.len());
            let rule =
                format!("must have one number for each of {segments} segments between points");
            return Err(ScenarioError::new(path, value, rule));
        }
        profile.friction = GroundFriction::of_segments(&points, frictions, surface.edge_radius);
    }
    let (low, high) = profile.extent();
    if !(low..=high).contains(&goal) {
        let rule = format!("must lie on the terrain, from {low} to {high} m");
        return Err(ScenarioError::new(format!("{path}.goal"), goal, rule));
    }
    Ok((profile, goal))
}

/// The upper envelope of two profiles over their common range of x. Arcs become equally fine polylines. Friction is
/// the larger of the two, at each point if it varies along one of them.
///
/// # Errors
/// They have no common stretch of x.
fn upper_envelope(path: &str, a: &Profile, b: &Profile) -> Result<Profile, ScenarioError> {
    let ((a_low, a_high), (b_low, b_high)) = (a.extent(), b.extent());
    let (low, high) = (a_low.max(b_low), a_high.min(b_high));
    if low >= high {
        let value = format!("left {a_low} to {a_high} m, right {b_low} to {b_high} m");
        let rule = "must have lanes with a common stretch of x";
        return Err(ScenarioError::new(path, value, rule));
    }
    let changes = || a.friction.changes().chain(b.friction.changes());
    let corners = a.points.iter().chain(&b.points).map(|p| p.x);
    let within = corners
        .chain(changes())
        .filter(|x| (low..=high).contains(x));
    let mut places: Vec<f64> = within.collect();
    places.extend([low, high]);
    places.sort_unstable_by(f64::total_cmp);
    places.dedup();

    let mut points: Vec<[f64; 2]> = Vec::new();
    for (i, x) in places.iter().enumerate() {
        let sides = [a, b].map(|profile| heights_at(profile, *x));
        let [before, after] = [0, 1].map(|k| sides[0][k].max(sides[1][k]));
        points.extend([[*x, before], [*x, after]]);
        if let Some(next) = places.get(i + 1) {
            let ahead = [a, b].map(|profile| heights_at(profile, *next)[0]);
            let (here, there) = (sides[0][1] - sides[1][1], ahead[0] - ahead[1]);
            if here * there < 0.0 {
                let fraction = here / (here - there);
                let y = sides[0][1] + fraction * (ahead[0] - sides[0][1]);
                points.push([x + fraction * (next - x), y]);
            }
        }
    }
    // Before the first and behind the last there is no ground.
    points.remove(0);
    points.pop();
    let surface = Surface {
        edge_radius: 0.0,
        friction: a.friction.most().or_larger(b.friction.most()),
    };
    let mut profile = Profile::new(path, &points, surface, true)?;
    if changes().next().is_some() {
        let pieces = points.windows(2);
        let frictions = pieces.map(|ends| larger_friction([a, b], [ends[0], ends[1]]));
        let frictions: Vec<f64> = frictions.collect();
        profile.friction = GroundFriction::of_segments(&points, &frictions, 0.0);
    }
    Ok(profile)
}

/// The larger coefficient of two profiles on a piece of their envelope, including profiles below it.
fn larger_friction(profiles: [&Profile; 2], ends: [[f64; 2]; 2]) -> f64 {
    let [x, y] = [0, 1].map(|i| 0.5 * (ends[0][i] + ends[1][i]));
    let is_face = (ends[1][0] - ends[0][0]).abs() < COLLINEAR.value();
    let found = profiles.map(|profile| {
        let height = if is_face {
            y
        } else {
            heights_at(profile, x)[0]
        };
        profile.friction.at(Vector::new(x, height))
    });
    found[0].or_larger(found[1]).coefficient
}

/// [m] Heights of a profile just before and just behind an x.
fn heights_at(profile: &Profile, x: f64) -> [f64; 2] {
    let points = &profile.points;
    let from = points.partition_point(|p| p.x < x);
    let to = points.partition_point(|p| p.x <= x);
    if from < to {
        return [points[from].y, points[to - 1].y];
    }
    let on = |a: Vector, b: Vector| a.y + (x - a.x) * (b.y - a.y) / (b.x - a.x);
    [on(points[from - 1], points[from]); 2]
}

#[cfg(test)]
mod tests;
