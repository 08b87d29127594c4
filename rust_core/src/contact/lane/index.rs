//! An index of the ground: finds the pieces near a place in a time that depends neither on the length of the
//! lane nor, for finely divided ground, on the number of its pieces.
//!
//! A table over x leads to the pieces under a place. If there are many, a hierarchy above them has bounds for
//! the height and normals of each stretch, so that on flat ground only the pieces right below a part are
//! visited. parry's hierarchy has only bounds for positions, this one also for normals and roofs.
//!
//! The equations: docs/physics.md, "Contacts".

use std::cell::Cell;
use std::ops::{Range, RangeInclusive};

use rapier2d_f64::parry::bounding_volume::{Aabb, BoundingVolume};

use super::Corner;
use super::features::{Face, ROUNDING, TURN_IN_A_STEP};
use super::roof::{Roof, roof};
use crate::geometry::{Vector, cross};
use crate::terrain::{FINE, Profile};

/// Pieces per stretch of the lowest level.
const BLOCK: usize = 8;
/// At most this many pieces are visited one by one.
const FEW: usize = 2 * BLOCK;
/// Largest number of cells in the table over x.
const MOST_CELLS: usize = 1 << 18;

/// The index. A piece is a face with the corner before it.
pub(super) struct Index {
    /// [m] x at which each piece begins.
    begins: Vec<f64>,
    /// Number of pieces that begin before each cell of the table.
    cells: Vec<u32>,
    cells_per_meter: f64,
    /// [m] Highest point of each piece, and of all pieces.
    tops: Vec<f64>,
    top: f64,
    /// Stretches of `BLOCK` pieces, then of twice as many, and so on up to a single one of all pieces.
    levels: Vec<Vec<Stretch>>,
    /// [m] Largest radius of the corners' arcs.
    largest_radius: f64,
}

/// A range of pieces.
#[derive(Clone, Debug)]
pub(crate) struct Region(Range<usize>);

impl Region {
    /// The region between two corners.
    pub(super) fn between(first: usize, last: usize) -> Self {
        Self(first..last)
    }

    /// Whether it has too many pieces to visit one by one.
    pub(crate) fn is_long(&self) -> bool {
        self.0.len() > FEW
    }

    /// Whether it has no piece.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The regions before and behind a piece.
    pub(super) fn around(&self, piece: usize) -> [Self; 2] {
        [self.0.start..piece, piece + 1..self.0.end].map(Self)
    }

    /// The pieces of the region.
    pub(super) fn pieces(&self) -> Range<usize> {
        self.0.clone()
    }

    /// The corners of the region, including both ends.
    pub(crate) fn corners(&self) -> RangeInclusive<usize> {
        self.0.start..=self.0.end
    }
}

/// Bounds of a stretch of the ground.
#[derive(Clone, Copy)]
pub(crate) struct Stretch {
    bounds: Aabb,
    /// The normals that point farthest to the right and to the left.
    normals: [Vector; 2],
    pub roof: Roof,
    /// Whether any of its corners is convex.
    pub is_convex: bool,
}

impl Stretch {
    /// The bounds of two stretches, without a roof.
    fn join(self, other: Self) -> Self {
        let [right, left] = self.normals;
        let [other_right, other_left] = other.normals;
        Self {
            bounds: self.bounds.merged(&other.bounds),
            // No normal points down, so they can be ordered by x.
            normals: [
                if right.x < other_right.x {
                    other_right
                } else {
                    right
                },
                if left.x > other_left.x {
                    other_left
                } else {
                    left
                },
            ],
            roof: self.roof,
            is_convex: self.is_convex || other.is_convex,
        }
    }

    /// Whether a disc may bear on the stretch within `reach` of its centre.
    pub(crate) fn may_face(&self, center: Vector, reach: f64) -> bool {
        let Aabb { mins, maxs } = self.bounds;
        let away = (mins - center).max(center - maxs).max(Vector::ZERO);
        if away.length_squared() > reach * reach {
            return false;
        }
        let [right, left] = self.normals;
        // Bounds of the cross products of the stretch's outermost normals with the vector from the stretch to
        // the centre: that vector, or its opposite in penetration, must lie between the normals.
        let bounds = |n: Vector| {
            let (a, b) = (n.x * mins.y, n.x * maxs.y);
            let here = cross(n, center);
            (
                here - a.max(b) + n.y * mins.x,
                here - a.min(b) + n.y * maxs.x,
            )
        };
        let (of_right, of_left) = (bounds(right), bounds(left));
        let above = of_right.1 >= -ROUNDING && of_left.0 <= ROUNDING;
        let below = of_right.0 <= ROUNDING && of_left.1 >= -ROUNDING;
        above || (below && center.y <= maxs.y)
    }

    /// Whether any of it lies within `margin` of a range of x.
    pub(crate) fn reaches(&self, [low, high]: [f64; 2], margin: f64) -> bool {
        self.bounds.mins.x - margin <= high && low <= self.bounds.maxs.x + margin
    }

