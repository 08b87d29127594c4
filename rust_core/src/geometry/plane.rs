//! Discs and their tangents, bounds of plausible numbers, and the engine's vectors and poses, which only this file
//! imports.

use crate::scenario::TrackOutline;

/// A point or a direction in the plane.
pub use rapier2d_f64::math::Vector;
pub(crate) use rapier2d_f64::math::{Pose, Rotation};

/// The z component of the product of two vectors.
pub(crate) fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The vector turned by +90 degrees.
pub(crate) fn left_of(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

/// The vector turned by -90 degrees.
pub(crate) fn right_of(v: Vector) -> Vector {
    Vector::new(v.y, -v.x)
}

/// Whether a vector points between two directions, counter-clockwise and less than half a turn apart, or beyond one of
/// them by an angle whose sine is at most `sine`.
pub(crate) fn is_between(v: Vector, [first, last]: [Vector; 2], sine: f64) -> bool {
    cross(first, v) >= -sine && cross(v, last) >= -sine && v.dot(first + last) > 0.0
}

/// The unit vector at an angle [rad] from +x; bit-identical on every platform.
pub(crate) fn direction(angle: f64) -> Vector {
    let (sine, cosine) = libm::sincos(angle);
    Vector::new(cosine, sine)
}

/// Turns points about the origin by an angle [rad]; bit-identical on every platform.
pub(crate) fn turned_by(angle: f64) -> impl Fn(Vector) -> Vector + Copy {
    let (sine, cosine) = libm::sincos(angle);
    move |p| Vector::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y)
}

/// In any SI unit: a thousand times the weight of the heaviest robot. Results computed from such numbers are finite.
const MOST: f64 = 1e18;

/// Whether a run can have produced these numbers; NaN is implausible.
pub(crate) fn plausible(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.abs() < MOST)
}

/// The same for vectors.
pub(crate) fn plausible_vectors(vectors: &[Vector]) -> bool {
    vectors.iter().all(|v| plausible(&[v.x, v.y]))
}

/// A disc in the chassis frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// [m] Centre.
    pub center: Vector,
    /// [m] Radius.
    pub radius: f64,
}

impl Disc {
    /// A disc of radius 0.
    pub(crate) fn point(center: Vector) -> Self {
        Self {
            center,
            radius: 0.0,
        }
    }

    /// The concentric disc with its radius increased by a length [m], which may be negative.
    pub(crate) fn grown(self, by: f64) -> Self {
        Self {
            radius: self.radius + by,
            ..self
        }
    }
}

impl From<[f64; 3]> for Disc {
    fn from([x, y, radius]: [f64; 3]) -> Self {
        Self {
            center: Vector::new(x, y),
            radius,
        }
    }
}

/// The end discs of an outline, the rear one first.
pub(crate) fn end_discs(outline: &TrackOutline) -> [Disc; 2] {
    outline.end_discs().map(Disc::from)
}

/// The discs of an outline: the rear end, the front end, and those between them from the rear to the front.
pub(crate) fn outline_discs(outline: &TrackOutline) -> Vec<Disc> {
    let between = outline.discs_between();
    outline
        .end_discs()
        .into_iter()
        .chain(between)
        .map(Disc::from)
        .collect()
}

/// The lower outer tangent of two discs as a segment from the left disc to the right one.
pub(crate) fn lower_tangent(left: Disc, right: Disc) -> [Vector; 2] {
    let along = right.center - left.center;
    let distance = along.length();
    let u = along / distance;
    // The tangent's outward normal makes the same angle with the line of centres at both discs.
    let sine = (left.radius - right.radius) / distance;
    let cosine = (1.0 - sine * sine).sqrt();
    let down = Vector::new(u.y, -u.x);
    let normal = u * sine + down * cosine;
    [
        left.center + normal * left.radius,
        right.center + normal * right.radius,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f64, radius: f64) -> Disc {
        Disc {
            center: Vector::new(x, 0.0),
            radius,
        }
    }

    #[test]
    fn tangent_touches_both_discs_and_cuts_neither() {
        for (r1, r2) in [(0.1, 0.1), (0.1, 0.05), (0.03, 0.08)] {
            let (left, right) = (disc(-0.2, r1), disc(0.3, r2));
            let [a, b] = lower_tangent(left, right);
            let d = (b - a).normalize();
            for (point, circle) in [(a, left), (b, right)] {
                let spoke = point - circle.center;
                assert!((spoke.length() - circle.radius).abs() < 1e-15);
                assert!(spoke.dot(d).abs() < 1e-15);
                assert!(spoke.y < 0.0);
            }
        }
    }

    #[test]
    fn a_direction_is_between_two_others_or_past_one_by_no_more_than_an_angle() {
        let ends = [direction(0.2), direction(1.0)];
        let past = libm::sin(0.1);
        for (angle, sine, is_it) in [
            (0.6, 0.0, true),
            (0.21, 0.0, true),
            (0.99, 0.0, true),
            (0.19, 0.0, false),
            (1.01, 0.0, false),
            (0.11, past, true),
            (0.09, past, false),
            (1.09, past, true),
            (1.11, past, false),
            // The opposite of what lies between them.
            (0.6 + std::f64::consts::PI, 0.0, false),
            (0.6 + std::f64::consts::PI, 1.0, false),
        ] {
            let v = direction(angle) * if sine > 0.0 { 1.0 } else { 3.0 };
            assert_eq!(is_between(v, ends, sine), is_it, "{angle} rad, {sine}");
        }
        assert!(!is_between(Vector::ZERO, ends, 0.1));
    }

    #[test]
    fn a_turn_about_the_origin_adds_to_the_angle_of_a_point() {
        for angle in [-2.0, 0.3, 1.0, 4.0] {
            let found = turned_by(angle)(direction(0.7) * 2.0);
            assert!((found - direction(0.7 + angle) * 2.0).length() < 1e-15);
        }
    }
}
