//! The outline of a track in side view.

use serde::Serialize;

use super::ScenarioError;
use super::fields::{Fields, Range};

/// [m] Plausible sizes of a tracked robot; a micrometre or a kilometre is a mistake of units.
pub(super) const LENGTH: Range = Range::between(1e-3, 100.0, "m");
const LENGTH_OR_ZERO: Range = Range::between(0.0, 100.0, "m");

/// The closed outline of the track: two arcs and their outer tangents, at the grouser tips.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackOutline {
    /// [m] Distance between the end axles.
    pub axle_distance: f64,
    /// [m] Front radius, measured to the grouser tips.
    pub front_radius: f64,
    /// [m] Rear radius, measured to the grouser tips.
    pub rear_radius: f64,
    /// [m] Height of the grousers above the belt.
    pub grouser_height: f64,
    /// [m] Spacing of the grousers along the belt.
    pub grouser_pitch: f64,
    /// [m] Thickness of a grouser along the belt.
    pub grouser_thickness: f64,
}

impl TrackOutline {
    /// [m] Radius of the belt at the rear, where the sprocket's torque acts.
    pub fn belt_radius(&self) -> f64 {
        self.rear_radius - self.grouser_height
    }

    /// Number of grousers that comes closest to the pitch on a belt of this length [m], at least `least`.
    ///
    /// # Errors
    /// The number would exceed `most`; the bounds are the same as for a given number.
    pub(crate) fn pitches_along(
        &self,
        length: f64,
        [least, most]: [u32; 2],
    ) -> Result<u32, ScenarioError> {
        let count = (length / self.grouser_pitch).round();
        if count <= f64::from(most) {
            return Ok((count as u32).max(least));
        }
        let rule =
            format!("must be large enough for at most {most} grousers on a belt of {length:.4} m");
        let path = "robot.outline.grouser_pitch";
        Err(ScenarioError::new(path, self.grouser_pitch, rule))
    }
}

impl TrackOutline {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
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
            let rule =
                format!("must be less than the smaller radius, {smallest} m, to leave a belt");
            return Err(f.error("grouser_height", outline.grouser_height, rule));
        }
        if outline.grouser_thickness >= outline.grouser_pitch {
            let rule = format!(
                "must be less than the pitch, {} m, or grousers would overlap",
                outline.grouser_pitch
            );
            return Err(f.error("grouser_thickness", outline.grouser_thickness, rule));
        }
        if (outline.front_radius - outline.rear_radius).abs() >= outline.axle_distance {
            let rule = "must differ from rear_radius by less than the axle distance: otherwise one end would enclose the other";
            return Err(f.error("front_radius", outline.front_radius, rule));
        }
        f.finish()?;
        Ok(outline)
    }
}
