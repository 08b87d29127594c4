//! The course of a contact's gap in a step: how its point moves on from the start.
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
    /// Updates the gap for the motion in a step of `h` [s], and how much faster the gap opens, and the surface slides, at
    /// its end than with the levers of its middle.
    pub(super) fn move_gap(
        &mut self,
        solved: &mut Contact,
        (state, unknowns): (&State, &[f64]),
        model: &Model,
        h: f64,
    ) {
        let Some(mount) = self.mount() else {
            // Its directions are kept, and so is its speed during the step.
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

    /// [m] How far an arc has rolled on its face since the middle of the step.
    fn rolled(&self, moved: &Moved) -> f64 {
        let Meeting::Arc(radius) = self.meeting else {
            return 0.0;
        };
        let [_, along] = self.along(moved.way);
        along - radius * moved.of_part.sin()
    }

    /// Whether it pressed in the first solve or touches now.
    pub(super) fn has_closed(&self, solved: &Contact) -> bool {
        solved.normal_impulse > 0.0 || self.gap <= TOUCHING.value()
    }

    /// Whether it did not touch when the step began.
    pub(super) fn was_open(&self) -> bool {
        self.gap_before > TOUCHING.value()
    }

    /// Its part's motion, where that slips at a speed [m/s].
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
        let ends = self.gap_before.min(self.gap).min(0.0);
        if solved.normal_impulse > 0.0 {
            0.0
        } else {
            (ends - self.middle.gap).max(0.0)
        }
    }
}