    /// Whether the stretch may have this normal, or nearly this normal at a corner.
    pub(crate) fn may_have_normal(&self, normal: Vector) -> bool {
        let [right, left] = self.normals;
        cross(right, normal) >= -TURN_IN_A_STEP && cross(normal, left) >= -TURN_IN_A_STEP
    }
}

impl Index {
    pub(super) fn new(profile: &Profile, faces: &[Face], corners: &[Corner]) -> Self {
        let begin_of = |c: &Corner| profile.points[c.facet].x;
        let begins: Vec<f64> = corners[..faces.len()].iter().map(begin_of).collect();
        let (low, high) = profile.extent();
        let count = (2 * faces.len()).clamp(16, MOST_CELLS);
        let cells_per_meter = count as f64 / (high - low);
        let cells = (0..=count)
            .map(|k| {
                let x = low + k as f64 / cells_per_meter;
                begins.partition_point(|begin| *begin < x) as u32
            })
            .collect();
        let pieces = pieces(profile, faces, corners);
        let tops: Vec<f64> = pieces.iter().map(|piece| piece.bounds.maxs.y).collect();
        Self {
            begins,
            cells,
            cells_per_meter,
            top: tops.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            tops,
            levels: levels(&pieces, corners),
            largest_radius: corners.iter().map(|c| c.radius).fold(0.0, f64::max),
        }
    }

    /// [m] Largest radius of the corners' arcs.
    pub(super) fn largest_radius(&self) -> f64 {
        self.largest_radius
    }

    /// The pieces that overlap a range of x.
    pub(super) fn region(&self, low: f64, high: f64) -> Region {
        let first = self.count_before(low).saturating_sub(1);
        // Most ranges have few pieces; counting them is faster than looking them up.
        let few = self.begins[first..].iter().take(FEW);
        let mut end = first + few.take_while(|begin| **begin <= high).count();
        if end == first + FEW {
            end = end.max(self.count_before(high));
            while end < self.begins.len() && self.begins[end] <= high {
                end += 1;
            }
        }
        Region(first..end.max(first + 1))
    }

    /// The same within a region.
    pub(super) fn narrow(&self, within: &Region, low: f64, high: f64) -> Region {
        if within.is_long() {
            return self.region(low, high);
        }
        let Range { mut start, mut end } = within.0;
        while start + 1 < end && self.begins[start + 1] < low {
            start += 1;
        }
        while start + 1 < end && self.begins[end - 1] > high {
            end -= 1;
        }
        Region(start..end)
    }

    /// A region's corners left of a range of x, in it and right of it; neighbouring regions share a corner.
    pub(super) fn split(&self, region: &Region, low: f64, high: f64) -> [Region; 3] {
        let Range { start, end } = region.0;
        let [a, b] = [low, high].map(|x| self.count_before(x).clamp(start, end));
        [start..a, a..b.max(a), b.max(a)..end].map(Region)
    }

    /// Number of pieces that begin before x.
    fn count_before(&self, x: f64) -> usize {
        let cell = ((x - self.begins[0]) * self.cells_per_meter).max(0.0) as usize;
        let last = self.cells.len() - 1;
        // One more cell on either side: rounding in the table may be off by one.
        let from = self.cells[cell.saturating_sub(1).min(last)] as usize;
        let to = match self.cells.get(cell.saturating_add(2)) {
            Some(to) => *to as usize,
            None => self.begins.len(),
        };
        from + self.begins[from..to].partition_point(|begin| *begin < x)
    }

    /// [m] Height of the highest ground.
    pub(super) fn highest_of_all(&self) -> f64 {
        self.top
    }

