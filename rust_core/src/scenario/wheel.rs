//! The shape of a wheel that represents a piece of track.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, Range, one_of};

/// Largest number of grousers of one wheel.
pub(crate) const MAX_GROUSERS: u32 = 200;

/// The shape of a wheel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Wheel {
    /// A disc.
    Round,
    /// A disc with grousers.
    Gear(GearWheel),
}

/// A wheel with grousers; fields that are `None` follow from the robot's outline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GearWheel {
    /// Grousers on the wheel.
    pub grouser_count: Option<u32>,
    /// [m] Radial height: the wheel's radius less that of its root circle.
    pub grouser_height: Option<f64>,
    /// [m] Thickness of a grouser at its tip.
    pub tip_thickness: Option<f64>,
    /// [m] Thickness of a grouser at the root circle; `None` takes that at the tip: parallel flanks.
    pub base_thickness: Option<f64>,
    /// Share of the angle between two grousers by which each wheel starts ahead of the previous one.
    pub phase_fraction: f64,
}

impl Wheel {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const SIZE: Range = Range::above(0.0, 100.0, "m");
        let wheel = match f.text("kind")? {
            "round" => Self::Round,
            "gear" => Self::Gear(GearWheel {
                grouser_count: f.optional_integer("grouser_count", 3, MAX_GROUSERS)?,
                grouser_height: f.optional_number("grouser_height", SIZE)?,
                tip_thickness: f.optional_number("tip_thickness", SIZE)?,
                base_thickness: f.optional_number("base_thickness", SIZE)?,
                phase_fraction: f.number("phase_fraction", Range::between(0.0, 1.0, ""))?,
            }),
            other => return Err(f.error("kind", other, one_of(Some(other), &["round", "gear"]))),
        };
        f.finish()?;
        Ok(wheel)
    }
}
