//! The robot as built, with masses, outline, belly and drivetrain, and the model of its track.

use serde::Serialize;
use serde_json::Value;

use super::ScenarioError;
use super::drivetrain::Drivetrain;
use super::fields::{
    COORDINATE, Fields, INERTIA, LEAST_FRACTION, MASS, ROTOR, Range, SIZE, TORQUE, is_false,
    is_zero, rows,
};
use super::outline::TrackOutline;
use super::track::Track;

/// A tracked robot with both tracks and with its arms at angle 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Robot {
    /// Name shown in tables and plots.
    pub name: String,
    /// [kg] Total mass, including tracks and arms.
    pub mass: f64,
    /// [m] Centre of mass in the chassis frame.
    pub center_of_mass: [f64; 2],
    /// [kg m^2] Moment of inertia of the whole robot about its centre of mass.
    pub moment_of_inertia: f64,
    /// [kg] Mass of both tracks together, all of it moving at track speed.
    pub track_mass: f64,
    /// The side view of the track.
    pub outline: TrackOutline,
    /// [m] Convex polygon in the chassis frame, counter-clockwise; `None` if it never touches.
    pub belly: Option<Vec<[f64; 2]>>,
    /// Pivoting arms.
    pub flippers: Option<Flippers>,
    /// [m] Lateral distance between the tracks.
    pub gauge: f64,
    /// Motors and their limits.
    pub drivetrain: Drivetrain,
    /// How the track is modelled.
    pub track: Track,
}

impl Robot {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let robot = Self {
            name: f.text("name")?.to_owned(),
            mass: f.number("mass", MASS)?,
            center_of_mass: f.point("center_of_mass", COORDINATE)?,
            moment_of_inertia: f.number("moment_of_inertia", INERTIA)?,
            track_mass: f.number("track_mass", MASS)?,
            outline: TrackOutline::read(f.child("outline")?)?,
            belly: read_belly(&mut f)?,
            flippers: if f.value("flippers")?.is_null() {
                None
            } else {
                Some(Flippers::read(f.child("flippers")?)?)
            },
            gauge: f.number("gauge", SIZE)?,
            drivetrain: Drivetrain::read(f.child("drivetrain")?)?,
            track: Track::read(f.child("track")?)?,
        };
        robot.check(&f)?;
        robot.track.check(robot.drivetrain.torque_sharing)?;
        robot
            .track
            .check_discs("robot.track", robot.outline.discs.len())?;
        if let Some(flippers) = &robot.flippers {
            robot.check_flippers(flippers)?;
        }
        f.finish()?;
        Ok(robot)
    }

    /// [m] The convex polygons of its belly, counter-clockwise; none if it has no belly.
    pub(crate) fn belly_polygons(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.belly.iter().map(Vec::as_slice)
    }

    /// The same robot without its belly; `None` if it has none.
    pub(crate) fn without_belly(&self) -> Option<Self> {
        self.belly.is_some().then(|| Self {
            belly: None,
            ..self.clone()
        })
    }

    /// Checks rules that involve several fields.
    fn check(&self, f: &Fields) -> Result<(), ScenarioError> {
        if self.track_mass >= self.mass {
            return Err(f.error(
                "track_mass",
                self.track_mass,
                format!("must be less than robot.mass = {} kg", self.mass),
            ));
        }
        let least = LEAST_FRACTION * self.mass;
        if self.track_mass < least {
            let rule = format!("must be at least a hundred-thousandth of robot.mass, {least} kg");
            return Err(f.error("track_mass", self.track_mass, rule));
        }
        let radius = self.outline.largest_radius();
        let circulating = self.track_mass * radius * radius;
        if circulating >= self.moment_of_inertia {
            return Err(f.error(
                "moment_of_inertia",
                self.moment_of_inertia,
                format!("must exceed track_mass x radius^2 = {circulating} kg m^2, the inertia of the moving track"),
            ));
        }
        self.check_rotor("drivetrain", self.drivetrain.rotor_inertia)?;
        if self.drivetrain.self_locking && matches!(self.track.open(), Track::Force(_)) {
            let rule = "must be false on a force track: a force that pushes the chassis has no gear to lock";
            let path = "robot.drivetrain.self_locking";
            return Err(ScenarioError::new(path, true, rule));
        }
        Ok(())
    }

    /// Checks that the digits of the chassis are not lost beside a motor's rotor.
    fn check_rotor(&self, of: &str, inertia: f64) -> Result<(), ScenarioError> {
        let most = self.moment_of_inertia / LEAST_FRACTION;
        if inertia <= most {
            return Ok(());
        }
        let rule = format!("must be at most 100,000 times robot.moment_of_inertia, {most} kg m^2");
        let path = format!("robot.{of}.rotor_inertia");
        Err(ScenarioError::new(path, inertia, rule))
    }

    /// Checks rules that involve robot and flippers.
    fn check_flippers(&self, flippers: &Flippers) -> Result<(), ScenarioError> {
        let error = |field: &str, value: f64, rule: String| {
            let path = format!("robot.flippers.{field}");
            Err(ScenarioError::new(path, value, rule))
        };
        let height = self.outline.grouser_height;
        let smallest = flippers.root_radius.min(flippers.tip_radius);
        if smallest <= height {
            let rule = format!("must exceed robot.outline.grouser_height = {height} m");
            return error("tip_radius", smallest, rule);
        }
        let least = LEAST_FRACTION * self.mass;
        if flippers.mass < least {
            let rule = format!("must be at least a hundred-thousandth of robot.mass, {least} kg");
            return error("mass", flippers.mass, rule);
        }
        self.check_rotor("flippers", flippers.rotor_inertia)?;
        let of_arms = 2.0 * flippers.mass * flippers.ends().count() as f64;
        if of_arms + self.track_mass >= self.mass {
            let rule = format!(
                "must leave mass for the chassis: arms ({of_arms} kg) and robot.track_mass together reach robot.mass = {} kg",
                self.mass
            );
            return error("mass", flippers.mass, rule);
        }
        let refused = |rule: &str| {
            Err(ScenarioError::new(
                "robot.flippers.track",
                "this model",
                rule,
            ))
        };
        let is_force = |track: &Track| matches!(track, Track::Force(_));
        let own = self.track.open();
        match &flippers.track {
            None if matches!(own, Track::Hybrid(_)) => {
                refused("must be given, because the robot's own track has wheels placed by hand")
            }
            Some(Track::Segmental(_)) => refused(
                "must not be segmental, because chains run round the chassis only (grouser_belt comes closest)",
            ),
            Some(Track::Closed(_)) => {
                refused("must not be closed, because a closed robot.track closes the arms' too")
            }
            Some(track) if is_force(track) != is_force(own) => {
                refused("must be a force track exactly when robot.track is one")
            }
            Some(track) => track.check(self.drivetrain.torque_sharing),
            None => Ok(()),
        }
    }
}

