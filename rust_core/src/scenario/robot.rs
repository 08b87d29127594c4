//! The robot as built, with masses, outline, belly and drivetrain, and the model of its track.

use serde::Serialize;

use super::ScenarioError;
use super::drivetrain::Drivetrain;
use super::fields::{
    COORDINATE, Checked, Fields, INERTIA, LEAST_FRACTION, MASS, ROTOR, Range, SIZE, TORQUE,
    is_false, is_zero,
};
use super::objects::{Choice, FromJson, choice, object};
use super::outline::TrackOutline;
use super::track::Track;

object! {
    /// A tracked robot with both tracks and with its arms at angle 0.
    pub struct Robot {
        /// Name shown in tables and plots.
        name: String = string(),
        /// [kg] Total mass, including tracks and arms.
        mass: f64 = number(MASS),
        /// [m] Centre of mass in the chassis frame.
        center_of_mass: [f64; 2] = point(COORDINATE),
        /// [kg m^2] Moment of inertia of the whole robot about its centre of mass.
        moment_of_inertia: f64 = number(INERTIA),
        /// [kg] Mass of both tracks together, all of it moving at track speed.
        track_mass: f64 = number(MASS),
        /// The side view of the track.
        outline: TrackOutline = object(),
        /// [m] Convex polygon in the chassis frame, counter-clockwise; `None` if it never touches.
        belly: Option<Vec<[f64; 2]>> = unless_null(read_belly),
        /// Pivoting arms.
        flippers: Option<Flippers> = optional_object(),
        /// [m] Lateral distance between the tracks.
        gauge: f64 = number(SIZE),
        /// Motors and their limits.
        drivetrain: Drivetrain = object(),
        /// How the track is modelled.
        track: Track = object(),
    }
    then check
}

impl Robot {
    /// [N] Its weight on Earth, for defaults of springs; the scenario's gravity may be 0.
    pub(crate) fn earth_weight(&self) -> f64 {
        const EARTH: f64 = 9.81;
        self.mass * EARTH
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
    fn check(&self, f: &Fields) -> Checked<()> {
        let least = LEAST_FRACTION * self.mass;
        let most = self.mass - least;
        if self.track_mass > most {
            let rule = format!(
                "must leave a hundred-thousandth of robot.mass for the chassis: at most {most} kg"
            );
            return Err(f.error("track_mass", self.track_mass, rule));
        }
        if self.track_mass < least {
            let rule = format!("must be at least a hundred-thousandth of robot.mass, {least} kg");
            return Err(f.error("track_mass", self.track_mass, rule));
        }
        let radius = self.outline.largest_radius();
        let circulating = self.track_mass * radius * radius;
        if circulating >= self.moment_of_inertia {
            let rule = format!(
                "must exceed track_mass x radius^2 = {circulating} kg m^2, the inertia of the moving track"
            );
            return Err(f.error("moment_of_inertia", self.moment_of_inertia, rule));
        }
        self.check_rotor("drivetrain", self.drivetrain.rotor_inertia)?;
        if self.drivetrain.self_locking && matches!(self.track.open(), Track::Force(_)) {
            let rule = "must be false on a force track: a force that pushes the chassis has no gear to lock";
            let path = "robot.drivetrain.self_locking";
            return Err(ScenarioError::new(path, true, rule));
        }
        self.track.check(self.drivetrain.torque_sharing)?;
        self.track
            .check_discs("robot.track", self.outline.discs.len())?;
        match &self.flippers {
            Some(flippers) => self.check_flippers(flippers),
            None => Ok(()),
        }
    }

    /// Checks that the inertia of the chassis is not lost in rounding beside that of a motor's rotor.
    fn check_rotor(&self, of: &str, inertia: f64) -> Checked<()> {
        let most = self.moment_of_inertia / LEAST_FRACTION;
        if inertia <= most {
            return Ok(());
        }
        let rule = format!("must be at most 100,000 times robot.moment_of_inertia, {most} kg m^2");
        let path = format!("robot.{of}.rotor_inertia");
        Err(ScenarioError::new(path, inertia, rule))
    }

    /// Checks rules that involve robot and flippers.
    fn check_flippers(&self, flippers: &Flippers) -> Checked<()> {
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
        let most = self.mass - least;
        if of_arms + self.track_mass > most {
            let rule = format!(
                "must leave a hundred-thousandth of robot.mass for the chassis: arms ({of_arms} kg) and robot.track_mass together are more than {most} kg"
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

/// Reads a convex counter-clockwise polygon of non-zero area.
fn read_belly(f: &mut Fields, name: &'static str) -> Checked<Vec<[f64; 2]>> {
    const MOST: usize = 64;
    let points = f.points(name, COORDINATE, MOST)?;
    let n = points.len();
    let refuse = |rule: &str| Err(f.error(name, format!("{n} points"), rule));
    if n < 3 {
        return refuse("must have at least 3 points");
    }
    for i in 0..n {
        let ([ax, ay], [bx, by], [cx, cy]) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        let turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx);
        if turn <= 0.0 {
            let corner = format!("{name}[{}]", (i + 1) % n);
            let rule = "must be a corner of a convex counter-clockwise polygon";
            return Err(f.error(&corner, format!("[{bx}, {by}]"), rule));
        }
    }
    // A polygon with left turns only may still go round more than once, like a pentagram.
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

object! {
    /// Identical arms at one end of the robot or at both, one on each side.
    pub struct Flippers {
        /// [m] Distance from the pivot to the axle at the tip.
        length: f64 = number(SIZE),
        /// [m] Radius at the pivot, measured to the grouser tips.
        root_radius: f64 = number(SIZE),
        /// [m] Radius at the tip, measured to the grouser tips.
        tip_radius: f64 = number(SIZE),
        /// [kg] Mass of one arm, spread evenly between pivot and tip axle.
        mass: f64 = number(MASS),
        /// The ends of the robot that have arms.
        ends: Ends = choice(),
        /// [rad] Angle of the arms at time 0: 0 points away from the robot, upwards > 0.
        angle: f64 = number(ANGLE),
        /// [rad/s] Largest turning rate relative to the chassis.
        rate_limit: f64 = number(Range::above(0.0, 100.0, "rad/s")),
        /// [N m] Largest torque of the motor of one arm.
        torque_limit: f64 = number(TORQUE),
        /// [kg m^2] Moment of inertia of the motor of one arm at the pivot: that of the rotor times the square of the
        /// gear ratio.
        #[serde(skip_serializing_if = "is_zero")]
        rotor_inertia: f64 = number_or_zero(ROTOR),
        /// Whether the gear is self-locking: no load turns an arm back.
        #[serde(skip_serializing_if = "is_false")]
        self_locking: bool = flag_or_false(),
        /// How their tracks are modelled; `None` takes the robot's model.
        track: Option<Track> = optional_object(),
    }
    then check
}

choice! {
    /// Ends of a robot.
    pub enum Ends {
        /// The front.
        "front" Front,
        /// The rear.
        "rear" Rear,
        /// Both ends.
        "both" Both,
    }
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
    fn check(&self, f: &Fields) -> Checked<()> {
        if (self.root_radius - self.tip_radius).abs() >= self.length {
            let rule = "must differ from root_radius by less than the length: otherwise one end would enclose the other";
            return Err(f.error("tip_radius", self.tip_radius, rule));
        }
        Ok(())
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
