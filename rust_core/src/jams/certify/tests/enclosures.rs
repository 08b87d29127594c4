//! Intervals, rectangles and turns contain all their values, and are no wider than necessary.
#![allow(clippy::float_cmp)] // an end of a product is the product of two ends

use super::*;
use crate::jams::certify::touch::Normals;

fn interval(draw: &mut Draw) -> Interval {
    let [a, b] = [0.0; 2].map(|_| draw.between(-2.0, 2.0));
    Interval::new(a.min(b), a.max(b))
}

fn vector(draw: &mut Draw, most: f64) -> Vector {
    let [x, y] = [0.0; 2].map(|_| draw.between(-most, most));
    Vector::new(x, y)
}

fn rectangle(draw: &mut Draw, most: f64) -> Rectangle {
    Rectangle {
        middle: vector(draw, most),
        half: vector(draw, most).abs(),
    }
}

fn corners(all: Rectangle) -> [Vector; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| all.middle + all.half * Vector::new(x, y))
}

/// The smallest and the largest of several numbers.
fn range(numbers: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let both = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
    (numbers.into_iter()).fold([f64::INFINITY, f64::NEG_INFINITY], both)
}

/// A range of angles about one [rad].
/// [rad] Half of a range of angles, which is small or drawn.
fn half_range(draw: &mut Draw, is_narrow: bool) -> f64 {
    if is_narrow {
        1e-3
    } else {
        draw.between(0.0, 0.5)
    }
}

fn turns(angle: f64, half: f64) -> Turns {
    let mut cell = Cell::ZERO;
    (cell.low[2], cell.high[2]) = (angle - half, angle + half);
    Turns::of(&cell)
}

/// Each of them rises or falls with each of its numbers.
#[test]
fn sums_differences_and_products_are_least_and_greatest_at_ends() {
    let mut draw = Draw(1);
    for _ in 0..500 {
        let (one, other) = (interval(&mut draw), interval(&mut draw));
        let at_ends = |f: &dyn Fn(f64, f64) -> f64| {
            let pairs = [one.low, one.high].map(|a| [other.low, other.high].map(|b| f(a, b)));
            range(pairs.concat())
        };
        let ends = |all: Interval| [all.low, all.high];
        assert_eq!(ends(one + other), at_ends(&|a, b| a + b));
        assert_eq!(ends(one - other), at_ends(&|a, b| a - b));
        assert_eq!(ends(one * other), at_ends(&|a, b| a * b));
        assert_eq!(ends(-one), range([-one.low, -one.high]));
        let again = Interval::around(one.middle(), one.half());
        assert!(
            (again.low - one.low)
                .abs()
                .max((again.high - one.high).abs())
                < 1e-15
        );
    }
}

#[test]
fn a_decision_keeps_its_margin() {
    for (margins, decided) in [(0.5, false), (2.0, true)] {
        let off = margins * MARGIN;
        assert_eq!(Interval::new(0.2 + off, 0.3).is_above(0.2), decided);
        assert_eq!(Interval::new(0.1, 0.2 - off).is_below(0.2), decided);
        assert_eq!(Interval::new(off, 1.0).is_signed(), decided);
        assert_eq!(Interval::new(-1.0, -off).is_signed(), decided);
        let (one, other) = (Interval::new(0.0, 1.0), Interval::new(1.0 + off, 2.0));
        assert_eq!(one.meets(other), !decided);
        assert_eq!(other.meets(one), !decided);
    }
    assert!(!Interval::new(-1.0, 1.0).is_signed());
}

