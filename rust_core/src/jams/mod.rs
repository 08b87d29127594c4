//! All poses in which a robot can stand still with its drives running, which is where a model of its track can jam:
//! computed, not sampled.
//!
//! Driven surfaces slide at every contact in a known direction, so each contact has one unknown, its normal force.
//! Three contacts fix the pose and their forces; two or one leave as many degrees of freedom as they lack forces. So
//! all equilibria are isolated, and each is a zero of a polynomial. docs/studies/jams.md, "Theory".

pub(crate) mod certify;
mod clear;
mod contact;
mod fixed;
mod forces;
mod jam;
mod layout;
mod leaning;
mod places;
mod ranges;
mod setting;
#[cfg(test)]
mod tests;
mod zeros;

pub use self::certify::{Certificate, ExcludedCell, Exclusion, Region, RegionStatus, SearchEffort};
use self::contact::Posture;
pub use self::jam::{Jam, JamContact};
use self::layout::Layout;
use self::places::Place;
use self::setting::{Setting, is_same};
use crate::error::Error;
use crate::geometry::Vector;
use crate::limits::Cancel;
use crate::robot::Model;
use crate::scenario::{Scenario, ScenarioError};
use crate::terrain::Ground;

/// All jams of the robot of a scenario, built on its ground, from the rear. Torque is not limited, and flippers stay as
/// at the start.
///
/// # Errors
/// [`Error::Scenario`] for a robot whose shape turns with its drives, one that is not driven, a ground that differs
/// between the tracks; [`Error::Interrupted`] once `cancel` is asked.
pub(crate) fn jams(
    scenario: &Scenario,
    built: (&Model, &Ground),
    cancel: &Cancel,
) -> Result<Vec<Jam>, Error> {
    let setting = setting(scenario, built, cancel)?;
    let fixed = setting.fixed(cancel)?.into_iter();
    let leaning = setting.leaning(cancel)?;
    let mut found: Vec<(Posture, Jam)> = Vec::new();
    for posture in fixed.chain(leaning) {
        if found.iter().any(|(known, _)| is_same(known, &posture)) {
            continue;
        }
        let Some(contacts) = setting.touching(&posture) else {
            continue;
        };
        if let Some(loads) = setting.loads(&contacts, &posture) {
            found.push((posture, setting.jam(&posture, &contacts, &loads)));
        }
    }
    let mut jams: Vec<Jam> = found.into_iter().map(|(_, jam)| jam).collect();
    jams.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
    Ok(jams)
}

/// A pose that three contacts fix, and the friction at which they carry the robot there.
#[derive(Clone, Copy, Debug)]
pub struct JamRange {
    /// [m] Position of the chassis frame.
    pub position: Vector,
    /// [rad] Its angle.
    pub angle: f64,
    /// The smallest and the largest friction.
    pub friction: [f64; 2],
}

/// The jams on three contacts at any friction up to `most`, regardless of the ground's own; see [`jams`].
///
/// # Errors
/// As [`jams`].
pub(crate) fn jam_ranges(
    scenario: &Scenario,
    built: (&Model, &Ground),
    most: f64,
    cancel: &Cancel,
) -> Result<Vec<JamRange>, Error> {
    let setting = setting(scenario, built, cancel)?.with_unit_friction();
    let mut found = Vec::new();
    for posture in setting.fixed(cancel)? {
        let contacts = setting.touching(&posture).unwrap_or_default();
        let ranges = setting.carried_at(&contacts, &posture, most);
        found.extend(ranges.into_iter().map(|friction| JamRange {
            position: posture.position,
            angle: posture.angle,
            friction,
        }));
    }
    Ok(found)
}

fn setting(
    scenario: &Scenario,
    (model, ground): (&Model, &Ground),
    cancel: &Cancel,
) -> Result<Setting, Error> {
    check(scenario, ground)?;
    let layout = Layout::new(model, scenario.drive.speed > 0.0)?;
    let most = scenario.criteria.tip_over_angle;
    Setting::new(layout, Place::of(ground), [-most, most], cancel)
}

/// Refuses scenarios without isolated jams.
fn check(scenario: &Scenario, ground: &Ground) -> Result<(), ScenarioError> {
    if ground.tracks > 1 {
        let rule = "must be the same under both tracks";
        return Err(ScenarioError::new("terrain", "two lanes", rule));
    }
    if let Some(path) = scenario.terrain.path_of_segments("terrain") {
        let rule = "must be null for jams, whose faces have one friction each";
        return Err(ScenarioError::new(path, "a list", rule));
    }
    if scenario.drive.speed == 0.0 {
        let rule = "must not be 0: jams are of a robot that drives";
        return Err(ScenarioError::new("drive.speed", 0.0, rule));
    }
    let friction = ground.lanes.iter().map(|lane| lane.friction.most());
    if friction.map(|f| f.coefficient).fold(0.0, f64::max) <= 0.0 {
        let rule = "must be > 0: without it a robot can stand anywhere on level ground";
        return Err(ScenarioError::new("terrain.friction", 0.0, rule));
    }
    Ok(())
}
