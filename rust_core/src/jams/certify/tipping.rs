//! Whether a robot that one wheel or two can carry would leave that pose by itself.
//!
//! On two contacts it has one freedom. With the vector `b` of the weight, the contacts' wrenches `w`, per unit of normal
//! force and about the centre of mass, and the velocity `u` that keeps both closed, its motion is
//! `nu . M u s'' = -nu . b m g` for `nu = w1 x w2`: at a pose of balance, where `nu . b = 0`, small deviations grow if that
//! product falls along the motion. On one corner alone they always grow.

use super::balance::{candidate, excludes};
use super::family::Family;
use super::interval::{Interval, Rectangle};
use super::touch::Touch;

/// Share by which the moment of inertia may be off, either way: how far drives turn along is not known better.
const INERTIA: f64 = 0.25;

impl Family {
    /// Whether there are at most two contacts at a time, and in every balance on them small deviations grow.
    pub(super) fn tips(&self, touches: &[Touch]) -> bool {
        let pairs = || {
            let later = |(i, one)| touches[i + 1..].iter().map(move |other| (one, other));
            touches.iter().enumerate().flat_map(later)
        };
        let apart = |one: &Touch, other: &Touch| !self.are_one(one, other);
        let with_third = |(one, other): (&Touch, &Touch)| {
            apart(one, other)
                && touches
                    .iter()
                    .any(|third| apart(one, third) && apart(other, third))
        };
        !pairs().any(with_third)
            && touches
                .iter()
                .all(|touch| touch.slides && tips_on_one(touch))
            && pairs().all(|(one, other)| !apart(one, other) || self.tips_on_two(one, other))
    }

    fn tips_on_two(&self, one: &Touch, other: &Touch) -> bool {
        let pair = [*one, *other];
        if candidate(&pair, self.reach).is_some_and(|twist| excludes(twist, &pair, self.reach)) {
            return true;
        }
        let (a, b) = (Wrench::of(one), Wrench::of(other));
        let nu = across(a.parts, b.parts);
        if nu[1].is_signed() {
            return true;
        }
        let u = across(a.gradient, b.gradient);
        let inertia = Interval::new(
            self.inertia.low * (1.0 - INERTIA),
            self.inertia.high * (1.0 + INERTIA),
        );
        let mass = nu[0] * u[0] + inertia * nu[2] * u[2];
        let (da, db) = (a.change(one, u), b.change(other, u));
        let [(xa, ma), (xb, mb)] = [&a, &b].map(|w| (w.parts[0], w.parts[2]));
        let change = da[2] * xb + ma * db[0] - da[0] * mb - xa * db[2];
        (mass * change).is_below(0.0)
    }

    /// Whether two contacts are one, or of one disc on a face and the corner at its end, where both are one.
    fn are_one(&self, one: &Touch, other: &Touch) -> bool {
        let [here, there] = [one, other].map(|touch| &self.places[touch.place]);
        let is_one = one.place == other.place || here.ends_at(there) || there.ends_at(here);
        one.surface == other.surface && is_one
    }
}

/// One contact on a corner is no balance, or one that is lost; on a face, it must be none.
fn tips_on_one(touch: &Touch) -> bool {
    if touch.normals.circle.is_some() {
        return true;
    }
    let [x, _, moment] = Wrench::of(touch).parts;
    x.is_signed() || moment.is_signed()
}

/// A contact's wrench per unit of normal force and what it pushes along, about the centre of mass, over a cell.
pub(super) struct Wrench {
    /// Force and moment.
    pub parts: [Interval; 3],
    /// Those of the normal force alone, which are how the gap changes with the pose.
    gradient: [Interval; 3],
}

fn moment(arm: Rectangle, x: Interval, y: Interval) -> Interval {
    arm.x() * y - arm.y() * x
}

fn across(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

impl Wrench {
    pub(super) fn of(touch: &Touch) -> Self {
        let normals = touch.normals.all();
        let (nx, ny) = (normals.x(), normals.y());
        let slope = Interval::new(touch.slopes[0], touch.slopes[1]);
        let (x, y) = (nx + slope * ny, ny - slope * nx);
        let turning = Interval::at(touch.radius) * slope;
        Self {
            parts: [x, y, moment(touch.arm, x, y) + turning],
            gradient: [nx, ny, moment(touch.arm, nx, ny)],
        }
    }

    /// How it changes when the robot moves with both contacts closed.
    fn change(&self, touch: &Touch, u: [Interval; 3]) -> [Interval; 3] {
        let (ax, ay) = (touch.arm.x(), touch.arm.y());
        let [x, y, _] = self.parts;
        let turning = match touch.normals.circle {
            None => Interval::at(0.0),
            Some(circle) => {
                let velocity = [u[0] - u[2] * ay, u[1] + u[2] * ax];
                let across = velocity[1] * self.gradient[0] - velocity[0] * self.gradient[1];
                across * Interval::at(1.0 / circle)
            }
        };
        [
            -(turning * y),
            turning * x,
            (turning - u[2]) * (ax * x + ay * y),
        ]
    }
}
