//! The taut belt round a set of discs: their convex hull, walked along belt travel.
//!
//! Driving forwards, a belt runs rearwards on the ground, up round the rear, forwards on top and down
//! round the front: clockwise. The walk starts where the lower run ends at the rear.

use std::f64::consts::TAU;

use super::hull::{Arc, Curve, Run, SAME_TURN, Stretch, arcs_round};
use super::search::maximise;
use super::{Disc, Vector};
use crate::units::Metres;

/// [m] Stretches whose distances differ by less count as equally near, regardless of rounding.
const AS_NEAR: Metres = Metres(1e-8);

/// The convex hull of discs, as arcs and straight runs.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    pub(super) stretches: Vec<Stretch>,
}

/// The part of the hull nearest to a point inside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// [m] Depth of the point inside the hull.
    pub depth: f64,
    stretch: usize,
}

impl Envelope {
    /// Wraps the discs; there must be at least one.
    pub(crate) fn new(discs: &[Disc]) -> Self {
        let mut arcs = arcs_round(discs);
        // A run follows each arc; the lowest is the lower run, and the walk starts at its end.
        let drop = |arc: &Arc| -libm::sin(arc.from - arc.sweep);
        let lower = (0..arcs.len()).max_by(|i, j| drop(&arcs[*i]).total_cmp(&drop(&arcs[*j])));
        let count = arcs.len();
        arcs.rotate_left(lower.map_or(0, |lower| (lower + 1) % count));
        let mut envelope = Self {
            stretches: Vec::new(),
        };
        for (i, arc) in arcs.iter().enumerate() {
            envelope.push(arc.radius * arc.sweep, Curve::Arc(*arc));
            if count > 1 {
                envelope.push_run(arc, &arcs[(i + 1) % count]);
            }
        }
        envelope
    }

    fn push_run(&mut self, from: &Arc, to: &Arc) {
        let [_, outward] = from.ends;
        let begin = from.center + outward * from.radius;
        let way = to.center + outward * to.radius - begin;
        let length = way.length();
        let along = way / length;
        let run = Run {
            begin,
            along,
            outward,
        };
        self.push(length, Curve::Run(run));
    }

    fn push(&mut self, length: f64, curve: Curve) {
        self.stretches.push(Stretch {
            start: self.length(),
            length,
            curve,
        });
    }

    /// [m] Length of the hull.
    pub(crate) fn length(&self) -> f64 {
        self.stretches.last().map_or(0.0, |p| p.start + p.length)
    }

    /// The point at a distance `position` [m] along the hull, which may be more than once round.
    pub(crate) fn point_at(&self, position: f64) -> Vector {
        let position = position.rem_euclid(self.length());
        let stretch = self.stretch_at(position);
        stretch.point_at(position - stretch.start)
    }

    /// The stretch at a distance [m] along the hull, from 0 to its length.
    pub(super) fn stretch_at(&self, position: f64) -> &Stretch {
        &self.stretches[self.number_at(position)]
    }

    /// Its index in the list of stretches.
    pub(super) fn number_at(&self, position: f64) -> usize {
        let next = self.stretches.partition_point(|p| p.start <= position);
        next.saturating_sub(1)
    }

    /// [m] Position of the next point, along belt travel, at a straight distance from the point at `position`; one
    /// whole round further if there is none.
    pub(crate) fn position_at_distance(&self, position: f64, distance: f64) -> f64 {
        let length = self.length();
        let (from, rounds) = (
            self.point_at(position),
            (position / length).floor() * length,
        );
        let first = self
            .stretches
            .partition_point(|p| p.start <= position - rounds)
            .saturating_sub(1);
        for k in first..first + self.stretches.len() {
            let stretch = &self.stretches[k % self.stretches.len()];
            let behind = rounds
                + if k < self.stretches.len() {
                    0.0
                } else {
                    length
                };
            if (stretch.point_at(stretch.length) - from).length() >= distance {
                let inner = stretch.at_distance(from, distance);
                return behind + stretch.start + inner.clamp(0.0, stretch.length);
            }
        }
        position + length
    }

    /// [m] Depth of a point inside the hull; negative outside.
    pub(crate) fn depth(&self, point: Vector) -> f64 {
        let depths = self.stretches.iter().filter_map(|s| s.depth(point));
        depths.fold(f64::INFINITY, f64::min)
    }

