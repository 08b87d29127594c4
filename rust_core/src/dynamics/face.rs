//! The face of the ground on which an arc rolls, and how far the ground falls away below one that rolls past its end.
//!
//! Within a step a normal stays that of the face, and forces are constant: the velocities at both ends of the step do not
//! tell that the face has ended.
//!
//! The equations: docs/physics.md, "Length of a step".

use std::f64::consts::FRAC_PI_2;

use crate::contact::Contact;
use crate::geometry::{Vector, cross, right_of};
use crate::terrain::Profile;

/// What is left of a face on either side of a point, backwards and forwards along the tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// [m] The way to its end.
    left: [f64; 2],
    /// [rad] The angle by which the ground turns down there; 0 where it turns up.
    bend: [f64; 2],
}

impl Default for Face {
    /// One without an end.
    fn default() -> Self {
        Self {
            left: [f64::INFINITY; 2],
            bend: [0.0; 2],
        }
    }
}

impl Face {
    /// The one that a contact on no edge is on.
    pub(super) fn of(contact: &Contact, lane: &Profile) -> Self {
        let (points, facet) = (&lane.points, contact.facet);
        let along = right_of(contact.normal);
        let way = |point: Vector| (point - contact.point).dot(along);
        let way_of = |from: usize, to: usize| points[to] - points[from];
        let direction = way_of(facet, facet + 1);
        let down = |next: Vector, sign: f64| {
            (sign * libm::atan2(cross(direction, next), direction.dot(next))).max(0.0)
        };
        Self {
            left: [-way(points[facet]), way(points[facet + 1])],
            bend: [
                if facet > 0 {
                    down(way_of(facet - 1, facet), 1.0)
                } else {
                    0.0
                },
                if facet + 2 < points.len() {
                    down(way_of(facet + 1, facet + 2), -1.0)
                } else {
                    0.0
                },
            ],
        }
    }

    /// [m] The gap below an arc that has rolled by `way` [m] at the height of the face.
    pub(super) fn below(&self, radius: f64, way: f64) -> f64 {
        let end = usize::from(way > 0.0);
        let (past, bend) = (way.abs() - self.left[end], self.bend[end]);
        if past <= 0.0 {
            return 0.0;
        }
        // Over the corner, or over the next face.
        if past < radius * libm::tan(bend.min(FRAC_PI_2)) {
            libm::hypot(past, radius) - radius
        } else {
            past * bend.sin() - radius * (1.0 - bend.cos())
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::scenario::Surface;

    const RADIUS: f64 = 0.05;

    /// On a level face after one that falls by 0.2 rad, 3 mm before one that falls by `bend` [rad].
    fn before_a_corner(bend: f64) -> Face {
        let slope = |angle: f64| Vector::new(angle.cos(), angle.sin());
        let middle = Vector::new(0.1, 0.0);
        let points = [-slope(-0.2), Vector::ZERO, middle, middle + slope(-bend)];
        let points = points.map(|point| [point.x, point.y]);
        let lane = Profile::new("terrain", &points, Surface::sharp(0.5), true).expect("a profile");
        let point = middle - Vector::new(0.003, 0.0);
        let contact = Contact::new(0, (1, -1), (point, Vector::Y), 0.0);
        Face::of(&contact, &lane)
    }

    #[test]
    fn a_wheel_on_its_face_is_on_the_ground() {
        let face = before_a_corner(0.7);
        for way in [-0.09, 0.0, 0.0029] {
            assert!(face.below(RADIUS, way) <= 0.0);
        }
    }

    #[test]
    fn past_its_end_the_ground_is_a_corner_and_then_the_next_face() {
        let (bend, past) = (0.1_f64, [0.001, 0.02]);
        let [corner, slope] = past.map(|past| before_a_corner(bend).below(RADIUS, 0.003 + past));
        assert_relative_eq!(
            corner,
            (0.001_f64.powi(2) + RADIUS * RADIUS).sqrt() - RADIUS,
            max_relative = 1e-9
        );
        let center = Vector::new(0.02, RADIUS);
        let normal = Vector::new(bend.sin(), bend.cos());
        assert_relative_eq!(slope, center.dot(normal) - RADIUS, max_relative = 1e-9);
    }

    #[test]
    fn ground_that_rises_does_not_fall_away() {
        assert!(before_a_corner(-0.3).below(RADIUS, 0.02) <= 0.0);
        assert!(before_a_corner(0.7).below(RADIUS, -0.2) <= 0.0);
    }
}
