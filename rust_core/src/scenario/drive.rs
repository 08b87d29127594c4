//! Commands of a driver: the speed of the tracks, and the motion of the flippers.

use serde::Serialize;

use super::ScenarioError;
use super::drivetrain::Drivetrain;
use super::fields::{Checked, Fields, Range, one_of};
use super::objects::{FromJson, kinds, object};
use super::robot::ANGLE;

const SPEED: Range = Range::between(-100.0, 100.0, "m/s");
/// Largest number of entries of a schedule.
const MOST: usize = 10_000;

object! {
    /// The commands of a run.
    pub struct Drive {
        /// [m/s] Track speed; positive drives towards +x.
        speed: f64 = number(SPEED),
        /// [s], [m/s] Increasing times and the speeds that apply from then on; `None` keeps the speed.
        schedule: Option<Vec<[f64; 2]>> = schedule(("speed", SPEED)),
        /// The motion of the flippers; `None` holds them at their initial angle.
        gait: Option<Gait> = optional_object(),
    }
}

kinds! {
    /// A rule by which a driver moves the flippers.
    pub enum Gait {
        /// Angles by a schedule.
        "hold" Hold(Hold),
        /// Reach up to meet an obstacle, sweep down to lift the chassis over it.
        "climb" Climb(Climb),
    }
}

object! {
    /// Holds the flippers at an angle, which a schedule can change.
    pub struct Hold {
        /// [rad] Angle relative to the chassis, upwards > 0.
        angle: f64 = number(ANGLE),
        /// [s], [rad] Increasing times and the angles that apply from then on; `None` keeps the angle.
        schedule: Option<Vec<[f64; 2]>> = schedule(("angle", ANGLE)),
        /// [rad] Of the front flippers all the time; `None` follows the angle and its schedule.
        #[serde(skip_serializing_if = "Option::is_none")]
        front: Option<f64> = if_given(|f, name| f.optional_number(name, ANGLE)),
        /// [rad] The same of the rear ones.
        #[serde(skip_serializing_if = "Option::is_none")]
        rear: Option<f64> = if_given(|f, name| f.optional_number(name, ANGLE)),
    }
}

object! {
    /// Angles of the flippers in the phases of a climb.
    pub struct Climb {
        /// [rad] Of the front flippers relative to the chassis, until they bear on something.
        reach_angle: f64 = number(ANGLE),
        /// [rad] Of the front flippers relative to the horizontal, from then on until the chassis is over.
        sweep_angle: f64 = number(ANGLE),
        /// [rad] Of the rear flippers relative to the horizontal, as long as the chassis is raised.
        push_angle: f64 = number(ANGLE),
        /// [rad] Chassis angle above which the chassis counts as raised.
        level_angle: f64 = number(Range::above(0.0, 1.5, "rad")),
    }
}

impl Drive {
    /// Checks that no commanded speed exceeds the drivetrain's.
    pub(crate) fn check(&self, drivetrain: &Drivetrain) -> Checked<()> {
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

impl Fields<'_> {
    /// Reads rows of a time [s] and a value, with increasing times; or null.
    fn schedule(
        &mut self,
        name: &'static str,
        value: (&str, Range),
    ) -> Checked<Option<Vec<[f64; 2]>>> {
        let columns = [("time", Range::between(0.0, 1e5, "s")), value];
        let rows = self.unless_null(name, |f, name| f.rows(name, columns, MOST))?;
        for (i, pair) in rows.iter().flat_map(|rows| rows.windows(2)).enumerate() {
            let ([before, _], [time, _]) = (pair[0], pair[1]);
            if time <= before {
                let rule = format!("must be later than the previous entry, {before} s");
                return Err(self.error(&format!("{name}[{}][0]", i + 1), time, rule));
            }
        }
        Ok(rows)
    }
}
