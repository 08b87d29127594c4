//! The convex hull of discs: found by rolling a tangent once round, and made of arcs and straight runs. parry's hulls are of
//! points.

use std::f64::consts::TAU;

use super::{Disc, Vector, cross, direction};

/// [rad] Smaller turns are rounding errors of collinear tangents.
pub(super) const SAME_TURN: f64 = 1e-12;

/// One disc's fraction of the hull.
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
            // Once round: the rest belongs to the first arc, which began half-line.
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
    let axis = other.center - disc.center;
    let distance = axis.length();
    let smaller = disc.radius - other.radius;
    if distance <= smaller.abs() {
        return None;
    }
    let tangent = libm::atan2(axis.y, axis.x) + libm::acos(smaller / distance);
    let turn = (outward - tangent).rem_euclid(TAU);
    Some(if turn > TAU - SAME_TURN { 0.0 } else { turn })
}

/// [m, rad] Stretches overlap by this, so that no line can slip between two of them.
const JOINT: f64 = 1e-9;

/// One stretch of the hull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// [m] Position of its start along the hull.
    pub start: f64,
    /// [m] Its length.
    pub length: f64,
    pub curve: Curve,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    /// An arc of disc `disc`, clockwise from the outward direction `from` [rad]; `ends` are its
    /// first and last outward directions.
    Arc {
        disc: usize,
        center: Vector,
        radius: f64,
        from: f64,
        sweep: f64,
        ends: [Vector; 2],
    },
    /// A straight run from `begin` along `along`.
    Run {
        begin: Vector,
        along: Vector,
        outward: Vector,
    },
}

impl Stretch {
    pub(super) fn point_at(&self, inner: f64) -> Vector {
        match self.curve {
            Curve::Arc {
                center,
                radius,
                from,
                sweep,
                ..
            } => {
                let fraction = if self.length > 0.0 {
                    inner / self.length
                } else {
                    0.0
                };
                center + direction(from - sweep * fraction) * radius
            }
            Curve::Run { begin, along, .. } => begin + along * inner,
        }
    }

    /// [m] Position of the point ahead of `from` at a straight `distance` from it.
    pub(super) fn at_distance(&self, from: Vector, distance: f64) -> f64 {
        match self.curve {
            Curve::Run { begin, along, .. } => {
                let offset = begin - from;
                let back = offset.dot(along);
                let root = back * back - offset.length_squared() + distance * distance;
                root.max(0.0).sqrt() - back
            }
            Curve::Arc {
                center,
                radius,
                from: start,
                ..
            } => {
                let spoke = from - center;
                let reach = spoke.length();
                let cosine = (radius * radius + reach * reach - distance * distance)
                    / (2.0 * radius * reach);
                let angle = libm::atan2(spoke.y, spoke.x) - libm::acos(cosine.clamp(-1.0, 1.0));
                (start - angle).rem_euclid(TAU) * radius
            }
        }
    }

    /// [m] Depth of a point below this stretch, if the point is within its extent.
    pub(super) fn depth(&self, point: Vector) -> Option<f64> {
        match self.curve {
            Curve::Run { begin, outward, .. } => Some((begin - point).dot(outward)),
            Curve::Arc {
                center,
                radius,
                sweep,
                ends,
                ..
            } => {
                let spoke = point - center;
                is_on_arc(spoke, ends, sweep, 0.0).then(|| radius - spoke.length())
            }
        }
    }

    /// Calls `cut` with the fractions of the segment at which it crosses this stretch.
    pub(super) fn crossings(&self, a: Vector, b: Vector, cut: &mut impl FnMut(f64)) {
        let line = b - a;
        match self.curve {
            Curve::Run {
                begin,
                along,
                outward,
            } => {
                let towards = line.dot(outward);
                let t = (begin - a).dot(outward) / towards;
                let along = (a + line * t - begin).dot(along);
                let on_run = (-JOINT..=self.length + JOINT).contains(&along);
                if (0.0..=1.0).contains(&t) && on_run {
                    cut(t);
                }
            }
            Curve::Arc {
                center,
                radius,
                sweep,
                ends,
                ..
            } => {
                let (offset, square) = (a - center, line.length_squared());
                let half = offset.dot(line) / square;
                let rest = half * half - (offset.length_squared() - radius * radius) / square;
                if rest < 0.0 {
                    return;
                }
                for t in [-half - rest.sqrt(), -half + rest.sqrt()] {
                    let spoke = offset + line * t;
                    if (0.0..=1.0).contains(&t) && is_on_arc(spoke, ends, sweep, JOINT * radius) {
                        cut(t);
                    }
                }
            }
        }
    }

    /// [m^2] Twice the signed area between the origin and this stretch between two positions.
    pub(super) fn swept(&self, from: f64, to: f64) -> f64 {
        let (p, q) = (self.point_at(from), self.point_at(to));
        match self.curve {
            Curve::Run { .. } => cross(p, q),
            Curve::Arc { center, radius, .. } => cross(center, q - p) - radius * (to - from),
        }
    }
}

/// Whether a vector from the centre points through a clockwise arc, with a margin at its ends.
fn is_on_arc(spoke: Vector, [first, last]: [Vector; 2], sweep: f64, margin: f64) -> bool {
    let (after_first, before_last) = (cross(spoke, first), cross(last, spoke));
    if sweep > 0.5 * TAU {
        after_first >= -margin || before_last >= -margin
    } else {
        after_first >= -margin && before_last >= -margin
    }
}
