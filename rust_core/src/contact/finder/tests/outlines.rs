//! Random parts: the shapes that the contacts get, and the test's own lines and arcs.

use std::f64::consts::TAU;

use super::curve::Curve;
use crate::draw::Draw;
use crate::geometry::{Disc, Gear, Pose, Rotation, Vector};
use crate::robot::{BodyKind, Mount, Part, Shape};

pub(super) struct Outline {
    pub part: Part,
    /// [m] Distance of the farthest point from the centre of the part.
    pub reach: f64,
    /// [m] Thickness of a grouser, or of the whole part.
    pub thinnest: f64,
    /// Counter-clockwise, in the chassis frame.
    curves: Vec<Curve>,
    /// [m] Centre in the chassis frame.
    pub center: Vector,
}

pub(super) const KINDS: usize = 5;

/// A part of this shape on the chassis, with a drive.
pub(super) fn driven(shape: Shape) -> Part {
    Part {
        kind: BodyKind::Wheel,
        shape,
        drive: Some(0),
        friction_limit: f64::INFINITY,
        lane: 0,
        mount: Mount::Chassis,
    }
}

impl Outline {
    pub(super) fn random(kind: usize, draw: &mut Draw) -> Self {
        let center = Vector::new(draw.between(-0.3, 0.3), draw.between(-0.1, 0.1));
        let radius = draw.size(15e-3, 0.12);
        let (shape, curves, reach) = match kind {
            0 => (Shape::Disc { center, radius }, disc(center, radius), radius),
            1 => {
                let count = 3 + draw.below(6);
                let angles = (0..count).map(|i| {
                    let angle = TAU * (i as f64 + draw.between(0.0, 0.7)) / count as f64;
                    center + Rotation::new(angle) * Vector::X * radius
                });
                let corners: Vec<Vector> = angles.collect();
                let next = |i: usize| corners[(i + 1) % count];
                let lines = (0..count)
                    .map(|i| Curve::Line([corners[i], next(i)]))
                    .collect();
                (
                    Shape::Polygon {
                        corners: corners.clone(),
                    },
                    lines,
                    radius,
                )
            }
            2 => capsule(center, radius, draw),
            _ => {
                let gear = gear(radius, draw);
                (Shape::Gear { center, gear }, wheel(center, &gear), radius)
            }
        };
        let thinnest = match &shape {
            Shape::Gear { gear, .. } => gear.tip_thickness,
            _ => reach,
        };
        Self {
            part: driven(shape),
            reach,
            thinnest,
            curves,
            center,
        }
    }

    /// The curves in world coordinates.
    pub(super) fn at(&self, pose: Pose, drive: f64) -> Vec<Curve> {
        let turn = match &self.part.shape {
            Shape::Gear { gear, .. } => -drive / gear.radius,
            _ => 0.0,
        };
        let own = Rotation::new(turn);
        let place = |p: Vector| pose.transform_point(self.center + own * (p - self.center));
        let angle = turn + pose.rotation.angle();
        let moved = |curve: &Curve| match *curve {
            Curve::Line([a, b]) => Curve::Line([place(a), place(b)]),
            Curve::Arc {
                center,
                radius,
                from,
                sweep,
            } => Curve::Arc {
                center: place(center),
                radius,
                from: from + angle,
                sweep,
            },
        };
        self.curves.iter().map(moved).collect()
    }
}

fn disc(center: Vector, radius: f64) -> Vec<Curve> {
    vec![Curve::Arc {
        center,
        radius,
        from: 0.0,
        sweep: TAU,
    }]
}

/// Two discs and their outer tangents.
fn capsule(middle: Vector, reach: f64, draw: &mut Draw) -> (Shape, Vec<Curve>, f64) {
    let way = Rotation::new(draw.between(0.0, TAU)) * Vector::X;
    let (r1, r2) = (
        reach * draw.between(0.2, 0.45),
        reach * draw.between(0.2, 0.45),
    );
    let (c1, c2) = (middle - way * (reach - r1), middle + way * (reach - r2));
    // The outward directions of the tangents are at this angle to the line between the centres.
    let half = ((r1 - r2) / (c2 - c1).length()).acos();
    let heading = way.y.atan2(way.x);
    let at = |c: Vector, r: f64, angle: f64| c + Vector::new(angle.cos(), angle.sin()) * r;
    let (left, right) = (heading + half, heading - half);
    let curves = vec![
        Curve::Arc {
            center: c2,
            radius: r2,
            from: right,
            sweep: 2.0 * half,
        },
        Curve::Line([at(c2, r2, left), at(c1, r1, left)]),
        Curve::Arc {
            center: c1,
            radius: r1,
            from: left,
            sweep: TAU - 2.0 * half,
        },
        Curve::Line([at(c1, r1, right), at(c2, r2, right)]),
    ];
    let discs = [(c1, r1), (c2, r2)].map(|(center, radius)| Disc { center, radius });
    (
        Shape::Hull {
            discs: discs.to_vec(),
            grouser_height: 0.0,
        },
        curves,
        reach,
    )
}

fn gear(radius: f64, draw: &mut Draw) -> Gear {
    let grousers = 6 + draw.below(43) as u32;
    // Grousers are higher than any penetration.
    let root_radius = radius - draw.between(1.1e-3_f64.max(0.05 * radius), 0.3 * radius);
    let room = 2.0 * root_radius * (0.5 * TAU / f64::from(grousers)).sin();
    let base_thickness = room * draw.between(0.15, 0.8);
    let parallel = draw.chance(0.5);
    let taper = if parallel {
        1.0
    } else {
        draw.between(0.3, 1.0)
    };
    Gear {
        radius,
        root_radius,
        grousers,
        tip_thickness: base_thickness * taper,
        base_thickness,
        phase: draw.between(0.0, 1.0),
    }
}

/// Each grouser stands on a chord of the root circle.
fn wheel(center: Vector, gear: &Gear) -> Vec<Curve> {
    let corner = |radius: f64, half: f64| Vector::new((radius * radius - half * half).sqrt(), half);
    let tip = corner(gear.radius, 0.5 * gear.tip_thickness);
    let base = corner(gear.root_radius, 0.5 * gear.base_thickness);
    let half = (base.y / base.x).atan();
    let pitch = TAU / f64::from(gear.grousers);
    let of_grouser = |i: u32| {
        let middle = gear.phase + f64::from(i) * pitch;
        let turned = Rotation::new(middle);
        let place = |x: f64, y: f64| center + turned * Vector::new(x, y);
        let corners = [
            place(base.x, -base.y),
            place(tip.x, -tip.y),
            place(tip.x, tip.y),
            place(base.x, base.y),
        ];
        let root = Curve::Arc {
            center,
            radius: gear.root_radius,
            from: middle + half,
            sweep: pitch - 2.0 * half,
        };
        corners
            .windows(2)
            .map(|ends| Curve::Line([ends[0], ends[1]]))
            .chain([root])
            .collect::<Vec<_>>()
    };
    (0..gear.grousers).flat_map(of_grouser).collect()
}
