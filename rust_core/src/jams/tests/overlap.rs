//! Whether a robot overlaps with the ground.

use super::*;
use crate::jams::clear::{distance, is_clear};

fn discs(draw: &mut Draw, count: usize) -> Vec<Disc> {
    let of = |_| Disc {
        center: vector(draw, 0.5),
        radius: draw.between(0.0, 0.2),
    };
    (0..count).map(of).collect()
}

/// The distance of two convex bodies is their largest separation along any direction. The best of 10,000 directions is
/// off by at most half a step, and the nearest points of the bodies are at most 2 m apart.
#[test]
fn the_distance_of_a_part_is_the_most_that_a_direction_separates_it() {
    let mut draw = Draw(21);
    let (mut apart, mut over) = (0, 0);
    for case in 0..300 {
        let discs = discs(&mut draw, 1 + case % 4);
        let solid = Solid::new(0, discs.clone());
        let [a, b] = [0.0; 2].map(|_| vector(&mut draw, 1.0));
        let points = if case % 3 == 0 { [a; 2] } else { [a, b] };
        let radius = if case % 2 == 0 { 0.0 } else { 0.03 };
        let separated = |k: u32| {
            let u = Vector::from_angle(TAU * f64::from(k) / 10_000.0);
            let least = points[0].dot(u).min(points[1].dot(u)) - radius;
            let most = discs.iter().map(|d| d.center.dot(u) + d.radius);
            least - most.fold(f64::NEG_INFINITY, f64::max)
        };
        let expected = (0..10_000).map(separated).fold(f64::NEG_INFINITY, f64::max);
        let runs = solid.runs.iter().copied();
        let found = distance(&solid, &discs, runs, &points, radius);
        if expected > 1e-5 {
            apart += 1;
            let off = found - expected;
            assert!(
                (-1e-12..1e-3).contains(&off),
                "case {case}: {found} {expected}"
            );
        } else if expected < -1e-3 {
            over += 1;
            // For bodies that overlap, only this is known.
            assert!(found < 0.0, "case {case}: {found} {expected}");
        }
    }
    assert!(apart > 100 && over > 50, "{apart} {over}");
}

/// Ground that is level except for a rounded step.
fn step() -> Vec<Place> {
    let (height, round) = (0.1, 0.01);
    let face = |from: [f64; 2], to: [f64; 2], normal: Vector| {
        let ends = [from, to].map(Vector::from);
        place(Facing::Face { ends, normal }, 0.5)
    };
    let corner = Facing::Corner {
        center: Vector::new(round, height - round),
        radius: round,
        cone: [Vector::Y, Vector::NEG_X],
    };
    vec![
        face([-1.0, 0.0], [0.0, 0.0], Vector::Y),
        face([0.0, 0.0], [0.0, height - round], Vector::NEG_X),
        place(corner, 0.5),
        face([round, height], [1.0, height], Vector::Y),
    ]
}

/// A wheel may touch the ground; nowhere is it clear inside it, however deep, nor where the ground has ended.
#[test]
fn a_wheel_is_clear_over_the_ground_and_nowhere_else() {
    let radius = 0.05;
    let wheel = Disc {
        center: Vector::new(0.3, 0.1),
        radius,
    };
    let mut layout = setting(vec![], vec![], Vector::ZERO).layout;
    layout.solids = vec![Solid::new(0, vec![wheel])];
    let places = step();
    let tolerance = 1e-9;
    for angle in [0.0, 0.7] {
        let is_clear_at = |x: f64, y: f64| {
            let position = Vector::new(x, y) - Turn::by(angle).apply(wheel.center);
            is_clear(&layout, &places, &Posture { position, angle }, tolerance)
        };
        let corner = Vector::new(0.01, 0.09) + Vector::new(-0.6, 0.8) * (radius + 0.01);
        let bit = 1e-6;
        for (x, y) in [
            (-0.5, radius),
            (-radius, 0.07),
            (0.5, 0.1 + radius),
            (corner.x, corner.y),
        ] {
            assert!(is_clear_at(x, y), "{x} {y}");
            // Away from the ground it stays clear, into it not.
            assert!(
                is_clear_at(x - bit, y + bit) && !is_clear_at(x + bit, y - bit),
                "{x} {y}"
            );
        }
        for (x, y) in [
            (-0.5, -0.3),
            (0.5, 0.0),
            (0.3, -0.4),
            (0.01, 0.02),
            (-1.2, 0.2),
            (1.2, 0.3),
        ] {
            assert!(!is_clear_at(x, y), "{x} {y}");
        }
        assert!(is_clear_at(-0.5, 3.0) && is_clear_at(0.005, 3.0) && is_clear_at(0.0, 3.0));
    }
    // One of two parts is enough.
    layout.solids.push(Solid::new(
        0,
        vec![Disc {
            center: Vector::new(0.3, -0.1),
            radius,
        }],
    ));
    let at = |y: f64| Posture {
        position: Vector::new(-0.5, y),
        angle: 0.0,
    };
    assert!(is_clear(&layout, &places, &at(0.15), tolerance));
    assert!(!is_clear(&layout, &places, &at(0.1), tolerance));
    // And parts over another lane have none of this ground under them.
    layout.solids[1].lane = 1;
    assert!(!is_clear(&layout, &places, &at(0.15), tolerance));
}
