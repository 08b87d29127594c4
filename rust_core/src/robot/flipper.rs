//! Flippers of a robot: arms that pivot on its end axles, and what they leave of it to the chassis.

use crate::geometry::{Pose, Rotation, Vector};
use crate::scenario::{End, Robot};

/// The arms at one end of a robot, those of both sides together.
#[derive(Clone, Debug)]
pub struct Flipper {
    /// [m] The pivot in the chassis frame.
    pub pivot: Vector,
    /// [m] From the pivot to its centre of mass, midway between its axles: the origin of its own frame.
    pub arm: Vector,
    /// [kg] Mass.
    pub mass: f64,
    /// [kg m^2] Moment of inertia about its centre of mass.
    pub moment_of_inertia: f64,
    /// [m] From the pivot to the farthest point.
    pub reach: f64,
    /// [m] Radius about the pivot.
    pub root_radius: f64,
    /// [rad/s] Fastest turn over the chassis that it is commanded to make.
    pub rate_limit: f64,
    /// [N m] Largest torque of its motor.
    pub torque_limit: f64,
    /// [rad] At time 0, upwards > 0.
    pub start_angle: f64,
    /// Where it is.
    pub end: End,
}

/// Where a flipper is on the chassis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mounted {
    /// Its frame in that of the chassis.
    pub pose: Pose,
    /// [m] How far a belt has run along it because it has turned about its sprocket.
    pub run: f64,
}

impl Flipper {
    /// The arms of a robot, the front first.
    pub(crate) fn of(robot: &Robot) -> Vec<Self> {
        let Some(flippers) = &robot.flippers else {
            return Vec::new();
        };
        let arm = |end: End| {
            let (sign, mass) = (end.sign(), 2.0 * flippers.mass);
            Self {
                pivot: Vector::new(0.5 * sign * robot.outline.axle_distance, 0.0),
                arm: Vector::new(0.5 * sign * flippers.length, 0.0),
                mass,
                moment_of_inertia: mass * flippers.length * flippers.length / 12.0,
                reach: flippers
                    .root_radius
                    .max(flippers.length + flippers.tip_radius),
                root_radius: flippers.root_radius,
                rate_limit: flippers.rate_limit,
                torque_limit: 2.0 * flippers.torque_limit,
                start_angle: flippers.angle,
                end,
            }
        };
        flippers.ends().map(arm).collect()
    }

    /// 1 at the front, -1 at the rear, where upwards is clockwise.
    pub fn sign(&self) -> f64 {
        self.end.sign()
    }

    /// [kg] What moves at the speed of its track where that has a drive of its own: a tenth, our assumption.
    pub(crate) fn mass_of_track(&self) -> f64 {
        0.1 * self.mass
    }

    /// [m] From the chassis' centre of mass, which is there in its frame, to the pivot, and from there to its
    /// own, when these are turned so far over ground [rad].
    pub(crate) fn spokes(&self, center_of_mass: Vector, [chassis, arm]: [f64; 2]) -> [Vector; 2] {
        [
            Rotation::new(chassis) * (self.pivot - center_of_mass),
            Rotation::new(arm) * self.arm,
        ]
    }

    /// Where it is when turned by `angle` [rad] over the chassis, counter-clockwise.
    pub(crate) fn mounted(&self, angle: f64, drive_radius: f64) -> Mounted {
        Mounted {
            pose: Pose::new(self.pivot, angle) * Pose::from_translation(self.arm),
            run: Self::run(angle, drive_radius),
        }
    }

    /// [m] How far a belt has run along it because it has turned by `angle` [rad] over the chassis.
    pub(crate) fn run(angle: f64, drive_radius: f64) -> f64 {
        // The sprocket turns with the chassis: over the arm it turns back.
        drive_radius * angle
    }
}
