//! Splits the range of parameters if a robot can jam at some values and not at others.

use super::cell::{Cell, Shares};
use super::family::Family;
use super::found::{Certificate, ExcludedCell, Region, RegionStatus, SearchEffort};
use super::search::Found;
use crate::error::{Error, LimitError};
use crate::jams::contact::Posture;
use crate::jams::jam::Jam;
use crate::limits::{Cancel, memory};

/// A robot on wheels, and with a belt round them.
pub(super) struct Pair {
    pub wheels: Family,
    pub belt: Family,
    pub effort: SearchEffort,
}

/// Checks that there is memory for this number of cells.
fn ask(what: &str, cells: usize) -> Result<(), LimitError> {
    // A growing vector takes twice as much for a moment.
    memory::ask(what, 2 * (cells * size_of::<ExcludedCell>()) as u64)
}

impl Pair {
    /// The result for all values of a number of parameters.
    pub(super) fn certificate(&self, cancel: &Cancel) -> Result<Certificate, Error> {
        ask("cells of a region (most_cells)", self.effort.cells)?;
        let mut certificate = Certificate {
            length: self.wheels.reach,
            ..Certificate::default()
        };
        let numbers = 3..3 + self.wheels.parameters;
        let mut open = vec![self.wheels.root()];
        while let Some(cell) = open.pop() {
            let (status, is_held) = self.status(&cell, &mut certificate, cancel)?;
            let widest = numbers
                .clone()
                .max_by(|a, b| cell.half(*a).total_cmp(&cell.half(*b)));
            match widest {
                Some(number)
                    if self.is_worth_a_split((&status, is_held), &cell, number, cancel)? =>
                {
                    let [lower, upper] = cell.split(number);
                    open.extend([upper, lower]);
                }
                _ => certificate.regions.push(Region {
                    low: cell.low[numbers.clone()].to_vec(),
                    high: cell.high[numbers.clone()].to_vec(),
                    status,
                }),
            }
        }
        Ok(certificate)
    }

    /// The status of a range, and whether the belt can jam in its middle, if requested.
    fn status(
        &self,
        cell: &Cell,
        certificate: &mut Certificate,
        cancel: &Cancel,
    ) -> Result<(RegionStatus, bool), Error> {
        let effort = self.effort;
        let mut shares = cell.shares();
        let mut jam = self.jam(&shares, cancel)?;
        if jam.is_none() {
            match self
                .wheels
                .search(*cell, effort.cells, effort.depth, cancel)?
            {
                Found::Excluded(cells) => {
                    let count = cells.len();
                    if effort.keeps_cells {
                        let all = certificate.cells.len() + count;
                        ask("cells of a certificate (keep_cells)", all)?;
                        certificate.cells.extend(cells);
                    }
                    return Ok((RegionStatus::Certified(count), false));
                }
                Found::Left(left) => shares = left,
            }
            // The search stops at the first cell that remains; a jam may also be at an end of the range.
            for tried in std::iter::once(shares).chain(self.corners(cell)) {
                jam = self.jam(&tried, cancel)?;
                if jam.is_some() {
                    shares = tried;
                    break;
                }
            }
        }
        let stands = self.belt.stands(&cell.shares(), cancel)?;
        if self.belt.is_held(cell, &stands) {
            return Ok((RegionStatus::AsBelt, true));
        }
        let found = jam.map(|jam| RegionStatus::Jams(shares.to_vec(), jam));
        let is_held = self.belt.is_held(&cell.at_middle(), &stands);
        Ok((found.unwrap_or(RegionStatus::Undecided), is_held))
    }

    /// Whether splitting a range may help: not if the robot can jam in the middle and at every corner, and the belt
    /// cannot in the middle.
    fn is_worth_a_split(
        &self,
        (status, is_held): (&RegionStatus, bool),
        cell: &Cell,
        widest: usize,
        cancel: &Cancel,
    ) -> Result<bool, Error> {
        /// For widths that are powers of one half.
        const ROUNDING: f64 = 1.0 + 1e-9;
        let is_done = matches!(status, RegionStatus::Certified(_) | RegionStatus::AsBelt);
        if is_done || 2.0 * cell.half(widest) <= self.effort.smallest * ROUNDING {
            return Ok(false);
        }
        if is_held || !matches!(status, RegionStatus::Jams(..)) {
            return Ok(true);
        }
        for shares in self.corners(cell) {
            if self.jam(&shares, cancel)?.is_none() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The fractions at all corners of a range.
    fn corners(&self, cell: &Cell) -> impl Iterator<Item = Shares> {
        let (low, high) = (cell.low, cell.high);
        (0..1_u32 << self.wheels.parameters).map(move |corner| {
            std::array::from_fn(|k| {
                let ends = [low[3 + k], high[3 + k]];
                ends[(corner >> k & 1) as usize]
            })
        })
    }

    /// A jam on three contacts with ground at least so deep inside the track, at fractions of the parameters' ranges.
    fn jam(&self, shares: &Shares, cancel: &Cancel) -> Result<Option<Jam>, Error> {
        let setting = self.wheels.setting(shares, cancel)?;
        let deep =
            |posture: &Posture| self.wheels.depth(&setting.places, posture) >= self.effort.depth;
        let of = |posture: Posture| {
            let contacts = setting.touching(&posture)?;
            let loads = setting.loads(&contacts, &posture)?;
            deep(&posture).then(|| setting.jam(&posture, &contacts, &loads))
        };
        Ok(setting.fixed(cancel)?.into_iter().find_map(of))
    }
}
