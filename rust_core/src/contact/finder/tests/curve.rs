//! Lines and arcs, and the nearest points between two of them.

use std::f64::consts::TAU;

use crate::geometry::{Vector, cross, left_of};

/// A feature of an outline or of the ground.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    Line([Vector; 2]),
    /// Counter-clockwise, starting at the angle `from` [rad].
    Arc {
        center: Vector,
        radius: f64,
        from: f64,
        sweep: f64,
    },
}

/// A bounding box of a feature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub low: Vector,
    pub high: Vector,
}

impl Extent {
    pub(super) fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// [m] Lower bound of the distance between the contents of two boxes.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let apart = (self.low - other.high).max(other.low - self.high);
        apart.max(Vector::ZERO).length()
    }
}

impl Curve {
    pub(super) fn extent(&self) -> Extent {
        match *self {
            Self::Line([a, b]) => Extent {
                low: a.min(b),
                high: a.max(b),
            },
            Self::Arc { center, radius, .. } => Extent {
                low: center - Vector::splat(radius),
                high: center + Vector::splat(radius),
            },
        }
    }

    pub(super) fn ends(&self) -> [Vector; 2] {
        match *self {
            Self::Line(ends) => ends,
            Self::Arc {
                center,
                radius,
                from,
                sweep,
            } => [from, from + sweep]
                .map(|angle| center + Vector::new(angle.cos(), angle.sin()) * radius),
        }
    }

    /// Whether an outward direction belongs to an arc.
    pub(super) fn points(&self, outward: Vector) -> bool {
        match *self {
            Self::Line(_) => false,
            Self::Arc { from, sweep, .. } => {
                (outward.y.atan2(outward.x) - from).rem_euclid(TAU) <= sweep
            }
        }
    }

    /// The point of the curve nearest to another point.
    pub(super) fn nearest(&self, point: Vector) -> Vector {
        match *self {
            Self::Line([a, b]) => {
                let way = b - a;
                a + way * ((point - a).dot(way) / way.length_squared()).clamp(0.0, 1.0)
            }
            Self::Arc { center, radius, .. } => {
                let outward = (point - center).normalize_or(Vector::Y);
                if self.points(outward) {
                    return center + outward * radius;
                }
                let [a, b] = self.ends();
                if (point - a).length() < (point - b).length() {
                    a
                } else {
                    b
                }
            }
        }
    }

    /// The nearest points of two curves that do not cross: a nearest point is at an end of one of them, or
    /// perpendicular to an arc.
    pub(super) fn approach(&self, other: &Self) -> [Vector; 2] {
        let mut best = [Vector::INFINITY, Vector::NEG_INFINITY];
        let mut consider = |pair: [Vector; 2]| {
            if (pair[0] - pair[1]).length() < (best[0] - best[1]).length() {
                best = pair;
            }
        };
        for end in self.ends() {
            consider([end, other.nearest(end)]);
        }
        for end in other.ends() {
            consider([self.nearest(end), end]);
        }
        if let Self::Arc { center, radius, .. } = *self {
            let q = other.nearest(center);
            if (q - center).length() > radius {
                consider([self.nearest(q), q]);
            }
        }
        if let Self::Arc { center, radius, .. } = *other {
            let p = self.nearest(center);
            if (p - center).length() > radius {
                consider([p, other.nearest(p)]);
            }
        }
        best
    }

    /// The points where two curves cross.
    pub(super) fn crossings(&self, other: &Self) -> Vec<Vector> {
        match (*self, *other) {
            (Self::Line([a, b]), Self::Line([c, d])) => {
                let (way, other_way) = (b - a, d - c);
                let area = cross(way, other_way);
                let (t, u) = (cross(c - a, other_way) / area, cross(c - a, way) / area);
                let meets = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u);
                if meets { vec![a + way * t] } else { Vec::new() }
            }
            (Self::Line([a, b]), Self::Arc { center, radius, .. }) => {
                let (way, offset) = (b - a, a - center);
                let (square, half) = (way.length_squared(), offset.dot(way));
                let root = half * half - square * (offset.length_squared() - radius * radius);
                if root < 0.0 {
                    return Vec::new();
                }
                [-root.sqrt(), root.sqrt()]
                    .map(|root| (root - half) / square)
                    .into_iter()
                    .filter(|t| (0.0..=1.0).contains(t))
                    .map(|t| a + way * t)
                    .filter(|p| other.points(*p - center))
                    .collect()
            }
            (Self::Arc { .. }, Self::Line(_)) => other.crossings(self),
            (
                Self::Arc { center, radius, .. },
                Self::Arc {
                    center: other_center,
                    radius: other_radius,
                    ..
                },
            ) => {
                let way = other_center - center;
                let distance = way.length();
                let along =
                    0.5 * (distance + (radius * radius - other_radius * other_radius) / distance);
                let square = radius * radius - along * along;
                if square < 0.0 {
                    return Vec::new();
                }
                let (forward, aside) = (way / distance, left_of(way / distance));
                [-square.sqrt(), square.sqrt()]
                    .map(|off| center + forward * along + aside * off)
                    .into_iter()
                    .filter(|p| self.points(*p - center) && other.points(*p - other_center))
                    .collect()
            }
        }
    }
}
