//! The robot as it is simulated: one body, the parts that meet the ground, the drives.

use rapier2d_f64::math::Vector;

use crate::error::ScenarioError;
use crate::outline::{self, Disc, Envelope, Gear};
use crate::plane::{left_of, right_of};
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
    /// Number of drives, the driven ones first.
    pub drives: usize,
    /// Number of drives with a motor; the others turn freely.
    pub motors: usize,
    /// [kg] Mass that moves at the surface speed of each drive.
    pub drive_mass: f64,
    /// [m] Radius that joins surface speed and spin of a drive.
    pub drive_radius: f64,
    /// [N] Largest traction of each motor.
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
    /// The convex hull of discs.
    Hull {
        /// The discs.
        discs: Vec<Disc>,
    },
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

/// A wheel whose shape turns with its drive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurningWheel {
    /// [m] Axle in the chassis frame.
    pub center: Vector,
    /// [m] Radius at which its surface runs with the drive.
    pub radius: f64,
    /// Index of the drive.
    pub drive: usize,
}

impl Model {
    /// The model of a robot: mass, centre of mass and moments of inertia are the built robot's,
    /// whatever the track model.
    ///
    /// # Errors
    /// Wheels that do not fit the robot.
    pub fn new(robot: &Robot) -> Result<Self, ScenarioError> {
        let track = track::build(robot)?;
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
        Ok(Self {
            mass: robot.mass,
            center_of_mass: Vector::from(robot.center_of_mass),
            moment_of_inertia: robot.moment_of_inertia - robot.track_mass * radius * radius,
            parts,
            drives: track.drives,
            motors: track.motors,
            drive_mass: robot.track_mass / drives,
            drive_radius: radius,
            drive_force: robot.drivetrain.max_force(&robot.outline) / track.motors as f64,
            pushes_chassis: track.pushes_chassis,
        })
    }

    /// [kg m^2] Moment of inertia of one drive.
    pub(crate) fn drive_inertia(&self) -> f64 {
        self.drive_mass * self.drive_radius * self.drive_radius
    }

    /// [kg m^2] Moment of inertia of the chassis with one drive locked to it.
    pub(crate) fn locked_inertia(&self) -> f64 {
        self.moment_of_inertia + self.drive_inertia()
    }

    /// The same robot with a closed belt, taut round the bodies of its track: their circumscribed
    /// circles, all their motors' force, their mass.
    pub(crate) fn closed(&self) -> Self {
        let discs: Vec<Disc> = self
            .parts
            .iter()
            .flat_map(|part| part.discs().map(|(tip, _)| tip).collect::<Vec<_>>())
            .collect();
        let belt = Envelope::new(&discs);
        // A closed belt shields a belly that lies inside of it.
        let reaches_out = |part: &&Part| match &part.shape {
            Shape::Polygon { corners } => corners.iter().any(|c| belt.depth(*c) < 0.0),
            _ => false,
        };
        let belly = self.parts.iter().filter(reaches_out).cloned();
        let shape = Shape::Hull { discs };
        let belt = Part {
            kind: BodyKind::Belt,
            shape,
            drive: Some(0),
            friction_limit: f64::INFINITY,
        };
        Self {
            parts: std::iter::once(belt).chain(belly).collect(),
            drives: 1,
            motors: 1,
            drive_mass: self.drive_mass * self.drives as f64,
            drive_force: self.drive_force * self.motors as f64,
            pushes_chassis: false,
            ..self.clone()
        }
    }

    /// The taut belts round the circumscribed and the root circles of the track's bodies, as points
    /// of the chassis frame, counter-clockwise; an arc is cut every `turn` [rad].
    pub fn envelopes(&self, turn: f64) -> [Vec<Vector>; 2] {
        let (tips, roots): (Vec<Disc>, Vec<Disc>) = self
            .parts
            .iter()
            .flat_map(|part| part.discs().collect::<Vec<_>>())
            .unzip();
        [tips, roots].map(|discs| {
            let mut points = Envelope::new(&discs).polyline(turn);
            points.reverse();
            points
        })
    }

