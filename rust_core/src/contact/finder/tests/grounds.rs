//! Random ground: the profile that the contacts get, and the test's own lines and arcs.

use std::collections::HashSet;

use super::curve::{Curve, Extent};
use crate::draw::Draw;
use crate::geometry::{Vector, cross, left_of};
use crate::scenario::Surface;
use crate::terrain::Profile;

/// [m] Level ground on both sides of the obstacle.
const RUN_OUT: f64 = 1.0;

pub(super) struct Ground {
    pub name: String,
    pub profile: Profile,
    /// Lines and arcs from left to right.
    pub curves: Vec<Curve>,
    pub extents: Vec<Extent>,
}

pub(super) const KINDS: usize = 11;

impl Ground {
    /// One whose arcs take up a whole face, or all of it except a given fraction.
    pub(super) fn random(kind: usize, left: Option<f64>, draw: &mut Draw) -> Self {
        let corners = corners(kind, draw);
        let rounded = draw.chance(0.5);
        let mut radius = if rounded {
            draw.size(0.5e-3, 20e-3)
        } else {
            0.0
        };
        if let Some(left) = left {
            radius = largest_radius(&corners) * (1.0 - left);
        }
        loop {
            if let Some(ground) = Self::new(&corners, radius) {
                return ground;
            }
            // Halve the radius until it fits the faces.
            radius = if radius > 1e-4 { 0.5 * radius } else { 0.0 };
        }
    }

    /// None if the radius does not fit.
    pub(super) fn new(corners: &[Vector], radius: f64) -> Option<Self> {
        let points: Vec<[f64; 2]> = corners.iter().map(|p| [p.x, p.y]).collect();
        let profile =
            Profile::new("terrain", &points, Surface::rounded(radius, 0.9), false).ok()?;
        // Points on straight ground are not corners.
        let bends: HashSet<usize> = profile.bends().iter().map(|i| *i as usize).collect();
        let straight = (0..profile.points.len()).filter(|i| !bends.contains(i));
        let straight: Vec<Vector> = straight.map(|i| profile.points[i]).collect();
        let mut corners = corners.to_vec();
        corners.retain(|corner| !straight.contains(corner));
        let curves = curves(&corners, radius);
        Some(Self {
            name: format!("{} corners, edge radius {radius}", corners.len()),
            profile,
            extents: curves.iter().map(Curve::extent).collect(),
            curves,
        })
    }

    /// [m] Height of the ground at x.
    pub(super) fn height(&self, x: f64) -> f64 {
        let at = |curve: &Curve| match *curve {
            Curve::Line([a, b]) if a.x <= x && x <= b.x && a.x < b.x => {
                a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x)
            }
            Curve::Arc { center, radius, .. } => {
                let [right, left] = curve.ends();
                let square = radius * radius - (x - center.x) * (x - center.x);
                if left.x <= x && x <= right.x {
                    center.y + square.max(0.0).sqrt()
                } else {
                    f64::NEG_INFINITY
                }
            }
            Curve::Line(_) => f64::NEG_INFINITY,
        };
        self.curves.iter().map(at).fold(f64::NEG_INFINITY, f64::max)
    }
}

