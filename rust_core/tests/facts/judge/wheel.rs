//! The outline of one wheel with grousers, in its own frame: a grouser points along +x.

use crawler2d_core::{Gear, Vector};

use super::ground::REACH;
use super::left_of;

/// Which side of a wheel's outline is touched.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    Tip,
    Flank,
    Root,
}

/// A root circle and grousers; all grousers are alike, and each is its own mirror image.
pub(super) struct Toothed {
    pub radius: f64,
    pub root: f64,
    pub phase: f64,
    /// [rad] Between two grousers.
    angle: f64,
    /// [rad] Half of what a grouser takes on the root circle.
    foot: f64,
    /// Ends of the left flank: on the root circle, and on the circumscribed circle.
    flank: [Vector; 2],
    /// All corners of the tips, at phase 0.
    pub corners: Vec<Vector>,
}

impl Toothed {
    pub(super) fn new(gear: &Gear) -> Self {
        // A point of a circle at a distance from the grouser's axis.
        let on = |radius: f64, y: f64| Vector::new((radius * radius - y * y).sqrt(), y);
        let flank = [
            on(gear.root_radius, 0.5 * gear.base_thickness),
            on(gear.radius, 0.5 * gear.tip_thickness),
        ];
        let angle = std::f64::consts::TAU / f64::from(gear.grousers);
        let mut corners = Vec::new();
        for i in 0..gear.grousers {
            let turn = super::Turn::by(f64::from(i) * angle);
            corners.push(turn.of(Vector::new(flank[1].x, -flank[1].y)));
            corners.push(turn.of(flank[1]));
        }
        Self {
            radius: gear.radius,
            root: gear.root_radius,
            phase: gear.phase,
            angle,
            foot: (flank[0].y / flank[0].x).atan(),
            flank,
            corners,
        }
    }

    /// [rad] Angle of the nearest grouser and of the point from it.
    fn fold(&self, point: Vector) -> (f64, f64) {
        let angle = point.y.atan2(point.x);
        let grouser = self.angle * (angle / self.angle).round();
        (grouser, angle - grouser)
    }

    /// Whether a direction from the centre meets the root circle beside the grousers.
    pub(super) fn shows_root(&self, direction: Vector) -> bool {
        self.fold(direction).1.abs() >= self.foot
    }

    /// The sides that a point lies behind, each with the depth [m] and the outward normal; of tip and
    /// flank, which meet in a corner that stands out, the nearer one.
    pub(super) fn over(&self, point: Vector, mut found: impl FnMut(Side, f64, Vector)) {
        let distance = point.length();
        if distance >= self.radius || distance < self.root - REACH {
            return;
        }
        let (grouser, angle) = self.fold(point);
        let (x, y) = (distance * angle.cos(), distance * angle.sin().abs());
        let [base, tip] = self.flank;
        let way = tip - base;
        let along = way / way.length();
        let out = left_of(along);
        let from_base = Vector::new(x, y) - base;
        let seen = |depth: f64| (0.0..REACH).contains(&depth).then_some(depth);

        let of_tip = seen(tip.x - x).filter(|_| y <= tip.y);
        // Behind the inner corner at its foot a flank goes on, and so does the root circle.
        let beside_flank = (-REACH..=way.length()).contains(&from_base.dot(along));
        let of_flank = seen(-from_base.dot(out)).filter(|_| beside_flank);
        let of_root =
            seen(self.root - distance).filter(|_| angle.abs() >= self.foot - REACH / self.root);

        let turn = super::Turn::by(grouser);
        let placed = |n: Vector| turn.of(Vector::new(n.x, n.y * angle.signum()));
        match (of_tip, of_flank) {
            (Some(a), Some(b)) if b < a => found(Side::Flank, b, placed(out)),
            (Some(a), _) => found(Side::Tip, a, placed(Vector::new(1.0, 0.0))),
            (None, Some(b)) => found(Side::Flank, b, placed(out)),
            (None, None) => {}
        }
        if let Some(depth) = of_root {
            found(Side::Root, depth, point / distance);
        }
    }
}
