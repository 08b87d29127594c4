//! Levers of a contact, with which the velocities of chassis, flipper and drive add up along its directions.
//!
//! The equations: docs/physics.md, "Levers".

use super::state::Carrier;
use crate::contact::Contact;
use crate::geometry::{Motion, Rotation, Vector, cross, left_of, right_of};
use crate::robot::Model;
use crate::solver::{Layout, Row};

/// How the contact point of the robot moves relative to its carrier per metre of drive travel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carried {
    /// [m] From the axle about which it turns to the point; 0 if it does not turn.
    pub spoke: Vector,
    /// [1/m] Rotation about that axle, clockwise.
    turn: f64,
    /// Translation in addition to the rotation.
    along: Vector,
}

impl Carried {
    /// Whether its drive moves it in another way than along the surface.
    pub(super) fn is_moving(&self) -> bool {
        self.turn != 0.0 || self.along != Vector::ZERO
    }

    /// Whether it turns about an axle of its own.
    pub(super) fn turns(&self) -> bool {
        self.turn != 0.0
    }

    /// [rad/s] Its rate relative to its carrier if its drive runs at a speed [m/s].
    pub(super) fn turn_at(&self, speed: f64) -> f64 {
        -self.turn * speed
    }

    /// [m/s] Its velocity in addition to the rotation if its drive runs at a speed [m/s] and its carrier has turned.
    pub(super) fn velocity(&self, turned: Rotation, speed: f64) -> Vector {
        turned * self.along * speed
    }

    /// Its rotation relative to its carrier after `run` [m] of drive travel; `None` if it does not turn.
    fn turned(&self, run: f64) -> Option<Rotation> {
        (self.turn != 0.0).then(|| Rotation::new(-self.turn * run))
    }
}

/// A direction at a contact of the robot, with the levers by which velocities add up along it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Direction {
    pub unit: Vector,
    /// [m] Lever of the rate of the chassis.
    pub lever: f64,
    /// [m] Lever of the spin of a drive.
    pub spin_lever: f64,
    /// [m] Lever of the rate of a flipper; `lever` is then that of the flipper's pivot.
    pub joint_lever: f64,
}

impl Direction {
    /// A direction at a contact of the robot: `arm` leads from the carrier's centre to the contact; `motion` is the velocity
    /// of the surface relative to the carrier at a surface speed of 1.
    pub(crate) fn on_robot(unit: Vector, arm: Vector, motion: Vector, model: &Model) -> Self {
        // The surface speed is the drive radius times the spin relative to the chassis, clockwise.
        let spin_lever = -model.drive_radius * unit.dot(motion);
        Self {
            unit,
            lever: cross(arm, unit) - spin_lever,
            spin_lever,
            ..Self::default()
        }
    }

    /// The same at a contact of a flipper, with `pivot` from the chassis' centre of mass to its pivot [m].
    pub(super) fn on_flipper(self, pivot: Vector) -> Self {
        Self {
            lever: cross(pivot, self.unit),
            joint_lever: self.lever,
            ..self
        }
    }

    /// Its row for the solver, if it acts on a drive and a flipper.
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
    /// The levers of a contact of a part that its drive moves relative to its carrier by `over_carrier`.
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

/// The contact point of the robot in the middle of the step, where the contact was found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// [m] Gap.
    pub gap: f64,
    /// Its carrier.
    pub carrier: Carrier,
    /// [m] From the carrier's centre to the contact, or to the axle about which it turns.
    pub arm: Vector,
    /// How its drive moves it from there.
    pub carried: Carried,
    /// [m] Position of the drive.
    pub drive_position: f64,
}

/// The same point at another time.
#[derive(Clone, Copy)]
pub(super) struct Moved {
    /// [m] From the carrier's centre to the end of the arm.
    pub arm: Vector,
    /// [m] From there to the contact point.
    pub spoke: Vector,
    /// [m] Displacement of the contact point since the middle of the step.
    pub way: Vector,
    /// Rotation since then, of the carrier and of the part.
    pub of_carrier: Rotation,
    pub of_part: Rotation,
}

impl Place {
    /// Where it is when its carrier is at `now` and its drive at `run` [m].
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
