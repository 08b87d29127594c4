//! The robot as it is simulated: one body, the parts that meet the ground, the drives.

use rapier2d_f64::math::Vector;

use crate::error::ScenarioError;
use crate::outline::{self, Disc};
use crate::scenario::{Robot, Scenario};
use crate::terrain::{Ground, Profile};
use crate::track;

/// Everything about a robot that does not change during a run.
#[derive(Clone, Debug)]
pub struct Model {
    /// [kg] Total mass.
    pub mass: f64,
    /// [m] Centre of mass in the chassis frame.
    pub center_of_mass: Vector,
    /// [kg m^2] Moment of inertia without the part that turns with the drives.
    pub moment_of_inertia: f64,
    /// What meets the ground; the belly, if any, is the last.
    pub parts: Vec<Part>,
    /// Number of drives.
    pub drives: usize,
    /// [kg] Mass that moves at the surface speed of each drive.
    pub drive_mass: f64,
    /// [m] Radius that joins surface speed and spin of a drive.
    pub drive_radius: f64,
    /// [N] Largest traction of each drive.
    pub drive_force: f64,
    /// The drive pushes the chassis along its axis, whatever touches the ground.
    pub pushes_chassis: bool,
}

/// What a part of the robot stands for; the code is the `body_kind` of the contact table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// A wheel.
    Wheel = 0,
    /// A moving belt.
    Belt = 1,
    /// A skid runner.
    Skid = 2,
    /// The underside of the chassis.
    Belly = 3,
}

/// A shape fixed to the chassis that meets the ground.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it stands for.
    pub kind: BodyKind,
    /// Its form in the chassis frame.
    pub shape: Shape,
    /// The drive that moves its surface.
    pub drive: Option<usize>,
    /// Friction of its own; the smaller of this and the ground's counts.
    pub friction_limit: f64,
}

/// Forms in the chassis frame.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A disc.
    Disc {
        /// [m] Centre.
        center: Vector,
        /// [m] Radius.
        radius: f64,
    },
    /// The convex hull of two discs.
    Hull {
        /// [m] Centre of the rear disc.
        rear: Vector,
        /// [m] Radius of the rear disc.
        rear_radius: f64,
        /// [m] Centre of the front disc.
        front: Vector,
        /// [m] Radius of the front disc.
        front_radius: f64,
    },
    /// A convex polygon, counter-clockwise.
    Polygon {
        /// [m] Corners.
        corners: Vec<Vector>,
    },
}

impl Model {
    /// The model of a robot: mass, centre of mass and moments of inertia are the built robot's,
    /// whatever the track model.
    pub fn new(robot: &Robot) -> Self {
        let track = track::build(robot);
        let mut parts = track.parts;
        if let Some(belly) = &robot.belly {
            let corners = belly.iter().map(|p| Vector::new(p[0], p[1])).collect();
            let shape = Shape::Polygon { corners };
            parts.push(Part {
                kind: BodyKind::Belly,
                shape,
                drive: None,
                friction_limit: f64::INFINITY,
            });
        }
        let drives = track.drives as f64;
        let radius = robot.outline.rear_radius;
        Self {
            mass: robot.mass,
            center_of_mass: Vector::from(robot.center_of_mass),
            moment_of_inertia: robot.moment_of_inertia - robot.track_mass * radius * radius,
            parts,
            drives: track.drives,
            drive_mass: robot.track_mass / drives,
            drive_radius: radius,
            drive_force: robot.drivetrain.max_force(&robot.outline) / drives,
            pushes_chassis: track.pushes_chassis,
        }
    }

    /// [m] Farthest point of any part from the centre of mass.
    pub(crate) fn reach(&self) -> f64 {
        let from_center = |p: &Vector| (*p - self.center_of_mass).length();
        let of_part = |part: &Part| match &part.shape {
            Shape::Disc { center, radius } => from_center(center) + radius,
            Shape::Hull {
                rear,
                rear_radius,
                front,
                front_radius,
            } => (from_center(rear) + rear_radius).max(from_center(front) + front_radius),
            Shape::Polygon { corners } => corners.iter().map(from_center).fold(0.0, f64::max),
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }
}

/// Position of the chassis frame at time 0: on the ground, `start.approach` before the first edge.
pub(crate) fn start_pose(scenario: &Scenario, ground: &Ground) -> Result<Vector, ScenarioError> {
    let model = Model::new(&scenario.robot);
    let (sine, cosine) = libm::sincos(scenario.start.angle);
    let turned = |p: Vector| Vector::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
    let mut discs: Vec<Disc> = outline::end_discs(&scenario.robot.outline).to_vec();
    let mut segments: Vec<[Vector; 2]> = Vec::new();
    let outline_discs = discs.len();
    for part in &model.parts {
        match &part.shape {
            Shape::Disc { center, radius } => discs.push(Disc {
                center: *center,
                radius: *radius,
            }),
            Shape::Hull {
                rear,
                rear_radius,
                front,
                front_radius,
            } => {
                let rear = Disc {
                    center: turned(*rear),
                    radius: *rear_radius,
                };
                let front = Disc {
                    center: turned(*front),
                    radius: *front_radius,
                };
                segments.push(outline::lower_tangent(rear, front));
                let ends = outline::end_discs(&scenario.robot.outline);
                discs.extend(ends);
            }
            Shape::Polygon { corners } => {
                let n = corners.len();
                segments.extend((0..n).map(|i| [turned(corners[i]), turned(corners[(i + 1) % n])]));
            }
        }
    }
    for disc in &mut discs {
        disc.center = turned(disc.center);
    }
    let of_discs = discs
        .iter()
        .map(|d| (d.center.x - d.radius, d.center.x + d.radius));
    let of_segments = segments.iter().flatten().map(|p| (p.x, p.x));
    let (rear, front) = of_discs
        .chain(of_segments)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
            (low.min(a), high.max(b))
        });
    let x = ground.first_edge - scenario.start.approach - front;
    let (low, high) = ground.profile.extent();
    if x + rear < low || x + front > high {
        let rule = format!(
            "must reach under the whole robot at its start, from x = {:.4} to {:.4} m",
            x + rear,
            x + front
        );
        return Err(ScenarioError::new(
            "terrain",
            format!("x from {low} to {high} m"),
            rule,
        ));
    }
    // The built outline only sets where the robot begins; what touches the ground are the parts.
    Ok(Vector::new(
        x,
        lowest_height(&ground.profile, x, &discs[outline_discs..], &segments),
    ))
}

/// [m] Height of the chassis frame at which the shapes, placed at `x`, only touch the ground.
fn lowest_height(profile: &Profile, x: f64, discs: &[Disc], segments: &[[Vector; 2]]) -> f64 {
    let shift = Vector::new(x, 0.0);
    let of_discs = discs
        .iter()
        .map(|d| profile.height_under_disc(x + d.center.x, d.radius) - d.center.y);
    let of_segments = segments.iter().map(|[a, b]| {
        let (a, b) = if a.x <= b.x { (*a, *b) } else { (*b, *a) };
        profile.rise_over_segment(a + shift, b + shift)
    });
    of_discs
        .chain(of_segments)
        .fold(f64::NEG_INFINITY, f64::max)
}
