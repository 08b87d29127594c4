//! The direction in which a constraint acts, and how velocities add up along it.
//!
//! The equations: docs/physics.md, "Levers".

use super::levers::Direction;
use crate::geometry::Vector;

/// The direction in which a constraint acts, with the motors in their state in the current solve.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Action {
    pub unit: Vector,
    /// [m] Lever of the angular velocity of the chassis and of all drives that turn with it.
    pub lever: f64,
    /// [m] Lever of the spin of a drive that does not turn with the chassis.
    pub spin_lever: f64,
    /// [m/s] Constant part of the speed: from a surface or a flipper held by its motor, and from how the robot turns.
    pub offset: f64,
    /// [m] Lever of the reaction on the chassis, if the chassis takes it.
    pub back: f64,
    /// [m] Lever of the rate of a flipper that turns freely.
    pub flipper_lever: f64,
}

impl Action {
    pub(super) fn new(along: &Direction, held: bool, spin_of_set_point: f64) -> Self {
        if held {
            Self {
                unit: along.unit,
                lever: along.lever + along.drive_lever,
                spin_lever: 0.0,
                offset: -along.drive_lever * spin_of_set_point,
                back: along.back,
                flipper_lever: along.flipper_lever,
            }
        } else {
            Self {
                unit: along.unit,
                lever: along.lever,
                spin_lever: along.drive_lever,
                offset: 0.0,
                back: along.back,
                flipper_lever: along.flipper_lever,
            }
        }
    }

    /// The same along which everything is faster by a speed [m/s].
    pub(super) fn faster(self, speed: f64) -> Self {
        Self {
            offset: self.offset + speed,
            ..self
        }
    }

    /// The action on a flipper; if its motor holds a rate [rad/s] relative to the chassis, it turns with that.
    pub(super) fn of_flipper(self, held: Option<f64>) -> Self {
        match held {
            Some(rate) => Self {
                lever: self.lever + self.flipper_lever,
                offset: self.offset + self.flipper_lever * rate,
                flipper_lever: 0.0,
                ..self
            },
            None => self,
        }
    }

    pub(super) fn of_shoe(along: &Direction, beside: f64) -> Self {
        Self {
            unit: along.unit,
            lever: along.lever,
            spin_lever: beside,
            back: along.back,
            ..Self::default()
        }
    }

    /// Its entries for x, y and angle.
    pub(super) fn body(&self) -> [f64; 3] {
        [self.unit.x, self.unit.y, self.lever]
    }

    /// Entries of the reaction for x, y and angle of the chassis, and for the idler or sprocket.
    pub(super) fn reaction(&self) -> [f64; 4] {
        [-self.unit.x, -self.unit.y, -self.back, self.spin_lever]
    }

    /// The sum of this and a share of another action.
    pub(super) fn plus(&self, other: &Self, share: f64) -> Self {
        Self {
            unit: self.unit + other.unit * share,
            lever: self.lever + other.lever * share,
            spin_lever: self.spin_lever + other.spin_lever * share,
            offset: self.offset + other.offset * share,
            back: self.back + other.back * share,
            flipper_lever: self.flipper_lever + other.flipper_lever * share,
        }
    }

    /// [m/s] Speed along the action.
    pub(super) fn speed(&self, velocity: Vector, angular_velocity: f64, spin: f64) -> f64 {
        self.change(velocity, angular_velocity, spin) + self.offset
    }

    /// [m/s] Change of that speed with a change of the velocities.
    pub(super) fn change(&self, velocity: Vector, angular_velocity: f64, spin: f64) -> f64 {
        self.unit.dot(velocity) + self.lever * angular_velocity + self.spin_lever * spin
    }
}