/// Reads the polygon of a belly, if there is one.
fn read_belly(f: &mut Fields) -> Result<Option<Vec<[f64; 2]>>, ScenarioError> {
    match f.value("belly")? {
        Value::Null => Ok(None),
        polygon => read_polygon(&f.path("belly"), polygon).map(Some),
    }
}

/// Reads a convex counter-clockwise polygon of non-zero area.
fn read_polygon(path: &str, value: &Value) -> Result<Vec<[f64; 2]>, ScenarioError> {
    const MOST: usize = 64;
    let points = rows(path, value, [("x", COORDINATE), ("y", COORDINATE)], MOST)?;
    let n = points.len();
    let refuse = |rule| Err(ScenarioError::new(path, format!("{n} points"), rule));
    if n < 3 {
        return refuse("must have at least 3 points");
    }
    for i in 0..n {
        let ([ax, ay], [bx, by], [cx, cy]) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        let turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx);
        if turn <= 0.0 {
            let corner = format!("{path}[{}]", (i + 1) % n);
            let rule = "must be a corner of a convex counter-clockwise polygon";
            return Err(ScenarioError::new(corner, format!("[{bx}, {by}]"), rule));
        }
    }
    // A polygon with left turns only may still go round more than once, as a pentagram does.
    let is_up = |i: usize| {
        let ([ax, ay], [bx, by]) = (points[i % n], points[(i + 1) % n]);
        (by, bx) > (ay, ax)
    };
    if (0..n).filter(|i| !is_up(*i) && is_up(i + 1)).count() != 1 {
        return refuse("must be a convex counter-clockwise polygon that goes round once");
    }
    Ok(points)
}

