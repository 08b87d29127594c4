//! Where a part overlaps the ground: every corner of one in the other, every circle against both.

use std::ops::Range;

use crawler2d_core::Vector;

use super::ground::{Lane, REACH};
use super::robot::{Form, Part};
use super::wheel::{Side, Toothed};
use super::{Turn, right_of};

/// One place of overlap.
pub(super) struct Touch {
    pub part: usize,
    pub point: Vector,
    /// Out of the ground.
    pub normal: Vector,
    pub depth: f64,
    /// What of the part touches: a corner by its number, sides and circles beyond all corners.
    pub feature: u32,
    /// What of the ground touches: face `i` is 2 i + 1, the corner before it 2 i.
    pub place: u32,
}

const FLANK: u32 = 1 << 20;
const TIP: u32 = FLANK + 1;
const ROUND: u32 = FLANK + 2;
const SIDES: u32 = FLANK + 3;

/// Gathers the overlaps of one part.
pub(super) struct Finder<'a> {
    pub ground: &'a Lane,
    pub range: Range<usize>,
    pub part: usize,
    pub touches: &'a mut Vec<Touch>,
}

impl Finder<'_> {
    /// `center`: the place of the part; `turn`: of the chassis; `wheel`: of the wheel on top of it.
    pub(super) fn find(&mut self, part: &Part, center: Vector, turn: Turn, wheel: f64) {
        match &part.form {
            Form::Disc { radius, .. } => self.circle(center, *radius, true, |_| true),
            Form::Toothed { wheel: toothed, .. } => self.toothed(toothed, center, Turn::by(wheel)),
            Form::Belly { corners } => self.belly(corners, center, turn),
        }
    }

    fn push(&mut self, point: Vector, normal: Vector, depth: f64, feature: u32, place: usize) {
        self.touches.push(Touch {
            part: self.part,
            point,
            normal,
            depth,
            feature,
            place: place as u32,
        });
    }

    /// A corner of the robot in the ground.
    fn corner(&mut self, point: Vector, feature: usize) {
        let (ground, range) = (self.ground, self.range.clone());
        ground.over(point, range, |i, depth| {
            self.push(
                point,
                ground.faces[i].normal,
                depth,
                feature as u32,
                2 * i + 1,
            );
        });
    }

    /// Lane, and corners of the ground if `corners`, in a circle where it is `open`.
    fn circle(
        &mut self,
        center: Vector,
        radius: f64,
        corners: bool,
        open: impl Fn(Vector) -> bool,
    ) {
        let ground = self.ground;
        for i in self.range.clone() {
            let face = &ground.faces[i];
            let from_start = center - face.start;
            let (way, height) = (from_start.dot(face.along), from_start.dot(face.normal));
            let depth = radius - height;
            if (0.0..=face.length).contains(&way)
                && (0.0..REACH).contains(&depth)
                && open(-face.normal)
            {
                let point = center - face.normal * height;
                self.push(point, face.normal, depth, ROUND, 2 * i + 1);
            }
            let distance = from_start.length();
            if corners && distance < radius && ground.in_cone(i, from_start) {
                let normal = from_start / distance;
                self.push(face.start, normal, radius - distance, ROUND, 2 * i);
            }
        }
    }

    fn toothed(&mut self, wheel: &Toothed, center: Vector, turn: Turn) {
        let ground = self.ground;
        let own = |v: Vector| turn.back(v);
        for i in self.range.clone().filter(|i| ground.convex[*i]) {
            let corner = ground.faces[i].start;
            wheel.over(own(corner - center), |side, depth, out| {
                let feature = match side {
                    Side::Tip => TIP,
                    Side::Flank => FLANK,
                    Side::Root => ROUND,
                };
                self.push(corner, -turn.of(out), depth, feature, 2 * i);
            });
        }
        for (k, corner) in wheel.corners.iter().enumerate() {
            self.corner(center + turn.of(*corner), k);
        }
        self.circle(center, wheel.root, false, |d| wheel.shows_root(own(d)));
    }

    fn belly(&mut self, corners: &[Vector], center: Vector, turn: Turn) {
        let n = corners.len();
        let placed: Vec<Vector> = corners.iter().map(|p| center + turn.of(*p)).collect();
        for (k, corner) in placed.iter().enumerate() {
            self.corner(*corner, k);
        }
        for i in self.range.clone().filter(|i| self.ground.convex[*i]) {
            let corner = self.ground.faces[i].start;
            let of_side = |k: usize| {
                let way = placed[(k + 1) % n] - placed[k];
                let out = right_of(way) / way.length();
                ((placed[k] - corner).dot(out), out, k)
            };
            let (depth, out, k) = (0..n)
                .map(of_side)
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .expect("a polygon has sides");
            if (0.0..REACH).contains(&depth) {
                self.push(corner, -out, depth, SIDES + k as u32, 2 * i);
            }
        }
    }
}
