//! All poses in which a robot touches the ground in three places.
//!
//! Three contacts make three equations for position and angle. At one angle each keeps the robot's origin on a line or on a
//! circle, and two circles share a line, too; so two lines give the origin, and what is left is one polynomial in cosine
//! and sine of the angle, of degree 6 at most.

use super::clear::is_clear;
use super::contact::{Contact, Kind, Locus, Posture, Turn, meeting, radical};
use super::layout::{Layout, Outline};
use super::places::{Facing, Place};
use super::zeros::{Difference, zeros};
use crate::error::Error;
use crate::geometry::{Vector, cross, is_between, left_of};
use crate::limits::Cancel;
use crate::units::Metres;

/// [m] Gaps up to this are contacts; poses are known to a thousandth of it.
pub(super) const TOUCHING: Metres = Metres(1e-9);
/// [m] and [rad] Poses that differ by less are the same.
const SAME: Metres = Metres(1e-7);
/// Sine of the angle below which two lines are parallel.
const PARALLEL: f64 = 1e-9;

/// A robot over a ground.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub layout: Layout,
    pub places: Vec<Place>,
    /// All that could touch.
    pub contacts: Vec<Contact>,
    /// For each contact, those of higher index that it can be together with.
    pub partners: Vec<Vec<Partner>>,
    /// Angles at which poses are sought.
    pub bins: Bins,
}

impl Setting {
    pub(super) fn new(layout: Layout, places: Vec<Place>, angles: [f64; 2]) -> Self {
        let contacts = Contact::all(&layout, &places);
        let bounds: Vec<Reach> = contacts
            .iter()
            .map(|contact| Reach::of(&layout, &places, contact))
            .collect();
        let bins = Bins::between(angles);
        let partners = bounds.iter().enumerate().map(|(i, one)| {
            let later = bounds.iter().enumerate().skip(i + 1);
            let apart = later.filter(|(j, _)| !are_one(&contacts[i], &contacts[*j]));
            let fitting = apart.map(|(j, other)| Partner {
                contact: j,
                angles: one.angles_with(other, &bins),
            });
            fitting.filter(|partner| partner.angles != 0).collect()
        });
        Self {
            partners: partners.collect(),
            layout,
            places,
            contacts,
            bins,
        }
    }

    /// The bins of angles at which two contacts, the first of lower index, can be together.
    fn together(&self, one: usize, other: usize) -> u128 {
        let partners = &self.partners[one];
        let found = partners.binary_search_by_key(&other, |partner| partner.contact);
        found.map_or(0, |k| partners[k].angles)
    }

    /// The contacts in place in a pose; `None` if the robot overlaps with the ground there.
    pub(super) fn touching(&self, posture: &Posture) -> Option<Vec<usize>> {
        let touches = |contact: &Contact| {
            contact.touch(posture).gap.abs() <= TOUCHING.value() && self.is_real(contact, posture)
        };
        if !self.is_clear(posture) {
            return None;
        }
        let all = self.contacts.iter().enumerate();
        Some(all.filter(|(_, c)| touches(c)).map(|(i, _)| i).collect())
    }

    /// Whether the robot does not overlap with the ground.
    fn is_clear(&self, posture: &Posture) -> bool {
        is_clear(&self.layout, &self.places, posture, TOUCHING.value())
    }

    /// Whether what touches is a piece of the outline and a piece of the ground.
    pub(super) fn is_real(&self, contact: &Contact, posture: &Posture) -> bool {
        contact.is_real(&self.layout, &self.places, posture, TOUCHING.value())
    }

    /// Every pose with three contacts that are not all on parallel lines.
    pub(super) fn corners(&self, cancel: &Cancel) -> Result<Vec<Posture>, Error> {
        let mut postures = Vec::new();
        for (a, partners) in self.partners.iter().enumerate() {
            cancel.check()?;
            for (k, b) in partners.iter().enumerate() {
                for c in &partners[k + 1..] {
                    let both = b.angles & c.angles;
                    if both == 0 {
                        continue;
                    }
                    let angles = both & self.together(b.contact, c.contact);
                    if angles != 0 {
                        let three = [a, b.contact, c.contact].map(|i| self.contacts[i]);
                        let ranges = self.bins.ranges(angles);
                        meet(&three, ranges, &mut postures);
                    }
                }
            }
        }
        let mut corners: Vec<Posture> = Vec::new();
        for (three, posture) in postures {
            if three.iter().all(|contact| self.is_real(contact, &posture))
                && !corners.iter().any(|known| is_same(known, &posture))
                && self.is_clear(&posture)
            {
                corners.push(posture);
            }
        }
        Ok(corners)
    }
}

