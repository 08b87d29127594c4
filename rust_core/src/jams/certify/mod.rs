//! Certificates: that a robot cannot stand still with its drives running anywhere in a range of heights, frictions and
//! centres of mass, other than as a belt would.
//!
//! Ranges of pose and parameters, together, are split until each half is excluded: no disc can touch there, one overlaps with
//! the ground, no ground is inside the track, forces cannot carry the weight, or what they carry tips over by itself.
//! docs/studies/jams.md, "Certificates".

mod balance;
mod cell;
mod family;
mod held;
mod inside;
mod interval;
mod regions;
mod search;
mod tipping;
mod touch;

use self::balance::Twist;
use self::cell::NUMBERS;
use self::family::{Family, check_wheels};
use self::regions::Pair;
use super::{Jam, check};
use crate::error::Error;
use crate::limits::Cancel;
use crate::robot::Model;
use crate::scenario::Scenario;
use crate::terrain::Ground;

/// Why a robot cannot stand in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exclusion {
    /// Nothing can touch.
    Apart,
    /// A part overlaps with the ground.
    Overlap,
    /// No ground is inside the track: a belt stands there as well.
    Belt,
    /// The weight works with a virtual motion that no force works against.
    Unbalanced,
    /// One wheel or two can carry it, but small deviations grow.
    Tips,
}

/// Ranges of pose and parameters in which a robot cannot stand, and why.
#[derive(Clone, Copy, Debug)]
pub struct ExcludedCell {
    /// Least values: x \[m\], y \[m\] and angle \[rad\] of the chassis frame, then shares of the parameters' ranges.
    pub low: [f64; NUMBERS],
    /// Greatest values.
    pub high: [f64; NUMBERS],
    /// Why.
    pub exclusion: Exclusion,
    /// The virtual motion, if that is what excludes it: velocity of the centre of mass and rate of turning times
    /// [`Certificate::length`].
    pub twist: Twist,
}

/// What is known of a range of parameters.
#[derive(Clone, Debug)]
pub enum RegionStatus {
    /// It cannot stand still anywhere in it; so many cells show that.
    Certified(usize),
    /// It can at these shares of the parameters' ranges.
    Jams(Vec<f64>, Jam),
    /// It may, but a belt can as well, at every value.
    AsBelt,
    /// None of these is shown.
    Undecided,
}

/// A range of each parameter, as shares of the whole.
#[derive(Clone, Debug)]
pub struct Region {
    /// Least values.
    pub low: Vec<f64>,
    /// Greatest values.
    pub high: Vec<f64>,
    /// What is known of it.
    pub status: RegionStatus,
}

/// What is known of all parameters.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// They cover the whole range, and do not overlap.
    pub regions: Vec<Region>,
    /// What shows it for those that are certified, one after the other, if that was asked for.
    pub cells: Vec<ExcludedCell>,
    /// \[m\] What moments are divided by.
    pub length: f64,
}

/// How far to search.
#[derive(Clone, Copy, Debug)]
pub struct SearchEffort {
    /// \[m\] Ground less deep inside the track is left to the belt.
    pub depth: f64,
    /// Regions are split until they are this share of the whole along each parameter.
    pub smallest: f64,
    /// So many cells are tried for each region.
    pub cells: usize,
    /// Whether to return them.
    pub keeps_cells: bool,
}

/// Which parameters there are no jams at that a belt does not have.
///
/// `built` is robot and ground at the least values of all parameters, then at the most of each alone, of all, and half way
/// between; `belts` the same with a belt round its wheels.
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