#[allow(clippy::float_cmp)] // the points of a vertical face have exactly one x
fn corners(kind: usize, draw: &mut Draw) -> Vec<Vector> {
    let height = draw.size(5e-3, 0.12);
    let mut points: Vec<[f64; 2]> = match kind {
        0 => vec![[0.0, 0.0]],
        1 => vec![
            [0.0, 0.0],
            [0.0, if draw.chance(0.5) { height } else { -height }],
        ],
        2 => block(height, draw.size(2e-3, 50e-3)),
        3 => {
            let half = height * (0.5 * draw.between(0.17, 2.6)).tan();
            vec![[0.0, 0.0], [half, height], [2.0 * half, 0.0]]
        }
        4 => {
            let (rise, run) = (draw.between(0.02, 0.15), draw.between(0.03, 0.3));
            (0..5)
                .map(f64::from)
                .flat_map(|i| [[i * run, i * rise], [i * run, (i + 1.0) * rise]])
                .collect()
        }
        5 => vec![[0.0, 0.0], [height / draw.between(0.1, 1.5), height]],
        6 => block(-height, draw.size(10e-3, 0.3)),
        7 => block(height, draw.between(0.05, 0.5)),
        // Any shape, including upright faces.
        8 => {
            let mut x = 0.0;
            (0..12)
                .map(|_| {
                    x += if draw.chance(0.4) {
                        0.0
                    } else {
                        draw.size(2e-3, 0.1)
                    };
                    [x, draw.between(-0.05, 0.05)]
                })
                .collect()
        }
        9 => {
            let count = 20 + draw.below(1000);
            let jitter = if draw.chance(0.3) {
                0.0
            } else {
                draw.size(1e-9, 1e-4)
            };
            (0..count)
                .map(|i| [0.4 * i as f64 / count as f64, draw.between(-jitter, jitter)])
                .collect()
        }
        // Bars side by side.
        _ => {
            let (thickness, gap) = (draw.size(2e-3, 20e-3), draw.size(5e-3, 0.1));
            (0..4)
                .map(f64::from)
                .flat_map(|i| {
                    let x = i * (thickness + gap);
                    [
                        [x, 0.0],
                        [x, height],
                        [x + thickness, height],
                        [x + thickness, 0.0],
                    ]
                })
                .collect()
        }
    };
    // A spike without thickness is not ground.
    points.dedup_by(|b, a| a[0] == b[0] && a[1] == b[1]);
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for p in points {
        let n = kept.len();
        if n >= 2 && kept[n - 2][0] == p[0] {
            kept.pop();
        }
        kept.push(p);
    }
    let (first, last) = (kept[0], kept[kept.len() - 1]);
    let mut all = vec![[first[0] - RUN_OUT, first[1]]];
    all.extend(kept);
    all.push([last[0] + RUN_OUT, last[1]]);
    // The whole ground on a slope.
    let slope = if draw.chance(0.2) {
        draw.between(-0.3, 0.3)
    } else {
        0.0
    };
    all.iter()
        .map(|p| Vector::new(p[0], p[1] + slope * p[0]))
        .collect()
}

/// [m] The radius at which arcs take up the whole of a face; 0 if there is none below a metre.
pub(super) fn largest_radius(corners: &[Vector]) -> f64 {
    // Length of an arc's tangent, in units of its radius.
    let tangents: Vec<f64> = corners
        .windows(3)
        .map(|c| {
            let (d1, d2) = (c[1] - c[0], c[2] - c[1]);
            (0.5 * cross(d2, d1).atan2(d1.dot(d2))).tan().max(0.0)
        })
        .collect();
    let of_face = |i: usize| (corners[i + 1] - corners[i]).length();
    let fits = (1..tangents.len()).map(|i| of_face(i) / (tangents[i - 1] + tangents[i]));
    let least = fits.fold(f64::INFINITY, f64::min);
    if least < 1.0 { least } else { 0.0 }
}

/// A block on the ground, or a trench in it.
fn block(height: f64, length: f64) -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [0.0, height], [length, height], [length, 0.0]]
}

/// Lines and arcs; the arc of a corner is tangent to both of its lines.
fn curves(corners: &[Vector], radius: f64) -> Vec<Curve> {
    let mut curves = Vec::new();
    let mut begin = corners[0];
    for three in corners.windows(3) {
        let [before, corner, behind] = [three[0], three[1], three[2]];
        let (d1, d2) = ((corner - before).normalize(), (behind - corner).normalize());
        let (n1, n2) = (left_of(d1), left_of(d2));
        if radius == 0.0 || cross(d1, d2) > -1e-9 {
            curves.push(Curve::Line([begin, corner]));
            begin = corner;
            continue;
        }
        let center = corner - (n1 + n2) * (radius / (1.0 + n1.dot(n2)));
        curves.push(Curve::Line([begin, center + n1 * radius]));
        curves.push(Curve::Arc {
            center,
            radius,
            from: n2.y.atan2(n2.x),
            sweep: cross(n2, n1).atan2(n1.dot(n2)),
        });
        begin = center + n2 * radius;
    }
    curves.push(Curve::Line([begin, corners[corners.len() - 1]]));
    curves.retain(|c| !matches!(c, Curve::Line([a, b]) if (*a - *b).length() < 1e-13));
    curves
}
