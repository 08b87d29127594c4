//! Certificates that a robot cannot stand still with its drives running anywhere in a range of heights, friction and
//! centres of mass, except where a belt could as well.
//!
//! Ranges of pose and parameters together are split until each part is excluded: no disc can touch there, one overlaps
//! with the ground, no ground is inside the track, forces cannot carry the weight, or the balance is unstable.
//! docs/studies/jams.md, "Certificates".

mod balance;
mod cell;
mod family;
mod found;
mod held;
mod inside;
mod interval;
mod regions;
mod search;
#[cfg(test)]
mod tests;
mod tipping;
mod touch;

use self::family::{Family, check_wheels};
pub use self::found::{Certificate, ExcludedCell, Exclusion, Region, RegionStatus, SearchEffort};
use self::regions::Pair;
use super::check;
use crate::error::Error;
use crate::limits::Cancel;
use crate::robot::Model;
use crate::scenario::Scenario;
use crate::terrain::Ground;

/// Certifies at which values of parameters there are no jams that a belt does not have.
///
/// `built` has robot and ground with the smallest values of all parameters, the largest of each alone, the largest of
/// all, and the middle of all; `belts` are the same with a belt round the wheels.
///
/// # Errors
/// As [`super::jams`], and for parameters that change what they may not.
pub(crate) fn certify(
    scenario: &Scenario,
    [built, belts]: [&[(&Model, &Ground)]; 2],
    names: &[String],
    effort: SearchEffort,
    cancel: &Cancel,
) -> Result<Certificate, Error> {
    check(scenario, built[0].1)?;
    let forwards = scenario.drive.speed > 0.0;
    let most_angle = scenario.criteria.tip_over_angle;
    let family = |built| Family::new(built, names, forwards, most_angle);
    let pair = Pair {
        wheels: family(built)?,
        belt: family(belts)?,
        effort,
    };
    check_wheels(&pair.wheels.layout)?;
    pair.certificate(cancel)
}
