//! By how much a gap may close in a step: a contact whose gap stays open is left out of the step.
//!
//! The equations: docs/physics.md, "Contacts".

use super::Dynamics;
use super::state::State;
use crate::contact::Contact;
use crate::geometry::{Rotation, left_of, right_of};
use crate::robot::Mount;

/// How a gap closes while velocities stay as they are.
#[derive(Clone, Copy)]
pub(crate) struct Closing {
    /// [m/s]
    speed: f64,
    /// [m/s^2] Upper bound.
    bend: f64,
}

impl Closing {
    const UNKNOWN: Self = Self {
        speed: f64::INFINITY,
        bend: 0.0,
    };

    /// [m] By how much the gap may be smaller at any time within a `time` [s] before or after.
    pub(crate) fn within(self, time: f64) -> f64 {
        (self.speed + 0.5 * self.bend * time) * time
    }
}

impl Dynamics {
    /// How the gap of a contact closes that was found where it will be after a `time` [s] at the velocities of a state; shoes
    /// may close at any speed.
    pub(crate) fn closing(&self, contact: &Contact, (state, time): (&State, f64)) -> Closing {
        let (part, model) = (&self.model.parts[contact.part], &self.model);
        let (center, _) = state.mass_pose_after(time);
        let carrier = state.carrier(part.mount, time, model);
        let (pivot, arm) = (carrier.center - center, contact.point - carrier.center);
        let of_chassis = state.angular_velocity;
        let of_carrier = match part.mount {
            Mount::Chassis => of_chassis,
            Mount::Flipper(k) => state.flippers[k].rate,
            Mount::Shoe(_) => return Closing::UNKNOWN,
        };
        let mut velocity = state.velocity + left_of(pivot) * of_chassis + left_of(arm) * of_carrier;
        let mut bend =
            of_chassis * of_chassis * pivot.length() + of_carrier * of_carrier * arm.length();
        let mut turn = of_carrier.abs();
        if let (true, Some(drive)) = (part.is_carried(), part.drive) {
            let speed = state.speed_over(part.mount, drive, model);
            let run = state.run_over(part.mount, drive, model) + speed * time;
            let (motion, rotation) = (part.motion(run, 0.0), Rotation::new(carrier.angle));
            let spoke = arm - rotation * (motion.center - carrier.origin);
            velocity += (right_of(spoke) * motion.turn + rotation * motion.along) * speed;
            // Of motion along a carrier that turns, and of rotation on it.
            bend += 2.0 * (of_carrier * speed).abs() * motion.along.length();
            turn += (motion.turn * speed).abs();
            bend += turn * turn * spoke.length();
        }
        // Of a side that slides over a corner while it turns.
        bend += 2.0 * turn * velocity.length();
        Closing {
            speed: velocity.dot(contact.normal).abs(),
            bend,
        }
    }

