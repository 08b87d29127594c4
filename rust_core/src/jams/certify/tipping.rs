//! Whether a robot carried by one or two wheels is unstable in that pose.
//!
//! On two contacts it has one freedom. With the vector `b` of the weight, the contacts' wrenches `w`, per unit of
//! normal force and about the centre of mass, and the velocity `u` that keeps both closed, its motion is
//! `nu . M u s'' = -nu . b m g` for `nu = w1 x w2`: at a pose of balance, where `nu . b = 0`, small deviations grow if
//! that product falls along the motion. On one corner alone they always grow.

use super::balance::{candidate, excludes};
use super::family::Family;
use super::interval::{Interval, Rectangle};
use super::touch::Touch;

/// Relative tolerance of the moment of inertia: it is not known better how far drives turn with the robot.
const INERTIA: f64 = 0.25;

impl Family {
    /// Whether there are at most two contacts at a time, and small deviations grow in every balance on them.
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

    /// Whether two contacts coincide, or are those of one disc on a face and on the corner at its end, which coincide.
    fn are_one(&self, one: &Touch, other: &Touch) -> bool {
        let [here, there] = [one, other].map(|touch| &self.places[touch.place]);
        let is_one = one.place == other.place || here.ends_at(there) || there.ends_at(here);
        one.surface == other.surface && is_one
    }
}

/// One contact on a corner is no balance, or an unstable one; on a face, there must be no balance.
fn tips_on_one(touch: &Touch) -> bool {
    if touch.normals.circle.is_some() {
        return true;
    }
    let [x, _, moment] = Wrench::of(touch).parts;
    x.is_signed() || moment.is_signed()
}

/// A contact's wrench per unit of normal force about the centre of mass, over a cell, and its direction of motion.
pub(super) struct Wrench {
    /// Force and moment.
    pub parts: [Interval; 3],
    /// Those of the normal force alone, which are the derivatives of the gap with respect to the pose.
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

    /// Its rate of change when the robot moves with both contacts closed.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::{Vector, cross, left_of, right_of};
    use crate::jams::certify::tests::family_on_a_step;
    use crate::jams::certify::touch::Normals;
    use crate::jams::places::Facing;

    /// A disc on a face, or on a corner at this distance [m] from its axle, with its arm from the centre of mass.
    fn touch(normal: Vector, circle: Option<f64>, arm: Vector, radius: f64) -> Touch {
        Touch {
            surface: 0,
            place: 0,
            normals: Normals {
                bisector: normal,
                sines: [0.0; 2],
                circle,
                is_on_face: circle.is_none(),
            },
            slopes: [0.0; 2],
            arm: Rectangle::at(arm),
            radius,
            slides: true,
        }
    }

    fn vector(draw: &mut Draw, most: f64) -> Vector {
        let [x, y] = [0.0; 2].map(|_| draw.between(-most, most));
        Vector::new(x, y)
    }

    /// Force of a unit normal force, and its moment at the point of the ground about the centre of mass.
    fn wrench([normal, arm]: [Vector; 2], radius: f64, slope: f64) -> [f64; 3] {
        let force = normal + right_of(normal) * slope;
        [force.x, force.y, cross(arm - normal * radius, force)]
    }

    #[test]
    fn a_wrench_holds_all_forces_of_a_touch() {
        let mut draw = Draw(21);
        for case in 0..200 {
            let normal = Vector::from_angle(draw.between(-3.0, 3.0));
            let (arm, radius) = (vector(&mut draw, 0.3), draw.between(0.0, 0.1));
            let mut all = touch(normal, None, arm, radius);
            all.slopes = [draw.between(-0.9, 0.0), draw.between(0.0, 0.9)];
            let share = if case % 2 == 0 { 0.0 } else { 1.0 };
            all.normals.sines = [-0.3 * share, 0.4 * share];
            all.arm.half = Vector::new(0.02, 0.01) * share;
            let parts = Wrench::of(&all).parts;
            for _ in 0..20 {
                let sine = draw.between(all.normals.sines[0], all.normals.sines[1]);
                let slope = draw.between(all.slopes[0], all.slopes[1]);
                let turned = Vector::from_angle(libm::asin(sine)).rotate(normal);
                let off = vector(&mut draw, 1.0) * all.arm.half;
                for (part, value) in parts.iter().zip(wrench([turned, arm + off], radius, slope)) {
                    assert!(
                        part.low <= value + 1e-15 && value - 1e-15 <= part.high,
                        "{case}"
                    );
                }
            }
            if case % 2 == 0 {
                // With one normal, each component is between those at the two ends of the friction.
                let ends = all.slopes.map(|slope| wrench([normal, arm], radius, slope));
                for (i, part) in parts.iter().enumerate().take(2) {
                    let width = (ends[0][i] - ends[1][i]).abs();
                    assert!((part.high - part.low - width).abs() < 1e-15, "{case}");
                }
            }
        }
    }

