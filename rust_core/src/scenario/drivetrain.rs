//! What drives the tracks.

use serde::Serialize;

use super::fields::{Fields, ROTOR, Range, TORQUE, is_false, is_zero};
use super::{ScenarioError, TrackOutline};

const FASTEST: Range = Range::above(0.0, 100.0, "m/s");
/// Largest number of points of a torque curve.
const MOST: usize = 1000;

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
    /// [m/s] Track speed at which the torque of a motor, which falls in a line from its largest at rest, is used up; `None`
    /// if it has that at any speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_load_speed: Option<f64>,
    /// [m/s], [N m] Track speeds and torques of one sprocket there, which fall from the largest at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_curve: Option<Vec<[f64; 2]>>,
    /// How a motor corrects its speed; `None` if it holds that as long as its torque suffices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controller: Option<Pi>,
    /// The gear locks itself: the load turns no motor back, nor faster than that turns by itself.
    #[serde(skip_serializing_if = "is_false")]
    pub self_locking: bool,
}

/// A controller of the speed of a sprocket, whose torque is in proportion to the error, and to the error's sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename = "pi")]
pub struct Pi {
    /// [N m s/rad] Torque of one sprocket for an error of its rate.
    pub gain: f64,
    /// [N m/rad] Torque for an error of its angle.
    pub integral: f64,
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
}

impl Drivetrain {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let sharing = [
            ("track", TorqueSharing::Track),
            ("wheel", TorqueSharing::Wheel),
        ];
        let drivetrain = Self {
            max_speed: f.number("max_speed", FASTEST)?,
            max_acceleration: f.number("max_acceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_deceleration: f.number("max_deceleration", Range::above(0.0, 1e6, "m/s^2"))?,
            max_torque: f.number("max_torque", TORQUE)?,
            torque_sharing: f.choice("torque_sharing", &sharing)?,
            rotor_inertia: f.number_or_zero("rotor_inertia", ROTOR)?,
            no_load_speed: if f.has("no_load_speed") {
                f.optional_number("no_load_speed", FASTEST)?
            } else {
                None
            },
            torque_curve: if f.has("torque_curve") {
                read_curve(&mut f)?
            } else {
                None
            },
            controller: if f.has("controller") && !f.value("controller")?.is_null() {
                Some(Pi::read(f.child("controller")?)?)
            } else {
                None
            },
            self_locking: f.flag_or_false("self_locking")?,
        };
        if drivetrain.self_locking && drivetrain.controller.is_some() {
            let rule = "must be false with a controller: the load never reaches the motor, so there is no error to correct";
            return Err(f.error("self_locking", true, rule));
        }
        if let (Some(_), Some(speed)) = (&drivetrain.torque_curve, drivetrain.no_load_speed) {
            let rule =
                "must not be given together with torque_curve, which says where the torque ends";
            return Err(f.error("no_load_speed", speed, rule));
        }
        f.finish()?;
        Ok(drivetrain)
    }
}

impl Pi {
    fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        f.choice("kind", &[("pi", ())])?;
        let pi = Self {
            gain: f.number("gain", Range::above(0.0, 1e17, "N m s/rad"))?,
            integral: f.number("integral", Range::between(0.0, 1e17, "N m/rad"))?,
        };
        f.finish()?;
        Ok(pi)
    }
}

/// Reads torques at track speeds, which start at rest with the largest and fall.
fn read_curve(f: &mut Fields) -> Result<Option<Vec<[f64; 2]>>, ScenarioError> {
    if f.value("torque_curve")?.is_null() {
        return Ok(None);
    }
    let speeds = Range::between(0.0, 100.0, "m/s");
    let curve = f.rows(
        "torque_curve",
        [("speed", speeds), ("torque", TORQUE)],
        MOST,
    )?;
    let Some([from, largest]) = curve.first().copied() else {
        let rule = "must have at least one pair of a speed and a torque";
        return Err(f.error("torque_curve", "[]", rule));
    };
    if from != 0.0 {
        return Err(f.error(
            "torque_curve[0][0]",
            from,
            "must be 0 m/s: the torque at rest",
        ));
    }
    let most = f.number("max_torque", TORQUE)?;
    if (largest - most).abs() > 1e-9 * most {
        let rule = format!("must be max_torque = {most} N m, the torque at rest");
        return Err(f.error("torque_curve[0][1]", largest, rule));
    }
    for (i, pair) in curve.windows(2).enumerate() {
        let ([speed, torque], [next, left]) = (pair[0], pair[1]);
        if next <= speed {
            let rule = format!("must exceed the speed of the pair before, {speed} m/s");
            return Err(f.error(&format!("torque_curve[{}][0]", i + 1), next, rule));
        }
        if left > torque {
            let rule = format!("must not exceed the torque of the pair before, {torque} N m");
            return Err(f.error(&format!("torque_curve[{}][1]", i + 1), left, rule));
        }
    }
    Ok(Some(curve))
}
