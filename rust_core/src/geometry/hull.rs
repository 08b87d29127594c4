//! The convex hull of discs, found by rolling a tangent once round.

use std::f64::consts::TAU;

use super::Disc;

/// [rad] Smaller turns are rounding errors of collinear tangents.
pub(super) const SAME_TURN: f64 = 1e-12;

/// One disc's share of the hull.
pub(super) struct Arc {
    pub disc: usize,
    /// [rad] Outward direction at its start.
    pub from: f64,
    /// [rad] How far it turns, clockwise.
    pub sweep: f64,
}

/// The arcs of the hull, clockwise, found by rolling a tangent once round.
pub(super) fn arcs_round(discs: &[Disc]) -> Vec<Arc> {
    let down = -0.25 * TAU;
    let support = |d: &Disc| d.radius - d.center.y;
    // Start at the rearmost of the lowest discs, where the tangent leaves them.
    let first = (0..discs.len()).fold(0, |best, i| {
        let (a, b) = (&discs[i], &discs[best]);
        let lower = support(a) - support(b);
        let rearmost = lower.abs() <= SAME_TURN && a.center.x < b.center.x;
        if lower > SAME_TURN || rearmost {
            i
        } else {
            best
        }
    });
    let (mut disc, mut from, mut turned) = (first, down, 0.0);
    let mut arcs: Vec<Arc> = Vec::new();
    // A hull has fewer than two arcs per disc; more would be an endless loop caused by rounding.
    for _ in 0..2 * discs.len() {
        let distance = |i: usize| (discs[i].center - discs[disc].center).length();
        let next = (0..discs.len())
            .filter_map(|other| Some((other, turn_to(&discs[disc], &discs[other], from)?)))
            .reduce(|best, other| {
                // Of several discs on one tangent take the farthest, so that a run is one piece.
                let same = (best.1 - other.1).abs() < SAME_TURN;
                let nearer = distance(other.0) < distance(best.0);
                if (same && nearer) || (!same && best.1 < other.1) {
                    best
                } else {
                    other
                }
            });
        let (to, turn) = next.unwrap_or((disc, TAU));
        let left = TAU - turned;
        if turn > left + SAME_TURN && !arcs.is_empty() {
            // Once round: the rest belongs to the first arc, which began half-way.
            arcs[0].from += left;
            arcs[0].sweep += left;
            break;
        }
        arcs.push(Arc {
            disc,
            from,
            sweep: turn.min(left),
        });
        if turn > left - SAME_TURN {
            break;
        }
        (disc, from, turned) = (to, from - turn, turned + turn);
    }
    arcs
}

/// [rad] How far the outward direction turns clockwise on `disc` until `other` reaches as far out.
fn turn_to(disc: &Disc, other: &Disc, outward: f64) -> Option<f64> {
    let way = other.center - disc.center;
    let distance = way.length();
    let smaller = disc.radius - other.radius;
    if distance <= smaller.abs() {
        return None;
    }
    let tangent = libm::atan2(way.y, way.x) + libm::acos(smaller / distance);
    let turn = (outward - tangent).rem_euclid(TAU);
    Some(if turn > TAU - SAME_TURN { 0.0 } else { turn })
}
