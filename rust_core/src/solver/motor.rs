//! A motor: it holds a speed, or corrects it, up to the limits of its impulse.
//!
//! What it turns moves with the base while it holds: that is then no unknown, but adds to the inertia of the base,
//! wherever it is. What a motor turns that corrects its speed, is at a limit, or is none, has a rate of its own to solve
//! for.
//!
//! The equations: docs/physics.md, "Motors".

use serde::{Deserialize, Serialize};

use super::damper::Damper;
use crate::units::MetresPerSecond;

/// The state of a motor in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Hold {
    /// Holds the speed, or corrects it.
    Holds,
    /// At its limit, forwards.
    Pushes,
    /// At its limit, backwards.
    Brakes,
    /// Its gear, which locks itself, holds it at rest against a load that it cannot move.
    Locked,
    /// There is no motor.
    Free,
}

/// Relative tolerance of the limit; a smaller excess is rounding.
pub(super) const AT_LIMIT: f64 = 1e-12;
/// [m/s] A motor at its limit holds again once it is past its speed by this.
pub(super) const PAST: MetresPerSecond = MetresPerSecond(1e-9);

/// What a motor moves over the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Driven {
    Spin(usize),
    Joint(usize),
    Ring(usize),
}

/// A motor. Its speed is a lever times the rate of what it turns, less that of the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motor {
    pub on: Driven,
    /// [m] The lever, below 0 if it runs forwards while what it turns spins clockwise.
    pub lever: f64,
    /// [m/s] The speed that it holds.
    pub target: f64,
    /// Its largest impulses at a speed, forwards and backwards.
    pub limits: [Damper; 2],
    /// Its impulse at a speed between these, if it corrects its speed; if not, it holds that.
    pub correction: Option<Damper>,
    /// Its gear locks itself: no load turns it back, or on faster than its target, which is then without limit what holds
    /// that.
    pub locks: bool,
    pub hold: Hold,
}

impl Motor {
    /// One at rest; without an impulse to give there is none.
    pub(crate) fn new(on: Driven, lever: f64, is_there: bool) -> Self {
        Self {
            on,
            lever,
            target: 0.0,
            limits: [Damper::default(); 2],
            correction: None,
            locks: false,
            hold: if is_there { Hold::Holds } else { Hold::Free },
        }
    }

    /// The same behind a gear that locks itself: that holds it at rest whether the motor has an impulse to give or not.
    pub(crate) fn behind_lock(self) -> Self {
        Self {
            locks: true,
            hold: Hold::Holds,
            ..self
        }
    }

    /// Holds the target with at most this impulse either way [N s].
    pub(crate) fn aim(&mut self, target: f64, most: f64) {
        self.limits = [most, -most].map(Damper::constant);
        self.turn_to(target);
    }

    /// Holds another target.
    pub(crate) fn turn_to(&mut self, target: f64) {
        self.target = target;
        // Behind a lock a motor gives its limit only the way that it turns.
        let turns = match self.hold {
            Hold::Pushes => target > 0.0,
            Hold::Brakes => target < 0.0,
            _ => true,
        };
        if self.locks && !turns {
            self.hold = Hold::Holds;
        }
    }

    /// [m/s] The speed that it holds, if it does.
    pub(super) fn held_speed(&self) -> f64 {
        if self.hold == Hold::Locked {
            0.0
        } else {
            self.target
        }
    }

    /// [rad/s] How much faster than the base it turns what it holds, if it does.
    pub(super) fn held_rate(&self) -> Option<f64> {
        (self.given().is_none()).then(|| self.held_speed() / self.lever)
    }

    /// Its impulse at a speed; none if that is what holds the speed.
    pub(super) fn given(&self) -> Option<Damper> {
        match self.hold {
            Hold::Holds => self.correction,
            Hold::Pushes => Some(self.limits[0]),
            Hold::Brakes => Some(self.limits[1]),
            Hold::Locked => None,
            Hold::Free => Some(Damper::default()),
        }
    }

    /// [N s] The part of its impulse that the motor itself can have given, without what its gear has held.
    pub(crate) fn without_lock(&self, impulse: f64) -> f64 {
        if !self.locks || self.given().is_some() {
            return impulse;
        }
        let [most, least] = self.limits.map(|limit| limit.at(self.held_speed()));
        impulse.clamp(least, most)
    }

    /// Whether its impulse depends on its speed.
    pub(super) fn has_slope(&self) -> bool {
        self.given().is_some_and(|given| given.stiffness != 0.0)
    }

    /// Its state after a solve in which it gave this impulse [N s], and was so much faster [m/s] than what it holds.
    pub(super) fn next(&self, impulse: f64, ahead: f64) -> Hold {
        let mut next = self.hold;
        let speed = ahead + self.held_speed();
        self.conditions(speed, impulse, [ahead, speed], |hold, value| {
            // A smaller excess is rounding.
            let slack = match (self.hold, self.correction) {
                (Hold::Holds | Hold::Locked, _) | (_, Some(_)) => AT_LIMIT * impulse.abs(),
                _ => PAST.value(),
            };
            if value < -slack {
                next = hold;
            }
        });
        next
    }
}
