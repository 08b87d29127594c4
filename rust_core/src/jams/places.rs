//! The ground as faces and corners, on which a robot can stand.

use crate::geometry::{Vector, is_between, left_of};
use crate::terrain::{Edge, Ground, Profile};

/// A face of the ground or a convex corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Index of its lane.
    pub lane: usize,
    /// Number of the edge on its lane, if it is a corner.
    pub edge: Option<i32>,
    pub shape: Facing,
    /// Coefficient of friction.
    pub friction: f64,
}

/// The shape of a place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Facing {
    /// A straight face from left to right.
    Face {
        /// [m] Its ends, those of the arcs of rounded edges.
        ends: [Vector; 2],
        /// Unit vector out of the ground.
        normal: Vector,
    },
    /// A corner, which may be rounded.
    Corner {
        /// [m] Centre of its arc.
        center: Vector,
        /// [m] Radius, 0 is sharp.
        radius: f64,
        /// Unit vectors out of the faces behind it and before it.
        cone: [Vector; 2],
    },
}

/// Sine of the angle by which a normal may lie outside a corner's cone: rounding.
const OUTSIDE: f64 = 1e-9;

impl Place {
    /// The faces and the convex corners of all lanes.
    pub(super) fn of(ground: &Ground) -> Vec<Self> {
        let lanes = ground.lanes.iter().enumerate();
        lanes
            .flat_map(|(lane, profile)| Self::of_lane(lane, profile))
            .collect()
    }

    fn of_lane(lane: usize, profile: &Profile) -> Vec<Self> {
        let mut places = Vec::new();
        let last = profile.points.len() - 1;
        let starts = profile.edges.iter().map(|edge| edge.span[0] as usize);
        let ends = profile.edges.iter().map(|edge| edge.span[1] as usize);
        // A face runs from the end of one edge to the start of the next.
        let from = std::iter::once(0).chain(ends);
        let to = starts.chain(std::iter::once(last));
        let at = |place: usize| profile.points[place];
        let faces: Vec<[Vector; 2]> = from.zip(to).map(|(a, b)| [at(a), at(b)]).collect();
        let normal = |face: [Vector; 2]| left_of(face[1] - face[0]).normalize_or(Vector::Y);
        // Ground whose faces differ in friction is refused earlier.
        let friction = profile.friction.most().coefficient;
        for face in &faces {
            if face[0] == face[1] {
                continue;
            }
            places.push(Self {
                lane,
                edge: None,
                shape: Facing::Face {
                    ends: *face,
                    normal: normal(*face),
                },
                friction,
            });
        }
        for (edge, around) in profile.edges.iter().zip(faces.windows(2)) {
            if edge.angle <= 0.0 {
                continue;
            }
            let Edge { center, radius, .. } = *edge;
            // An arc that takes up a whole face leaves no direction of that face: the cone is that of the arc.
            let before = outwards(around[0], at(edge.span[0] as usize), edge, normal);
            let behind = outwards(around[1], at(edge.span[1] as usize), edge, normal);
            places.push(Self {
                lane,
                edge: Some(edge.id),
                shape: Facing::Corner {
                    center,
                    radius,
                    cone: [behind, before],
                },
                friction,
            });
        }
        places
    }
}

/// The direction out of the ground at the end of an edge's arc.
fn outwards(
    face: [Vector; 2],
    end: Vector,
    edge: &Edge,
    normal: impl Fn([Vector; 2]) -> Vector,
) -> Vector {
    if face[0] == face[1] && edge.radius > 0.0 {
        (end - edge.center) / edge.radius
    } else {
        normal(face)
    }
}

impl Facing {
    /// Whether a point of the extended line or circle, `foot`, from which `normal` points out of the ground, is on it.
    pub(super) fn is_touched(&self, foot: Vector, normal: Vector, tolerance: f64) -> bool {
        match self {
            Self::Face { ends: [a, b], .. } => {
                let along = (*b - *a).normalize_or(Vector::X);
                let here = (foot - *a).dot(along);
                here >= -tolerance && here <= (*b - *a).length() + tolerance
            }
            Self::Corner { cone, .. } => is_between(normal, *cone, OUTSIDE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Surface;

    #[test]
    fn a_step_has_three_faces_and_one_convex_corner() {
        for radius in [0.0, 0.02] {
            let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
            let surface = Surface {
                edge_radius: radius,
                ..Surface::sharp(0.7)
            };
            let profile = Profile::new("terrain", &points, surface, true).expect("a step");
            let places = Place::of_lane(0, &profile);
            assert_eq!(places.len(), 4);
            let Facing::Face { normal, ends } = places[1].shape else {
                panic!("{places:?}");
            };
            assert!((normal - Vector::NEG_X).length() < 1e-15);
            assert!((ends[1].y - (0.1 - radius)).abs() < 1e-15);
            let Facing::Corner { cone, center, .. } = places[3].shape else {
                panic!("{places:?}");
            };
            assert!((cone[0] - Vector::Y).length() < 1e-15);
            assert!((cone[1] - Vector::NEG_X).length() < 1e-15);
            assert!((center - Vector::new(radius, 0.1 - radius)).length() < 1e-15);
        }
    }

    /// All of the wall is an arc from its foot to its top.
    #[test]
    fn an_arc_that_takes_up_a_face_has_the_directions_of_its_own_ends() {
        let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
        let surface = Surface::rounded(0.1, 0.7);
        let profile = Profile::new("terrain", &points, surface, true).expect("a step");
        let places = Place::of_lane(3, &profile);
        assert_eq!(places.len(), 3);
        let Facing::Corner {
            cone,
            center,
            radius,
        } = places[2].shape
        else {
            panic!("{places:?}");
        };
        assert!((center - Vector::new(0.1, 0.0)).length() < 1e-15);
        assert!((radius - 0.1).abs() < 1e-15);
        assert!((cone[0] - Vector::Y).length() < 1e-12);
        assert!((cone[1] - Vector::NEG_X).length() < 1e-12);
        assert!(places.iter().all(|place| place.lane == 3));
        assert!(
            places
                .iter()
                .all(|place| (place.friction - 0.7).abs() < 1e-15)
        );
        // The faces have no number, and the corner has that of its edge.
        let convex = profile.edges.iter().find(|edge| edge.angle > 0.0);
        let edges = [None, None, convex.map(|edge| edge.id)];
        assert_eq!([0, 1, 2].map(|k| places[k].edge), edges);
    }

    #[test]
    fn a_face_is_touched_as_far_as_its_ends_and_a_tolerance_beyond() {
        let face = Facing::Face {
            ends: [Vector::new(1.0, 2.0), Vector::new(1.0, 5.0)],
            normal: Vector::NEG_X,
        };
        let tolerance = 0.125;
        for (y, touched) in [
            (1.75, false),
            (1.9, true),
            (2.0, true),
            (5.0, true),
            (5.1, true),
            (5.25, false),
        ] {
            let foot = Vector::new(1.0, y);
            assert_eq!(
                face.is_touched(foot, Vector::NEG_X, tolerance),
                touched,
                "{y}"
            );
        }
    }
}
