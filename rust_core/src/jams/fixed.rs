//! All poses that three contacts fix.
//!
//! Three contacts are three equations for position and angle. At one angle, each keeps the robot's origin on a line or
//! on a circle, and two circles give a line, too. So two lines give the origin, and one polynomial in cosine and sine
//! of the angle remains, of degree at most 6.

use super::contact::{Contact, Locus, PARALLEL, Posture, Turn, meeting, radical};
use super::setting::{Setting, is_same};
use super::zeros::{Difference, zeros};
use crate::error::Error;
use crate::geometry::{Vector, left_of};
use crate::limits::Cancel;
use crate::units::Metres;

impl Setting {
    /// Every pose with three contacts that are not all on parallel lines.
    pub(super) fn fixed(&self, cancel: &Cancel) -> Result<Vec<Posture>, Error> {
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
        let mut fixed: Vec<Posture> = Vec::new();
        for (three, posture) in postures {
            if three.iter().all(|contact| self.is_real(contact, &posture))
                && !fixed.iter().any(|known| is_same(known, &posture))
                && self.is_clear(&posture)
            {
                fixed.push(posture);
            }
        }
        Ok(fixed)
    }
}

/// Adds the poses in which three contacts touch if their lines and circles are extended.
pub(super) fn meet(
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
        .filter(|(i, j)| three[*i].is_parallel_to(&three[*j]));
    match (lines.next(), lines.next()) {
        (None, _) => Parallel::None,
        (Some(_), Some(_)) => Parallel::All,
        (Some((i, j)), None) => Parallel::Two(i, j),
    }
}

/// [m] Distance of two parallel lines.
pub(super) fn apart(one: (Vector, f64), other: (Vector, f64)) -> Difference {
    let value = one.1 - one.0.dot(other.0).signum() * other.1;
    [value, one.1.abs() + other.1.abs()]
}

/// The normal and offset of a line; for a circle the pair is not a line.
pub(super) fn line(locus: Locus) -> (Vector, f64) {
    match locus {
        Locus::Line(normal, offset) | Locus::Circle(normal, offset) => (normal, offset),
    }
}

/// A line as its normal and its offset, or a circle as its centre and its radius.
type Pair = (Vector, f64);

/// Lines through the origin's position at one angle, those of contacts first, and a circle if there is one.
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

/// A function that is zero if three lines, or two lines and a circle, meet in a point.
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

/// Positions of the origin at a zero of this function.
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
        (Some((_, point)), None) => vec![point],
        (Some((sine, point)), Some(_)) if sine > 1e-6 => vec![point],
        // If the lines coincide, the intersections with the circle; two circles that coincide have none.
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

/// The intersections of a line and a circle, or the nearest point of the line.
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

/// [m] Largest error of a pose before polishing.
const NEAR: Metres = Metres(1e-4);
/// [m] Gaps of a pose that is found.
const FOUND: Metres = Metres(1e-12);

/// The pose near another in which three contacts touch.
fn polished(three: &[Contact; 3], near: Posture) -> Option<Posture> {
    let mut posture = near;
    // Where contacts come together without crossing, the gap falls to a quarter in each step: fourteen are enough.
    for _ in 0..=14 {
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
    None
}

/// The solution of three equations; `None` if they are singular.
pub(super) fn solve(rows: &[[f64; 3]; 3], right: &[f64; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = *rows;
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