    /// A disc continues to roll or slide: its normal turns with the axle about a corner, and does not turn on a face.
    #[test]
    fn a_wrench_changes_as_when_the_robot_moves_with_the_contact_closed() {
        let mut draw = Draw(22);
        for case in 0..200 {
            let normal = Vector::from_angle(draw.between(-3.0, 3.0));
            let (arm, radius) = (vector(&mut draw, 0.3), draw.between(0.01, 0.1));
            let circle = (case % 2 == 0).then_some(radius + 0.01);
            let slope = draw.between(-0.9, 0.9);
            let mut on = touch(normal, circle, arm, radius);
            on.slopes = [slope; 2];
            // The velocity of the axle is along the ground.
            let (rate, speed) = (draw.between(-1.0, 1.0), draw.between(-1.0, 1.0));
            let velocity = left_of(normal) * speed - left_of(arm) * rate;
            let moved = |time: f64| {
                let turned = Vector::from_angle(rate * time).rotate(arm);
                let axle = velocity * time + turned - arm;
                let there = circle.map_or(normal, |circle| (normal * circle + axle).normalize());
                wrench([there, turned], radius, slope)
            };
            let step = 1e-5;
            let (ahead, behind) = (moved(step), moved(-step));
            let u = [velocity.x, velocity.y, rate].map(Interval::at);
            let found = Wrench::of(&on).change(&on, u);
            for (i, part) in found.iter().enumerate() {
                let slope = (ahead[i] - behind[i]) / (2.0 * step);
                // Of central differences a rate of up to 1e2 rad/s leaves 1e4 times the square of the step.
                assert!(
                    (part.middle() - slope).abs() < 1e-4,
                    "{case}: {part:?} {slope}"
                );
                assert!(part.half() < 1e-12);
            }
        }
    }

    /// Both walls of a notch rise at the same angle. The ends of a bar between them stay on lines, and its middle is
    /// highest when it is level, by half its length times the tangent: a mass that hangs lower than that is lifted, and
    /// comes back.
    #[test]
    fn a_bar_in_a_notch_tips_unless_its_mass_hangs_below_the_foot_of_the_notch() {
        let mut family = family_on_a_step();
        let half = 0.2;
        for slope in [0.3, 0.6] {
            let (sine, cosine) = libm::sincos(slope);
            let wall = |side: f64| {
                let mut spot = family.places[0].clone();
                spot.place.shape = Facing::Face {
                    ends: [Vector::ZERO; 2],
                    normal: Vector::new(side * sine, cosine),
                };
                spot
            };
            family.places = vec![wall(1.0), wall(-1.0)];
            let on = |side: f64, height: f64| {
                let arm = Vector::new(-side * half, -height);
                let place = usize::from(side < 0.0);
                Touch {
                    surface: place,
                    place,
                    ..touch(Vector::new(side * sine, cosine), None, arm, 0.05)
                }
            };
            let foot = -half * libm::tan(slope);
            for (height, tips) in [(0.1, true), (0.9 * foot, true), (1.1 * foot, false)] {
                let both = [on(1.0, height), on(-1.0, height)];
                assert_eq!(family.tips(&both), tips, "{slope} {height}");
                // With a third contact, or with one that stands still, there are more ways to carry it.
                let third = Touch {
                    surface: 2,
                    ..both[0]
                };
                assert!(!family.tips(&[both[0], both[1], third]));
                assert!(!family.tips(&[
                    Touch {
                        slides: false,
                        ..both[0]
                    },
                    both[1]
                ]));
            }
        }
    }

    /// It stands on the floor and leans against a wall, its front axle 0.1 m below the centre of mass and 0.3 m ahead
    /// of it. With a friction of 0.9 the wall's force has a moment of 0.9 (0.3 m + 0.05 m) - 0.1 m = 0.215 m per
    /// newton of its normal force, which alone has -0.1 m. Where the square of the radius of inertia is less than
    /// 0.0215 m^2, its friction drives it against the direction in which the ground accelerates it. On a narrow
    /// corner its rear wheel is then what tips it.
    #[test]
    fn a_balance_tips_if_it_does_with_a_quarter_less_inertia_and_with_a_quarter_more() {
        let mut family = family_on_a_step();
        let friction = 0.9;
        let rubs = |touch: Touch, number: usize| Touch {
            surface: number,
            place: 2 * number,
            slopes: [friction; 2],
            ..touch
        };
        let high = [(1.0 / 0.74, true), (1.0 / 0.76, false), (0.1, false)];
        let low = [(1.0 / 1.26, true), (1.0 / 1.24, false), (9.0, false)];
        for (rear_axle, circle, shares) in [
            (-0.1, None, high),
            (0.0, None, high),
            (-0.05, Some(0.031_25), low),
        ] {
            // So far behind that the floor's force has a moment of -0.9 x 0.215 m, and both balance the weight.
            let behind = -0.9 * 0.215 + friction * (rear_axle - 0.05);
            let rear = touch(Vector::Y, circle, Vector::new(behind, rear_axle), 0.05);
            let front = touch(Vector::NEG_X, None, Vector::new(0.3, -0.1), 0.05);
            for (share, tips) in shares {
                family.inertia = Interval::at(0.0215 * share);
                let both = [rubs(rear, 0), rubs(front, 1)];
                assert_eq!(family.tips(&both), tips, "{rear_axle} {share}");
            }
        }
    }

    #[test]
    fn a_robot_on_one_corner_tips_and_on_one_face_only_if_it_cannot_stand_there() {
        let family = family_on_a_step();
        let down = Vector::new(0.0, -0.1);
        let on_corner = touch(Vector::Y, Some(0.05), down, 0.05);
        assert!(family.tips(&[on_corner]));
        let on_face = touch(Vector::Y, None, down, 0.05);
        assert!(!family.tips(&[on_face]));
        // The force is not vertical, or the support not under the centre of mass.
        let pushed = Touch {
            slopes: [0.5; 2],
            ..on_face
        };
        let aside = Touch {
            arm: Rectangle::at(Vector::new(0.01, -0.1)),
            ..on_face
        };
        assert!(family.tips(&[pushed]) && family.tips(&[aside]));
    }
}
