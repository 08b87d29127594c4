//! The convex hull of discs as arcs and straight runs, found by rolling a tangent once round; parry has only hulls of
//! points.

use std::f64::consts::TAU;

use super::{Disc, Vector, cross, direction};

/// [rad, m] Smaller turns are rounding errors of collinear tangents, and smaller distances those of discs that touch.
pub(super) const SAME_TURN: f64 = 1e-12;

/// The arc of the hull round one disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    /// Index of the disc.
    pub disc: usize,
    pub center: Vector,
    pub radius: f64,
    /// [rad] Outward direction at its start.
    pub from: f64,
    /// [rad] Angle of the arc, clockwise.
    pub sweep: f64,
    /// Its first and its last outward direction.
    pub ends: [Vector; 2],
}

impl Arc {
    pub(super) fn new(disc: usize, Disc { center, radius }: Disc, from: f64, sweep: f64) -> Self {
        Self {
            disc,
            center,
            radius,
            from,
            sweep,
            ends: [direction(from), direction(from - sweep)],
        }
    }

    /// Whether a vector from the centre points to the arc, with a margin at its ends.
    fn holds(&self, spoke: Vector, margin: f64) -> bool {
        let [first, last] = self.ends;
        let (after_first, before_last) = (cross(spoke, first), cross(last, spoke));
        if self.sweep > 0.5 * TAU {
            after_first >= -margin || before_last >= -margin
        } else {
            after_first >= -margin && before_last >= -margin
        }
    }
}

/// A straight piece of the hull.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub begin: Vector,
    /// Unit vectors, along belt travel and out of the hull.
    pub along: Vector,
    pub outward: Vector,
}

/// The arcs of the hull, clockwise, found by rolling a tangent once round.
pub(super) fn arcs_round(discs: &[Disc]) -> Vec<Arc> {
    let down = -0.25 * TAU;
    let support = |d: &Disc| d.radius - d.center.y;
    let outer: Vec<usize> = (0..discs.len()).filter(|i| !is_inside(discs, *i)).collect();
    // Start at the rearmost of the lowest discs, where the tangent leaves them.
    let first = outer.iter().copied().reduce(|best, i| {
        let (a, b) = (&discs[i], &discs[best]);
        let lower = support(a) - support(b);
        let rearmost = lower.abs() <= SAME_TURN && a.center.x < b.center.x;
        if lower > SAME_TURN || rearmost {
            i
        } else {
            best
        }
    });
    let Some(first) = first else {
        return Vec::new();
    };
    let (mut disc, mut from, mut turned) = (first, down, 0.0);
    let mut arcs: Vec<Arc> = Vec::new();
    // A hull has fewer than two arcs per disc; more would be an endless loop caused by rounding.
    for _ in 0..2 * discs.len() {
        let distance = |i: usize| (discs[i].center - discs[disc].center).length();
        let next = outer
            .iter()
            .filter_map(|other| Some((*other, turn_to(&discs[disc], &discs[*other], from)?)))
            .reduce(|best, other| {
                // If several discs are on one tangent, take the farthest, so that a run is one piece.
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
            // Once round: the rest belongs to the first arc.
            let Arc {
                disc, from, sweep, ..
            } = arcs[0];
            arcs[0] = Arc::new(disc, discs[disc], from + left, sweep + left);
            break;
        }
        arcs.push(Arc::new(disc, discs[disc], from, turn.min(left)));
        if turn > left - SAME_TURN {
            break;
        }
        (disc, from, turned) = (to, from - turn, turned + turn);
    }
    arcs
}

/// Whether a disc lies inside another one, up to rounding; of equal discs, all but the first are inside.
fn is_inside(discs: &[Disc], i: usize) -> bool {
    let inner = &discs[i];
    let mut others = discs.iter().enumerate();
    others.any(|(k, outer)| {
        let is_larger = outer
            .radius
            .total_cmp(&inner.radius)
            .then(i.cmp(&k))
            .is_gt();
        let reach = (inner.center - outer.center).length() + inner.radius;
        is_larger && reach - outer.radius <= SAME_TURN
    })
}

/// [rad] Clockwise turn of the outward direction on `disc` until `other` reaches equally far out.
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

/// [m, rad] Stretches overlap by this, so that no line can pass between two of them.
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
    Arc(Arc),
    Run(Run),
}

impl Stretch {
    pub(super) fn point_at(&self, inner: f64) -> Vector {
        match self.curve {
            Curve::Arc(arc) => {
                let fraction = if self.length > 0.0 {
                    inner / self.length
                } else {
                    0.0
                };
                arc.center + direction(arc.from - arc.sweep * fraction) * arc.radius
            }
            Curve::Run(run) => run.begin + run.along * inner,
        }
    }

    /// [m] Position of the point ahead of `from` at a straight `distance` from it.
    pub(super) fn at_distance(&self, from: Vector, distance: f64) -> f64 {
        match self.curve {
            Curve::Run(run) => {
                let offset = run.begin - from;
                let back = offset.dot(run.along);
                let root = back * back - offset.length_squared() + distance * distance;
                root.max(0.0).sqrt() - back
            }
            Curve::Arc(arc) => {
                let (spoke, radius) = (from - arc.center, arc.radius);
                let reach = spoke.length();
                let cosine = (radius * radius + reach * reach - distance * distance)
                    / (2.0 * radius * reach);
                let angle = libm::atan2(spoke.y, spoke.x) - libm::acos(cosine.clamp(-1.0, 1.0));
                (arc.from - angle).rem_euclid(TAU) * radius
            }
        }
    }

