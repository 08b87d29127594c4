//! The parts of a robot: kind, shape, what carries them, where they are, and how their drives move them.

use super::Mounted;
use crate::geometry::{Disc, Gear, Grouser, Motion, Pose, Rotation, Vector};
use crate::names::named;

/// A shape on a body of the robot that can meet the ground.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it represents.
    pub kind: BodyKind,
    /// Its shape in the frame of its mount.
    pub shape: Shape,
    /// The drive that moves its surface.
    pub drive: Option<usize>,
    /// Its own coefficient of friction; the smaller of this and that of the ground counts.
    pub friction_limit: f64,
    /// Index of the lane under it.
    pub lane: usize,
    /// The body that it is fixed to.
    pub mount: Mount,
}

/// Shapes in the frame of their mount.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A disc.
    Disc {
        /// [m] Centre.
        center: Vector,
        /// [m] Radius.
        radius: f64,
    },
    /// The convex hull of discs.
    Hull {
        /// The discs.
        discs: Vec<Disc>,
        /// [m] Height of the grousers that travel along it.
        grouser_height: f64,
    },
    /// A grouser on a belt.
    Grouser(Grouser),
    /// A wheel with grousers that turns with its drive.
    Gear {
        /// [m] Centre.
        center: Vector,
        /// Its outline.
        gear: Gear,
    },
    /// A convex polygon, counter-clockwise.
    Polygon {
        /// [m] Corners.
        corners: Vec<Vector>,
    },
}

impl Part {
    /// A part on the chassis over one lane, without its own limit of friction.
    pub(super) fn new(kind: BodyKind, shape: Shape, drive: Option<usize>) -> Self {
        Self {
            kind,
            shape,
            drive,
            friction_limit: f64::INFINITY,
            lane: 0,
            mount: Mount::Chassis,
        }
    }

    /// Circumscribed and root circles of the discs whose hull it fills; none for a polygon.
    pub(crate) fn discs(&self) -> impl Iterator<Item = (Disc, Disc)> {
        let round = |center, radius| {
            let disc = Disc { center, radius };
            (disc, disc)
        };
        let discs = match &self.shape {
            Shape::Disc { center, radius } => vec![round(*center, *radius)],
            Shape::Hull {
                discs,
                grouser_height,
            } => discs
                .iter()
                .map(|d| (d.grown(*grouser_height), *d))
                .collect(),
            Shape::Gear { center, gear } => {
                let (tip, _) = round(*center, gear.radius);
                let (root, _) = round(*center, gear.root_radius);
                vec![(tip, root)]
            }
            Shape::Polygon { .. } | Shape::Grouser(_) => Vec::new(),
        };
        discs.into_iter()
    }

    /// A disc that contains it, in its own frame: centre and radius [m].
    pub(crate) fn bound(&self) -> (Vector, f64) {
        let corners: Vec<Disc> = match &self.shape {
            Shape::Disc { radius, .. } => return (Vector::ZERO, *radius),
            Shape::Gear { gear, .. } => return (Vector::ZERO, gear.radius),
            Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
            Shape::Grouser(grouser) => grouser.corners().map(Disc::point).to_vec(),
            Shape::Hull { .. } => self.discs().map(|(tip, _)| tip).collect(),
        };
        let sum: Vector = corners.iter().map(|d| d.center).sum();
        let middle = sum / corners.len() as f64;
        let reach = |d: &Disc| (d.center - middle).length() + d.radius;
        (middle, corners.iter().map(reach).fold(0.0, f64::max))
    }

    /// [m] Travel of its surface relative to its mount.
    pub(crate) fn run(&self, running: &Running) -> f64 {
        self.drive.map_or(0.0, |k| running.run(self.mount, k))
    }

    /// [rad] Its rotation relative to its mount when its surface has run by this distance [m]; full turns count.
    pub(crate) fn turn(&self, run: f64) -> f64 {
        match &self.shape {
            Shape::Disc { radius, .. } => -run / radius,
            Shape::Gear { gear, .. } => -run / gear.radius,
            Shape::Grouser(grouser) => grouser.angle(run),
            Shape::Hull { .. } | Shape::Polygon { .. } => 0.0,
        }
    }

