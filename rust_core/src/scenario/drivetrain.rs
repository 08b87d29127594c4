//! What drives the tracks.

use serde::Serialize;

use super::fields::{Fields, ROTOR, Range, TORQUE, is_zero};
use super::{ScenarioError, TrackOutline};

/// What drives the tracks, and its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drivetrain {
    /// [m/s] Largest track speed.
    pub max_speed: f64,
    /// [m/s^2] Largest rate at which the commanded speed rises in magnitude.
    pub max_acceleration: f64,
    /// [m/s^2] Largest rate at which the commanded speed falls in magnitude.
    pub max_deceleration: f64,
    /// [N m] Largest torque of one sprocket at the belt radius; the robot has two.
    pub max_torque: f64,
    /// How the torque is shared.
    pub torque_sharing: TorqueSharing,
    /// [kg m^2] Moment of inertia of one sprocket's motor as that feels it: the rotor's own times the square of the gear's
    /// ratio.
    #[serde(skip_serializing_if = "is_zero")]
    pub rotor_inertia: f64,
}

/// How the wheels of a track share its torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueSharing {
    /// One motor per track: all surfaces have one speed, and the sum of their traction is limited.
    Track,
    /// Every wheel has its own servo and an equal share of the torque.
    Wheel,
}

impl Drivetrain {
    /// [N] Largest traction of both tracks together.
    pub fn max_force(&self, outline: &TrackOutline) -> f64 {
        2.0 * self.max_torque / outline.belt_radius()
    }

    /// [kg] Mass at the surface that would be as hard to speed up as the rotors of both tracks.
    pub(crate) fn rotor_mass(&self, outline: &TrackOutline) -> f64 {
        let radius = outline.belt_radius();
        2.0 * self.rotor_inertia / (radius * radius)
    }
}

impl Drivetrain {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let sharing = [
            ("track", TorqueSharing::Track),
            ("wheel", TorqueSharing::Wheel),
        ];
        let drivetrain = Self {
            max_speed: f.number("max_speed", Range::above(0.0, 100.0, "m/s"))?,
            max_acceleration: f.number("max_acceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_deceleration: f.number("max_deceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_torque: f.number("max_torque", TORQUE)?,
            torque_sharing: f.choice("torque_sharing", &sharing)?,
            rotor_inertia: f.number_or_zero("rotor_inertia", ROTOR)?,
        };
        f.finish()?;
        Ok(drivetrain)
    }
}
