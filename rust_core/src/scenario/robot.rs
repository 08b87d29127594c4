//! The robot as it is built: masses, outline, belly, drivetrain, and how its track is modelled.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, Range};
use super::flippers::Flippers;
use super::track::Track;

/// [m] Sizes a crawler can have; a micrometre or a kilometre is a unit mistake.
pub(super) const LENGTH: Range = Range::between(1e-3, 100.0, "m");
const LENGTH_OR_ZERO: Range = Range::between(0.0, 100.0, "m");
const COORDINATE: Range = Range::between(-100.0, 100.0, "m");
pub(super) const MASS: Range = Range::between(1e-3, 1e6, "kg");

/// A tracked robot with both its tracks, arms at angle 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Robot {
    /// Name for tables and plots.
    pub name: String,
    /// [kg] Total mass, tracks included.
    pub mass: f64,
    /// [m] Centre of mass in the chassis frame.
    pub center_of_mass: [f64; 2],
    /// [kg m^2] Moment of inertia of the whole robot about its centre of mass.
    pub moment_of_inertia: f64,
    /// [kg] Mass of both tracks together, all of it moving at belt speed.
    pub track_mass: f64,
    /// The side view of the track.
    pub outline: TrackOutline,
    /// [m] Convex polygon in the chassis frame, counter-clockwise; none if the body never touches.
    pub belly: Option<Vec<[f64; 2]>>,
    /// Pivoting arms.
    pub flippers: Option<Flippers>,
    /// [m] Lateral distance of the tracks.
    pub gauge: f64,
    /// Motors and their limits.
    pub drivetrain: Drivetrain,
    /// How the track is modelled.
    pub track: Track,
}

/// The closed outline of the track: two arcs and their outer tangents, to the grouser tips.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackOutline {
    /// [m] Distance of the end axles.
    pub axle_distance: f64,
    /// [m] Front radius to the grouser tips.
    pub front_radius: f64,
    /// [m] Rear radius to the grouser tips.
    pub rear_radius: f64,
    /// [m] Height of the grousers above the belt.
    pub grouser_height: f64,
    /// [m] Distance of the grousers along the belt.
    pub grouser_pitch: f64,
    /// [m] Thickness of a grouser along the belt.
    pub grouser_thickness: f64,
}

/// What drives the track, and within which limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drivetrain {
    /// [m/s] Largest track speed.
    pub max_speed: f64,
    /// [m/s^2] Largest rate at which the commanded speed grows in magnitude.
    pub max_acceleration: f64,
    /// [m/s^2] Largest rate at which the commanded speed falls in magnitude.
    pub max_deceleration: f64,
    /// [N m] Largest torque of one sprocket at the belt radius; the robot has two.
    pub max_torque: f64,
    /// Who shares the torque.
    pub torque_sharing: TorqueSharing,
}

/// How the torque of a track is shared by its wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueSharing {
    /// One motor a track: all surfaces keep one speed, the sum of their traction is limited.
    Track,
    /// Every wheel has its own servo and an equal share of the torque.
    Wheel,
}

impl TrackOutline {
    /// [m] Radius of the belt, where the sprocket's torque acts (the rear end drives).
    pub fn belt_radius(&self) -> f64 {
        self.rear_radius - self.grouser_height
    }

    /// How many grousers come nearest to the pitch along a belt of a length [m], at least `least`.
    ///
    /// # Errors
    /// More than `most`: the bounds are those of a number that is given.
    pub(crate) fn pitches_along(
        &self,
        length: f64,
        [least, most]: [u32; 2],
    ) -> Result<u32, ScenarioError> {
        let count = (length / self.grouser_pitch).round();
        if count <= f64::from(most) {
            return Ok((count as u32).max(least));
        }
        let rule = format!("must leave at most {most} grousers on a belt of {length:.4} m");
        let path = "robot.outline.grouser_pitch";
        Err(ScenarioError::new(path, self.grouser_pitch, rule))
    }
}

impl Drivetrain {
    /// [N] Largest traction of both tracks together.
    pub fn max_force(&self, outline: &TrackOutline) -> f64 {
        2.0 * self.max_torque / outline.belt_radius()
    }
}

