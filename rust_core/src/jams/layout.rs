//! A robot as one rigid body: its surfaces that can touch the ground, and the friction there while the drives run.

use crate::geometry::{Disc, Envelope, Pose, Vector, left_of};
use crate::robot::{BodyKind, Model, Part, Shape};
use crate::scenario::ScenarioError;

/// The robot in its chassis frame, with flippers as at time 0.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// [m] Centre of mass of all of it.
    pub center_of_mass: Vector,
    /// [m] Largest distance of its points from the centre of mass.
    pub reach: f64,
    pub surfaces: Vec<Surface>,
    pub solids: Vec<Solid>,
}

/// A piece of the outline of a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Index of the part, and what it represents.
    pub part: usize,
    pub kind: BodyKind,
    /// Index of the lane under it.
    pub lane: usize,
    pub shape: Outline,
    pub grip: Grip,
    /// Its own coefficient of friction; the smaller of this and that of the ground counts.
    pub friction_limit: f64,
}

/// The shape of such a piece.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outline {
    /// The circle of a disc; a corner has radius 0.
    Round(Disc),
    /// A straight run.
    Flat {
        /// [m] Its ends.
        ends: [Vector; 2],
        /// Unit vector out of the part.
        outward: Vector,
    },
}

/// How friction acts on a surface of a robot at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Grip {
    /// It is driven and slides on the ground, so friction pushes the robot in this direction along it: +1 as when
    /// driving forwards.
    Driven(f64),
    /// It rolls without a motor: no friction.
    Free,
    /// It stands still: any friction within the cone.
    Still,
}

/// The hull of discs that a part fills.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// Index of the lane under it.
    pub lane: usize,
    pub discs: Vec<Disc>,
    /// Outward unit vectors of its straight runs, and their distance [m] from the origin.
    pub runs: Vec<(Vector, f64)>,
}

impl Layout {
    /// A robot whose drives run forwards or backwards.
    ///
    /// # Errors
    /// A part whose shape turns with its drive, such as a gear wheel, a grouser or a shoe; a drive that pushes the
    /// chassis.
    pub(super) fn new(model: &Model, forwards: bool) -> Result<Self, ScenarioError> {
        check(model)?;
        let running = model.running_at_start(0.0);
        let (_, center_of_mass) = model.mass_center(&running);
        let (mut surfaces, mut solids) = (Vec::new(), Vec::new());
        for (index, part) in model.parts.iter().enumerate() {
            let place = running.mounted(part.mount, Pose::IDENTITY);
            let discs = discs(part).into_iter().map(|disc| Disc {
                center: place.transform_point(disc.center),
                ..disc
            });
            let solid = Solid::new(part.lane, discs.collect());
            let outlines = solid.outlines();
            surfaces.extend(outlines.into_iter().map(|shape| Surface {
                part: index,
                kind: part.kind,
                lane: part.lane,
                shape,
                grip: grip(model, part, forwards),
                friction_limit: part.friction_limit,
            }));
            solids.push(solid);
        }
        let far = |disc: &Disc| (disc.center - center_of_mass).length() + disc.radius;
        let discs = solids.iter().flat_map(|solid| &solid.discs);
        Ok(Self {
            center_of_mass,
            reach: discs.map(far).fold(0.0, f64::max),
            surfaces,
            solids,
        })
    }
}

/// Refuses parts without a fixed outline, and robots that are not driven by their surfaces.
fn check(model: &Model) -> Result<(), ScenarioError> {
    let turning = |part: &Part| match &part.shape {
        Shape::Gear { .. } => Some("gear wheels"),
        Shape::Grouser(_) => Some("a belt with grousers"),
        _ => part.mount.shoe().map(|_| "a chain of shoes"),
    };
    let refused = |value: &str, rule: &str| Err(ScenarioError::new("robot.track", value, rule));
    if let Some(name) = model.parts.iter().find_map(turning) {
        let rule = "must have round wheels or a smooth belt: where gear wheels, grousers and shoes can jam depends on how \
                    far they have turned, too";
        return refused(name, rule);
    }
    if model.push_drive().is_some() {
        let rule =
            "must drive by its surfaces: a force that pushes the chassis has no jams of its own";
        return refused("force", rule);
    }
    Ok(())
}

/// The discs whose hull a part fills, in the frame of its mount.
fn discs(part: &Part) -> Vec<Disc> {
    match &part.shape {
        Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
        _ => part.discs().map(|(disc, _)| disc).collect(),
    }
}

fn grip(model: &Model, part: &Part, forwards: bool) -> Grip {
    match part.drive {
        Some(drive) if model.has_motor(drive) => Grip::Driven(if forwards { 1.0 } else { -1.0 }),
        Some(_) => Grip::Free,
        None => Grip::Still,
    }
}

impl Solid {
    pub(super) fn new(lane: usize, discs: Vec<Disc>) -> Self {
        let hull = Envelope::new(&discs);
        let runs = hull.runs().map(|[from, to]| {
            // The hull is walked clockwise.
            let outward = left_of(to - from).normalize();
            (outward, outward.dot(from))
        });
        let runs = runs.collect();
        Self { lane, discs, runs }
    }

    /// Its circles and its straight runs.
    fn outlines(&self) -> Vec<Outline> {
        let hull = Envelope::new(&self.discs);
        let round = hull.arcs().into_iter().map(|(disc, ..)| disc);
        // A disc that the hull touches at two places is one circle.
        let mut circles: Vec<Disc> = Vec::new();
        for disc in round {
            if !circles.contains(&disc) {
                circles.push(disc);
            }
        }
        let runs = hull.runs().zip(&self.runs);
        let flats = runs.map(|(ends, (outward, _))| Outline::Flat {
            ends,
            outward: *outward,
        });
        circles
            .into_iter()
            .map(Outline::Round)
            .chain(flats)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_hull_look_outwards() {
        let disc = |x: f64, y: f64, radius: f64| Disc {
            center: Vector::new(x, y),
            radius,
        };
        let solid = Solid::new(
            0,
            vec![
                disc(0.0, 0.0, 0.1),
                disc(0.5, 0.0, 0.05),
                disc(0.2, 0.3, 0.0),
            ],
        );
        assert_eq!(solid.runs.len(), 3);
        let middle = Vector::new(0.23, 0.1);
        for (outward, offset) in &solid.runs {
            assert!((outward.length() - 1.0).abs() < 1e-15);
            assert!(outward.dot(middle) < *offset);
            let beyond = |d: &Disc| outward.dot(d.center) + d.radius - offset;
            assert!(solid.discs.iter().all(|d| beyond(d) < 1e-12));
        }
        assert_eq!(solid.outlines().len(), 6);
    }
}