/// What is linear is least and greatest at corners, and so is the greatest distance; the nearest point of a rectangle
/// to the origin has each coordinate as near to 0 as it can be.
#[test]
fn a_rectangle_reaches_as_far_as_its_corners_and_as_near_as_its_sides() {
    let mut draw = Draw(2);
    for _ in 0..500 {
        let (all, way) = (rectangle(&mut draw, 1.0), vector(&mut draw, 1.0));
        let other = rectangle(&mut draw, 1.0);
        let close = |found: Interval, [low, high]: [f64; 2]| {
            // Two roundings of numbers up to 5.
            (found.low - low).abs().max((found.high - high).abs()) < 1e-14
        };
        let along = |way: Vector| range(corners(all).map(|v| v.dot(way)));
        assert!(close(all.along(way), along(way)));
        assert!(close(all.x(), along(Vector::X)) && close(all.y(), along(Vector::Y)));
        assert!(close(all.times(-2.0).along(way), along(way * -2.0)));
        let nearest = Vector::ZERO.clamp(all.middle - all.half, all.middle + all.half);
        let [_, farthest] = range(corners(all).map(Vector::length));
        assert!(close(all.distance(), [nearest.length(), farthest]));
        let both = |sign: f64| {
            let sums = corners(all).map(|a| corners(other).map(|b| (a + b * sign).dot(way)));
            range(sums.concat())
        };
        assert!(close((all + other).along(way), both(1.0)));
        assert!(close((all - other).along(way), both(-1.0)));
    }
}

/// Corners turned to both ends of the range of angles, and half way, are all within; within so small a range they reach
/// the bounds up to the square of it, and up to how far the corners are from the middle, which turns along.
#[test]
fn a_turned_rectangle_lies_within_its_bounds_and_all_but_reaches_them() {
    let mut draw = Draw(3);
    for case in 0..500 {
        let is_narrow = case % 2 == 0;
        let half = half_range(&mut draw, is_narrow);
        let (angle, all) = (draw.between(-3.0, 3.0), rectangle(&mut draw, 1.0));
        let turns = turns(angle, half);
        let turned = |v: Vector| {
            let at = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| angle + share * half);
            at.map(|angle| Vector::from_angle(angle).rotate(v))
        };
        let (point, whole) = (turns.apply(all.middle), turns.apply_all(all));
        // Lengths up to 3 turn by the half range at most.
        let squares = 20.0 * half * half;
        let far = 2.0 * all.half.length() * half;
        for (bounds, points, most) in [
            (point, turned(all.middle).to_vec(), squares),
            (whole, corners(all).map(turned).concat(), far + squares),
        ] {
            for axis in [Vector::X, Vector::Y] {
                let [low, high] = range(points.iter().map(|v| v.dot(axis)));
                let found = bounds.along(axis);
                assert!(found.low <= low + 1e-15 && found.high >= high - 1e-15);
                if is_narrow {
                    assert!(low - found.low < most && found.high - high < most, "{case}");
                }
            }
        }
        assert!((turns.middle(all.middle) - point.middle).length() < 1e-15);
    }
}

/// In the robot's frame, the ground turns in the opposite direction.
#[test]
fn what_is_seen_lies_within_its_distance_and_all_but_reaches_it() {
    let mut draw = Draw(4);
    for case in 0..500 {
        let is_narrow = case % 2 == 0;
        let half = half_range(&mut draw, is_narrow);
        let angle = draw.between(-3.0, 3.0);
        let mut all = rectangle(&mut draw, 1.0);
        if is_narrow {
            // A turn and a rectangle do not add up in one direction; either alone is exact.
            all = Rectangle::at(all.middle);
        }
        let (middle, off) = turns(angle, half).seen(all);
        let seen =
            |v: Vector| [-half, 0.0, half].map(|by| Vector::from_angle(-angle - by).rotate(v));
        let offs = corners(all).map(|v| seen(v).map(|at| (at - middle).length()));
        let [_, most] = range(offs.concat());
        assert!(most <= off + 1e-15);
        assert!(!is_narrow || off - most < half * half, "{case}");
    }
}

#[test]
fn the_reach_of_a_still_rectangle_is_its_half_diagonal() {
    let all = Rectangle {
        middle: Vector::new(7.0, -2.0),
        half: Vector::new(0.3, 0.4),
    };
    let (_, off) = turns(1.0, 0.0).seen(all);
    assert!((off - 0.5).abs() < 1e-15);
}

