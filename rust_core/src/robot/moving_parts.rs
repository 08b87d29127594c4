//! Parts that move on the chassis besides wheels: chains of shoes, and flippers, which are arms that pivot on the end
//! axles.

use std::ops::Range;

use crate::geometry::{Disc, Envelope, Pose, Rotation, ShoeLoop, Teeth, Vector, end_discs};
use crate::scenario::{End, LineOfWheels, Robot, Track};

/// A closed chain of shoes round a guide, or round sprocket and idler.
#[derive(Clone, Debug)]
pub struct ChainOfShoes {
    /// Its number.
    pub number: usize,
    /// Numbers of its shoes.
    pub shoes: Range<usize>,
    /// The path of its pins, and their pitch.
    pub path: ShoeLoop,
    /// The ends of the guide on which the plates slide, or sprocket drum and idler; rear first.
    pub ends: [Disc; 2],
    /// The other discs of the guide, or road wheels and return rollers.
    pub between: Vec<Disc>,
    /// Its sprocket; `None` if the drive pulls on the shoes at the rear end of a guide.
    pub sprocket: Option<Sprocket>,
    /// [m] Thickness of the plates; the pins lie in their middle.
    pub plate_thickness: f64,
    /// [kg] Mass of a shoe.
    pub shoe_mass: f64,
    /// [kg m^2] Its moment of inertia about the middle of its pins.
    pub shoe_inertia: f64,
    /// The tensioner, which pushes the front end out.
    pub tensioner: Tensioner,
    /// The bushing between the shoes at each pin, except the pin that closes the chain.
    pub bushing: Bushing,
    /// The guide, or the hull of sprocket and idler.
    pub(crate) hull: Envelope,
}

/// The wheel that drives a chain with its teeth.
#[derive(Clone, Debug)]
pub struct Sprocket {
    /// Its teeth; they turn about the centre of the rear end.
    pub teeth: Teeth,
    /// [rad] Angle of one of its seats relative to the chassis at the start.
    pub first_seat: f64,
    /// [kg m^2] Moment of inertia about its axle.
    pub inertia: f64,
}

impl Sprocket {
    /// [rad] Angle relative to the chassis when it has moved the chain by a distance [m]; forwards is clockwise.
    pub fn angle(&self, run: f64) -> f64 {
        self.first_seat - run / self.teeth.drive_radius()
    }
}

/// A massless spring and damper that push the front end of a guide along the chassis.
#[derive(Clone, Copy, Debug)]
pub struct Tensioner {
    /// [N] Force in the middle of its travel.
    pub pre_tension: f64,
    /// [N/m] Stiffness.
    pub stiffness: f64,
    /// [N s/m] Damping.
    pub damping: f64,
    /// [m] Travel up to its stop.
    pub stop: f64,
}

/// A bushing of a pin: a spring that is relaxed when its shoes are in line, and a damper.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bushing {
    /// [N m/rad] Stiffness.
    pub stiffness: f64,
    /// [N m s/rad] Damping.
    pub damping: f64,
}

impl Bushing {
    /// Several of them side by side.
    pub(crate) fn times(self, count: f64) -> Self {
        Self {
            stiffness: count * self.stiffness,
            damping: count * self.damping,
        }
    }
}

impl ChainOfShoes {
    /// [kg m^2] Moment of inertia of its sprocket, if there is one.
    pub(crate) fn sprocket_inertia(&self) -> f64 {
        self.sprocket.as_ref().map_or(0.0, |s| s.inertia)
    }
}

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
    /// [kg m^2] Moment of inertia of its motors' rotors, for rotation relative to the chassis.
    pub rotor_inertia: f64,
    /// Whether its gear is self-locking.
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
    /// [m] Travel of its belt caused by turning the arm about its sprocket.
    pub run: f64,
}

impl Flipper {
    /// The arms of a robot, front first.
    pub(crate) fn of(robot: &Robot) -> Vec<Self> {
        let Some(flippers) = &robot.flippers else {
            return Vec::new();
        };
        let [rear, front] = end_discs(&robot.outline);
        // A closed track is a belt round the same wheels.
        let open = match &robot.track {
            Track::Closed(closed) => &closed.of,
            open => open,
        };
        let tip = match flippers.track_model(open) {
            Track::Line(LineOfWheels {
                wheel_radius: Some(radius),
                ..
            }) => radius.max(flippers.tip_radius),
            _ => flippers.tip_radius,
        };
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
                reach: flippers.root_radius.max(flippers.length + tip),
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

    /// [kg] Mass that moves with its track, if that has its own drive: a tenth of its mass, our assumption.
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

    /// [m] Travel of a belt along it because it has turned by `angle` [rad] relative to the chassis.
    pub(crate) fn run(angle: f64, drive_radius: f64) -> f64 {
        // The sprocket turns with the chassis; relative to the arm it turns back.
        drive_radius * angle
    }
}
