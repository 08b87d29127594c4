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
            hold: if is_there { Hold::Holds } else { Hold::Free },
        }
    }

    /// Holds the target with at most this impulse either way [N s].
    pub(crate) fn aim(&mut self, target: f64, most: f64) {
        self.target = target;
        self.limits = [most, -most].map(Damper::constant);
    }

    /// [rad/s] How much faster than the base it turns what it holds, if it does.
    pub(super) fn held_rate(&self) -> Option<f64> {
        self.given().is_none().then(|| self.target / self.lever)
    }

    /// Its impulse at a speed; none if that is what holds the speed.
    pub(super) fn given(&self) -> Option<Damper> {
        match self.hold {
            Hold::Holds => self.correction,
            Hold::Pushes => Some(self.limits[0]),
            Hold::Brakes => Some(self.limits[1]),
            Hold::Free => Some(Damper::default()),
        }
    }

    /// Whether its impulse depends on its speed.
    pub(super) fn has_slope(&self) -> bool {
        self.given().is_some_and(|given| given.stiffness != 0.0)
    }

    /// Its state after a solve in which it gave this impulse [N s], and was so much too fast [m/s].
    pub(super) fn next(&self, impulse: f64, ahead: f64) -> Hold {
        let mut next = self.hold;
        self.conditions(ahead + self.target, [impulse, ahead], |hold, value| {
            // A smaller excess is rounding.
            let slack = match (self.hold, self.correction) {
                (Hold::Holds, _) | (_, Some(_)) => AT_LIMIT * impulse.abs(),
                _ => PAST.value(),
            };
            if value < -slack {
                next = hold;
            }
        });
        next
    }
}
