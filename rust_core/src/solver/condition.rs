//! A condition of the state of a contact or a motor, and what follows where it is not met any more.
//!
//! A state holds as long as all its conditions are above 0. Beyond one of them another state follows.
//!
//! The equations: docs/physics.md, "Lowering".

use super::grip::Grip;
use super::motor::{Hold, Motor};

/// What the state of a contact or a motor becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Switch {
    Contact(usize, Grip),
    Motor(usize, Hold),
}

/// A condition of the present states: they hold as long as its value is above 0, and the switch is made where it
/// reaches 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    pub switch: Switch,
    /// Its value now, and where the present states are a solution on the ground.
    pub now: f64,
    pub there: f64,
}

impl Switch {
    /// Whether both are switches of one contact or motor.
    pub(super) fn is_of_the_same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Contact(i, _), Self::Contact(k, _)) | (Self::Motor(i, _), Self::Motor(k, _)) => {
                i == k
            }
            _ => false,
        }
    }
}

impl Motor {
    /// Calls `found` with the conditions of its state at a speed [m/s]: the state that follows, and the value, from its
    /// impulse [N s] and, at a limit of that, from how much faster it is than its target, and than at rest.
    pub(super) fn conditions(
        &self,
        speed: f64,
        impulse: f64,
        [ahead, on]: [f64; 2],
        mut found: impl FnMut(Hold, f64),
    ) {
        let [most, least] = self.limits.map(|limit| limit.at(speed));
        let wanted = self.correction.map(|correction| correction.at(speed));
        match self.hold {
            Hold::Holds => {
                let impulse = wanted.unwrap_or(impulse);
                if !self.locks || self.target > 0.0 {
                    found(Hold::Pushes, most - impulse);
                }
                if !self.locks || self.target < 0.0 {
                    found(Hold::Brakes, impulse - least);
                }
            }
            Hold::Pushes => {
                found(Hold::Holds, wanted.map_or(-ahead, |wanted| wanted - most));
                if self.locks {
                    found(Hold::Locked, on);
                }
            }
            Hold::Brakes => {
                found(Hold::Holds, wanted.map_or(ahead, |wanted| least - wanted));
                if self.locks {
                    found(Hold::Locked, -on);
                }
            }
            Hold::Locked if self.target > 0.0 => found(Hold::Pushes, impulse - most),
            Hold::Locked if self.target < 0.0 => found(Hold::Brakes, least - impulse),
            Hold::Locked | Hold::Free => {}
        }
    }
}