    /// [m] Depth of a point below this stretch, if the point is within its extent.
    pub(super) fn depth(&self, point: Vector) -> Option<f64> {
        match &self.curve {
            Curve::Run(run) => Some((run.begin - point).dot(run.outward)),
            Curve::Arc(arc) => {
                let spoke = point - arc.center;
                arc.holds(spoke, 0.0).then(|| arc.radius - spoke.length())
            }
        }
    }

    /// Calls `cut` with the fractions of the segment at which it crosses this stretch.
    pub(super) fn crossings(&self, a: Vector, b: Vector, cut: &mut impl FnMut(f64)) {
        let line = b - a;
        match &self.curve {
            Curve::Run(run) => {
                let towards = line.dot(run.outward);
                let t = (run.begin - a).dot(run.outward) / towards;
                let along = (a + line * t - run.begin).dot(run.along);
                let on_run = (-JOINT..=self.length + JOINT).contains(&along);
                if (0.0..=1.0).contains(&t) && on_run {
                    cut(t);
                }
            }
            Curve::Arc(arc) => {
                let (offset, square, radius) = (a - arc.center, line.length_squared(), arc.radius);
                let half = offset.dot(line) / square;
                let rest = half * half - (offset.length_squared() - radius * radius) / square;
                if rest < 0.0 {
                    return;
                }
                for t in [-half - rest.sqrt(), -half + rest.sqrt()] {
                    let spoke = offset + line * t;
                    if (0.0..=1.0).contains(&t) && arc.holds(spoke, JOINT * radius) {
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
            Curve::Run(_) => cross(p, q),
            Curve::Arc(arc) => cross(arc.center, q - p) - arc.radius * (to - from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_within_rounding_of_the_tangent_does_not_turn_at_all() {
        let disc = |x: f64, radius: f64| Disc {
            center: Vector::new(x, 0.0),
            radius,
        };
        let (large, small) = (disc(0.0, 0.2), disc(1.0, 0.1));
        let tangent = (0.1_f64).acos();
        let turn =
            |outward: f64| turn_to(&large, &small, outward).expect("neither holds the other");
        assert!((turn(tangent + 0.3) - 0.3).abs() < 1e-12);
        assert!((turn(tangent - 0.3) - (TAU - 0.3)).abs() < 1e-12);
        assert!(turn(tangent - 1e-14) == 0.0);
        assert!(turn_to(&large, &disc(0.05, 0.1), 0.0).is_none());
    }

    #[test]
    fn a_run_along_several_discs_is_one_piece() {
        let disc = |x: f64, radius: f64| Disc {
            center: Vector::new(x, 0.0),
            radius,
        };
        for order in [[0, 1, 2, 3], [3, 1, 2, 0], [1, 0, 3, 2]] {
            let discs = order.map(|i| disc([-0.4, -0.1, 0.2, 0.5][i], 0.1));
            let ends: Vec<f64> = arcs_round(&discs).iter().map(|arc| arc.center.x).collect();
            assert_eq!(ends, [-0.4, 0.5]);
        }
    }

    /// Wherever they touch, and in any order of the discs.
    #[test]
    fn a_disc_that_touches_a_larger_one_from_inside_leaves_no_trace() {
        let at = |angle: f64, apart: f64, radius: f64| Disc {
            center: direction(angle) * apart,
            radius,
        };
        for i in 0..100 {
            let angle = TAU * f64::from(i) / 100.0;
            for (inner, ahead) in [(0.03, 0.5), (0.2, 0.5), (0.03, 0.7)] {
                let discs = [
                    at(0.0, 0.0, 0.3),
                    at(angle, 0.3 - inner, inner),
                    at(0.0, ahead, 0.2),
                    at(0.0, 0.0, 0.3),
                ];
                for order in [[0, 1, 2, 3], [1, 0, 2, 3], [2, 1, 3, 0], [3, 2, 1, 0]] {
                    let arcs = arcs_round(&order.map(|k| discs[k]));
                    let radii: Vec<f64> = arcs.iter().map(|arc| arc.radius).collect();
                    assert_eq!(arcs.len(), 2, "{radii:?} at {angle} rad");
                    assert!(radii.contains(&0.3) && radii.contains(&0.2));
                    let turned: f64 = arcs.iter().map(|arc| arc.sweep).sum();
                    assert!((turned - TAU).abs() < 1e-9, "{turned} rad");
                }
            }
        }
        assert!(arcs_round(&[]).is_empty());
    }

    #[test]
    fn an_arc_holds_the_directions_that_it_turns_through_however_wide_it_is() {
        for (from, sweep) in [(0.3, 1.0), (2.0, 3.0), (-1.0, 3.3), (0.5, 5.0)] {
            let disc = Disc {
                center: Vector::X,
                radius: 0.2,
            };
            let arc = Arc::new(0, disc, from, sweep);
            // Clockwise, in steps that miss both ends.
            for i in 0..200 {
                let turn = TAU * (f64::from(i) + 0.37) / 200.0;
                let spoke = direction(from - turn) * 2.0;
                assert_eq!(arc.holds(spoke, 0.0), turn < sweep, "{turn} of {sweep} rad");
            }
            for (end, outwards) in [(from, 1.0), (from - sweep, -1.0)] {
                let beyond = |off: f64| direction(end + outwards * off);
                assert!(arc.holds(beyond(0.01), 0.02) && !arc.holds(beyond(0.01), 0.005));
                assert!(arc.holds(beyond(-0.01), -0.005) && !arc.holds(beyond(-0.01), -0.02));
            }
        }
    }
}
