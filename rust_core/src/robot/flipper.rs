//! Flippers of a robot: arms that pivot on its end axles.

use crate::geometry::{Pose, Rotation, Vector, end_discs};
use crate::scenario::{End, Robot};

/// The arms at one end of a robot, both sides together.
#[derive(Clone, Debug)]
pub struct Flipper {
    /// [m] The pivot in the chassis frame.
    pub pivot: Vector,
    /// [m] From the pivot to its centre of mass, which is midway between its axles and the origin of its frame.
    pub arm: Vector,
    /// [kg] Mass.
    pub mass: f64,
    /// [kg m^2] Moment of inertia about its centre of mass.
    pub moment_of_inertia: f64,
    /// [m] Distance from the pivot to its farthest point.
    pub reach: f64,
    /// [m] Radius at the pivot.
    pub root_radius: f64,
    /// [rad/s] Largest commanded turning rate relative to the chassis.
    pub rate_limit: f64,
    /// [N m] Largest torque of its motor.
    pub torque_limit: f64,
    /// [kg m^2] Moment of inertia of its motors' rotors, as far as they turn over the chassis.
    pub rotor_inertia: f64,
    /// Its gear locks itself.
    pub self_locking: bool,
    /// [rad] Angle at time 0, upwards > 0.
    pub start_angle: f64,
    /// The end of the robot that it is on.
    pub end: End,
}

/// Position of a flipper on the chassis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mounted {
    /// Its frame in the chassis frame.
    pub pose: Pose,
    /// [m] How far its belt has run because the arm turned about its sprocket.
    pub run: f64,
}

impl Flipper {
    /// The arms of a robot, front first.
    pub(crate) fn of(robot: &Robot) -> Vec<Self> {
        let Some(flippers) = &robot.flippers else {
            return Vec::new();
        };
        let [rear, front] = end_discs(&robot.outline);
        let arm = |end: End| {
            let (sign, mass) = (end.sign(), 2.0 * flippers.mass);
            Self {
                pivot: match end {
                    End::Rear => rear.center,
                    End::Front => front.center,
                },
                arm: Vector::new(0.5 * sign * flippers.length, 0.0),
                mass,
                moment_of_inertia: mass * flippers.length * flippers.length / 12.0,
                reach: flippers
                    .root_radius
                    .max(flippers.length + flippers.tip_radius),
                root_radius: flippers.root_radius,
                rate_limit: flippers.rate_limit,
                torque_limit: 2.0 * flippers.torque_limit,
                rotor_inertia: 2.0 * flippers.rotor_inertia,
                self_locking: flippers.self_locking,
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

    /// [kg] Mass that moves at the speed of its track if that has its own drive: a tenth of its mass, our assumption.
    pub(crate) fn mass_of_track(&self) -> f64 {
        0.1 * self.mass
    }

    /// [m] From the chassis' centre of mass, given in its frame, to the pivot, and from the pivot to its own centre of
    /// mass, with chassis and arm at these angles over ground [rad].
    pub(crate) fn spokes(&self, center_of_mass: Vector, [chassis, arm]: [f64; 2]) -> [Vector; 2] {
        [
            Rotation::new(chassis) * (self.pivot - center_of_mass),
            Rotation::new(arm) * self.arm,
        ]
    }

    /// Its position when turned by `angle` [rad] relative to the chassis, counter-clockwise.
    pub(crate) fn mounted(&self, angle: f64, drive_radius: f64) -> Mounted {
        Mounted {
            pose: Pose::new(self.pivot, angle) * Pose::from_translation(self.arm),
            run: Self::run(angle, drive_radius),
        }
    }

    /// [m] How far a belt has run along it because it has turned by `angle` [rad] over the chassis.
    pub(crate) fn run(angle: f64, drive_radius: f64) -> f64 {
        // The sprocket turns with the chassis; relative to the arm it turns back.
        drive_radius * angle
    }
}
