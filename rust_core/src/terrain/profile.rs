//! One lane as a polyline with edges, and positions along it.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::friction::GroundFriction;
use super::straight::{COLLINEAR, bends, without_collinear};
use crate::geometry::{Vector, left_of};
use crate::scenario::{ScenarioError, Surface};
use crate::units::Metres;

/// [rad] Turn of one facet of a rounded edge; at a radius of 20 mm, it is 0.8 um below its true arc.
const FACET_TURN: f64 = 0.0175;
/// Largest number of facets of a lane; so many are built in well under a second.
const MAX_FACETS: f64 = 1e6;

/// The part of the robot above a profile; the code is the `lane` of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// Under both tracks, and the belly unless it has its own.
    Both = 0,
    /// Under the left track.
    Left = 1,
    /// Under the right track.
    Right = 2,
    /// Under the belly.
    Middle = 3,
}

impl Side {
    /// All of them, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::Both, Self::Left, Self::Right, Self::Middle];

    /// Name as in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::Left => "left",
            Self::Right => "right",
            Self::Middle => "middle",
        }
    }
}

/// One lane: a polyline from left to right with the rounded edges cut into facets.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The part of the robot that it is under.
    pub side: Side,
    /// [m] Points from left to right; x never decreases.
    pub points: Vec<Vector>,
    /// Edge that each point belongs to, or -1.
    pub edge_of_point: Vec<i32>,
    /// Corners of the described ground.
    pub edges: Vec<Edge>,
    /// Friction with the robot.
    pub friction: GroundFriction,
    /// Number of points left out because they repeat or continue their neighbours.
    pub merged: usize,
    /// Indices of the points at which it bends.
    bends: Vec<u32>,
}

/// A corner of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Lane that it is on.
    pub side: Side,
    /// Number on its lane, counted from the left.
    pub id: i32,
    /// [m] Position of the corner (of the sharp corner, if rounded).
    pub x: f64,
    /// [m] Position of the corner, likewise.
    pub y: f64,
    /// [rad] Turn of the ground there, clockwise positive: convex edges > 0, inner corners < 0.
    pub angle: f64,
    /// [m] Radius, 0 is sharp.
    pub radius: f64,
    /// [m] Centre of the arc, or the corner itself if sharp.
    pub center: Vector,
    /// Its first and last points; an arc that takes up a whole face shares one with the edge at its other end.
    pub(crate) span: [u32; 2],
}

impl Profile {
    /// Orders, merges, checks and rounds a list of points; without `merge`, collinear points stay.
    ///
    /// # Errors
    /// Fewer than two distinct points, an overhang, a spike, an edge radius that does not fit.
    pub fn new(
        path: &str,
        given: &[[f64; 2]],
        surface: Surface,
        merge: bool,
    ) -> Result<Self, ScenarioError> {
        let mut points: Vec<(usize, Vector)> = given
            .iter()
            .map(|p| Vector::new(p[0], p[1]))
            .enumerate()
            .collect();
        if points
            .first()
            .zip(points.last())
            .is_some_and(|(a, b)| a.1.x > b.1.x)
        {
            points.reverse();
        }
        points.dedup_by(|b, a| a.1 == b.1);
        if points.len() < 2 {
            let value = format!("{} distinct points", points.len());
            let rule = "must have at least 2 distinct points";
            return Err(ScenarioError::new(format!("{path}.points"), value, rule));
        }
        check_overhangs(path, &points)?;
        let mut points: Vec<Vector> = points.into_iter().map(|(_, p)| p).collect();
        if merge {
            points = without_collinear(&points);
        }
        let merged = given.len() - points.len();
        let mut profile = Self {
            side: Side::Both,
            points: Vec::new(),
            edge_of_point: Vec::new(),
            edges: Vec::new(),
            friction: GroundFriction::everywhere(surface.friction),
            merged,
            bends: Vec::new(),
        };
        profile.round(path, &points, surface.edge_radius)?;
        profile.bends = bends(&profile.points, |i| {
            let edge = usize::try_from(profile.edge_of_point[i]);
            edge.is_ok_and(|edge| profile.edges[edge].radius > 0.0)
        });
        Ok(profile)
    }

