//! The judge: support functions, tangents and vertical slices.

use crate::geometry::{Disc, Rotation, Vector};
use crate::terrain::Profile;

/// Slices per pose; pieces and gaps narrower than a few of them are not judged.
pub(super) const SLICES: usize = 800;

/// The envelope of discs in world coordinates, as its support function.
pub(super) struct Judge {
    pub(super) discs: Vec<Disc>,
    /// Directions of the tangents that touch two discs, with their support values.
    tangents: Vec<(Vector, f64)>,
}

impl Judge {
    pub(super) fn new(discs: Vec<Disc>) -> Self {
        let mut judge = Self {
            discs,
            tangents: Vec::new(),
        };
        for a in &judge.discs.clone() {
            for b in &judge.discs.clone() {
                let way = b.center - a.center;
                let cosine = (a.radius - b.radius) / way.length();
                if way.length() == 0.0 || cosine.abs() > 1.0 {
                    continue;
                }
                for turn in [cosine.acos(), -cosine.acos()] {
                    let normal = Rotation::new(way.y.atan2(way.x) + turn) * Vector::X;
                    let support = judge.support(normal);
                    if support - a.center.dot(normal) - a.radius < 1e-12 {
                        judge.tangents.push((normal, support));
                    }
                }
            }
        }
        judge
    }

    pub(super) fn support(&self, normal: Vector) -> f64 {
        self.discs
            .iter()
            .map(|d| d.center.dot(normal) + d.radius)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Depth of a point, the normal of the nearest tangent, and the distance to the next nearest.
    pub(super) fn depth(&self, point: Vector) -> (f64, Vector, f64) {
        let from_centers = self.discs.iter().filter_map(|d| {
            let normal = (point - d.center).try_normalize()?;
            Some((normal, self.support(normal)))
        });
        let (mut best, mut second) = ((f64::INFINITY, Vector::X), f64::INFINITY);
        for (normal, support) in self.tangents.iter().copied().chain(from_centers) {
            let room = support - point.dot(normal);
            if room < best.0 {
                if normal.dot(best.1) < 1.0 - 1e-9 {
                    second = best.0;
                }
                best = (room, normal);
            } else if normal.dot(best.1) < 1.0 - 1e-9 {
                second = second.min(room);
            }
        }
        (best.0, best.1, second)
    }

    /// The largest depth on a segment.
    pub(super) fn deepest_on(&self, a: Vector, b: Vector) -> (f64, Vector) {
        let at = |t: f64| a + (b - a) * t;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..120 {
            let (p, q) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if self.depth(at(p)).0 < self.depth(at(q)).0 {
                low = p;
            } else {
                high = q;
            }
        }
        [0.0, 1.0, 0.5 * (low + high)]
            .map(|t| (self.depth(at(t)).0, at(t)))
            .into_iter()
            .reduce(|a, b| if b.0 > a.0 { b } else { a })
            .expect("three places")
    }

    /// The deepest place of all, by nested ternary search.
    pub(super) fn deepest(&self) -> (f64, Vector) {
        let (left, right) = (-self.support(-Vector::X), self.support(Vector::X));
        let (bottom, top) = (-self.support(-Vector::Y), self.support(Vector::Y));
        let (mut low, mut high) = (bottom, top);
        let along = |y: f64| self.deepest_on(Vector::new(left, y), Vector::new(right, y));
        for _ in 0..60 {
            let (p, q) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if along(p).0 < along(q).0 {
                low = p;
            } else {
                high = q;
            }
        }
        along(0.5 * (low + high))
    }

    /// Bodies that bound a point: on either side the nearest one that reaches out as far as the tangent.
    pub(super) fn bodies(&self, point: Vector) -> Option<[usize; 2]> {
        let (depth, normal, second) = self.depth(point);
        let along = Vector::new(normal.y, -normal.x); // clockwise
        let own = |d: &Disc| depth + point.dot(normal) - d.center.dot(normal) - d.radius;
        let touching = self.discs.iter().filter(|d| own(d) < 1e-10).count();
        if second - depth < 1e-7 {
            return None; // two sides are equally near
        }
        let place = |d: &Disc| (d.center - point).dot(along);
        if touching == 1 {
            let disc = self.discs.iter().position(|d| own(d) < 1e-10)?;
            return Some([disc, disc]);
        }
        let reaching: Vec<usize> = (0..self.discs.len())
            .filter(|i| own(&self.discs[*i]) <= depth)
            .collect();
        let unsure = (0..self.discs.len()).any(|i| {
            let d = &self.discs[i];
            place(d).abs() < 1e-9 || (own(d) - depth).abs() < 1e-9
        });
        if unsure {
            return None;
        }
        let of = |i: &usize| place(&self.discs[*i]);
        let before = reaching
            .iter()
            .copied()
            .filter(|i| of(i) <= 0.0)
            .max_by(|i, j| of(i).total_cmp(&of(j)))?;
        let after = reaching
            .iter()
            .copied()
            .filter(|i| of(i) > 0.0)
            .min_by(|i, j| of(i).total_cmp(&of(j)))?;
        Some([before, after])
    }
}

/// A range of x over which ground is inside.
pub(super) struct Range {
    pub left: f64,
    pub right: f64,
    pub area: f64,
}

/// Lower and upper side of the envelope at x, from many tangents.
fn sides(x: f64, tangents: &[(Vector, f64)]) -> (f64, f64) {
    let mut sides = (f64::NEG_INFINITY, f64::INFINITY);
    for (normal, support) in tangents {
        let y = (support - x * normal.x) / normal.y;
        if normal.y > 0.0 {
            sides.1 = sides.1.min(y);
        } else {
            sides.0 = sides.0.max(y);
        }
    }
    sides
}

/// Ranges of x over which the profile lies above the lower side, each with its area.
pub(super) fn ranges(judge: &Judge, profile: &Profile) -> Vec<Range> {
    // Without the tangents of the straight runs, the runs would bulge.
    let runs = judge.tangents.iter().map(|(normal, _)| *normal);
    let tangents: Vec<(Vector, f64)> = (0..240)
        .map(|i| Rotation::new((f64::from(i) + 0.25) * std::f64::consts::TAU / 240.0) * Vector::X)
        .chain(runs)
        .map(|normal| (normal, judge.support(normal)))
        .collect();
    let (left, right) = (-judge.support(-Vector::X), judge.support(Vector::X));
    let (low, high) = profile.extent();
    let (left, right) = (left.max(low), right.min(high));
    let width = (right - left) / SLICES as f64;
    let mut found: Vec<Range> = Vec::new();
    let mut inside = false;
    for i in 0..SLICES {
        let x = left + (i as f64 + 0.5) * width;
        let (bottom, top) = sides(x, &tangents);
        let ground = profile.height_under_disc(x, 0.0);
        let was_inside = std::mem::replace(&mut inside, ground > bottom && top > bottom);
        if inside {
            let area = (ground.min(top) - bottom) * width;
            match found.last_mut() {
                Some(range) if was_inside => {
                    range.right = x;
                    range.area += area;
                }
                _ => found.push(Range {
                    left: x,
                    right: x,
                    area,
                }),
            }
        }
    }
    found
}