/// Whether two poses are the same up to rounding.
pub(super) fn is_same(one: &Posture, other: &Posture) -> bool {
    (one.position - other.position).length() < SAME.value()
        && (one.angle - other.angle).abs() < SAME.value()
}

/// The box in which a point of the robot lies while a surface touches a place: the centre of a disc, the middle of a run.
struct Reach {
    point: Vector,
    low: Vector,
    high: Vector,
}

impl Reach {
    fn of(layout: &Layout, places: &[Place], contact: &Contact) -> Self {
        let surface = &layout.surfaces[contact.surface].shape;
        let (point, far) = match surface {
            Outline::Round(disc) => (disc.center, disc.radius),
            Outline::Flat { ends: [a, b], .. } => ((*a + *b) * 0.5, 0.5 * (*b - *a).length()),
        };
        let ends = match (&places[contact.place].shape, surface) {
            (Facing::Face { ends, normal }, _) => ends.map(|end| end + *normal * far).to_vec(),
            (
                Facing::Corner {
                    center,
                    radius,
                    cone,
                },
                Outline::Round(_),
            ) => {
                let axes = [Vector::X, Vector::Y, Vector::NEG_X, Vector::NEG_Y];
                let inside = axes
                    .into_iter()
                    .filter(|axis| is_between(*axis, *cone, 0.0));
                let directions = cone.iter().copied().chain(inside);
                directions.map(|d| center + d * (radius + far)).collect()
            }
            // The run may lie in any direction.
            (Facing::Corner { center, radius, .. }, Outline::Flat { .. }) => {
                let most = Vector::ONE * (radius + far);
                vec![center - most, center + most]
            }
        };
        let first = ends[0];
        let slack = Vector::ONE * (2.0 * TOUCHING.value());
        Self {
            point,
            low: ends.iter().copied().fold(first, Vector::min) - slack,
            high: ends.iter().copied().fold(first, Vector::max) + slack,
        }
    }

    /// The bins of angles at which both points can be in their boxes.
    fn angles_with(&self, other: &Self, bins: &Bins) -> u128 {
        let between = other.point - self.point;
        let (low, high) = (other.low - self.high, other.high - self.low);
        let distance = between.length();
        let least = low.max(-high).max(Vector::ZERO).length();
        let most = low.abs().max(high.abs()).length();
        if !(least..=most).contains(&distance) {
            return 0;
        }
        let slack = Vector::ONE * (distance * bins.half_width);
        let (low, high) = (low - slack, high + slack);
        let is_in = |v: Vector| v.cmpge(low).all() && v.cmple(high).all();
        let at = bins.middles.iter().enumerate();
        at.filter(|(_, turn)| is_in(turn.apply(between)))
            .fold(0, |bits, (i, _)| bits | 1 << i)
    }
}

/// A contact that another can be together with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partner {
    pub contact: usize,
    /// The bins of angles.
    pub angles: u128,
}

/// A range of angles, divided into as many bins as an integer has bits.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    low: f64,
    half_width: f64,
    middles: Vec<Turn>,
}

impl Bins {
    fn between([low, high]: [f64; 2]) -> Self {
        let half_width = 0.5 * (high - low) / f64::from(u128::BITS);
        let middle = |i: u32| Turn::by(low + f64::from(2 * i + 1) * half_width);
        Self {
            low,
            half_width,
            middles: (0..u128::BITS).map(middle).collect(),
        }
    }

    /// [rad] The ranges that bins cover together.
    pub(super) fn ranges(&self, bins: u128) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (low, width) = (self.low, 2.0 * self.half_width);
        let mut left = bins;
        let mut from = 0;
        std::iter::from_fn(move || {
            if left == 0 {
                return None;
            }
            let skipped = left.trailing_zeros();
            // All bins together leave nothing to shift.
            left = left.checked_shr(skipped).unwrap_or(0);
            let count = left.trailing_ones();
            left = left.checked_shr(count).unwrap_or(0);
            let first = from + skipped;
            from = first + count;
            Some([first, from].map(|bin| low + f64::from(bin) * width))
        })
    }

    /// Whether an angle is in the range.
    pub(super) fn hold(&self, angle: f64) -> bool {
        let width = 2.0 * self.half_width * f64::from(u128::BITS);
        (self.low..=self.low + width).contains(&angle)
    }
}

