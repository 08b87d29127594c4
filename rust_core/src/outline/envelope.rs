//! The taut belt round a set of discs: their convex hull, walked along belt travel.
//!
//! Driving forwards, a belt runs rearwards on the ground, up round the rear, forwards on top and down
//! round the front: clockwise. The walk starts where the lower run ends at the rear.

use std::f64::consts::TAU;

use rapier2d_f64::math::Vector;

use super::Disc;

/// [rad] Turns smaller than this are rounding of collinear tangents.
const SAME_TURN: f64 = 1e-12;

/// [m, rad] Stretches overlap by this, so that no line slips through where two of them meet.
const JOINT: f64 = 1e-9;

/// The convex hull of discs, as arcs and straight runs.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    pieces: Vec<Piece>,
}

/// One stretch of the hull.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// [m] Length of the hull up to here.
    start: f64,
    /// [m] Own length.
    length: f64,
    shape: Form,
}

#[derive(Clone, Copy, Debug)]
enum Form {
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

/// Where the hull lies nearest to a point inside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// [m] Depth of the point inside the hull.
    pub depth: f64,
    piece: usize,
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
        let mut envelope = Self { pieces: Vec::new() };
        for (i, arc) in arcs.iter().enumerate() {
            envelope.push_arc(discs, arc);
            if count > 1 {
                let next = &arcs[(i + 1) % count];
                envelope.push_run(&discs[arc.disc], &discs[next.disc], arc.from - arc.sweep);
            }
        }
        envelope
    }

    fn push_arc(&mut self, discs: &[Disc], arc: &Arc) {
        let Disc { center, radius } = discs[arc.disc];
        let shape = Form::Arc {
            disc: arc.disc,
            center,
            radius,
            from: arc.from,
            sweep: arc.sweep,
            ends: [direction(arc.from), direction(arc.from - arc.sweep)],
        };
        self.push(radius * arc.sweep, shape);
    }

    fn push_run(&mut self, from: &Disc, to: &Disc, outward: f64) {
        let outward = direction(outward);
        let begin = from.center + outward * from.radius;
        let way = to.center + outward * to.radius - begin;
        let length = way.length();
        let shape = Form::Run {
            begin,
            along: way / length,
            outward,
        };
        self.push(length, shape);
    }

    fn push(&mut self, length: f64, shape: Form) {
        self.pieces.push(Piece {
            start: self.length(),
            length,
            shape,
        });
    }

    /// [m] Length of the hull.
    pub(crate) fn length(&self) -> f64 {
        self.pieces.last().map_or(0.0, |p| p.start + p.length)
    }

    /// The point a way [m] along the hull; the way may go round more than once.
    pub(crate) fn point_at(&self, way: f64) -> Vector {
        let way = way.rem_euclid(self.length());
        let i = self.pieces.partition_point(|p| p.start <= way) - 1;
        self.pieces[i].point_at(way - self.pieces[i].start)
    }

    /// [m] The way to the next point, along belt travel, at a straight distance from the one at
    /// `way`; a whole round further if there is none.
    pub(crate) fn way_to_distance(&self, way: f64, distance: f64) -> f64 {
        let length = self.length();
        let (from, rounds) = (self.point_at(way), (way / length).floor() * length);
        let first = self
            .pieces
            .partition_point(|p| p.start <= way - rounds)
            .saturating_sub(1);
        for k in first..first + self.pieces.len() {
            let piece = &self.pieces[k % self.pieces.len()];
            let behind = rounds + if k < self.pieces.len() { 0.0 } else { length };
            if (piece.point_at(piece.length) - from).length() >= distance {
                let inner = piece.at_distance(from, distance);
                return behind + piece.start + inner.clamp(0.0, piece.length);
            }
        }
        way + length
    }

    /// [m] Depth of a point inside the hull; outside it is negative.
    pub(crate) fn depth(&self, point: Vector) -> f64 {
        self.nearest(point).depth
    }

    /// The nearest stretch of the hull.
    pub(crate) fn nearest(&self, point: Vector) -> Nearest {
        let mut nearest = Nearest {
            depth: f64::INFINITY,
            piece: 0,
        };
        for (i, piece) in self.pieces.iter().enumerate() {
            if let Some(depth) = piece.depth(point)
                && depth < nearest.depth
            {
                nearest = Nearest { depth, piece: i };
            }
        }
        nearest
    }

    /// The discs on either side of a point, first the one that the belt passes before it.
    ///
    /// They are the nearest along the belt that reach as far out as the point lies deep.
    pub(crate) fn neighbours(&self, point: Vector, nearest: Nearest, discs: &[Disc]) -> [usize; 2] {
        match self.pieces[nearest.piece].shape {
            Form::Arc { disc, .. } => [disc, disc],
            Form::Run {
                begin,
                along,
                outward,
            } => {
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
                // Both ends of a run reach out to it; only rounding at an end leaves one side empty.
                let either = before.or(after).unwrap_or_default();
                [before.unwrap_or(either), after.unwrap_or(either)]
            }
        }
    }

    /// The part of a segment that lies inside, as shares of its length.
    pub(crate) fn clip(&self, a: Vector, b: Vector) -> Option<(f64, f64)> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut cut = |t: f64| {
            low = low.min(t);
            high = high.max(t);
        };
        for piece in &self.pieces {
            piece.crossings(a, b, &mut cut);
        }
        // An end inside has no crossing before it.
        if self.depth(a) > 0.0 {
            cut(0.0);
        }
        if self.depth(b) > 0.0 {
            cut(1.0);
        }
        (low < high).then_some((low, high))
    }

    /// [m] The way along the hull to the point of it nearest to `point`.
    pub(crate) fn way_of(&self, point: Vector) -> f64 {
        let piece = &self.pieces[self.nearest(point).piece];
        let inner = match piece.shape {
            Form::Arc {
                center,
                radius,
                from,
                sweep,
                ..
            } => {
                let spoke = point - center;
                let turn = (from - libm::atan2(spoke.y, spoke.x)).rem_euclid(TAU);
                // Just before the start of the arc is its start, not a whole turn further.
                let turn = if turn > 0.5 * (sweep + TAU) {
                    0.0
                } else {
                    turn
                };
                turn.min(sweep) * radius
            }
            Form::Run { begin, along, .. } => (point - begin).dot(along).clamp(0.0, piece.length),
        };
        piece.start + inner
    }

    /// [m^2] Twice the signed area swept from the origin along the hull from one way to another.
    pub(crate) fn swept(&self, from: f64, to: f64) -> f64 {
        let length = self.length();
        let to = if to < from { to + length } else { to };
        let mut sum = 0.0;
        for round in [0.0, length] {
            for piece in &self.pieces {
                let begin = (from - round - piece.start).clamp(0.0, piece.length);
                let end = (to - round - piece.start).clamp(0.0, piece.length);
                if begin < end {
                    sum += piece.swept(begin, end);
                }
            }
        }
        sum
    }

    /// The deepest point inside.
    pub(crate) fn deepest(&self) -> Vector {
        // No point of a hull is farther from another than half its length.
        let (middle, reach) = (self.point_at(0.0), 0.5 * self.length());
        let along_x = |y: f64| {
            let depth = |x: f64| self.depth(Vector::new(x, y));
            Vector::new(maximise(middle.x - reach, middle.x + reach, depth), y)
        };
        let height = |y: f64| self.depth(along_x(y));
        along_x(maximise(middle.y - reach, middle.y + reach, height))
    }
}