    /// [m] An upper bound for the depth of points of a segment: the depth of its deeper end below a straight run.
    pub(crate) fn depth_below_runs(&self, ends: [Vector; 2]) -> f64 {
        let is_run = |s: &&Stretch| matches!(s.curve, Curve::Run(_));
        let runs = self.stretches.iter().filter(is_run);
        let depths = runs.filter_map(|s| Some(s.depth(ends[0])?.max(s.depth(ends[1])?)));
        depths.fold(f64::INFINITY, f64::min)
    }

    /// The nearest stretch of the hull; the first of several equally near ones.
    pub(crate) fn nearest(&self, point: Vector) -> Nearest {
        let depths = || self.stretches.iter().map(|s| s.depth(point));
        let depth = depths().flatten().fold(f64::INFINITY, f64::min);
        let is_nearest = |d: Option<f64>| d.is_some_and(|d| d - depth < AS_NEAR.value());
        Nearest {
            depth,
            stretch: depths().position(is_nearest).unwrap_or_default(),
        }
    }

    fn curved(&self) -> impl Iterator<Item = &Arc> {
        self.stretches
            .iter()
            .filter_map(|stretch| match &stretch.curve {
                Curve::Arc(arc) => Some(arc),
                Curve::Run(_) => None,
            })
    }

    /// The arcs of the hull: disc, outward direction at the start, and clockwise turn [rad].
    pub(crate) fn arcs(&self) -> Vec<(Disc, f64, f64)> {
        let disc = |&Arc { center, radius, .. }: &Arc| Disc { center, radius };
        let arcs = self.curved().map(|arc| (disc(arc), arc.from, arc.sweep));
        arcs.collect()
    }

    /// The ends of its straight runs.
    pub(crate) fn runs(&self) -> impl Iterator<Item = [Vector; 2]> {
        let is_run = |stretch: &&Stretch| matches!(stretch.curve, Curve::Run(_));
        let ends =
            |stretch: &Stretch| [0.0, stretch.length].map(|position| stretch.point_at(position));
        self.stretches.iter().filter(is_run).map(ends)
    }

    /// [rad] The angle at which a body with this hull and centre of mass stands on level ground, on the run that needs
    /// the smallest turn; 0 if it can stand on none.
    pub(crate) fn standing_angle(&self, center_of_mass: Vector) -> f64 {
        let stands = self.runs().filter_map(|[a, b]| {
            // Clockwise, its lower runs lead to the rear.
            let along = a - b;
            let foot = (center_of_mass - b).dot(along) / along.length_squared();
            (along.x > 0.0 && (0.0..=1.0).contains(&foot)).then(|| -libm::atan2(along.y, along.x))
        });
        let least = stands.min_by(|a, b| a.abs().total_cmp(&b.abs()));
        least.unwrap_or(0.0)
    }

    /// [rad] Angle by which the hull bends round each of the first `count` discs; 0 for a disc that it does not touch.
    pub(crate) fn bends(&self, count: usize) -> Vec<f64> {
        let mut bends = vec![0.0; count];
        for arc in self.curved() {
            bends[arc.disc] += arc.sweep;
        }
        bends
    }

    /// Points along the hull, arcs divided every `turn` [rad]; the first point is not repeated at the end.
    pub(crate) fn polyline(&self, turn: f64) -> Vec<Vector> {
        let points = self.cuts(turn);
        points.map(|(s, inner)| s.point_at(inner)).collect()
    }

    /// [m] Positions of these points along the hull.
    pub(crate) fn positions(&self, turn: f64) -> impl Iterator<Item = f64> {
        self.cuts(turn)
            .map(|(stretch, inner)| stretch.start + inner)
    }

    fn cuts(&self, turn: f64) -> impl Iterator<Item = (&Stretch, f64)> {
        self.stretches.iter().flat_map(move |stretch| {
            let cuts = match stretch.curve {
                Curve::Arc(arc) => (arc.sweep / turn).ceil().max(1.0) as usize,
                Curve::Run(_) => 1,
            };
            (0..cuts).map(move |i| (stretch, stretch.length * i as f64 / cuts as f64))
        })
    }