/// Adds the poses in which three contacts meet, whether or not the pieces are there.
fn meet(
    three: &[Contact; 3],
    ranges: impl Iterator<Item = [f64; 2]>,
    found: &mut Vec<([Contact; 3], Posture)>,
) {
    let origin = three[0].anchor();
    let local = three.map(|contact| contact.seen_from(origin));
    let line = |i: usize, angle: f64| line(local[i].locus(Turn::by(angle)));
    let angles = match parallel(&local) {
        Parallel::All => return,
        Parallel::Two(i, j) => zeros(ranges, |angle| apart(line(i, angle), line(j, angle))),
        Parallel::None => zeros(ranges, |angle| {
            let turn = Turn::by(angle);
            residual(&local.map(|contact| contact.locus(turn)))
        }),
    };
    for angle in angles {
        for position in positions(&local.map(|c| c.locus(Turn::by(angle)))) {
            let near = Posture { position, angle };
            if let Some(exact) = polished(&local, near) {
                let position = exact.position + origin;
                found.push((*three, Posture { position, ..exact }));
            }
        }
    }
}

/// Which of three contacts keep the origin on lines that are parallel at every angle.
enum Parallel {
    None,
    Two(usize, usize),
    All,
}

fn parallel(three: &[Contact; 3]) -> Parallel {
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let mut lines = pairs
        .into_iter()
        .filter(|(i, j)| are_parallel(&three[*i], &three[*j]));
    match (lines.next(), lines.next()) {
        (None, _) => Parallel::None,
        (Some(_), Some(_)) => Parallel::All,
        (Some((i, j)), None) => Parallel::Two(i, j),
    }
}

/// Whether two contacts are never at the same time, or are one then: a disc on a face and on the corner at its end, a run and
/// the disc at its end on one corner, faces in one plane, a corner between discs that touch.
fn are_one(one: &Contact, other: &Contact) -> bool {
    if one.surface != other.surface && one.place != other.place {
        return false;
    }
    // How line and circle lie to each other does not depend on the angle.
    let turn = Turn::by(0.3);
    match [one, other].map(|contact| contact.locus(turn)) {
        [Locus::Line(normal, offset), Locus::Circle(center, radius)]
        | [Locus::Circle(center, radius), Locus::Line(normal, offset)] => {
            ((normal.dot(center) - offset).abs() - radius).abs() < TOUCHING.value()
        }
        // Two discs can be on one face.
        [Locus::Line(..), Locus::Line(..)] => {
            one.surface == other.surface && are_parallel(one, other)
        }
        // Wheels that touch have a corner between them only at that point, where it would have to be a needle.
        [Locus::Circle(one, r), Locus::Circle(other, s)] => {
            ((one - other).length() - r - s).abs() < TOUCHING.value()
        }
    }
}

/// Whether two contacts keep the origin on lines that are parallel at every angle.
pub(super) fn are_parallel(one: &Contact, other: &Contact) -> bool {
    match (one.kind, other.kind) {
        (Kind::OnFace(_, n, _), Kind::OnFace(_, m, _))
        | (Kind::Across(n, ..), Kind::Across(m, ..)) => cross(n, m).abs() < PARALLEL,
        _ => false,
    }
}

/// [m] How far two parallel lines are apart.
pub(super) fn apart(one: (Vector, f64), other: (Vector, f64)) -> Difference {
    let value = one.1 - one.0.dot(other.0).signum() * other.1;
    [value, one.1.abs() + other.1.abs()]
}

/// A line; of a circle, nothing that matters.
pub(super) fn line(locus: Locus) -> (Vector, f64) {
    match locus {
        Locus::Line(normal, offset) | Locus::Circle(normal, offset) => (normal, offset),
    }
}

/// A line as its normal and its offset, or a circle as its centre and its radius.
type Pair = (Vector, f64);

/// Lines that hold the origin at one angle, own ones first, and a circle, if there is one.
fn lines(loci: &[Locus; 3]) -> ([Pair; 3], Option<Pair>) {
    let mut lines = [(Vector::ZERO, 0.0); 3];
    let mut count = 0;
    let mut first = None;
    for locus in loci {
        if let Locus::Line(normal, offset) = locus {
            lines[count] = (*normal, *offset);
            count += 1;
        }
    }
    for locus in loci {
        if let Locus::Circle(center, radius) = locus {
            match first {
                None => first = Some((*center, *radius)),
                Some(first) => {
                    lines[count] = radical(first, (*center, *radius));
                    count += 1;
                }
            }
        }
    }
    (lines, first)
}

