//! How the gap of a contact changes in a step, as its point moves on.
//!
//! The equations: docs/physics.md, "Contacts".

use super::levers::Moved;
use super::meeting::{Meeting, Swing};
use super::state::State;
use super::touch::Touch;
use crate::geometry::{Vector, left_of};
use crate::robot::{Model, Mount};
use crate::solver::Contact;
use crate::units::Metres;

/// [m] Surfaces closer than this touch; a gap that a step has just closed is only rounding.
const TOUCHING: Metres = Metres(1e-10);

impl Touch {
    /// Updates the gap for the motion in a step of `h` [s], and sets the offsets of its speeds: how much faster the gap opens,
    /// and the surface slides, at the end of the step than by the levers of its middle.
    pub(super) fn move_gap(
        &mut self,
        solved: &mut Contact,
        (state, unknowns): (&State, &[f64]),
        model: &Model,
        h: f64,
    ) {
        let Some(mount) = self.mount() else {
            // Its directions and its speed stay the same during the step.
            self.gap += solved.normal.along(unknowns) * h;
            return;
        };
        let moved = self.moved(state, model, (mount, 0.0));
        self.gap = self.gap_at(&moved);
        if self.has_closed(solved) {
            let slip = solved.tangent.along(unknowns);
            let swing = self.swing(slip, state, model, (mount, &moved));
            let [opens, slides] = self.meeting.gains(swing).map(|gain| 0.5 * h * gain);
            (solved.normal.offset, solved.tangent.offset) = (opens, slides);
            self.rolled = self.rolled(&moved);
        }
    }

    /// [m] Distance that an arc has rolled on a face since the middle of the step.
    fn rolled(&self, moved: &Moved) -> f64 {
        let Meeting::Arc(radius) = self.meeting else {
            return 0.0;
        };
        let [_, along] = self.along(moved.way);
        along - radius * moved.of_part.sin()
    }

    /// Whether it pressed in the first solve of the step or touches now.
    pub(super) fn has_closed(&self, solved: &Contact) -> bool {
        solved.normal_impulse > 0.0 || self.gap <= TOUCHING.value()
    }

    /// Whether it did not touch when the step began.
    pub(super) fn was_open(&self) -> bool {
        self.gap_before > TOUCHING.value()
    }

    /// The motion of its part, which slips at a speed [m/s].
    fn swing(
        &self,
        slip: f64,
        state: &State,
        model: &Model,
        (mount, moved): (Mount, &Moved),
    ) -> Swing {
        let of_drive = |of: &dyn Fn(usize) -> f64| self.drive.map_or(0.0, of);
        let speed = of_drive(&|k| state.speed_over(mount, k, model));
        let &Moved {
            arm,
            spoke,
            of_carrier,
            ..
        } = moved;
        let carried = &self.middle.carried;
        // The pivot of an arm turns with the chassis.
        let of_chassis = state.angular_velocity * state.angular_velocity;
        let (turn, of_pivot) = match mount {
            Mount::Flipper(k) => (
                state.flippers[k].rate,
                (state.center - state.carrier(mount, 0.0, model).center) * of_chassis,
            ),
            _ => (state.angular_velocity, Vector::ZERO),
        };
        if carried.turns() {
            return Swing {
                turn: turn + carried.turn_at(speed),
                center: self.along(-spoke),
                pull: self.along(of_pivot - arm * (turn * turn)),
                slip,
            };
        }
        let of_surface = if carried.is_moving() {
            0.0
        } else {
            of_drive(&|k| self.spin_levers[1] * (state.drives[k].spin - turn))
        };
        let over_carrier = carried.velocity(of_carrier, speed);
        Swing {
            turn,
            center: self.along(-(arm + spoke)),
            pull: self.along(of_pivot + left_of(over_carrier) * (2.0 * turn)),
            slip: slip - of_surface,
        }
    }

    /// [m] The gap after a time [s] at the present velocities.
    pub(super) fn gap_after(
        &self,
        state: &State,
        model: &Model,
        (mount, time): (Mount, f64),
    ) -> f64 {
        self.gap_at(&self.moved(state, model, (mount, time)))
    }

    fn gap_at(&self, moved: &Moved) -> f64 {
        let way = self.along(moved.way);
        self.middle.gap + self.meeting.opened(way, moved.of_part)
    }

    /// Its point after a time [s] at the present velocities.
    fn moved(&self, state: &State, model: &Model, (mount, time): (Mount, f64)) -> Moved {
        let then = state.carrier(mount, time, model);
        let run = self.drive.map_or(0.0, |k| {
            state.run_over(mount, k, model) + state.speed_over(mount, k, model) * time
        });
        self.middle.moved(&then, run)
    }

