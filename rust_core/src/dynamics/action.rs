//! A direction in which a constraint acts, and how velocities count along it.
//!
//! The equations: docs/physics.md, "Levers".

use super::levers::Direction;
use crate::geometry::Vector;

/// A direction in which a constraint acts, with the motors as they are in this solve.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Action {
    pub unit: Vector,
    /// [m] Lever of the angular velocity of the chassis and of all drives that turn with it.
    pub lever: f64,
    /// [m] Lever of the spin of a drive with a spin of its own.
    pub spin_lever: f64,
    /// [m/s] What a surface that is held at the set-point adds, and what a frame that moves over the ground does.
    pub offset: f64,
    /// [m] Lever of the reaction on the chassis, if that takes it.
    pub back: f64,
    /// [m] Lever of the turn of a flipper that turns by itself.
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

    /// The same where the flipper that it acts on turns over the chassis at a rate [rad/s], if it does.
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

    /// The same of a place on the ground, measured in a frame that moves over it [m/s].
    pub(super) fn on_ground(self, frame: Vector) -> Self {
        Self {
            offset: self.offset + self.unit.dot(frame),
            ..self
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

    /// What it does to x, y and angle.
    pub(super) fn body(&self) -> [f64; 3] {
        [self.unit.x, self.unit.y, self.lever]
    }

    /// What it does to x, y and angle of the chassis that takes the reaction, and to idler or sprocket.
    pub(super) fn reaction(&self) -> [f64; 4] {
        [-self.unit.x, -self.unit.y, -self.back, self.spin_lever]
    }

    /// Together with a share of another.
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

    /// [m/s] Speed along it.
    pub(super) fn speed(&self, velocity: Vector, angular_velocity: f64, spin: f64) -> f64 {
        self.change(velocity, angular_velocity, spin) + self.offset
    }

    /// [m/s] What a change of the velocities changes of its speed.
    pub(super) fn change(&self, velocity: Vector, angular_velocity: f64, spin: f64) -> f64 {
        self.unit.dot(velocity) + self.lever * angular_velocity + self.spin_lever * spin
    }
}
