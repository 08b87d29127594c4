//! The shape of a part: what it covers, where it is, how its drive moves it.

use rapier2d_f64::math::{Pose, Rotation, Vector};

use crate::contact::Running;
use crate::outline::{Disc, Motion};
use crate::robot::{Part, Shape};

impl Part {
    /// Discs whose hull it fills: circumscribed and root circle of each; none for a polygon.
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

    /// A disc round it in its own frame: centre and radius [m].
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

    /// [m] How far its surface has run over its mount.
    pub(crate) fn run(&self, running: &Running) -> f64 {
        self.drive.map_or(0.0, |k| running.run(self.mount, k))
    }

    /// Its own frame in that of its mount.
    pub(crate) fn place(&self, running: &Running) -> Pose {
        let run = self.run(running);
        match &self.shape {
            Shape::Disc { center, .. } => Pose::from_translation(*center),
            Shape::Gear { center, gear } => {
                Pose::from_parts(*center, Rotation::new(-run / gear.radius))
            }
            Shape::Grouser(grouser) => grouser.place(run),
            Shape::Hull { .. } | Shape::Polygon { .. } => Pose::IDENTITY,
        }
    }

    /// How its drive moves its shape over the chassis when the surface has run so far [m], the mean over as
    /// much as `reach` [m] before and behind. A surface that only runs along itself moves no shape.
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

    /// Whether its shape moves over the chassis at all.
    pub(crate) fn is_carried(&self) -> bool {
        matches!(self.shape, Shape::Gear { .. } | Shape::Grouser(_)) || self.mount.shoe().is_some()
    }
}
