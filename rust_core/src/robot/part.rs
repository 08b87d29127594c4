//! A part of the robot: its shape, its carrier, its position, and how its drive moves it.

use super::{BodyKind, Mount, Running};
use crate::geometry::{Disc, Gear, Grouser, Motion, Pose, Rotation, Vector};

/// A shape on a body of the robot that can meet the ground.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it represents.
    pub kind: BodyKind,
    /// Its shape in the frame of its mount.
    pub shape: Shape,
    /// The drive that moves its surface.
    pub drive: Option<usize>,
    /// Its own friction; the smaller of this and that of the ground counts.
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
    /// Circumscribed and root circle of each disc whose hull it fills; none for a polygon.
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
            } => {
                let tip = |d: &Disc| Disc {
                    radius: d.radius + grouser_height,
                    ..*d
                };
                discs.iter().map(|d| (tip(d), *d)).collect()
            }
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

    /// [rad] Its rotation relative to its mount when its surface has run this far [m]; full turns count.
    pub(crate) fn turn(&self, run: f64) -> f64 {
        match &self.shape {
            Shape::Disc { radius, .. } => -run / radius,
            Shape::Gear { gear, .. } => -run / gear.radius,
            Shape::Grouser(grouser) => grouser.angle(run),
            Shape::Hull { .. } | Shape::Polygon { .. } => 0.0,
        }
    }

    /// Its own frame in that of its mount; that of a disc does not turn, which makes no visible difference.
    pub(crate) fn place(&self, running: &Running) -> Pose {
        let run = self.run(running);
        match &self.shape {
            Shape::Disc { center, .. } => Pose::from_translation(*center),
            Shape::Gear { center, .. } => Pose::from_parts(*center, Rotation::new(self.turn(run))),
            Shape::Grouser(grouser) => grouser.place(run),
            Shape::Hull { .. } | Shape::Polygon { .. } => Pose::IDENTITY,
        }
    }

    /// How its drive moves its shape relative to its mount when the surface has run by `run` [m], as a mean over
    /// `reach` [m] in both directions. A surface that only moves tangentially does not move the shape.
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