impl Robot {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let robot = Self {
            name: f.text("name")?.to_owned(),
            mass: f.number("mass", MASS)?,
            center_of_mass: f.point("center_of_mass", COORDINATE)?,
            moment_of_inertia: f
                .number("moment_of_inertia", Range::between(1e-9, 1e9, "kg m^2"))?,
            track_mass: f.number("track_mass", MASS)?,
            outline: TrackOutline::read(f.child("outline")?)?,
            belly: read_belly(&mut f)?,
            flippers: if f.value("flippers")?.is_null() {
                None
            } else {
                Some(Flippers::read(f.child("flippers")?)?)
            },
            gauge: f.number("gauge", LENGTH)?,
            drivetrain: Drivetrain::read(f.child("drivetrain")?)?,
            track: Track::read(f.child("track")?)?,
        };
        robot.check(&f)?;
        robot.track.check(&robot)?;
        if let Some(flippers) = &robot.flippers {
            flippers.check(&robot)?;
        }
        f.finish()?;
        Ok(robot)
    }

    /// Rules that join several fields.
    fn check(&self, f: &Fields) -> Result<(), ScenarioError> {
        if self.track_mass >= self.mass {
            return Err(f.error(
                "track_mass",
                self.track_mass,
                format!("must be below robot.mass = {} kg", self.mass),
            ));
        }
        let o = &self.outline;
        let radius = o.front_radius.max(o.rear_radius);
        let circulating = self.track_mass * radius * radius;
        if circulating >= self.moment_of_inertia {
            return Err(f.error(
                "moment_of_inertia",
                self.moment_of_inertia,
                format!("must exceed track_mass x radius^2 = {circulating} kg m^2, the part that turns with the track"),
            ));
        }
        Ok(())
    }
}

/// A convex counter-clockwise polygon of non-zero area.
fn read_belly(f: &mut Fields) -> Result<Option<Vec<[f64; 2]>>, ScenarioError> {
    const MOST: usize = 64;
    if f.value("belly")?.is_null() {
        return Ok(None);
    }
    let points = f.points("belly", COORDINATE, MOST)?;
    let n = points.len();
    if n < 3 {
        return Err(f.error(
            "belly",
            format!("{n} points"),
            "must have at least 3 points",
        ));
    }
    for i in 0..n {
        let ([ax, ay], [bx, by], [cx, cy]) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        let turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx);
        if turn <= 0.0 {
            let corner = format!("belly[{}]", (i + 1) % n);
            return Err(f.error(
                &corner,
                format!("[{bx}, {by}]"),
                "must be a corner of a convex counter-clockwise polygon",
            ));
        }
    }
    // Left turns alone may still add up to more than one round, as in a pentagram.
    let is_up = |i: usize| {
        let ([ax, ay], [bx, by]) = (points[i % n], points[(i + 1) % n]);
        (by, bx) > (ay, ax)
    };
    if (0..n).filter(|i| !is_up(*i) && is_up(i + 1)).count() != 1 {
        let rule = "must be a convex counter-clockwise polygon: this one goes round more than once";
        return Err(f.error("belly", format!("{n} points"), rule));
    }
    Ok(Some(points))
}

impl TrackOutline {
    fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let outline = Self {
            axle_distance: f.number("axle_distance", LENGTH)?,
            front_radius: f.number("front_radius", LENGTH)?,
            rear_radius: f.number("rear_radius", LENGTH)?,
            grouser_height: f.number("grouser_height", LENGTH_OR_ZERO)?,
            grouser_pitch: f.number("grouser_pitch", LENGTH)?,
            grouser_thickness: f.number("grouser_thickness", LENGTH_OR_ZERO)?,
        };
        let smallest = outline.front_radius.min(outline.rear_radius);
        if outline.grouser_height >= smallest {
            let rule = format!("must be below the smaller radius, {smallest} m: no belt is left");
            return Err(f.error("grouser_height", outline.grouser_height, rule));
        }
        if outline.grouser_thickness >= outline.grouser_pitch {
            let rule = format!(
                "must be below the pitch, {} m: grousers would overlap",
                outline.grouser_pitch
            );
            return Err(f.error("grouser_thickness", outline.grouser_thickness, rule));
        }
        if (outline.front_radius - outline.rear_radius).abs() >= outline.axle_distance {
            let rule = "must differ from rear_radius by less than the axle distance: one end would swallow the other";
            return Err(f.error("front_radius", outline.front_radius, rule));
        }
        f.finish()?;
        Ok(outline)
    }
}

impl Drivetrain {
    fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let sharing = [
            ("track", TorqueSharing::Track),
            ("wheel", TorqueSharing::Wheel),
        ];
        let drivetrain = Self {
            max_speed: f.number("max_speed", Range::above(0.0, 100.0, "m/s"))?,
            max_acceleration: f.number("max_acceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_deceleration: f.number("max_deceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_torque: f.number("max_torque", Range::between(0.0, 1e6, "N m"))?,
            torque_sharing: f.choice("torque_sharing", &sharing)?,
        };
        f.finish()?;
        Ok(drivetrain)
    }
}
