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
    /// The weight does positive work in a virtual motion in which no force does negative work.
    Unbalanced,
    /// One or two wheels can carry it, but small deviations grow.
    Tips,
}

/// Ranges of pose and parameters in which a robot cannot stand, and why.
#[derive(Clone, Copy, Debug)]
pub struct ExcludedCell {
    /// Smallest values: x \[m\], y \[m\] and angle \[rad\] of the chassis frame, then fractions of the parameters'
    /// ranges.
    pub low: [f64; NUMBERS],
    /// Greatest values.
    pub high: [f64; NUMBERS],
    /// The reason.
    pub exclusion: Exclusion,
    /// The virtual motion, if one excludes it: velocity of the centre of mass, and rate of rotation times
    /// [`Certificate::length`].
    pub twist: Twist,
}

/// The status of a range of parameters.
#[derive(Clone, Debug)]
pub enum RegionStatus {
    /// The robot cannot stand still anywhere in it, as this number of cells shows.
    Certified(usize),
    /// It can, at these fractions of the parameters' ranges.
    Jams(Vec<f64>, Jam),
    /// It may, but so can a belt, at every value.
    AsBelt,
    /// Undecided.
    Undecided,
}

/// A part of the range of each parameter, in fractions of the whole range.
#[derive(Clone, Debug)]
pub struct Region {
    /// Least values.
    pub low: Vec<f64>,
    /// Greatest values.
    pub high: Vec<f64>,
    /// Its status.
    pub status: RegionStatus,
}

/// The result for the whole range of the parameters.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// Regions that cover the whole range, without overlaps.
    pub regions: Vec<Region>,
    /// The proof for the certified regions, one after the other, if requested.
    pub cells: Vec<ExcludedCell>,
    /// \[m\] Length by which moments are divided.
    pub length: f64,
}

/// How far to search.
#[derive(Clone, Copy, Debug)]
pub struct SearchEffort {
    /// \[m\] Ground less deep inside the track does not count: a belt stands there as well.
    pub depth: f64,
    /// Regions are split until they are this fraction of the whole range along each parameter.
    pub smallest: f64,
    /// Largest number of cells tried for each region.
    pub cells: usize,
    /// Whether to return the cells.
    pub keeps_cells: bool,
}
