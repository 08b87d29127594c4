//! The velocity of a body.

use serde::{Deserialize, Serialize};

use super::{Vector, left_of};

/// Velocity of a body: [m/s] of its centre of mass, [rad/s] of its rotation.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Twist {
    pub velocity: Vector,
    pub turn: f64,
}

impl Twist {
    /// The components: x, y and rotation.
    pub(crate) fn entries(self) -> [f64; 3] {
        [self.velocity.x, self.velocity.y, self.turn]
    }

    /// [m/s] Velocity of a point at `arm` from the centre [m].
    pub(crate) fn at(self, arm: Vector) -> Vector {
        self.velocity + self.turn * left_of(arm)
    }

    /// The difference from another velocity.
    pub(crate) fn less(self, other: Self) -> Self {
        Self {
            velocity: self.velocity - other.velocity,
            turn: self.turn - other.turn,
        }
    }

    /// The sum with a fraction of a change.
    pub(crate) fn plus(self, change: Self, share: f64) -> Self {
        Self {
            velocity: self.velocity + change.velocity * share,
            turn: self.turn + change.turn * share,
        }
    }
}

impl From<[f64; 3]> for Twist {
    fn from([x, y, turn]: [f64; 3]) -> Self {
        Self {
            velocity: Vector::new(x, y),
            turn,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // sums of exact numbers

    use super::*;

    /// In numbers without rounding.
    #[test]
    fn velocities_add_up_and_points_move_with_them() {
        let (a, b) = (Twist::from([1.0, 2.0, 4.0]), Twist::from([0.5, -1.5, 3.0]));
        assert_eq!(a.plus(b, 0.5).entries(), [1.25, 1.25, 5.5]);
        assert_eq!(a.less(b).entries(), [0.5, 3.5, 1.0]);
        // Counter-clockwise, a point ahead rises and a point above goes back.
        assert_eq!(a.at(Vector::new(0.25, 0.0)), Vector::new(1.0, 3.0));
        assert_eq!(a.at(Vector::new(0.0, 0.5)), Vector::new(-1.0, 2.0));
    }
}