/// What is zero if three lines, or two lines and a circle, have a point in common.
fn residual(loci: &[Locus; 3]) -> Difference {
    let (lines, circle) = lines(loci);
    let (point, scale) = meeting(lines[0], lines[1]);
    let size = point.length() + scale.abs();
    match circle {
        Some((center, radius)) => {
            let off = (point - center * scale).length_squared() - radius * radius * scale * scale;
            [off, size * size]
        }
        None => [lines[2].0.dot(point) - lines[2].1 * scale, size],
    }
}

/// Where the origin can be at an angle at which that is zero.
fn positions(loci: &[Locus; 3]) -> Vec<Vector> {
    let (lines, circle) = lines(loci);
    let count = if circle.is_some() { 2 } else { 3 };
    let pairs = [(0, 1), (0, 2), (1, 2)]
        .into_iter()
        .filter(|(_, j)| *j < count);
    let sharp = |(i, j): (usize, usize)| {
        let (point, scale) = meeting(lines[i], lines[j]);
        let sine = scale / (lines[i].0.length() * lines[j].0.length());
        (sine.abs() > PARALLEL).then(|| (sine.abs(), point / scale))
    };
    let best = pairs.filter_map(sharp).max_by(|a, b| a.0.total_cmp(&b.0));
    match (best, circle) {
        (Some((sine, point)), None) if sine > 0.0 => vec![point],
        (Some((sine, point)), Some(_)) if sine > 1e-6 => vec![point],
        // Lines that are one: where it meets the circle. Two circles that are one have none.
        (_, Some(circle)) => {
            let length = |line: &(Vector, f64)| line.0.length_squared();
            let line = if length(&lines[0]) > length(&lines[1]) {
                lines[0]
            } else {
                lines[1]
            };
            on_circle(line, circle).to_vec()
        }
        (..) => Vec::new(),
    }
}

/// Where a line meets a circle, or comes nearest to it.
pub(super) fn on_circle(
    (normal, offset): (Vector, f64),
    (center, radius): (Vector, f64),
) -> [Vector; 2] {
    let square = normal.length_squared();
    let foot = center + normal * ((offset - normal.dot(center)) / square);
    let half = (radius * radius - (foot - center).length_squared())
        .max(0.0)
        .sqrt();
    let along = left_of(normal) / square.sqrt();
    [foot + along * half, foot - along * half]
}

/// [m] How far a pose may be off before it is polished.
const NEAR: Metres = Metres(1e-4);
/// [m] Gaps of a pose that is found.
const FOUND: Metres = Metres(1e-12);

/// The pose near another in which three contacts touch.
fn polished(three: &[Contact; 3], near: Posture) -> Option<Posture> {
    let mut posture = near;
    for _ in 0..12 {
        let touches = three.map(|contact| contact.touch(&posture));
        let gaps = touches.map(|touch| touch.gap);
        if gaps.iter().all(|gap| gap.abs() <= FOUND.value()) {
            return Some(posture);
        }
        if gaps.iter().any(|gap| gap.abs() > NEAR.value()) {
            return None;
        }
        let rows = touches.map(|touch| Contact::gradient(&touch, posture.position));
        let step = solve(&rows, &gaps)?;
        posture.position -= Vector::new(step[0], step[1]);
        posture.angle -= step[2];
    }
    // Where contacts come together without crossing, steps are halves: their sum is near enough.
    let gap = |contact: &Contact| contact.touch(&posture).gap.abs();
    three
        .iter()
        .all(|c| gap(c) <= 1e-3 * TOUCHING.value())
        .then_some(posture)
}

/// The solution of three equations; `None` if they are singular.
pub(super) fn solve(rows: &[[f64; 3]; 3], right: &[f64; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = rows.map(|row| row);
    let minor = |p: &[f64; 3], q: &[f64; 3]| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let (bc, ca, ab) = (minor(&b, &c), minor(&c, &a), minor(&a, &b));
    let determinant = a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2];
    let of = |i: usize| (right[0] * bc[i] + right[1] * ca[i] + right[2] * ab[i]) / determinant;
    let found = [of(0), of(1), of(2)];
    found.iter().all(|x| x.is_finite()).then_some(found)
}