    /// Its own frame in that of its mount; the frame of a disc does not turn, which is invisible.
    pub(crate) fn place(&self, running: &Running) -> Pose {
        let run = self.run(running);
        match &self.shape {
            Shape::Disc { center, .. } => Pose::from_translation(*center),
            Shape::Gear { center, .. } => Pose::from_parts(*center, Rotation::new(self.turn(run))),
            Shape::Grouser(grouser) => grouser.place(run),
            Shape::Hull { .. } | Shape::Polygon { .. } => Pose::IDENTITY,
        }
    }

    /// Motion of its shape relative to its mount when the surface has run by `run` [m], as a mean over `reach` [m] in
    /// both directions. A surface that only moves tangentially does not move the shape.
    pub(crate) fn motion(&self, run: f64, reach: f64) -> Motion {
        match &self.shape {
            Shape::Gear { center, gear } if self.drive.is_some() => Motion {
                center: *center,
                turn: 1.0 / gear.radius,
                along: Vector::ZERO,
            },
            Shape::Grouser(grouser) => grouser.motion(run, reach),
            _ => Motion::default(),
        }
    }

    /// Whether its shape moves relative to its mount at all.
    pub(crate) fn is_carried(&self) -> bool {
        matches!(self.shape, Shape::Gear { .. } | Shape::Grouser(_)) || self.mount.shoe().is_some()
    }
}

named! {
    /// What a body represents; its code is the `body_kind` of the contact table.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum BodyKind {
        /// A wheel.
        Wheel = "wheel",
        /// A moving belt.
        Belt = "belt",
        /// A skid runner.
        Skid = "skid",
        /// The underside of the chassis.
        Belly = "belly",
        /// A grouser of a moving belt or of a shoe.
        Grouser = "grouser",
        /// The plate of a shoe.
        Shoe = "shoe",
        /// The guide that a chain slides on.
        Guide = "guide",
        /// The toothed wheel that drives a chain.
        Sprocket = "sprocket",
        /// The front wheel of a chain, on the tensioner.
        Idler = "idler",
        /// A wheel that runs on the lower run of a chain.
        RoadWheel = "road_wheel",
        /// A return roller, which carries the upper run.
        Roller = "roller",
    }
}

impl BodyKind {
    /// Whether a chain of shoes runs round it.
    pub(crate) fn is_in_chain(self) -> bool {
        match self {
            Self::Guide | Self::Sprocket | Self::Idler | Self::RoadWheel | Self::Roller => true,
            Self::Wheel | Self::Belt | Self::Skid | Self::Belly | Self::Grouser | Self::Shoe => {
                false
            }
        }
    }
}

/// A body of the robot that carries parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mount {
    /// The chassis.
    Chassis,
    /// The shoe of this number.
    Shoe(usize),
    /// The arms at one end, by number.
    Flipper(usize),
}

impl Mount {
    /// The mount that carries its track: for shoes it is the chassis.
    pub(crate) fn carrier(self) -> Self {
        match self {
            Self::Chassis | Self::Shoe(_) => Self::Chassis,
            Self::Flipper(_) => self,
        }
    }

    /// Number of the shoe, if it is one.
    pub fn shoe(self) -> Option<usize> {
        match self {
            Self::Shoe(shoe) => Some(shoe),
            Self::Chassis | Self::Flipper(_) => None,
        }
    }
}

/// The positions of everything that moves relative to the chassis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Running {
    /// [m] Travel of the surface of each drive.
    pub drives: Vec<f64>,
    /// Frames of the shoes in that of the chassis.
    pub shoes: Vec<Pose>,
    /// Poses of the flippers.
    pub flippers: Vec<Mounted>,
}

impl Running {
    /// Frame of a mount on a robot whose chassis frame is `pose`.
    pub(crate) fn mounted(&self, mount: Mount, pose: Pose) -> Pose {
        match mount {
            Mount::Chassis => pose,
            Mount::Shoe(shoe) => pose * self.shoes[shoe],
            Mount::Flipper(k) => pose * self.flippers[k].pose,
        }
    }

    /// [m] Travel of a drive's surface relative to a mount.
    pub(crate) fn run(&self, mount: Mount, drive: usize) -> f64 {
        let over_chassis = self.drives[drive];
        match mount {
            Mount::Flipper(k) => over_chassis + self.flippers[k].run,
            Mount::Chassis | Mount::Shoe(_) => over_chassis,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_listed_by_their_codes() {
        let codes = BodyKind::ALL.map(|kind| kind as usize);
        assert_eq!(codes, std::array::from_fn(|code| code));
    }
}
