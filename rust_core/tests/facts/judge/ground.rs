//! The ground as faces and corners, and how deep a point lies in it.

use crawler2d_core::{Ground, Vector};

use super::{cross, left_of};

/// [m] Overlaps up to this depth are seen; a run in which one comes near it is no judgement.
pub(super) const REACH: f64 = 2e-3;

/// A straight piece of the ground, from left to right.
pub(super) struct Face {
    pub start: Vector,
    pub along: Vector,
    /// Out of the ground.
    pub normal: Vector,
    pub length: f64,
}

/// All the ground: face `i` leads from point `i` to point `i + 1`.
pub(super) struct Lane {
    pub faces: Vec<Face>,
    /// Whether the ground stands out at the start of each face.
    pub convex: Vec<bool>,
    pub friction: f64,
}

impl Lane {
    pub(super) fn new(ground: &Ground) -> Self {
        let points = &ground.lanes[0].points;
        let faces: Vec<Face> = points
            .windows(2)
            .map(|ends| {
                let way = ends[1] - ends[0];
                let along = way / way.length();
                Face {
                    start: ends[0],
                    along,
                    normal: left_of(along),
                    length: way.length(),
                }
            })
            .collect();
        let convex = (0..faces.len())
            .map(|i| i > 0 && cross(faces[i - 1].along, faces[i].along) < 0.0)
            .collect();
        Self {
            faces,
            convex,
            friction: ground.lanes[0].friction.most().coefficient,
        }
    }

    /// Lane that may be touched by a disc about `center`, from the first to before the last.
    pub(super) fn near(&self, center: Vector, radius: f64) -> std::ops::Range<usize> {
        let close = |face: &Face| {
            let way = (center - face.start)
                .dot(face.along)
                .clamp(0.0, face.length);
            (face.start + face.along * way - center).length() < radius
        };
        let first = self.faces.iter().position(close);
        let last = self.faces.iter().rposition(close);
        match (first, last) {
            (Some(first), Some(last)) => first..last + 1,
            _ => 0..0,
        }
    }

    /// [m] How deep `point` lies behind a face, if it lies beside it.
    ///
    /// Behind an inner corner a face goes on: a point in that corner is in both faces.
    fn below(&self, i: usize, point: Vector) -> Option<f64> {
        let face = &self.faces[i];
        let from_start = point - face.start;
        let depth = -from_start.dot(face.normal);
        if !(0.0..REACH).contains(&depth) {
            return None;
        }
        let way = from_start.dot(face.along);
        let end_is_convex = self.convex.get(i + 1).is_some_and(|c| *c);
        // At a sharp corner a point may be beside and behind one face, and out of the ground.
        let behind = |j: usize| (point - self.faces[j].start).dot(self.faces[j].normal) < 0.0;
        let beyond = |convex: bool| if convex { 0.0 } else { REACH };
        let beside = -beyond(self.convex[i]) <= way
            && way <= face.length + beyond(end_is_convex)
            && (!self.convex[i] || behind(i - 1))
            && (!end_is_convex || behind(i + 1));
        beside.then_some(depth)
    }

    /// The faces that a point is behind, each with the depth [m]; of two faces that meet in a corner
    /// that stands out, the nearer one.
    pub(super) fn over(
        &self,
        point: Vector,
        range: std::ops::Range<usize>,
        mut found: impl FnMut(usize, f64),
    ) {
        let mut pending: Option<(usize, f64)> = None;
        let mut last = usize::MAX - 1;
        for i in range {
            let Some(depth) = self.below(i, point) else {
                continue;
            };
            pending = match pending {
                // Both ends of a chain of facets are compared with the nearest so far.
                Some((_, other)) if last + 1 == i && self.convex[i] => {
                    if depth < other {
                        Some((i, depth))
                    } else {
                        pending
                    }
                }
                Some((j, other)) => {
                    found(j, other);
                    Some((i, depth))
                }
                None => Some((i, depth)),
            };
            last = i;
        }
        if let Some((i, depth)) = pending {
            found(i, depth);
        }
    }

    /// Whether a direction out of the start of face `i` lies between the normals of its two faces.
    pub(super) fn in_cone(&self, i: usize, direction: Vector) -> bool {
        self.convex[i]
            && direction.dot(self.faces[i - 1].along) >= 0.0
            && direction.dot(self.faces[i].along) <= 0.0
    }
}
