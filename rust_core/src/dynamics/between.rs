//! The motion within a step, for states between its ends.
//!
//! Forces are constant over a step, so velocities change linearly and positions quadratically. The quadratic misses the
//! end of the step by its local error at most, and that is spread evenly.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::state::{Shoe, State};
use crate::geometry::{Twist, Vector};
use crate::robot::Model;

/// A time within a step.
#[derive(Clone, Copy)]
struct Within {
    /// [s] Length of the step.
    h: f64,
    /// Share of it that has passed.
    share: f64,
}

impl Within {
    fn linear(self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.share
    }

    /// A position, from those at the ends and the speeds there.
    fn quadratic(self, [from, to]: [f64; 2], [speed, to_speed]: [f64; 2]) -> f64 {
        let straight = from + (to - from) * self.share;
        straight - 0.5 * (to_speed - speed) * self.h * self.share * (1.0 - self.share)
    }

    fn point(self, places: [Vector; 2], velocities: [Vector; 2]) -> Vector {
        let of = |axis: fn(Vector) -> f64| self.quadratic(places.map(axis), velocities.map(axis));
        Vector::new(of(|v| v.x), of(|v| v.y))
    }

    fn twist(self, [from, to]: [Twist; 2]) -> Twist {
        from.plus(to.less(from), self.share)
    }
}

impl State {
    /// Sets this state to that after a share of a step of `h` [s] between two states.
    pub(crate) fn set_between(&mut self, ends: [&Self; 2], model: &Model, (h, share): (f64, f64)) {
        let at = Within { h, share };
        let [before, after] = ends;
        self.copy(after);
        let twist = at.twist(ends.map(Self::twist));
        self.center = at.point(ends.map(|s| s.center), ends.map(|s| s.velocity));
        self.angle = at.quadratic(ends.map(|s| s.angle), ends.map(|s| s.angular_velocity));
        (self.velocity, self.angular_velocity) = (twist.velocity, twist.turn);
        for (k, drive) in self.drives.iter_mut().enumerate() {
            drive.position = at.quadratic(
                ends.map(|s| s.drives[k].position),
                ends.map(|s| s.track_speed(model, k)),
            );
            drive.spin = at.linear(ends.map(|s| s.drives[k].spin));
        }
        for (k, turn) in self.flippers.iter_mut().enumerate() {
            turn.angle = at.quadratic(
                ends.map(|s| s.flippers[k].angle),
                ends.map(|s| s.flippers[k].rate),
            );
            turn.rate = at.linear(ends.map(|s| s.flippers[k].rate));
        }
        for (k, shoe) in self.shoes.iter_mut().enumerate() {
            let ends = [before.shoes[k], after.shoes[k]];
            let twists = ends.map(|s| s.twist);
            *shoe = Shoe {
                center: at.point(ends.map(|s| s.center), twists.map(|t| t.velocity)),
                angle: at.quadratic(ends.map(|s| s.angle), twists.map(|t| t.turn)),
                twist: at.twist(twists),
            };
        }
        for (k, idler) in self.idlers.iter_mut().enumerate() {
            let ends = [before.idlers[k], after.idlers[k]];
            idler.travel = at.quadratic(ends.map(|i| i.travel), ends.map(|i| i.rate));
            idler.rate = at.linear(ends.map(|i| i.rate));
        }
    }
}