    /// [m] How much deeper its point was in the ground in the middle of the step than at either end, if it bore nothing:
    /// the tip of a wheel that turns fast may dip in and out within a step.
    pub(super) fn dip(&self, solved: &Contact) -> f64 {
        let ends = self.gap_before.min(self.gap).min(0.0);
        if solved.normal_impulse > 0.0 {
            0.0
        } else {
            (ends - self.middle.gap).max(0.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::contact;
    use crate::dynamics::tests::whirling;
    use crate::dynamics::touch::Start;
    use crate::geometry::{Rotation, direction};
    use crate::robot::Shape;
    use crate::solver::Row;

    /// The same after a time [s] at these velocities.
    fn after(state: &State, model: &Model, time: f64) -> State {
        let mut then = state.clone();
        (then.center, then.angle) = state.mass_pose_after(time);
        for k in 0..state.drives.len() {
            then.drives[k].position += state.track_speed(model, k) * time;
        }
        for flipper in &mut then.flippers {
            flipper.angle += flipper.rate * time;
        }
        then
    }

    /// Checks the acceleration of a point of each part against the place where it is before and after.
    fn check(name: &str) {
        const TIME: f64 = 1e-4;
        let (mut dynamics, state) = whirling(name);
        let (layout, unknowns) = (dynamics.problem.layout, &mut dynamics.problem.unknowns);
        state.write_velocities(layout, unknowns);
        let (model, unknowns) = (&dynamics.model, &dynamics.problem.unknowns);
        let start = Start::new((&state, model), (layout, unknowns), 0.0);
        for (i, part) in model.parts.iter().enumerate() {
            let point = state.center + Vector::new(0.21, -0.07);
            let contact = contact::Contact::new(i, (0, -1), (point, direction(1.9)), 0.0);
            let (mut touch, solved) = Touch::new(&contact, None, &start);
            // Its normal stays as it is, so its gap and slip are those of the point.
            touch.meeting = Meeting::Point;
            let moved = |time: f64| {
                let then = after(&state, model, time);
                touch.moved(&then, model, (part.mount, 0.0))
            };
            let way = |time: f64| touch.along(moved(time).way);
            let slip = solved.tangent.along(unknowns);
            let swing = touch.swing(slip, &state, model, (part.mount, &moved(0.0)));
            let gains = touch.meeting.gains(swing);
            let (back, on) = (way(-TIME), way(TIME));
            for axis in [0, 1] {
                let bend = (on[axis] + back[axis]) / (TIME * TIME);
                assert_relative_eq!(gains[axis], bend, max_relative = 1e-4, epsilon = 1e-5);
            }
            // The surface of a belt or disc moves over the point, which counts for the normal alone.
            let slides = (on[1] - back[1]) / (2.0 * TIME);
            assert_relative_eq!(swing.slip, slides, max_relative = 1e-5);
        }
    }

    #[test]
    fn the_points_of_gears_accelerate_with_chassis_and_axle() {
        check("engineer_gear3_step");
    }

    #[test]
    fn grousers_accelerate_along_their_belt_and_round_its_ends() {
        let (dynamics, _) = whirling("engineer_grouser_belt_step");
        assert!(
            dynamics
                .model
                .parts
                .iter()
                .any(|part| matches!(part.shape, Shape::Grouser(_)))
        );
        check("engineer_grouser_belt_step");
    }

    #[test]
    fn the_points_of_arms_accelerate_with_pivot_and_arm() {
        check("engineer_flippers_step");
    }

    #[test]
    fn an_arc_rolls_by_the_way_of_its_centre() {
        let touch = Touch {
            normal: Vector::Y,
            meeting: Meeting::Arc(0.05),
            ..Touch::default()
        };
        let rolled = |way: f64, turned: f64| {
            let of_part = Rotation::new(turned);
            let moved = Moved {
                arm: Vector::ZERO,
                spoke: Vector::ZERO,
                way: Vector::new(way, 0.0),
                of_carrier: of_part,
                of_part,
            };
            touch.rolled(&moved)
        };
        assert_relative_eq!(rolled(0.01, 0.0), 0.01);
        assert_relative_eq!(
            rolled(0.0, -0.2),
            0.05 * 0.2_f64.sin(),
            max_relative = 1e-12
        );
        assert_relative_eq!(
            rolled(0.01, 0.2),
            0.01 - 0.05 * 0.2_f64.sin(),
            max_relative = 1e-12
        );
    }

    #[test]
    fn a_tip_dips_by_what_it_is_deeper_than_at_either_end_unless_something_bears_it() {
        let mut solved = Contact::new([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]].map(Row::on_base));
        let dip = |[before, middle, now]: [f64; 3], solved: &Contact| {
            let mut touch = Touch::default();
            (touch.gap_before, touch.middle.gap, touch.gap) = (before, middle, now);
            touch.dip(solved)
        };
        assert_relative_eq!(dip([1e-3, -2e-3, 3e-3], &solved), 2e-3);
        assert_relative_eq!(dip([-1e-3, -5e-3, -2e-3], &solved), 3e-3);
        assert_relative_eq!(dip([-1e-3, -5e-3, 2e-3], &solved), 4e-3);
        assert_relative_eq!(dip([-3e-3, -2e-3, 1e-3], &solved), 0.0);
        solved.normal_impulse = 1e-6;
        assert_relative_eq!(dip([1e-3, -2e-3, 3e-3], &solved), 0.0);
    }
}
