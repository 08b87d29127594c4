//! A motor: it holds a speed, up to the limit of its impulse.
//!
//! What it turns moves with the base while it holds: that is then no unknown, but adds to the inertia of the base,
//! wherever it is. What a motor at its limit turns, or none, has a rate of its own to solve for.
//!
//! The equations: docs/physics.md, "Motors".

use serde::{Deserialize, Serialize};

/// The state of a motor in a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Hold {
    /// Holds the speed.
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
pub(super) const PAST: f64 = 1e-9;

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
    /// [m/s] The speed that it holds, ...
    pub target: f64,
    /// [N s] ... and its largest impulse.
    pub most: f64,
    pub hold: Hold,
}

impl Hold {
    /// Share of the limit with which it pushes; none if it holds.
    pub(super) fn share(self) -> Option<f64> {
        match self {
            Self::Holds => None,
            Self::Pushes => Some(1.0),
            Self::Brakes => Some(-1.0),
            Self::Free => Some(0.0),
        }
    }

    /// That of a motor that holds with this impulse, or is at its limit if the impulse exceeds that.
    fn within(impulse: f64, limit: f64) -> Self {
        if impulse > limit {
            Self::Pushes
        } else if impulse < -limit {
            Self::Brakes
        } else {
            Self::Holds
        }
    }
}

impl Motor {
    /// One at rest; without an impulse to give there is none.
    pub(crate) fn new(on: Driven, lever: f64, is_there: bool) -> Self {
        Self {
            on,
            lever,
            target: 0.0,
            most: 0.0,
            hold: if is_there { Hold::Holds } else { Hold::Free },
        }
    }

    /// [rad/s] How much faster than the base it turns what it holds, if it does.
    pub(super) fn held_rate(&self) -> Option<f64> {
        self.given().is_none().then(|| self.target / self.lever)
    }

    /// [N s] Its impulse, if that is its limit.
    pub(super) fn given(&self) -> Option<f64> {
        self.hold.share().map(|share| share * self.most)
    }

    /// Its state after a solve in which it gave this impulse [N s], and was so much too fast [m/s].
    pub(super) fn next(&self, impulse: f64, ahead: f64) -> Hold {
        match self.hold {
            Hold::Free => Hold::Free,
            Hold::Holds => Hold::within(impulse, self.most * (1.0 + AT_LIMIT)),
            at_limit => {
                let past = ahead * at_limit.share().unwrap_or_default();
                if past > PAST { Hold::Holds } else { at_limit }
            }
        }
    }
}