/// So many points of the arc, from end to end, miss its farthest by a millionth at most.
#[test]
fn a_rectangle_of_normals_is_that_round_their_arc() {
    let mut draw = Draw(6);
    for case in 0..300 {
        let sines = range([0.0; 2].map(|_| draw.between(-0.95, 0.95)));
        let angle = draw.between(-3.0, 3.0);
        let normals = Normals {
            bisector: Vector::from_angle(angle),
            sines,
            circle: None,
            is_on_face: false,
        };
        let [from, to] = sines.map(libm::asin);
        let points = (0..=2_000).map(|k| {
            let turn = from + (to - from) * f64::from(k) / 2_000.0;
            Vector::from_angle(angle + turn)
        });
        for axis in [Vector::X, Vector::Y] {
            let [low, high] = range(points.clone().map(|v| v.dot(axis)));
            let found = normals.all().along(axis);
            let off = (found.low - low).abs().max((found.high - high).abs());
            assert!(off < 1e-6, "{case}: {found:?} {low} {high}");
        }
    }
}

/// A linear value is smallest and largest where each parameter is smallest or largest.
#[test]
fn what_is_in_proportion_ranges_between_the_corners_of_a_cell() {
    let mut draw = Draw(5);
    for _ in 0..200 {
        let mut cell = Cell::ZERO;
        for number in 3..NUMBERS {
            let shares = [0.0; 2].map(|_| draw.between(0.0, 1.0));
            [cell.low[number], cell.high[number]] = range(shares);
        }
        let all: [Shares; 16] = std::array::from_fn(|corner| {
            std::array::from_fn(|k| {
                let ends = [cell.low[3 + k], cell.high[3 + k]];
                ends[corner >> k & 1]
            })
        });
        let numbers = Affine::through((0..5).map(|_| draw.between(-1.0, 1.0)));
        let [low, high] = range(all.map(|shares| numbers.at(&shares)));
        let found = numbers.over(&cell);
        assert!((found.low - low).abs().max((found.high - high).abs()) < 1e-14);
        let vectors = Affine::through((0..5).map(|_| vector(&mut draw, 1.0)));
        for axis in [Vector::X, Vector::Y] {
            let [low, high] = range(all.map(|shares| vectors.at(&shares).dot(axis)));
            let found = vectors.over(&cell).along(axis);
            assert!((found.low - low).abs().max((found.high - high).abs()) < 1e-14);
        }
    }
    // Through what it is made from: at the least of all, and with one at the most.
    let of = Affine::through([1.0, 3.0, 7.0].into_iter());
    assert_eq!(of.at(&[0.0; MOST_PARAMETERS]), 1.0);
    assert_eq!(of.at(&[1.0, 0.0, 0.0, 0.0]), 3.0);
    assert_eq!(of.at(&[0.0, 1.0, 0.0, 0.0]), 7.0);
    assert_eq!(of.at(&[0.0, 0.0, 1.0, 1.0]), 1.0);
}

#[test]
fn two_halves_make_a_cell() {
    let mut cell = Cell::ZERO;
    for number in 0..NUMBERS {
        (cell.low[number], cell.high[number]) = (number as f64, 3.0 * number as f64 + 1.0);
    }
    for number in 0..NUMBERS {
        let [lower, upper] = cell.split(number);
        assert_eq!((lower.low, upper.high), (cell.low, cell.high));
        assert_eq!(lower.high[number], upper.low[number]);
        assert_eq!(lower.half(number), upper.half(number));
        for other in (0..NUMBERS).filter(|other| *other != number) {
            assert_eq!(lower.high[other], cell.high[other]);
            assert_eq!(upper.low[other], cell.low[other]);
        }
    }
    let point = cell.at_middle();
    assert_eq!(point.low, point.high);
    assert_eq!(cell.shares().to_vec(), point.low[3..].to_vec());
    let (all, at) = (cell.position(), point.position());
    assert_eq!((all.middle, at.half), (at.middle, Vector::ZERO));
    assert_eq!(all.half, Vector::new(cell.half(0), cell.half(1)));
}