    /// [m] An upper bound of the height of a region.
    pub(super) fn top(&self, region: &Region) -> f64 {
        if !region.is_long() {
            let tops = self.tops[region.0.clone()].iter();
            return tops.copied().fold(f64::NEG_INFINITY, f64::max);
        }
        let (level, stretches) = self.cover(region);
        let tops = self.levels[level][stretches]
            .iter()
            .map(|s| s.bounds.maxs.y);
        tops.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether `matters` holds for any of a few stretches that cover a region.
    pub(super) fn any(&self, region: &Region, matters: impl FnMut(&Stretch) -> bool) -> bool {
        let (level, stretches) = self.cover(region);
        self.levels[level][stretches].iter().any(matters)
    }

    /// The level at which a few stretches cover a region, and those stretches.
    fn cover(&self, region: &Region) -> (usize, RangeInclusive<usize>) {
        let Range { start, end } = region.0;
        let blocks = (end - start) / BLOCK;
        let level = (blocks.max(1).ilog2() as usize).min(self.levels.len() - 1);
        let size = BLOCK << level;
        (level, start / size..=(end - 1) / size)
    }

    /// Calls `piece` with every piece of the stretches that may matter, and with whether it has a face; the last
    /// corner of a region has none.
    pub(super) fn visit(
        &self,
        region: &Region,
        matters: impl FnMut(&Stretch) -> bool,
        mut piece: impl FnMut(usize, bool),
    ) {
        let end = region.0.end;
        if !region.is_long() {
            region.0.clone().for_each(|i| piece(i, true));
            piece(end, false);
            return;
        }
        let mut last = usize::MAX;
        self.descend(region, matters, |pieces| {
            last = pieces.end;
            pieces.for_each(|i| piece(i, true));
        });
        if last == end {
            piece(end, false);
        }
    }

    /// Whether the pieces of a region are many and small.
    pub(super) fn is_fine(&self, region: &Region) -> bool {
        let Range { start, end } = region.0;
        let is_fine =
            || self.begins[end - 1] - self.begins[start] < FINE.value() * (end - start) as f64;
        region.is_long() && is_fine()
    }

    /// The corner of a region that rises highest, if by more than `least` [m]; `bound` gives a bound for a stretch.
    pub(super) fn highest(
        &self,
        region: &Region,
        least: f64,
        bound: impl Fn(&Stretch) -> f64,
        rise: impl Fn(usize) -> f64,
    ) -> Option<usize> {
        let highest = Cell::new((least, None));
        let meet = |i: usize| {
            let rise = rise(i);
            if rise > highest.get().0 {
                highest.set((rise, Some(i)));
            }
        };
        let matters = |stretch: &Stretch| stretch.is_convex && bound(stretch) > highest.get().0;
        self.descend(region, matters, |pieces| pieces.for_each(meet));
        highest.get().1
    }

    /// Calls `block` with the pieces of each lowest-level stretch of a region that may matter.
    fn descend(
        &self,
        region: &Region,
        mut matters: impl FnMut(&Stretch) -> bool,
        mut block: impl FnMut(Range<usize>),
    ) {
        let (top, stretches) = self.cover(region);
        for k in stretches {
            self.descend_from(top, k, &region.0, &mut matters, &mut block);
        }
    }

    fn descend_from(
        &self,
        level: usize,
        k: usize,
        region: &Range<usize>,
        matters: &mut impl FnMut(&Stretch) -> bool,
        block: &mut impl FnMut(Range<usize>),
    ) {
        let size = BLOCK << level;
        let pieces = (k * size).max(region.start)..((k + 1) * size).min(region.end);
        if pieces.is_empty() || !matters(&self.levels[level][k]) {
            return;
        }
        if level == 0 {
            block(pieces);
        } else {
            self.descend_from(level - 1, 2 * k, region, matters, block);
            self.descend_from(level - 1, 2 * k + 1, region, matters, block);
        }
    }
}

fn pieces(profile: &Profile, faces: &[Face], corners: &[Corner]) -> Vec<Stretch> {
    let of_piece = |i: usize| {
        let (face, corner, next) = (&faces[i], &corners[i], &corners[i + 1]);
        let points = profile.points[corner.facet..=next.facet].iter();
        let place = |point: &Vector| Stretch {
            bounds: Aabb::new(*point, *point),
            normals: [face.normal; 2],
            roof: [*point; 2],
            is_convex: corner.is_convex || next.is_convex,
        };
        // The closing corner is visited together with the piece before it.
        let normals = corner.normals.into_iter().chain(next.normals);
        let facing = |normal| Stretch {
            normals: [normal; 2],
            ..place(&face.begin)
        };
        // The top of an arc need not be one of its points.
        let peak = corner.center + Vector::Y * corner.radius;
        let has_peak = corner.normals[0].x < 0.0 && corner.normals[1].x > 0.0;
        let peak = has_peak.then(|| place(&peak));
        let parts = points.map(place).chain(peak).chain(normals.map(facing));
        parts.fold(place(&face.begin), Stretch::join)
    };
    (0..faces.len()).map(of_piece).collect()
}

/// Stretches of `BLOCK` pieces, then of twice as many, and so on.
fn levels(pieces: &[Stretch], corners: &[Corner]) -> Vec<Vec<Stretch>> {
    let join = |stretches: &[Stretch]| stretches[1..].iter().fold(stretches[0], |a, b| a.join(*b));
    let mut levels = vec![pieces.chunks(BLOCK).map(join).collect::<Vec<_>>()];
    while levels[levels.len() - 1].len() > 1 {
        let next = levels[levels.len() - 1].chunks(2).map(join).collect();
        levels.push(next);
    }
    for (level, stretches) in levels.iter_mut().enumerate() {
        for (k, stretch) in stretches.iter_mut().enumerate() {
            let (first, end) = (k * (BLOCK << level), (k + 1) * (BLOCK << level));
            stretch.roof = roof(&corners[first..=end.min(pieces.len())]);
        }
    }
    levels
}

#[cfg(test)]
mod tests;
