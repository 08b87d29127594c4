//! Results and limits of a search.

use super::balance::Twist;
use super::cell::NUMBERS;
use crate::jams::jam::Jam;

/// Why a robot cannot stand in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exclusion {
    /// Nothing can touch.
    Apart,
    /// A part overlaps with the ground.
    Overlap,
    /// No ground is inside the track, so a belt can stand there, too.
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