impl Piece {
    fn point_at(&self, way: f64) -> Vector {
        match self.shape {
            Form::Arc {
                center,
                radius,
                from,
                sweep,
                ..
            } => {
                let share = if self.length > 0.0 {
                    way / self.length
                } else {
                    0.0
                };
                center + direction(from - sweep * share) * radius
            }
            Form::Run { begin, along, .. } => begin + along * way,
        }
    }

    /// [m] Way to the point, leaving `from` behind, that lies at `distance` from it.
    fn at_distance(&self, from: Vector, distance: f64) -> f64 {
        match self.shape {
            Form::Run { begin, along, .. } => {
                let offset = begin - from;
                let back = offset.dot(along);
                let root = back * back - offset.length_squared() + distance * distance;
                root.max(0.0).sqrt() - back
            }
            Form::Arc {
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

    /// [m] Depth of a point below this stretch, if the stretch is the nearest in its direction.
    fn depth(&self, point: Vector) -> Option<f64> {
        match self.shape {
            Form::Run { begin, outward, .. } => Some((begin - point).dot(outward)),
            Form::Arc {
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

    /// Shares of the segment at which it crosses this stretch.
    fn crossings(&self, a: Vector, b: Vector, cut: &mut impl FnMut(f64)) {
        let way = b - a;
        match self.shape {
            Form::Run {
                begin,
                along,
                outward,
            } => {
                let towards = way.dot(outward);
                let t = (begin - a).dot(outward) / towards;
                let along = (a + way * t - begin).dot(along);
                let on_run = (-JOINT..=self.length + JOINT).contains(&along);
                if (0.0..=1.0).contains(&t) && on_run {
                    cut(t);
                }
            }
            Form::Arc {
                center,
                radius,
                sweep,
                ends,
                ..
            } => {
                let (offset, square) = (a - center, way.length_squared());
                let half = offset.dot(way) / square;
                let rest = half * half - (offset.length_squared() - radius * radius) / square;
                if rest < 0.0 {
                    return;
                }
                for t in [-half - rest.sqrt(), -half + rest.sqrt()] {
                    let spoke = offset + way * t;
                    if (0.0..=1.0).contains(&t) && is_on_arc(spoke, ends, sweep, JOINT * radius) {
                        cut(t);
                    }
                }
            }
        }
    }

    /// [m^2] Twice the signed area between the origin and this stretch from one way to another.
    fn swept(&self, from: f64, to: f64) -> f64 {
        let (p, q) = (self.point_at(from), self.point_at(to));
        match self.shape {
            Form::Run { .. } => cross(p, q),
            Form::Arc { center, radius, .. } => cross(center, q - p) - radius * (to - from),
        }
    }
}

/// One disc's share of the hull.
struct Arc {
    disc: usize,
    /// [rad] Outward direction at its start.
    from: f64,
    /// [rad] How far it turns, clockwise.
    sweep: f64,
}

/// The arcs of the hull, clockwise, found by turning a tangent once round.
fn arcs_round(discs: &[Disc]) -> Vec<Arc> {
    let down = -0.25 * TAU;
    let support = |d: &Disc| d.radius - d.center.y;
    // Of the lowest discs the rearmost: the tangent leaves them there.
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
    loop {
        let distance = |i: usize| (discs[i].center - discs[disc].center).length();
        let next = (0..discs.len())
            .filter_map(|other| Some((other, turn_to(&discs[disc], &discs[other], from)?)))
            .reduce(|best, other| {
                // Of discs on one tangent the farthest, so that a run is one piece.
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
            // Round: what is left belongs to the first arc, which began half-way.
            arcs[0].from += left;
            arcs[0].sweep += left;
            return arcs;
        }
        arcs.push(Arc {
            disc,
            from,
            sweep: turn.min(left),
        });
        if turn > left - SAME_TURN {
            return arcs;
        }
        (disc, from, turned) = (to, from - turn, turned + turn);
    }
}

/// Whether a way from the centre points through a clockwise arc, with a margin at its ends.
fn is_on_arc(spoke: Vector, [first, last]: [Vector; 2], sweep: f64, margin: f64) -> bool {
    let (after_first, before_last) = (cross(spoke, first), cross(last, spoke));
    if sweep > 0.5 * TAU {
        after_first >= -margin || before_last >= -margin
    } else {
        after_first >= -margin && before_last >= -margin
    }
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

fn direction(angle: f64) -> Vector {
    let (sine, cosine) = libm::sincos(angle);
    Vector::new(cosine, sine)
}

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Where a concave function is largest, by golden section.
pub(crate) fn maximise(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut at_a, mut at_b) = (f(a), f(b));
    // The bracket shrinks to 1e-11 of its start.
    for _ in 0..52 {
        if at_a < at_b {
            (low, a, at_a) = (a, b, at_b);
            b = low + SHARE * (high - low);
            at_b = f(b);
        } else {
            (high, b, at_b) = (b, a, at_a);
            a = high - SHARE * (high - low);
            at_a = f(a);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f64, y: f64, radius: f64) -> Disc {
        Disc {
            center: Vector::new(x, y),
            radius,
        }
    }

    fn stadium() -> Envelope {
        Envelope::new(&[
            disc(-0.2, 0.0, 0.1),
            disc(0.0, 0.0, 0.1),
            disc(0.3, 0.0, 0.1),
        ])
    }

    #[test]
    fn length_and_area_are_those_of_a_stadium() {
        let belt = stadium();
        assert!((belt.length() - (1.0 + TAU * 0.1)).abs() < 1e-12);
        let area = -0.5 * belt.swept(0.0, belt.length());
        assert!((area - (0.1 + 0.5 * TAU * 0.01)).abs() < 1e-12, "{area}");
    }

    #[test]
    fn walk_starts_at_the_rear_of_the_lower_run_and_follows_the_belt() {
        let belt = stadium();
        let arc = 0.05 * TAU;
        for (way, x, y) in [
            (0.0, -0.2, -0.1),
            (0.5 * arc, -0.3, 0.0),
            (arc, -0.2, 0.1),
            (arc + 0.5, 0.3, 0.1),
            (1.5 * arc + 0.5, 0.4, 0.0),
            (2.0 * arc + 0.6, 0.2, -0.1),
        ] {
            let point = belt.point_at(way);
            assert!(
                (point - Vector::new(x, y)).length() < 1e-12,
                "{way}: {point}"
            );
            assert!((belt.way_of(point) - way).abs() < 1e-9, "{way}");
        }
    }

    #[test]
    fn one_disc_is_its_own_envelope() {
        let belt = Envelope::new(&[disc(1.0, 2.0, 0.5)]);
        assert!((belt.length() - 0.5 * TAU).abs() < 1e-12);
        assert!((belt.depth(Vector::new(1.0, 2.2)) - 0.3).abs() < 1e-12);
        assert!((-0.5 * belt.swept(0.0, belt.length()) - 0.125 * TAU).abs() < 1e-12);
    }

    #[test]
    fn discs_inside_the_hull_leave_no_trace() {
        let belt = Envelope::new(&[
            disc(-0.2, 0.0, 0.1),
            disc(0.0, 0.02, 0.05),
            disc(0.3, 0.0, 0.1),
        ]);
        assert!((belt.length() - stadium().length()).abs() < 1e-12);
    }

    #[test]
    fn distances_along_the_belt_come_back_as_distances() {
        let belt = Envelope::new(&[disc(-0.2, 0.0, 0.1), disc(0.3, 0.05, 0.04)]);
        for i in 0..100 {
            let way = 0.017 * f64::from(i);
            for distance in [0.01, 0.05, 0.07] {
                let next = belt.way_to_distance(way, distance);
                let apart = (belt.point_at(next) - belt.point_at(way)).length();
                assert!((apart - distance).abs() < 1e-9, "{way} {distance} {apart}");
                // No arc within a half circle is longer than pi / 2 of its chord.
                assert!(next > way && next - way < 0.26 * TAU * distance);
            }
        }
    }
}
