//! Arms that pivot on the end axles of the robot, each with a track of its own.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, MASS, ROTOR, Range, SIZE, TORQUE, is_false, is_zero};
use super::outline::TrackOutline;
use super::track::Track;

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
