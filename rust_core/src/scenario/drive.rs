//! What a driver commands: the speed of the tracks, and how the flippers move.

use serde::Serialize;

use super::ScenarioError;
use super::drivetrain::Drivetrain;
use super::fields::{Fields, Range, one_of};
use super::robot::ANGLE;

const SPEED: Range = Range::between(-100.0, 100.0, "m/s");
/// Largest number of entries of a schedule.
const MOST: usize = 10_000;

/// The commands of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drive {
    /// [m/s] Track speed; positive drives towards +x.
    pub speed: f64,
    /// [s], [m/s] Increasing times and the speeds that apply from then on; `None` keeps the speed.
    pub schedule: Option<Vec<[f64; 2]>>,
    /// How the flippers move; `None` holds them where they start.
    pub gait: Option<Gait>,
}

/// A rule by which a driver moves the flippers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Gait {
    /// Angles by a schedule.
    Hold(Hold),
    /// Reach up to meet an obstacle, sweep down to lift the chassis over it.
    Climb(Climb),
}

/// Holds the flippers at an angle, which a schedule can change.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Hold {
    /// [rad] Angle relative to the chassis, upwards > 0.
    pub angle: f64,
    /// [s], [rad] Increasing times and the angles that apply from then on; `None` keeps the angle.
    pub schedule: Option<Vec<[f64; 2]>>,
}

/// Angles of the flippers in the phases of a climb.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Climb {
    /// [rad] Of the front flippers relative to the chassis, until they bear on something.
    pub reach_angle: f64,
    /// [rad] Of the front flippers relative to the horizontal, from then on until the chassis is over.
    pub sweep_angle: f64,
    /// [rad] Of the rear flippers relative to the horizontal, as long as the chassis is raised.
    pub push_angle: f64,
    /// [rad] Chassis angle above which the chassis counts as raised.
    pub level_angle: f64,
}

impl Drive {
    pub(super) fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        let drive = Self {
            speed: f.number("speed", SPEED)?,
            schedule: read_schedule(&mut f, ("speed", SPEED))?,
            gait: if f.value("gait")?.is_null() {
                None
            } else {
                Some(Gait::read(f.child("gait")?)?)
            },
        };
        f.finish()?;
        Ok(drive)
    }

    /// Checks that no commanded speed exceeds the drivetrain's.
    pub(crate) fn check(&self, drivetrain: &Drivetrain) -> Result<(), ScenarioError> {
        let limit = drivetrain.max_speed;
        let (path, speed) = self.fastest();
        if speed.abs() <= limit {
            return Ok(());
        }
        let rule = format!("must not exceed robot.drivetrain.max_speed = {limit} m/s");
        Err(ScenarioError::new(path, speed, rule))
    }

    /// [m/s] The commanded speed of largest magnitude, with the path of its field.
    fn fastest(&self) -> (String, f64) {
        let later = self.schedule.iter().flatten().enumerate();
        let later = later.map(|(i, [_, speed])| (format!("drive.schedule[{i}][1]"), *speed));
        let first = ("drive.speed".to_owned(), self.speed);
        later.fold(first, |most, next| {
            if next.1.abs() > most.1.abs() {
                next
            } else {
                most
            }
        })
    }
}

impl Gait {
    fn read(mut f: Fields) -> Result<Self, ScenarioError> {
        const KINDS: [&str; 2] = ["hold", "climb"];
        let gait = match f.text("kind")? {
            "hold" => Self::Hold(Hold {
                angle: f.number("angle", ANGLE)?,
                schedule: read_schedule(&mut f, ("angle", ANGLE))?,
            }),
            "climb" => Self::Climb(Climb {
                reach_angle: f.number("reach_angle", ANGLE)?,
                sweep_angle: f.number("sweep_angle", ANGLE)?,
                push_angle: f.number("push_angle", ANGLE)?,
                level_angle: f.number("level_angle", Range::above(0.0, 1.5, "rad"))?,
            }),
            other => return Err(f.error("kind", other, one_of(Some(other), &KINDS))),
        };
        f.finish()?;
        Ok(gait)
    }
}

/// Reads rows of a time [s] and a value, with increasing times.
fn read_schedule(
    f: &mut Fields,
    value: (&str, Range),
) -> Result<Option<Vec<[f64; 2]>>, ScenarioError> {
    if f.value("schedule")?.is_null() {
        return Ok(None);
    }
    let time = Range::between(0.0, 1e5, "s");
    let rows = f.rows("schedule", [("time", time), value], MOST)?;
    for i in 1..rows.len() {
        if rows[i][0] <= rows[i - 1][0] {
            let rule = format!(
                "must be later than the previous entry, {} s",
                rows[i - 1][0]
            );
            return Err(f.error(&format!("schedule[{i}][0]"), rows[i][0], rule));
        }
    }
    Ok(Some(rows))
}