    /// Walks along the corners and replaces each convex one by an arc of this radius.
    fn round(&mut self, path: &str, corners: &[Vector], radius: f64) -> Result<(), ScenarioError> {
        // The facets of a smaller arc would have no length.
        let radius = if radius < COLLINEAR.value() {
            0.0
        } else {
            radius
        };
        if radius > 0.0 {
            check_facets(path, corners, radius)?;
        }
        let mut taken = 0.0; // [m] length of the segment that the previous arc takes up
        self.push(corners[0], -1);
        for i in 1..corners.len() - 1 {
            let (before, corner, behind) = (corners[i - 1], corners[i], corners[i + 1]);
            let (d1, angle) = turn(before, corner, behind);
            if angle.abs() * (corner - before).length().min((behind - corner).length())
                < COLLINEAR.value()
            {
                taken = 0.0;
                self.push(corner, -1);
                continue;
            }
            let id = self.edges.len() as i32;
            // A shorter arc would have both ends in one point, and no normals.
            let rounded = radius * angle >= COLLINEAR.value();
            let tangent = if rounded {
                radius * libm::tan(0.5 * angle)
            } else {
                0.0
            };
            let (to_last, to_next) = (
                (corner - before).length() - taken,
                (behind - corner).length(),
            );
            let room = to_last.min(to_next);
            if rounded && tangent > room * (1.0 + 1e-12) {
                let rule = format!(
                    "must fit the edge at ({}, {}), whose arc needs {tangent} m of {room} m",
                    corner.x, corner.y
                );
                let path = format!("{path}.edge_radius");
                return Err(ScenarioError::new(path, radius, rule));
            }
            // The rest of a face beside an arc has no direction if it is no longer than this.
            let is_joined = taken + tangent > 0.0 && to_last - tangent < COLLINEAR.value();
            taken = tangent;
            let outward = left_of(d1);
            let start = corner - d1 * tangent;
            let radius = if rounded { radius } else { 0.0 };
            let center = start - outward * radius;
            let facets = if rounded { facets(angle) } else { 0.0 };
            let point = |k: usize| {
                if !rounded {
                    return corner;
                }
                if k == facets as usize && to_next - tangent < COLLINEAR.value() {
                    return behind;
                }
                let (s, c) = libm::sincos(-angle * k as f64 / facets);
                let spoke =
                    Vector::new(c * outward.x - s * outward.y, s * outward.x + c * outward.y);
                center + spoke * radius
            };
            let first = if is_joined {
                self.points.len() as u32 - 1
            } else {
                self.push(point(0), id)
            };
            let last = (1..=facets as usize).fold(first, |_, k| self.push(point(k), id));
            self.edges.push(Edge {
                side: self.side,
                id,
                x: corner.x,
                y: corner.y,
                angle,
                radius,
                center,
                span: [first, last],
            });
        }
        self.push(corners[corners.len() - 1], -1);
        Ok(())
    }

    /// Adds a point and returns its index; of two edges that meet in it, one is stored.
    fn push(&mut self, point: Vector, edge: i32) -> u32 {
        let is_it = |last: &Vector| (*last - point).length() < 1e-12;
        if !self.points.last().is_some_and(is_it) {
            self.points.push(point);
            self.edge_of_point.push(edge);
        }
        self.points.len() as u32 - 1
    }

    /// The same profile under another part of the robot.
    pub(super) fn under(mut self, side: Side) -> Self {
        self.side = side;
        for edge in &mut self.edges {
            edge.side = side;
        }
        self
    }

    /// Indices of the points at which it bends, including both ends; in between it is straight, for contacts
    /// and for ground inside a track.
    pub(crate) fn bends(&self) -> &[u32] {
        &self.bends
    }

    /// [m] Smallest and largest x.
    pub fn extent(&self) -> (f64, f64) {
        (self.points[0].x, self.points[self.points.len() - 1].x)
    }

