//! The course of a contact's gap in a step: how its point moves on from the start.
//!
//! The equations: docs/physics.md, "Contacts".

use super::levers::Place;
use super::meeting::Swing;
use super::row::{Link, Row};
use super::state::State;
use crate::geometry::Rotation;
use crate::robot::{Model, Mount};

impl Row {
    /// Updates the gap for the motion in a step of `h` [s].
    pub(super) fn follow(&mut self, state: &State, model: &Model, h: f64) {
        let Some(mount) = self.mount() else {
            // Its directions are kept, and so is its speed during the step.
            self.gap += self.opening_speed(state) * h;
            return;
        };
        self.gap = self.start.gap + self.gained(state, model, (mount, 0.0));
        let speed = self
            .drive
            .map_or(0.0, |k| state.speed_over(mount, k, model));
        // It may let the gap close, but pushes nothing.
        let grows = self.meeting.opens(self.swing(state, speed)).max(0.0);
        self.opens = 0.5 * h * grows;
    }

    /// What carries it, if that is no shoe.
    pub(super) fn mount(&self) -> Option<Mount> {
        match self.link {
            Link::Chassis => Some(Mount::Chassis),
            Link::Flipper(k) => Some(Mount::Flipper(k)),
            Link::Shoe(_) | Link::Guide { .. } | Link::Tooth { .. } => None,
        }
    }

    /// Its part's motion, with its drive at a speed [m/s] over what carries it.
    fn swing(&self, state: &State, speed: f64) -> Swing {
        let Place {
            carrier,
            arm,
            carried,
            ..
        } = &self.start;
        let (angle, turn) = match self.link {
            Link::Flipper(k) => (state.flippers[k].angle, state.flippers[k].rate),
            _ => (state.angle, state.angular_velocity),
        };
        let normal = self.normal.unit;
        if carried.turns() {
            return Swing {
                turn: turn + carried.turn_at(speed),
                height: -carried.spoke.dot(normal),
                slip: self.slip(state),
            };
        }
        let of_surface = self.drive.map_or(0.0, |k| state.drives[k].spin - turn);
        Swing {
            turn,
            height: -(Rotation::new(angle - carrier.angle) * *arm).dot(normal),
            slip: self.slip(state) - self.tangent.drive_lever * of_surface,
        }
    }

    /// [m] By how much the gap changes in a time [s] at the present velocities.
    pub(super) fn gained(&self, state: &State, model: &Model, (mount, time): (Mount, f64)) -> f64 {
        let s = &self.start;
        let then = state.carrier(mount, time, model);
        let run = self.drive.map_or(0.0, |k| {
            state.run_over(mount, k, model) + state.speed_over(mount, k, model) * time
        });
        self.normal.unit.dot(s.moved(&then, run))
    }

    /// [m] How much deeper in the ground the place was in the middle of the step than at either end, if nothing
    /// bore there: the tip of a wheel that turns fast may come and go within a step.
    pub(super) fn dip(&self) -> f64 {
        let ends = self.start.gap.min(self.gap).min(0.0);
        if self.normal_impulse > 0.0 {
            0.0
        } else {
            (ends - self.start.middle).max(0.0)
        }
    }
}