    /// [m] Farthest point of any part from the centre of mass.
    pub(crate) fn reach(&self) -> f64 {
        let from_center = |p: &Vector| (*p - self.center_of_mass).length();
        let of_part = |part: &Part| match &part.shape {
            Shape::Polygon { corners } => corners.iter().map(from_center).fold(0.0, f64::max),
            _ => part
                .discs()
                .map(|(tip, _)| from_center(&tip.center) + tip.radius)
                .fold(0.0, f64::max),
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }
}

impl Part {
    /// Discs whose hull it fills: circumscribed and root circle of each; none for a polygon.
    pub(crate) fn discs(&self) -> impl Iterator<Item = (Disc, Disc)> {
        let round = |center, radius| {
            let disc = Disc { center, radius };
            (disc, disc)
        };
        let discs = match &self.shape {
            Shape::Disc { center, radius } => vec![round(*center, *radius)],
            Shape::Hull { discs } => discs.iter().map(|d| (*d, *d)).collect(),
            Shape::Gear { center, gear } => {
                let (tip, _) = round(*center, gear.radius);
                let (root, _) = round(*center, gear.root_radius);
                vec![(tip, root)]
            }
            Shape::Polygon { .. } => Vec::new(),
        };
        discs.into_iter()
    }

    /// A disc round it: centre and radius [m].
    pub(crate) fn bound(&self) -> (Vector, f64) {
        let corners: Vec<Disc> = match &self.shape {
            Shape::Polygon { corners } => corners
                .iter()
                .map(|c| Disc {
                    center: *c,
                    radius: 0.0,
                })
                .collect(),
            _ => self.discs().map(|(tip, _)| tip).collect(),
        };
        let sum: Vector = corners.iter().map(|d| d.center).sum();
        let middle = sum / corners.len() as f64;
        let reach = |d: &Disc| (d.center - middle).length() + d.radius;
        (middle, corners.iter().map(reach).fold(0.0, f64::max))
    }

    /// The wheel that it is, if turning changes what it touches.
    pub(crate) fn turning(&self) -> Option<TurningWheel> {
        match (&self.shape, self.drive) {
            (Shape::Gear { center, gear }, Some(drive)) => Some(TurningWheel {
                center: *center,
                radius: gear.radius,
                drive,
            }),
            _ => None,
        }
    }

    /// Velocity of the surface over the chassis where the outward normal of the ground is `normal`,
    /// for a surface speed of 1; `spoke` leads from the centre of a turning wheel to that place.
    pub(crate) fn surface_motion(&self, normal: Vector, spoke: Vector) -> Vector {
        match &self.shape {
            _ if self.drive.is_none() => Vector::ZERO,
            // Turning does not change the shape: the surface moves along itself.
            Shape::Disc { .. } | Shape::Hull { .. } | Shape::Polygon { .. } => left_of(normal),
            Shape::Gear { gear, .. } => right_of(spoke) / gear.radius,
        }
    }
}

/// Position of the chassis frame at time 0: on the ground, `start.approach` before the first edge.
pub(crate) fn start_pose(
    scenario: &Scenario,
    model: &Model,
    ground: &Ground,
) -> Result<Vector, ScenarioError> {
    let (sine, cosine) = libm::sincos(scenario.start.angle);
    let turned = |p: Vector| Vector::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
    let turned_disc = |d: Disc| Disc {
        center: turned(d.center),
        ..d
    };
    // What touches the ground: discs, and segments between points.
    let mut discs: Vec<Disc> = Vec::new();
    let mut segments: Vec<[Vector; 2]> = Vec::new();
    for part in &model.parts {
        discs.extend(part.discs().map(|(_, root)| turned_disc(root)));
        match &part.shape {
            Shape::Disc { .. } => {}
            Shape::Hull { discs: round } => {
                let placed = &discs[discs.len() - round.len()..];
                segments.extend(
                    placed
                        .windows(2)
                        .map(|pair| outline::lower_tangent(pair[0], pair[1])),
                );
            }
            Shape::Gear { center, gear } => {
                let start = -scenario.start.track_phase / gear.radius;
                for direction in gear.directions() {
                    let corners = gear.corners(direction + start);
                    segments.extend(closed(&corners.map(|c| turned(*center + c))));
                }
            }
            Shape::Polygon { corners } => {
                let corners: Vec<Vector> = corners.iter().map(|c| turned(*c)).collect();
                segments.extend(closed(&corners));
            }
        }
    }
    // The built outline sets where the robot begins, too, although it need not touch the ground.
    let outline = outline::end_discs(&scenario.robot.outline).into_iter();
    let tips = model.parts.iter().flat_map(Part::discs).map(|(tip, _)| tip);
    let of_discs = outline
        .chain(tips)
        .map(turned_disc)
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
    Ok(Vector::new(
        x,
        lowest_height(&ground.profile, x, &discs, &segments),
    ))
}

/// The sides of a polygon.
fn closed(corners: &[Vector]) -> impl Iterator<Item = [Vector; 2]> {
    let n = corners.len();
    (0..n).map(move |i| [corners[i], corners[(i + 1) % n]])
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