    /// [m] Height of the lowest point.
    pub(crate) fn lowest(&self) -> f64 {
        self.points
            .iter()
            .map(|p| p.y)
            .fold(f64::INFINITY, f64::min)
    }

    /// Facets that a range of x touches.
    pub(crate) fn facets(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let first = self.points.partition_point(|p| p.x < low).saturating_sub(1);
        let last = self
            .points
            .partition_point(|p| p.x <= high)
            .min(self.points.len() - 1);
        first..last
    }

    /// [rad] Angle of the ground at x; of the right-hand facet at a corner.
    pub fn angle_at(&self, x: f64) -> f64 {
        let last = self.points.len() - 2;
        let facet = self.points.partition_point(|p| p.x <= x).clamp(1, last + 1) - 1;
        let d = self.points[facet + 1] - self.points[facet];
        libm::atan2(d.y, d.x)
    }

    /// Whether a disc is above all ground beside and below it.
    pub(crate) fn is_clear_of(&self, center: Vector, radius: f64) -> bool {
        let under = self.facets(center.x - radius, center.x + radius);
        let below = center.y - radius;
        self.points[under.start..(under.end + 1).min(self.points.len())]
            .iter()
            .all(|p| p.y < below)
    }

    /// [m] Height of the centre of a disc above `x` at which it just touches the ground.
    pub fn height_under_disc(&self, x: f64, radius: f64) -> f64 {
        let mut height = f64::NEG_INFINITY;
        for i in self.facets(x - radius, x + radius) {
            let (a, b) = (self.points[i], self.points[i + 1]);
            for corner in [a, b] {
                let reach = radius * radius - (corner.x - x) * (corner.x - x);
                if reach >= 0.0 {
                    height = height.max(corner.y + reach.sqrt());
                }
            }
            let d = (b - a).normalize();
            let foot = x + radius * d.y;
            if (a.x..=b.x).contains(&foot) && d.x > 0.0 {
                height = height.max(a.y + (foot - a.x) * d.y / d.x + radius * d.x);
            }
        }
        height
    }

    /// [m] Largest rise of the ground above the segment from `a` to `b`, `a` left of `b`.
    pub fn rise_over_segment(&self, a: Vector, b: Vector) -> f64 {
        let mut rise = self.height_under_disc(a.x, 0.0) - a.y;
        rise = rise.max(self.height_under_disc(b.x, 0.0) - b.y);
        for i in self.facets(a.x, b.x) {
            for p in [self.points[i], self.points[i + 1]] {
                if p.x > a.x && p.x < b.x {
                    rise = rise.max(p.y - (a.y + (p.x - a.x) * (b.y - a.y) / (b.x - a.x)));
                }
            }
        }
        rise
    }
}

/// Direction of the ground before a corner, and its turn there [rad], clockwise positive.
fn turn(before: Vector, corner: Vector, behind: Vector) -> (Vector, f64) {
    let (d1, d2) = ((corner - before).normalize(), (behind - corner).normalize());
    (d1, libm::atan2(d1.y * d2.x - d1.x * d2.y, d1.dot(d2)))
}

/// Number of facets of an arc that turns by an angle [rad].
fn facets(angle: f64) -> f64 {
    (angle / FACET_TURN).ceil().max(1.0)
}

/// Checks that all arcs together do not need more facets than a ground may have.
fn check_facets(path: &str, corners: &[Vector], radius: f64) -> Result<(), ScenarioError> {
    let turns = corners.windows(3).map(|c| turn(c[0], c[1], c[2]).1);
    let all: f64 = turns.filter(|turn| *turn > 0.0).map(facets).sum();
    if all <= MAX_FACETS {
        return Ok(());
    }
    let rule = format!(
        "must be 0 on a ground with so many edges, which would take {all} facets if rounded; the maximum is {MAX_FACETS}"
    );
    let path = format!("{path}.edge_radius");
    Err(ScenarioError::new(path, radius, rule))
}

