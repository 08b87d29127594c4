//! Whether a robot overlaps with the ground in a pose.

use super::contact::{Posture, Turn};
use super::layout::{Layout, Solid};
use super::places::{Facing, Place};
use crate::geometry::{Disc, Vector, left_of};

/// Whether no part reaches into the ground by more than a tolerance [m].
///
/// Faces and the arcs of corners are the whole surface. A part that touches none of it is outside the ground, unless it
/// is entirely inside; so one of its points must be above the ground.
pub(super) fn is_clear(
    layout: &Layout,
    places: &[Place],
    posture: &Posture,
    tolerance: f64,
) -> bool {
    let turn = Turn::by(posture.angle);
    let placed = |v: Vector| posture.position + turn.apply(v);
    layout.solids.iter().all(|solid| {
        let discs: Vec<Disc> = solid
            .discs
            .iter()
            .map(|disc| Disc {
                center: placed(disc.center),
                ..*disc
            })
            .collect();
        let of_lane = places.iter().filter(|place| place.lane == solid.lane);
        let runs = || {
            let of = |(outward, offset): &(Vector, f64)| {
                let outward = turn.apply(*outward);
                (outward, offset + outward.dot(posture.position))
            };
            solid.runs.iter().map(of)
        };
        let mut above = false;
        for place in of_lane {
            let (points, radius) = match &place.shape {
                Facing::Face { ends, .. } => (*ends, 0.0),
                Facing::Corner { center, radius, .. } => ([*center; 2], *radius),
            };
            if distance(solid, &discs, runs(), &points, radius) < -tolerance {
                return false;
            }
            above |= match &place.shape {
                Facing::Face { ends, normal } => {
                    let x = discs[0].center.x;
                    let is_over = ends[0].x <= x && x <= ends[1].x && normal.y > 0.0;
                    is_over && normal.dot(discs[0].center - ends[0]) >= -tolerance
                }
                Facing::Corner { center, radius, .. } => {
                    *radius > 0.0 && {
                        let beside = (discs[0].center.x - center.x).abs() <= *radius;
                        beside && discs[0].center.y >= center.y
                    }
                }
            };
        }
        above
    })
}

/// [m] Distance of a part from a segment grown by a radius; negative only if they overlap.
///
/// The distance of two convex bodies is their largest separation along any direction; that direction is normal to a
/// straight run or to the segment, or leads from the centre of an arc to an end.
pub(super) fn distance(
    solid: &Solid,
    discs: &[Disc],
    runs: impl Iterator<Item = (Vector, f64)>,
    points: &[Vector; 2],
    radius: f64,
) -> f64 {
    let [a, b] = *points;
    if let ([disc], true) = (discs, solid.runs.is_empty()) {
        let along = b - a;
        let square = along.length_squared();
        let share = if square > 0.0 {
            ((disc.center - a).dot(along) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        return (a + along * share - disc.center).length() - disc.radius - radius;
    }
    let support = |u: Vector| {
        let of = |disc: &Disc| disc.center.dot(u) + disc.radius;
        discs.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let least = |u: Vector| a.dot(u).min(b.dot(u)) - radius;
    let by_runs = runs.map(|(outward, offset)| least(outward) - offset);
    let mut most = by_runs.fold(f64::NEG_INFINITY, f64::max);
    let mut try_out = |u: Vector| {
        if let Some(u) = u.try_normalize() {
            most = most.max(least(u) - support(u));
        }
    };
    if a != b {
        try_out(left_of(b - a));
        try_out(left_of(a - b));
    }
    for disc in discs {
        try_out(a - disc.center);
        try_out(b - disc.center);
    }
    most
}
