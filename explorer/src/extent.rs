//! The stretch of ground that a robot visits, which a picture of a run has to show.

use crawler2d_core::{Ground, Vector};

use crate::carrier::{Carrier, placed};

/// [m] Margin round the extent of a run.
const MARGIN: f64 = 0.05;

/// [m] Left, right, bottom and top.
pub(crate) fn of(carriers: &[Carrier], ground: &Ground) -> [f64; 4] {
    let chassis = &carriers[0];
    let reach = MARGIN
        + chassis
            .circles
            .iter()
            .map(|(center, radius)| center.length() + radius)
            .fold(0.0, f64::max);
    let below = chassis
        .circles
        .iter()
        .map(|circle| circle.1)
        .fold(0.0, f64::max);
    let mut seen = Extent::default();
    for [x, y, _] in &chassis.poses {
        seen.add([x - reach, x + reach, y - below, y + reach]);
    }
    for arm in &carriers[1..] {
        for (center, radius) in &arm.circles {
            for pose in &arm.poses {
                let Vector { x, y, .. } = placed(*center, *pose);
                let wide = radius + MARGIN;
                seen.add([x - wide, x + wide, y - radius, y + wide]);
            }
        }
    }
    let Extent([left, right, low, high]) = seen;
    let surface = heights(ground, left, right);
    let lowest = surface.iter().copied().fold(low, f64::min);
    let highest = surface.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [left, right, lowest - MARGIN, highest.max(high)]
}

struct Extent([f64; 4]);

impl Default for Extent {
    fn default() -> Self {
        let (most, least) = (f64::INFINITY, f64::NEG_INFINITY);
        Self([most, least, most, least])
    }
}

impl Extent {
    fn add(&mut self, [left, right, low, high]: [f64; 4]) {
        let Self(now) = self;
        *now = [
            now[0].min(left),
            now[1].max(right),
            now[2].min(low),
            now[3].max(high),
        ];
    }
}

/// [m] Heights of the ground under the tracks, at two positions and at its points between them.
fn heights(ground: &Ground, left: f64, right: f64) -> Vec<f64> {
    let mut found = Vec::new();
    for lane in &ground.lanes[..ground.tracks] {
        let inside = lane.points.iter().filter(|p| left < p.x && p.x < right);
        found.extend(inside.map(|point| point.y));
        found.extend([left, right].map(|x| height(&lane.points, x)));
    }
    found
}

/// [m] Height of a line of points at a position; beyond its ends, the height of the end.
fn height(points: &[Vector], x: f64) -> f64 {
    let after = points.partition_point(|point| point.x <= x);
    let (Some(a), Some(b)) = (
        after.checked_sub(1).and_then(|i| points.get(i)),
        points.get(after),
    ) else {
        return points[after.min(points.len() - 1)].y;
    };
    a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y)
}