    /// [m] How far a step of `h` [s] may have taken any point of the outline from where the velocities `before` it would have;
    /// `reach` is the farthest from the centre of mass [m].
    pub(crate) fn strayed(&self, before: &State, h: f64, reach: f64) -> f64 {
        let now = &self.motion;
        let flippers = now.flippers.iter().zip(&before.flippers);
        let turns = flippers.map(|(now, before)| (now.rate - before.rate).abs());
        let of_chassis = (now.angular_velocity - before.angular_velocity).abs();
        let turn = turns.fold(of_chassis, f64::max);
        let drives = now.drives.iter().zip(&before.drives);
        let spins = drives.map(|(now, before)| (now.spin - before.spin).abs());
        let surface = self.model.drive_radius * (turn + spins.fold(0.0, f64::max));
        let body = (now.velocity - before.velocity).length() + turn * reach;
        (body + self.tip_speed * surface) * h
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::contact;
    use crate::draw::Draw;
    use crate::dynamics::meeting::Meeting;
    use crate::dynamics::tests::whirling;
    use crate::dynamics::touch::{Start, Touch};
    use crate::geometry::{Vector, direction};
    use crate::robot::Shape;

    const SCENARIOS: [&str; 3] = [
        "judge_gear3_step",
        "engineer_grouser_belt_step",
        "engineer_flippers_step",
    ];

    /// Calls `check` with contacts anywhere at the parts of robots that whirl through the air: with how the gap changes,
    /// and with the change [m] after a time [s].
    fn for_each(check: impl Fn(Closing, &dyn Fn(f64) -> f64)) {
        let mut draw = Draw(7);
        for name in SCENARIOS {
            let (mut dynamics, state) = whirling(name);
            let (layout, unknowns) = (dynamics.problem.layout, &mut dynamics.problem.unknowns);
            state.write_velocities(layout, unknowns);
            let (model, unknowns) = (&dynamics.model, &dynamics.problem.unknowns);
            let start = Start::new((&state, model), (layout, unknowns), 0.0);
            for (i, part) in model.parts.iter().enumerate() {
                let away = Vector::new(draw.between(-0.3, 0.3), draw.between(-0.1, 0.1));
                let normal = direction(draw.between(0.0, 7.0));
                let place = (state.center + away, normal);
                let contact = contact::Contact::new(i, (0, -1), place, 0.01);
                let closing = dynamics.closing(&contact, (&state, 0.0));
                let (mut touch, _) = Touch::new(&contact, None, &start);
                for meeting in [Meeting::Point, Meeting::SideOnCorner] {
                    touch.meeting = meeting;
                    let gap = |time: f64| touch.gap_after(&state, model, (part.mount, time));
                    check(closing, &|time| gap(time) - gap(0.0));
                }
            }
        }
    }

    #[test]
    fn a_gap_changes_at_the_speed_of_the_point_along_the_normal() {
        for_each(|closing, change| {
            let time = 1e-7;
            let by = 0.5 * (change(time) - change(-time)).abs();
            assert_relative_eq!(
                by,
                closing.speed * time,
                max_relative = 1e-4,
                epsilon = 1e-12
            );
        });
    }

    #[test]
    fn at_constant_velocities_no_gap_closes_further_than_its_bound() {
        for_each(|closing, change| {
            for time in [1e-4, 1e-3, 4e-3] {
                let by = change(time).abs().max(change(-time).abs());
                assert!(by <= closing.within(time) + 1e-15, "{by} m in {time} s");
            }
        });
    }

    #[test]
    fn no_point_strays_farther_than_its_bound() {
        const TIME: f64 = 1e-3;
        let mut draw = Draw(3);
        for name in SCENARIOS {
            let (mut dynamics, state) = whirling(name);
            let (layout, unknowns) = (dynamics.problem.layout, &mut dynamics.problem.unknowns);
            state.write_velocities(layout, unknowns);
            let other = &mut dynamics.motion;
            other.copy(&state);
            other.velocity += Vector::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0));
            other.angular_velocity += draw.between(-2.0, 2.0);
            other.drives[0].spin += draw.between(-9.0, 9.0);
            for flipper in &mut other.flippers {
                flipper.rate += draw.between(-2.0, 2.0);
            }
            let (model, other) = (&dynamics.model, &dynamics.motion);
            let start = Start::new((&state, model), (layout, &dynamics.problem.unknowns), 0.0);
            let mut most = 0.0_f64;
            for (i, part) in model.parts.iter().enumerate() {
                let carrier = state.carrier(part.mount, 0.0, model);
                let (mut middle, radius) = part.bound();
                if let Shape::Grouser(grouser) = &part.shape {
                    let run = state.run_over(part.mount, 0, model);
                    middle = grouser.place(run).transform_point(middle);
                }
                let place =
                    carrier.center + Rotation::new(carrier.angle) * (middle - carrier.origin);
                for k in 0..24 {
                    let normal = direction(0.27 * f64::from(k));
                    let at = (place + normal * radius, normal);
                    let contact = contact::Contact::new(i, (0, -1), at, 0.01);
                    let (mut touch, _) = Touch::new(&contact, None, &start);
                    touch.meeting = Meeting::Point;
                    let gap = |state| touch.gap_after(state, model, (part.mount, TIME));
                    most = most.max((gap(other) - gap(&state)).abs());
                }
            }
            let bound = dynamics.strayed(&state, TIME, model.reach());
            assert!(most <= bound && bound < 3.0 * most, "{most} m, {bound} m");
        }
    }
}