/// [rad] Angle of an arm relative to the chassis: up to a full turn either way.
pub(super) const ANGLE: Range = Range::between(-6.3, 6.3, "rad");

/// Identical arms at one end of the robot or at both, one on each side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flippers {
    /// [m] Distance from the pivot to the axle at the tip.
    pub length: f64,
    /// [m] Radius at the pivot, measured to the grouser tips.
    pub root_radius: f64,
    /// [m] Radius at the tip, measured to the grouser tips.
    pub tip_radius: f64,
    /// [kg] Mass of one arm, spread evenly between pivot and tip axle.
    pub mass: f64,
    /// The ends of the robot that have arms.
    pub ends: Ends,
    /// [rad] Angle of the arms at time 0: 0 points away from the robot, upwards > 0.
    pub angle: f64,
    /// [rad/s] Largest turning rate relative to the chassis.
    pub rate_limit: f64,
    /// [N m] Largest torque of the motor of one arm.
    pub torque_limit: f64,
    /// [kg m^2] Moment of inertia of the motor of one arm as the pivot feels it: the rotor's own times the square of the
    /// gear's ratio.
    #[serde(skip_serializing_if = "is_zero")]
    pub rotor_inertia: f64,
    /// The gear locks itself: no load turns an arm back.
    #[serde(skip_serializing_if = "is_false")]
    pub self_locking: bool,
    /// How their tracks are modelled; `None` takes the robot's model.
    pub track: Option<Track>,
}

/// Ends of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// The front.
    Front,
    /// The rear.
    Rear,
    /// Both ends.
    Both,
}

/// One end of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The front.
    Front,
    /// The rear.
    Rear,
}

impl End {
    /// 1 at the front, -1 at the rear.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Front => 1.0,
            Self::Rear => -1.0,
        }
    }
}

impl Flippers {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let ends = [
            ("front", Ends::Front),
            ("rear", Ends::Rear),
            ("both", Ends::Both),
        ];
        let flippers = Self {
            length: f.number("length", SIZE)?,
            root_radius: f.number("root_radius", SIZE)?,
            tip_radius: f.number("tip_radius", SIZE)?,
            mass: f.number("mass", MASS)?,
            ends: f.choice("ends", &ends)?,
            angle: f.number("angle", ANGLE)?,
            rate_limit: f.number("rate_limit", Range::above(0.0, 100.0, "rad/s"))?,
            torque_limit: f.number("torque_limit", TORQUE)?,
            rotor_inertia: f.number_or_zero("rotor_inertia", ROTOR)?,
            self_locking: f.flag_or_false("self_locking")?,
            track: if f.value("track")?.is_null() {
                None
            } else {
                Some(Track::read(f.child("track")?)?)
            },
        };
        if (flippers.root_radius - flippers.tip_radius).abs() >= flippers.length {
            let rule = "must differ from root_radius by less than the length: otherwise one end would enclose the other";
            return Err(f.error("tip_radius", flippers.tip_radius, rule));
        }
        f.finish()?;
        Ok(flippers)
    }

    /// The ends that have arms, the front first.
    pub(crate) fn ends(&self) -> impl Iterator<Item = End> + Clone {
        let ends: &[End] = match self.ends {
            Ends::Front => &[End::Front],
            Ends::Rear => &[End::Rear],
            Ends::Both => &[End::Front, End::Rear],
        };
        ends.iter().copied()
    }

    /// Outline of the track of an arm at an end, in a frame midway between its axles.
    pub(crate) fn outline(&self, end: End, robot: &TrackOutline) -> TrackOutline {
        let radii = match end {
            End::Front => [self.root_radius, self.tip_radius],
            End::Rear => [self.tip_radius, self.root_radius],
        };
        TrackOutline {
            discs: TrackOutline::two_discs(self.length, radii),
            ..robot.clone()
        }
    }

    /// The track model of an arm.
    pub(crate) fn track_model(&self, robot: &Track) -> Track {
        self.track.clone().unwrap_or_else(|| match robot {
            Track::Segmental(_) => Track::GrouserBelt(super::GrouserBeltTrack {
                grouser_count: None,
            }),
            other => other.clone(),
        })
    }
}
