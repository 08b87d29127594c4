//! The course of a contact's gap in a step: how its point moves on from the start.
//!
//! The equations: docs/physics.md, "Contacts".

use super::levers::Moved;
use super::meeting::{Meeting, Swing};
use super::state::State;
use super::touch::{Touch, mount};
use crate::geometry::{Vector, left_of};
use crate::robot::{Model, Mount};
use crate::solver::{Contact, Direction};
use crate::units::Metres;

/// [m] Surfaces closer than this touch; a gap that a step has just closed is only rounding.
const TOUCHING: Metres = Metres(1e-10);

impl Touch {
    /// Updates the gap for the motion in a step of `h` [s], and how much faster the gap opens, and the surface slides, at
    /// its end than with the levers of its middle.
    pub(super) fn follow(&mut self, solved: &mut Contact, state: &State, model: &Model, h: f64) {
        let Some(mount) = mount(solved) else {
            // Its directions are kept, and so is its speed during the step.
            self.gap += solved.opening_speed(state) * h;
            return;
        };
        let moved = self.moved(state, model, (mount, 0.0));
        self.gap = self.gap_at(solved, &moved);
        if self.has_closed(solved) {
            let swing = self.swing(solved, state, model, mount, &moved);
            let [opens, slides] = self.meeting.gains(swing).map(|gain| 0.5 * h * gain);
            (solved.normal.offset, solved.tangent.offset) = (opens, slides);
            self.overrun = self.overrun(&solved.tangent, &moved);
        }
    }

    /// [m] How far the ground has fallen away below an arc that has rolled past the end of its face.
    fn overrun(&self, tangent: &Direction, moved: &Moved) -> f64 {
        let Meeting::Arc(radius) = self.meeting else {
            return 0.0;
        };
        let way = tangent.unit.dot(moved.way) - radius * moved.of_part.sin();
        self.face.below(radius, way)
    }

    /// Whether it pressed in the first solve or touches now.
    pub(super) fn has_closed(&self, solved: &Contact) -> bool {
        solved.normal_impulse > 0.0 || self.gap <= TOUCHING.value()
    }

    /// Whether it did not touch when the step began.
    pub(super) fn was_open(&self) -> bool {
        self.start > TOUCHING.value()
    }

    /// Its part's motion.
    fn swing(
        &self,
        solved: &Contact,
        state: &State,
        model: &Model,
        mount: Mount,
        moved: &Moved,
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
        let slip = solved.slip(state);
        // The pivot of an arm turns with the chassis.
        let of_chassis = state.angular_velocity * state.angular_velocity;
        let (turn, of_pivot) = match mount {
            Mount::Flipper(k) => (
                state.flippers[k].rate,
                (state.center - state.carrier(mount, 0.0, model).center) * of_chassis,
            ),
            _ => (state.angular_velocity, Vector::ZERO),
        };
        let along = |v: Vector| [solved.normal.unit, solved.tangent.unit].map(|unit| unit.dot(v));
        if carried.turns() {
            return Swing {
                turn: turn + carried.turn_at(speed),
                center: along(-spoke),
                pull: along(of_pivot - arm * (turn * turn)),
                slip,
            };
        }
        let of_surface = if carried.is_moving() {
            0.0
        } else {
            of_drive(&|k| solved.tangent.spin_lever * (state.drives[k].spin - turn))
        };
        let over_carrier = carried.velocity(of_carrier, speed);
        Swing {
            turn,
            center: along(-(arm + spoke)),
            pull: along(of_pivot + left_of(over_carrier) * (2.0 * turn)),
            slip: slip - of_surface,
        }
    }

    /// [m] The gap after a time [s] at the present velocities.
    pub(super) fn gap_after(
        &self,
        solved: &Contact,
        state: &State,
        model: &Model,
        (mount, time): (Mount, f64),
    ) -> f64 {
        self.gap_at(solved, &self.moved(state, model, (mount, time)))
    }

    fn gap_at(&self, solved: &Contact, moved: &Moved) -> f64 {
        let way = [solved.normal.unit, solved.tangent.unit].map(|unit| unit.dot(moved.way));
        self.middle.gap + self.meeting.opened(way, moved.of_part)
    }

    /// Its point then.
    fn moved(&self, state: &State, model: &Model, (mount, time): (Mount, f64)) -> Moved {
        let then = state.carrier(mount, time, model);
        let run = self.drive.map_or(0.0, |k| {
            state.run_over(mount, k, model) + state.speed_over(mount, k, model) * time
        });
        self.middle.moved(&then, run)
    }

    /// [m] How much deeper in the ground the place was in the middle of the step than at either end, if nothing
    /// bore there: the tip of a wheel that turns fast may come and go within a step.
    pub(super) fn dip(&self, solved: &Contact) -> f64 {
        let ends = self.start.min(self.gap).min(0.0);
        if solved.normal_impulse > 0.0 {
            0.0
        } else {
            (ends - self.middle.gap).max(0.0)
        }
    }
}
