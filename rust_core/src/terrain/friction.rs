//! The friction of a lane, which may differ from segment to segment; docs/physics.md, "Coulomb's law".

use crate::geometry::Vector;
use crate::scenario::Friction;
use crate::units::Metres;

/// [m] A contact whose distances from two segments differ by less touches both: its overlap with the ground, which is
/// smaller, may shift it off their corner.
const AT_BOTH: Metres = Metres(1e-5);

/// Resistance of a lane against sliding.
#[derive(Clone, Debug)]
pub struct GroundFriction {
    /// Friction of the whole lane; the largest, if it differs between segments.
    most: Friction,
    /// Segments from left to right, if friction differs.
    segments: Vec<Segment>,
    /// [m] Largest distance of a point of the lane from its segment.
    reach: f64,
}

/// A segment of the described ground, before its edges are rounded.
#[derive(Clone, Copy, Debug)]
struct Segment {
    left: Vector,
    right: Vector,
    friction: Friction,
}

impl GroundFriction {
    /// The same everywhere.
    pub(crate) fn everywhere(friction: Friction) -> Self {
        Self {
            most: friction,
            segments: Vec::new(),
            reach: 0.0,
        }
    }

    /// The friction of each segment between described points, in either direction, with edges rounded by a radius [m].
    pub(super) fn of_segments(points: &[[f64; 2]], frictions: &[f64], radius: f64) -> Self {
        let points = points.iter().map(|p| Vector::new(p[0], p[1]));
        let points: Vec<Vector> = points.collect();
        let mut segments: Vec<Segment> = points
            .windows(2)
            .zip(frictions)
            .filter(|(ends, _)| ends[0] != ends[1])
            .map(|(ends, friction)| Segment {
                left: ends[0],
                right: ends[1],
                friction: Friction::dry(*friction),
            })
            .collect();
        if points[0].x > points[points.len() - 1].x {
            segments.reverse();
            for segment in &mut segments {
                std::mem::swap(&mut segment.left, &mut segment.right);
            }
        }
        let most = segments.iter().map(|segment| segment.friction);
        Self {
            most: most.fold(Friction::dry(0.0), Friction::or_larger),
            segments,
            reach: radius + AT_BOTH.value(),
        }
    }

    /// [m] The x at which it may change; none if it is the same everywhere.
    pub(super) fn changes(&self) -> impl Iterator<Item = f64> + '_ {
        let segments = self.segments.iter();
        segments.flat_map(|segment| [segment.left.x, segment.right.x])
    }

    /// The largest anywhere.
    pub fn most(&self) -> Friction {
        self.most
    }

    /// That of the segment nearest to a point of the ground; at a corner the larger of two.
    pub(crate) fn at(&self, point: Vector) -> Friction {
        if self.segments.is_empty() {
            return self.most;
        }
        let from = |x: f64| self.segments.partition_point(|s| s.right.x < x);
        let to = |x: f64| self.segments.partition_point(|s| s.left.x <= x);
        // A point beyond the ends belongs to the last segment on its side.
        let first = from(point.x - self.reach).min(self.segments.len() - 1);
        let behind = to(point.x + self.reach).max(first + 1);
        let near = &self.segments[first..behind];
        let least = near.iter().map(|s| s.distance(point));
        let limit = least.fold(f64::INFINITY, f64::min) + AT_BOTH.value();
        let touched = near.iter().filter(|s| s.distance(point) <= limit);
        touched.fold(Friction::dry(0.0), |most, s| most.or_larger(s.friction))
    }
}

impl Segment {
    /// [m] Distance of a point.
    fn distance(&self, point: Vector) -> f64 {
        let (along, to) = (self.right - self.left, point - self.left);
        let fraction = (to.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (to - along * fraction).length()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // coefficients are handed on as they are

    use super::*;

    const STEP: [[f64; 2]; 5] = [[-1.0, 0.0], [-0.5, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
    const FRICTIONS: [f64; 4] = [0.9, 0.1, 0.3, 0.6];

    fn at(ground: &GroundFriction, x: f64, y: f64) -> f64 {
        ground.at(Vector::new(x, y)).coefficient
    }

    #[test]
    fn a_segment_is_as_far_as_its_nearest_point() {
        let segment = Segment {
            left: Vector::new(1.0, 1.0),
            right: Vector::new(3.0, 1.0),
            friction: Friction::dry(0.5),
        };
        for (x, y, distance) in [
            (2.5, 3.0, 2.0),
            (1.0, 0.0, 1.0),
            (0.0, 1.0, 1.0),
            (6.0, 5.0, 5.0),
        ] {
            assert_eq!(segment.distance(Vector::new(x, y)), distance);
        }
    }

    #[test]
    fn each_segment_has_its_own() {
        let ground = GroundFriction::of_segments(&STEP, &FRICTIONS, 0.0);
        let places = [(-0.7, 0.0), (-0.2, 0.0), (0.0, 0.05), (0.4, 0.1)];
        assert_eq!(places.map(|(x, y)| at(&ground, x, y)), FRICTIONS);
        assert_eq!(ground.most().coefficient, 0.9);
    }

    #[test]
    fn at_a_corner_the_larger_counts_whichever_segment_a_contact_overlaps_more() {
        let ground = GroundFriction::of_segments(&STEP, &FRICTIONS, 0.0);
        for (x, y) in [(0.0, 0.1), (1e-6, 0.1 - 3e-6), (3e-6, 0.1 - 1e-6)] {
            assert_eq!(at(&ground, x, y), 0.6);
        }
    }

    #[test]
    fn the_direction_of_the_points_does_not_matter() {
        let back: Vec<[f64; 2]> = STEP.iter().rev().copied().collect();
        let frictions: Vec<f64> = FRICTIONS.iter().rev().copied().collect();
        let ground = GroundFriction::of_segments(&back, &frictions, 0.0);
        assert_eq!(at(&ground, -0.2, 0.0), 0.1);
        assert_eq!(at(&ground, 0.0, 0.05), 0.3);
    }

    #[test]
    fn an_arc_is_divided_between_the_faces_beside_it() {
        let radius = 0.02;
        let ground = GroundFriction::of_segments(&STEP, &FRICTIONS, radius);
        let on_arc = |angle: f64| (radius * (1.0 - angle.cos()), 0.08 + radius * angle.sin());
        let [(low_x, low_y), (high_x, high_y)] = [0.2, 1.3].map(on_arc);
        assert_eq!(at(&ground, low_x, low_y), 0.3);
        assert_eq!(at(&ground, high_x, high_y), 0.6);
    }

    #[test]
    fn beyond_the_ends_the_last_segment_counts() {
        let ground = GroundFriction::of_segments(&STEP, &FRICTIONS, 0.0);
        assert_eq!([-5.0, 5.0].map(|x| at(&ground, x, 0.0)), [0.9, 0.6]);
    }
}