#[allow(clippy::float_cmp)] // the points of a vertical face have exactly one x
fn check_overhangs(path: &str, points: &[(usize, Vector)]) -> Result<(), ScenarioError> {
    let error = |row: usize, point: Vector, rule: String| {
        let value = format!("[{}, {}]", point.x, point.y);
        Err(ScenarioError::new(
            format!("{path}.points[{row}]"),
            value,
            rule,
        ))
    };
    for (i, pair) in points.windows(2).enumerate() {
        let ((_, a), (row, b)) = (pair[0], pair[1]);
        if b.x < a.x {
            let rule = format!(
                "must not lie behind its neighbour at x = {}: overhangs are not allowed",
                a.x
            );
            return error(row, b, rule);
        }
        if let Some((_, c)) = points.get(i + 2)
            && a.x == b.x
            && b.x == c.x
            && (b.y - a.y) * (c.y - b.y) < 0.0
        {
            let rule = format!(
                "must not be a spike, where segments {i} and {} coincide",
                i + 1
            );
            return error(row, b, rule);
        }
    }
    if points[0].1.x == points[points.len() - 1].1.x {
        let rule = "must extend along x, not be only a vertical wall";
        let value = format!("x = {} only", points[0].1.x);
        return Err(ScenarioError::new(format!("{path}.points"), value, rule));
    }
    Ok(())
}

/// [m] A contact this close to a vertex touches the edge, not the face beside it.
const AT_VERTEX: Metres = Metres(1e-7);

impl Profile {
    /// Position along the profile of a point on a facet, as the index of the facet plus a fraction of it.
    pub(crate) fn place_on(&self, facet: usize, point: Vector) -> f64 {
        let (a, b) = (self.points[facet], self.points[facet + 1]);
        let (chord, length) = (b - a, (b - a).length());
        let fraction = (point - a).dot(chord) / (length * length);
        facet as f64 + fraction.clamp(0.0, 1.0)
    }

    /// The point at such a position.
    pub(crate) fn point_at(&self, place: f64) -> Vector {
        let facet = (place as usize).min(self.points.len() - 2);
        let (a, b) = (self.points[facet], self.points[facet + 1]);
        a + (b - a) * (place - facet as f64)
    }

    /// The same for a fraction of a straight piece of facets.
    pub(crate) fn place_along(&self, facets: Range<usize>, fraction: f64) -> f64 {
        if facets.len() == 1 {
            return facets.start as f64 + fraction;
        }
        let (begin, end) = (self.points[facets.start], self.points[facets.end]);
        let point = begin + (end - begin) * fraction;
        self.place_on(facet_along(&self.points, facets, fraction), point)
    }

    /// The edge that a point on a facet touches, or -1 on a face.
    pub(crate) fn edge_at(&self, facet: usize, point: Vector) -> i32 {
        let (left, right) = (self.edge_of_point[facet], self.edge_of_point[facet + 1]);
        let on_arc = left == right && left >= 0;
        if on_arc || (point - self.points[facet]).length() < AT_VERTEX.value() {
            left
        } else if (point - self.points[facet + 1]).length() < AT_VERTEX.value() {
            right
        } else {
            -1
        }
    }
}

/// The facet at a fraction of the way along a straight piece of facets.
pub(crate) fn facet_along(points: &[Vector], facets: Range<usize>, fraction: f64) -> usize {
    let Range { start, end } = facets;
    if end <= start + 1 {
        return start;
    }
    let chord = points[end] - points[start];
    let far = fraction * chord.length_squared();
    let is_behind = |i: usize| (points[i] - points[start]).dot(chord) <= far;
    let guess = likely_facet(start..end, fraction);
    if is_behind(guess) && !is_behind(guess + 1) {
        return guess;
    }
    let (mut facet, mut behind) = (start, end);
    while facet + 1 < behind {
        let middle = facet.midpoint(behind);
        if is_behind(middle) {
            facet = middle;
        } else {
            behind = middle;
        }
    }
    facet
}

/// The facet there if all are equally long, as they often are.
fn likely_facet(facets: Range<usize>, fraction: f64) -> usize {
    let count = facets.len();
    let before = (fraction * count as f64).max(0.0) as usize;
    facets.start + before.min(count - 1)
}

#[cfg(test)]
mod tests;
