//! Levers of a contact: how the velocities of body, flipper and drive add up along its directions.
//!
//! The equations: docs/physics.md, "Levers".

use super::state::Carrier;
use crate::contact::Contact;
use crate::geometry::{Motion, Rotation, Vector, cross, left_of, right_of};
use crate::robot::Model;
use crate::solver::{Layout, Row};

/// How the touching point moves relative to its carrier per metre of drive travel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carried {
    /// [m] From the axle about which it turns, or from where it began, to the point.
    pub spoke: Vector,
    /// [1/m] Rotation about that axle.
    turn: f64,
    /// Translation in addition to that.
    along: Vector,
}

impl Carried {
    /// Whether its drive moves it at all, other than along the surface.
    pub(super) fn is_moving(&self) -> bool {
        self.turn != 0.0 || self.along != Vector::ZERO
    }

    /// Whether it turns about an axle of its own.
    pub(super) fn turns(&self) -> bool {
        self.turn != 0.0
    }

    /// [rad/s] How fast, over its carrier, if its drive runs at a speed [m/s].
    pub(super) fn turn_at(&self, speed: f64) -> f64 {
        -self.turn * speed
    }

    /// [m/s] How fast, in addition to turning, after the chassis has turned.
    pub(super) fn velocity(&self, turned: Rotation, speed: f64) -> Vector {
        turned * self.along * speed
    }

    /// How far it has turned over its carrier once its drive has run by `run` [m]; `None` if it never does.
    fn turned(&self, run: f64) -> Option<Rotation> {
        (self.turn != 0.0).then(|| Rotation::new(-self.turn * run))
    }
}

/// A direction at a contact of the robot, with the levers by which velocities add up along it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Direction {
    pub unit: Vector,
    /// [m] Lever of the turn of the chassis.
    pub lever: f64,
    /// [m] Lever of the spin of a drive.
    pub spin_lever: f64,
    /// [m] Lever of the rate of a flipper; `lever` is then that of its pivot.
    pub joint_lever: f64,
}

impl Direction {
    /// That of a contact on the robot: `arm` leads from the carrier's centre to the contact; `motion` is the velocity of
    /// the surface over the carrier for a surface speed of 1.
    pub(crate) fn on_robot(unit: Vector, arm: Vector, motion: Vector, model: &Model) -> Self {
        // The surface speed is the drive radius times the spin over the chassis, clockwise.
        let spin_lever = -model.drive_radius * unit.dot(motion);
        Self {
            unit,
            lever: cross(arm, unit) - spin_lever,
            spin_lever,
            ..Self::default()
        }
    }

    /// That of a contact of a flipper whose pivot is at `pivot` from the chassis' centre of mass [m].
    pub(super) fn on_flipper(self, pivot: Vector) -> Self {
        Self {
            lever: cross(pivot, self.unit),
            joint_lever: self.lever,
            ..self
        }
    }

    /// Its row for the solver, with a drive and a flipper on which it acts.
    pub(super) fn row(&self, layout: Layout, drive: Option<usize>, flipper: Option<usize>) -> Row {
        let Vector { x, y } = self.unit;
        let mut row = Row::on_base([x, y, self.lever]);
        if let Some(k) = flipper {
            row = row.and(layout.joint(k), self.joint_lever);
        }
        if let Some(k) = drive {
            row = row.and(layout.spin(k), self.spin_lever);
        }
        row
    }
}

/// The position of a contact on the robot, and its directions.
pub(crate) struct Levers {
    pub normal: Direction,
    pub tangent: Direction,
    /// [m] From the carrier's centre to the contact.
    pub(super) arm: Vector,
    pub(super) carried: Carried,
}

impl Levers {
    /// The levers of a contact of a part that its drive moves in this way relative to its carrier.
    pub(crate) fn new(
        contact: &Contact,
        carrier: &Carrier,
        over_carrier: Motion,
        model: &Model,
    ) -> Self {
        let part = &model.parts[contact.part];
        let arm = contact.point - carrier.center;
        let mut carried = Carried::default();
        let motion = if part.is_carried() {
            let (motion, rotation) = (over_carrier, Rotation::new(carrier.angle));
            (carried.turn, carried.along) = (motion.turn, rotation * motion.along);
            if motion.turn != 0.0 {
                carried.spoke = arm - rotation * (motion.center - carrier.origin);
            }
            right_of(carried.spoke) * motion.turn + carried.along
        } else if part.drive.is_some() {
            left_of(contact.normal) // the surface moves tangentially
        } else {
            Vector::ZERO
        };
        Self {
            normal: Direction::on_robot(contact.normal, arm, motion, model),
            tangent: Direction::on_robot(right_of(contact.normal), arm, motion, model),
            arm,
            carried,
        }
    }
}

/// The touching point of the robot in the middle of the step, where the contact was found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// [m] Gap.
    pub gap: f64,
    /// Its carrier.
    pub carrier: Carrier,
    /// [m] From the carrier's centre to the contact, or to the axle about which it turns.
    pub arm: Vector,
    /// The way from there to the contact.
    pub carried: Carried,
    /// [m] Position of the drive.
    pub drive_position: f64,
}

/// The same at another time.
#[derive(Clone, Copy)]
pub(super) struct Moved {
    /// [m] From the carrier's centre to the end of the arm.
    pub arm: Vector,
    /// [m] From there to the touching point.
    pub spoke: Vector,
    /// [m] Travel of that.
    pub way: Vector,
    /// How far its carrier has turned, and the part itself.
    pub of_carrier: Rotation,
    pub of_part: Rotation,
}

impl Place {
    /// Where it is once its carrier is there and its drive has run to `run` [m].
    pub(super) fn moved(&self, now: &Carrier, run: f64) -> Moved {
        let of_carrier = Rotation::new(now.angle - self.carrier.angle);
        let run = run - self.drive_position;
        let (arm, spoke) = (of_carrier * self.arm, of_carrier * self.carried.spoke);
        let (spoke, of_part) = match self.carried.turned(run) {
            Some(own) => (own * spoke, own * of_carrier),
            None => (spoke, of_carrier),
        };
        let spoke = spoke + of_carrier * self.carried.along * run;
        Moved {
            arm,
            spoke,
            way: now.center - self.carrier.center + arm + spoke - self.arm - self.carried.spoke,
            of_carrier,
            of_part,
        }
    }
}
