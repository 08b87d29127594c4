//! The judge: every feature of a part against every feature of the ground.

use super::curve::{Curve, Extent};
use super::grounds::Ground;
use crate::geometry::Vector;

/// A part in a pose over the ground.
pub(super) struct Judge<'a> {
    pub part: Vec<Curve>,
    pub ground: &'a Ground,
    extents: Vec<Extent>,
    /// Features of the ground near the part.
    near: Vec<usize>,
}

/// Two features close to each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    pub of_part: usize,
    pub of_ground: usize,
    /// [m] The two nearest points.
    pub ends: [Vector; 2],
}

impl Approach {
    pub(super) fn distance(&self) -> f64 {
        (self.ends[0] - self.ends[1]).length()
    }

    /// The direction from the ground to the part.
    pub(super) fn normal(&self) -> Vector {
        (self.ends[0] - self.ends[1]).normalize()
    }
}

impl<'a> Judge<'a> {
    /// A judge that considers ground within `sight` [m].
    pub(super) fn new(part: Vec<Curve>, ground: &'a Ground, sight: f64) -> Self {
        let extents: Vec<Extent> = part.iter().map(Curve::extent).collect();
        let whole = extents.iter().copied().reduce(Extent::join).unwrap();
        let near = |j: &usize| ground.extents[*j].distance(&whole) <= sight;
        let near = (0..ground.curves.len()).filter(near).collect();
        Self {
            part,
            ground,
            extents,
            near,
        }
    }

    /// Calls `pair` with every two features whose boxes are within a limit; `pair` returns the next limit.
    fn pairs(&self, mut limit: f64, mut pair: impl FnMut(usize, usize) -> f64) {
        for &j in &self.near {
            for i in 0..self.part.len() {
                if self.extents[i].distance(&self.ground.extents[j]) <= limit {
                    limit = pair(i, j);
                }
            }
        }
    }

    fn approach(&self, i: usize, j: usize) -> Approach {
        Approach {
            of_part: i,
            of_ground: j,
            ends: self.part[i].approach(&self.ground.curves[j]),
        }
    }

    /// The nearest approach of all, within `limit` [m].
    pub(super) fn nearest(&self, limit: f64) -> Option<Approach> {
        let mut best: Option<Approach> = None;
        self.pairs(limit, |i, j| {
            let here = self.approach(i, j);
            if best.is_none_or(|b| here.distance() < b.distance()) {
                best = Some(here);
            }
            best.map_or(limit, |b| b.distance())
        });
        best.filter(|b| b.distance() <= limit)
    }

    /// Every local minimum of the distance within `limit`.
    pub(super) fn approaches(&self, limit: f64) -> Vec<Approach> {
        let mut found = Vec::new();
        self.pairs(limit, |i, j| {
            let here = self.approach(i, j);
            if here.distance() < limit && self.is_least(&here) && self.is_open(&here) {
                found.push(here);
            }
            limit
        });
        found
    }

    /// Whether neither neighbour of either feature is nearer, within rounding.
    fn is_least(&self, approach: &Approach) -> bool {
        let [p, q] = approach.ends;
        let distance = approach.distance();
        let is_farther = |from: Vector, to: Vector, neighbour: &Curve| {
            let near = neighbour.nearest(from);
            let is_it = (near - to).length() < 1e-15;
            is_it || (near - from).length() > distance + 1e-12
        };
        let count = self.part.len();
        let (i, j) = (approach.of_part, approach.of_ground);
        let curves = &self.ground.curves;
        let mut of_part = [(i + count - 1) % count, (i + 1) % count].into_iter();
        let mut of_ground = [j.saturating_sub(1), (j + 1).min(curves.len() - 1)].into_iter();
        of_part.all(|i| is_farther(q, p, &self.part[i]))
            && of_ground.all(|j| is_farther(p, q, &curves[j]))
    }

    /// Whether nothing lies between its ends: neither point is inside the other solid.
    fn is_open(&self, approach: &Approach) -> bool {
        let [p, q] = approach.ends;
        let inner = Curve::Line([p + (q - p) * 1e-6, q + (p - q) * 1e-6]);
        let box_of = inner.extent();
        let crossed = |curve: &Curve, extent: &Extent| {
            extent.distance(&box_of) <= 0.0 && !inner.crossings(curve).is_empty()
        };
        let mut of_part = self.part.iter().zip(&self.extents);
        let mut of_ground = self
            .near
            .iter()
            .map(|j| (&self.ground.curves[*j], &self.ground.extents[*j]));
        !of_part.any(|(c, e)| crossed(c, e)) && !of_ground.any(|(c, e)| crossed(c, e))
    }

    /// Every crossing of the outline with the ground: both features, and the point.
    pub(super) fn crossings(&self) -> Vec<(usize, usize, Vector)> {
        let mut found = Vec::new();
        self.pairs(0.0, |i, j| {
            let places = self.part[i].crossings(&self.ground.curves[j]);
            found.extend(places.into_iter().map(|p| (i, j, p)));
            0.0
        });
        found
    }

    /// Whether no point of the part is in the ground.
    pub(super) fn is_clear(&self) -> bool {
        let p = self.part[0].ends()[0];
        p.y > self.ground.height(p.x) && self.crossings().is_empty()
    }
}