    /// The outward normal of the hull at its point nearest to a given point.
    pub(crate) fn outward_at(&self, point: Vector) -> Vector {
        match self.stretches[self.nearest(point).stretch].curve {
            Curve::Arc(arc) => (point - arc.center).normalize_or(Vector::NEG_Y),
            Curve::Run(run) => run.outward,
        }
    }

    /// The discs on either side of a point; the first is the one that the belt passes before the point.
    ///
    /// They are the nearest discs along the belt that reach at least as far out as the point.
    pub(crate) fn neighbours(&self, point: Vector, nearest: Nearest, discs: &[Disc]) -> [usize; 2] {
        match self.stretches[nearest.stretch].curve {
            Curve::Arc(arc) => [arc.disc; 2],
            Curve::Run(Run {
                begin,
                along,
                outward,
            }) => {
                let here = (point - begin).dot(along);
                let reaches_out = |d: &Disc| {
                    let gap = (begin - d.center).dot(outward) - d.radius;
                    gap <= nearest.depth + SAME_TURN
                };
                let place = |i: usize| (discs[i].center - begin).dot(along);
                let candidates = (0..discs.len()).filter(|i| reaches_out(&discs[*i]));
                let before = candidates
                    .clone()
                    .filter(|i| place(*i) <= here)
                    .max_by(|i, j| place(*i).total_cmp(&place(*j)));
                let after = candidates
                    .filter(|i| place(*i) > here)
                    .min_by(|i, j| place(*i).total_cmp(&place(*j)));
                // Both ends of a run reach out to the belt; only rounding can leave one side empty.
                let either = before.or(after).unwrap_or_default();
                [before.unwrap_or(either), after.unwrap_or(either)]
            }
        }
    }

    /// The part of a segment that lies inside, as fractions of its length; `depths` are those of its ends.
    pub(crate) fn clip(&self, [a, b]: [Vector; 2], depths: [f64; 2]) -> Option<(f64, f64)> {
        if depths.iter().all(|depth| *depth > 0.0) {
            return Some((0.0, 1.0));
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut cut = |t: f64| {
            low = low.min(t);
            high = high.max(t);
        };
        for stretch in &self.stretches {
            stretch.crossings(a, b, &mut cut);
        }
        // An end inside has no crossing on its own side.
        for (end, depth) in [0.0, 1.0].into_iter().zip(depths) {
            if depth > 0.0 {
                cut(end);
            }
        }
        (low < high).then_some((low, high))
    }

    /// [m] Position along the hull of its point nearest to `point`.
    pub(crate) fn position_of(&self, point: Vector) -> f64 {
        let stretch = &self.stretches[self.nearest(point).stretch];
        let inner = match stretch.curve {
            Curve::Arc(arc) => {
                let spoke = point - arc.center;
                let turn = (arc.from - libm::atan2(spoke.y, spoke.x)).rem_euclid(TAU);
                // An angle just before the start of the arc means its start, not a full turn later.
                let turn = if turn > 0.5 * (arc.sweep + TAU) {
                    0.0
                } else {
                    turn
                };
                turn.min(arc.sweep) * arc.radius
            }
            Curve::Run(run) => {
                let along = (point - run.begin).dot(run.along);
                along.clamp(0.0, stretch.length)
            }
        };
        stretch.start + inner
    }

    /// [m^2] Twice the signed area swept from the origin along the hull between two positions.
    pub(crate) fn swept(&self, from: f64, to: f64) -> f64 {
        let length = self.length();
        let to = if to < from { to + length } else { to };
        let mut sum = 0.0;
        for round in [0.0, length] {
            for stretch in &self.stretches {
                let begin = (from - round - stretch.start).clamp(0.0, stretch.length);
                let end = (to - round - stretch.start).clamp(0.0, stretch.length);
                if begin < end {
                    sum += stretch.swept(begin, end);
                }
            }
        }
        sum
    }

    /// The deepest point inside.
    pub(crate) fn deepest(&self) -> Vector {
        // No two points of a hull are farther apart than half its length.
        let (middle, reach) = (self.point_at(0.0), 0.5 * self.length());
        let along_x = |y: f64| {
            let depth = |x: f64| self.depth(Vector::new(x, y));
            Vector::new(maximise(middle.x - reach, middle.x + reach, depth), y)
        };
        let height = |y: f64| self.depth(along_x(y));
        along_x(maximise(middle.y - reach, middle.y + reach, height))
    }
}

#[cfg(test)]
mod tests;
