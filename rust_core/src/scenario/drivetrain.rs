//! The drivetrain of the tracks.

use serde::Serialize;

use super::TrackOutline;
use super::fields::{Checked, Fields, ROTOR, Range, TORQUE, is_false, is_zero, one_of};
use super::objects::{Choice, FromJson, choice, object};

const FASTEST: Range = Range::above(0.0, 100.0, "m/s");
/// Largest number of points of a torque curve.
const MOST: usize = 1000;

object! {
    /// The drivetrain of the tracks, and its limits.
    pub struct Drivetrain {
        /// [m/s] Largest track speed.
        max_speed: f64 = number(FASTEST),
        /// [m/s^2] Largest rate at which the commanded speed rises in magnitude.
        max_acceleration: f64 = number(Range::above(0.0, 1e6, "m/s^2")),
        /// [m/s^2] Largest rate at which the commanded speed falls in magnitude.
        max_deceleration: f64 = number(Range::above(0.0, 1e6, "m/s^2")),
        /// [N m] Largest torque of one sprocket at the belt radius; the robot has two.
        max_torque: f64 = number(TORQUE),
        /// How the torque is shared.
        torque_sharing: TorqueSharing = choice(),
        /// [kg m^2] Moment of inertia of one motor at its sprocket: that of the rotor times the square of the gear
        /// ratio.
        #[serde(skip_serializing_if = "is_zero")]
        rotor_inertia: f64 = number_or_zero(ROTOR),
        /// [m/s] Track speed at which the torque of a motor, which decreases linearly from its largest at rest, is 0;
        /// `None` if the torque does not depend on speed.
        #[serde(skip_serializing_if = "Option::is_none")]
        no_load_speed: Option<f64> = if_given(|f, name| f.optional_number(name, FASTEST)),
        /// [m/s], [N m] Track speeds and torques of one sprocket, which decrease from the largest at rest.
        #[serde(skip_serializing_if = "Option::is_none")]
        torque_curve: Option<Vec<[f64; 2]>> = if_given(read_curve),
        /// How a motor corrects its speed; `None` if it holds the speed as long as its torque suffices.
        #[serde(skip_serializing_if = "Option::is_none")]
        controller: Option<Pi> = if_given(Fields::optional_object),
        /// Whether the gear is self-locking: the load turns a motor neither back nor faster than it turns by itself.
        #[serde(skip_serializing_if = "is_false")]
        self_locking: bool = flag_or_false(),
    }
    then check
}

/// A controller of the speed of a sprocket, whose torque is proportional to the error and to its integral.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename = "pi")]
pub struct Pi {
    /// [N m s/rad] Torque of one sprocket for an error of its rate.
    pub gain: f64,
    /// [N m/rad] Torque for an error of its angle.
    pub integral: f64,
}

choice! {
    /// How the wheels of a track share its torque.
    pub enum TorqueSharing {
        /// One motor per track: all surfaces have one speed, and the sum of their traction is limited.
        "track" Track,
        /// Every wheel has its own servo and an equal share of the torque.
        "wheel" Wheel,
    }
}

impl Drivetrain {
    /// [N] Largest traction of both tracks together.
    pub fn max_force(&self, outline: &TrackOutline) -> f64 {
        2.0 * self.max_torque / outline.belt_radius()
    }

    /// Multiplies the torque of the motors at any speed, up to the largest allowed.
    pub(crate) fn scale_torque(&mut self, factor: f64) {
        let of_curve = self.torque_curve.iter_mut().flatten();
        for torque in of_curve
            .map(|[_, torque]| torque)
            .chain([&mut self.max_torque])
        {
            *torque = TORQUE.cut(*torque * factor);
        }
    }

    fn check(&self, f: &Fields) -> Checked<()> {
        if self.self_locking && self.controller.is_some() {
            let rule = "must be false with a controller: the load never reaches the motor, so there is no error to correct";
            return Err(f.error("self_locking", true, rule));
        }
        if let (Some(_), Some(speed)) = (&self.torque_curve, self.no_load_speed) {
            let rule =
                "must not be given together with torque_curve, which says where the torque ends";
            return Err(f.error("no_load_speed", speed, rule));
        }
        Ok(())
    }
}

impl FromJson for Pi {
    fn read(f: &mut Fields) -> Checked<Self> {
        match f.text("kind")? {
            "pi" => Ok(Self {
                gain: f.number("gain", Range::above(0.0, 1e17, "N m s/rad"))?,
                integral: f.number("integral", Range::between(0.0, 1e17, "N m/rad"))?,
            }),
            other => Err(f.error("kind", other, one_of(Some(other), &["pi"]))),
        }
    }
}

/// Reads torques at track speeds, which begin at rest with the largest and decrease.
fn read_curve(f: &mut Fields, name: &'static str) -> Checked<Option<Vec<[f64; 2]>>> {
    let columns = [
        ("speed", Range::between(0.0, 100.0, "m/s")),
        ("torque", TORQUE),
    ];
    let Some(curve) = f.unless_null(name, |f, name| f.rows(name, columns, MOST))? else {
        return Ok(None);
    };
    let Some([from, largest]) = curve.first().copied() else {
        let rule = "must have at least one pair of a speed and a torque";
        return Err(f.error("torque_curve", "[]", rule));
    };
    if from != 0.0 {
        let rule = "must be 0 m/s: the torque at rest";
        return Err(f.error("torque_curve[0][0]", from, rule));
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
