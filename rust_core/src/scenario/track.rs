//! How the track is modelled: one variant a family of the literature.

use serde::Serialize;

use super::fields::{Fields, Range, one_of};
use super::robot::{Robot, TorqueSharing};
use crate::error::ScenarioError;

/// A model of the same built track.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Track {
    /// Wheels on the straight line between the end axles.
    Line(LineOfWheels),
    /// A smooth closed belt whose surface moves along the outline.
    Belt(BeltTrack),
    /// No track at all: the drive pushes the chassis.
    Force(ForceTrack),
}

/// Wheels on one straight line, overlapping, touching or spaced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineOfWheels {
    /// Number of wheels a side, the end axles included.
    pub count: u32,
    /// [m] Radius of every wheel; none takes the outline's, linear between unequal ends.
    pub wheel_radius: Option<f64>,
    /// The wheel itself.
    pub wheel: Wheel,
}

/// The shape of a wheel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Wheel {
    /// A disc.
    Round,
}

/// A smooth belt; it has no parameters of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeltTrack {}

/// The drive acts on the chassis as a force along it at axle height, in the air too.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForceTrack {
    /// What the robot slides or rolls on.
    pub support: ForceSupport,
    /// Friction of the skids; the terrain's own friction caps it.
    pub skid_friction: f64,
}

/// What carries a robot that is pushed by a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceSupport {
    /// Skid runners of the outline's shape.
    Skids,
}

impl Track {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const KINDS: [&str; 3] = ["line", "belt", "force"];
        let kind = f.text("kind")?;
        let track = match kind {
            "line" => Self::Line(LineOfWheels {
                count: f.integer("count", 2, 200)?,
                wheel_radius: f
                    .optional_number("wheel_radius", Range::between(1e-3, 100.0, "m"))?,
                wheel: Wheel::read(f.child("wheel")?)?,
            }),
            "belt" => Self::Belt(BeltTrack {}),
            "force" => Self::Force(ForceTrack {
                support: f.choice("support", &[("skids", ForceSupport::Skids)])?,
                skid_friction: f.number("skid_friction", Range::between(0.0, 100.0, ""))?,
            }),
            other => return Err(f.error("kind", other, one_of(Some(other), &KINDS))),
        };
        f.finish()?;
        Ok(track)
    }

    /// Rules that join the model with the robot.
    pub(super) fn check(&self, robot: &Robot) -> Result<(), ScenarioError> {
        if robot.drivetrain.torque_sharing == TorqueSharing::Wheel && !matches!(self, Self::Line(_))
        {
            let rule = "must be \"track\" for a model without wheels";
            return Err(ScenarioError::new(
                "robot.drivetrain.torque_sharing",
                "wheel",
                rule,
            ));
        }
        Ok(())
    }
}

impl Wheel {
    fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let kind = f.text("kind")?;
        let wheel = match kind {
            "round" => Self::Round,
            other => return Err(f.error("kind", other, one_of(Some(other), &["round"]))),
        };
        f.finish()?;
        Ok(wheel)
    }
}
