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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::Disc;
    use crate::jams::contact::Kind;

    fn vector(draw: &mut Draw, most: f64) -> Vector {
        let [x, y] = [0.0; 2].map(|_| draw.between(-most, most));
        Vector::new(x, y)
    }

    /// A line or a circle through a point, not far from the origin.
    fn through(draw: &mut Draw, point: Vector, is_circle: bool) -> Locus {
        if is_circle {
            let center = vector(draw, 0.5);
            Locus::Circle(center, (point - center).length())
        } else {
            let normal = Vector::from_angle(draw.between(-3.0, 3.0));
            Locus::Line(normal, normal.dot(point))
        }
    }

    /// Any of lines and circles.
    const KINDS: [[bool; 3]; 5] = [
        [false, false, false],
        [false, true, false],
        [true, false, true],
        [true, true, false],
        [true, true, true],
    ];

    /// Two circles may meet in a second point on the same lines.
    #[test]
    fn what_meets_in_a_point_has_no_residual_and_is_found_there() {
        let mut draw = Draw(71);
        for case in 0..500 {
            let point = vector(&mut draw, 0.4);
            let loci = KINDS[case % 5].map(|is_circle| through(&mut draw, point, is_circle));
            let [value, size] = residual(&loci);
            // Circles round almost one point lose digits.
            assert!(value.abs() < 1e-12 * size, "{case}: {value} {size}");
            let (lines, _) = lines(&loci);
            let (_, scale) = meeting(lines[0], lines[1]);
            if scale.abs() < 0.05 * lines[0].0.length() * lines[1].0.length() {
                continue;
            }
            let found = positions(&loci);
            assert_eq!(found.len(), 1, "{case}");
            assert!((found[0] - point).length() < 1e-11, "{case}: {found:?}");
        }
    }

    /// If nothing is farther from the origin than 1 m, the terms of a value are squares of a length of at most its
    /// size.
    #[test]
    fn a_residual_is_no_larger_than_its_size() {
        let mut draw = Draw(72);
        for case in 0..2_000 {
            let loci = KINDS[case % 5].map(|is_circle| {
                let distance = draw.between(0.0, 1.0);
                let normal = Vector::from_angle(draw.between(-3.0, 3.0));
                if is_circle {
                    Locus::Circle(normal * distance, draw.between(0.0, 1.0))
                } else {
                    Locus::Line(normal, distance)
                }
            });
            let [value, size] = residual(&loci);
            assert!(
                value.abs() <= size * (1.0 + 1e-14),
                "{case}: {value} {size}"
            );
        }
        let line = |x: f64, y: f64, offset: f64| Locus::Line(Vector::new(x, y), offset);
        let circle = |x: f64, y: f64| Locus::Circle(Vector::new(x, y), 0.0);
        let root = 0.5_f64.sqrt();
        for (loci, least) in [
            // Lines that meet in the origin, 1 m from it, and in a corner of the square round it.
            (
                [line(1.0, 0.0, 0.0), line(0.0, 1.0, 0.0), circle(1.0, 0.0)],
                1.0,
            ),
            (
                [line(1.0, 0.0, 0.0), line(0.0, 1.0, 1.0), circle(0.0, -1.0)],
                4.0,
            ),
            (
                [
                    line(1.0, 0.0, 1.0),
                    line(0.0, 1.0, 1.0),
                    circle(-root, -root),
                ],
                5.8,
            ),
            (
                [
                    line(1.0, 0.0, 0.0),
                    line(0.0, 1.0, 0.0),
                    line(root, root, 1.0),
                ],
                1.0,
            ),
            (
                [
                    line(1.0, 0.0, 0.0),
                    line(0.0, 1.0, 1.0),
                    line(0.0, -1.0, 1.0),
                ],
                2.0,
            ),
        ] {
            let [value, size] = residual(&loci);
            let most = size * (1.0 + 1e-14);
            assert!((least..=most).contains(&value.abs()), "{value} {size}");
        }
    }

    /// The second of two almost parallel lines tells nothing, nor the line through the intersections of circles round
    /// one point.
    #[test]
    fn of_lines_that_are_almost_one_the_places_on_a_circle_are_found() {
        let mut draw = Draw(73);
        for case in 0..100 {
            let point = vector(&mut draw, 0.4);
            let circle = through(&mut draw, point, true);
            let Locus::Circle(center, radius) = circle else {
                panic!("it is one");
            };
            let tilted = |angle: f64| {
                let normal = Vector::from_angle(angle);
                Locus::Line(normal, normal.dot(point))
            };
            let angle = draw.between(-3.0, 3.0);
            let other = through(&mut draw, point, true);
            for loci in [
                [tilted(angle), tilted(angle + 1e-10), circle],
                [tilted(angle), tilted(angle + 1e-7), circle],
                [tilted(angle), circle, circle],
                [circle, circle, other],
                [circle, other, circle],
            ] {
                let found = positions(&loci);
                assert_eq!(found.len(), 2, "{case}: {loci:?}");
                assert!(
                    found.iter().any(|place| (*place - point).length() < 1e-6),
                    "{case}: {found:?} {point}"
                );
                for place in found {
                    let off = (place - center).length() - radius;
                    assert!(off.abs() < 1e-12, "{case}: {off} m");
                }
            }
        }
    }

    /// Of three lines, two of which are almost parallel, the sharpest crossing is the most accurate.
    #[test]
    fn three_lines_meet_where_the_sharpest_crossing_is() {
        let point = Vector::new(0.3, -0.2);
        let line = |angle: f64, off: f64| {
            let normal = Vector::from_angle(angle);
            Locus::Line(normal, normal.dot(point) + off)
        };
        // Where the second is off by 1 nm, it crosses the first some millimetres away.
        for loci in [
            [line(0.4, 0.0), line(0.4 + 1e-7, 1e-9), line(1.9, 0.0)],
            [line(0.4, 0.0), line(1.9, 0.0), line(0.4 + 1e-7, 1e-9)],
            [line(1.9, 0.0), line(0.4 + 1e-7, 1e-9), line(0.4, 0.0)],
        ] {
            let found = positions(&loci);
            assert_eq!(found.len(), 1);
            assert!((found[0] - point).length() < 2e-9, "{found:?}");
        }
        // Parallel lines meet nowhere.
        assert!(positions(&[0.0, 0.1, 0.2].map(|off| line(0.4, off))).is_empty());
    }

    #[test]
    fn a_line_cuts_a_circle_in_two_points_or_its_nearest_point_is_returned() {
        let mut draw = Draw(74);
        for case in 0..200 {
            let (center, radius) = (vector(&mut draw, 1.0), draw.between(0.1, 1.0));
            let normal = vector(&mut draw, 2.0);
            let far = draw.between(-1.5, 1.5) * radius;
            let offset = normal.dot(center) + far * normal.length();
            let [one, other] = on_circle((normal, offset), (center, radius));
            for place in [one, other] {
                assert!((normal.dot(place) - offset).abs() < 1e-12, "{case}");
                let distance = (place - center).length();
                assert!((distance - radius.max(far.abs())).abs() < 1e-12, "{case}");
            }
            let apart = 2.0 * (radius * radius - far * far).max(0.0).sqrt();
            assert!(((one - other).length() - apart).abs() < 1e-7, "{case}");
        }
    }

    /// Whichever way their normals point.
    #[test]
    fn parallel_lines_are_as_far_apart_as_their_offsets_differ() {
        let normal = Vector::new(0.6, 0.8);
        for (one, other, distance, size) in [
            ((normal, 1.0), (normal, 0.25), 0.75, 1.25),
            ((normal, 1.0), (-normal, -0.25), 0.75, 1.25),
            ((normal, 1.0), (normal, -0.25), 1.25, 1.25),
            ((-normal, -1.0), (normal, 1.0), 0.0, 2.0),
        ] {
            let found = apart(one, other);
            assert!((found[0] - distance).abs() < 1e-15, "{found:?}");
            assert!((found[1] - size).abs() < 1e-15, "{found:?}");
        }
    }

    /// A disc in a corner of the ground, and another one that hangs on a wall.
    #[test]
    fn a_pose_within_a_tenth_of_a_millimetre_is_brought_to_its_contacts() {
        let on = |x: f64, normal: Vector| Contact {
            surface: 0,
            place: 0,
            kind: Kind::OnFace(
                Disc {
                    center: Vector::new(x, 0.0),
                    radius: 0.05,
                },
                normal,
                -0.05,
            ),
        };
        // All of them touch where the chassis frame is at the origin.
        let three = [on(0.0, Vector::X), on(0.0, Vector::Y), on(0.3, Vector::Y)];
        for (off, is_near) in [
            (0.0, true),
            (0.9e-4, true),
            (-0.9e-4, true),
            (1.1e-4, false),
        ] {
            for position in [Vector::X * off, Vector::Y * off] {
                let found = polished(
                    &three,
                    Posture {
                        position,
                        angle: 0.0,
                    },
                );
                assert_eq!(found.is_some(), is_near, "{position}");
                if let Some(Posture { position, angle }) = found {
                    assert!(position.length() < 1e-11 && angle.abs() < 1e-11);
                }
            }
        }
    }

    /// Each in three directions, of which pairs are parallel or not.
    #[test]
    fn contacts_are_told_apart_by_how_many_of_their_lines_are_parallel() {
        let on = |normal: Vector| {
            let disc = Disc {
                center: Vector::new(0.1, 0.2),
                radius: 0.05,
            };
            Contact {
                surface: 0,
                place: 0,
                kind: Kind::OnFace(disc, normal, 0.3),
            }
        };
        let of = |normals: [Vector; 3]| parallel(&normals.map(on));
        let (x, y, z) = (Vector::X, Vector::Y, Vector::new(0.6, 0.8));
        assert!(matches!(of([x, y, z]), Parallel::None));
        assert!(matches!(of([x, -x, z]), Parallel::Two(0, 1)));
        assert!(matches!(of([x, y, x]), Parallel::Two(0, 2)));
        assert!(matches!(of([x, y, -y]), Parallel::Two(1, 2)));
        assert!(matches!(of([x, x, -x]), Parallel::All));
    }
}
