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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;
    use crate::jams::certify::tests::{belts_on_a_step, family_on_a_step, stands};

    fn pair(smallest: f64) -> Pair {
        let effort = SearchEffort {
            depth: 1e-3,
            smallest,
            cells: 10,
            keeps_cells: false,
        };
        Pair {
            wheels: family_on_a_step(),
            belt: belts_on_a_step(),
            effort,
        }
    }

    /// The poses of the wheels in the middle of all ranges in which forces carry them, each with its depth [m].
    fn depths(pair: &Pair) -> Vec<f64> {
        let shares = pair.wheels.root().shares();
        let (setting, all) = stands(&pair.wheels, &shares);
        let carried = all.iter().filter(|(posture, contacts)| {
            let loads = setting.loads(contacts, posture);
            loads.is_some()
        });
        let depth =
            |(posture, _): &(Posture, Vec<usize>)| pair.wheels.depth(&setting.places, posture);
        carried.map(depth).collect()
    }

    #[test]
    fn a_jam_has_ground_inside_its_track_as_deep_as_is_asked_for() {
        let mut pair = pair(0.5);
        let (shares, cancel) = (pair.wheels.root().shares(), Cancel::default());
        let deepest = depths(&pair).into_iter().fold(0.0, f64::max);
        assert!(deepest > 5e-3, "{deepest} m");
        for (depth, is_found) in [(deepest - 1e-9, true), (deepest + 1e-9, false)] {
            pair.effort.depth = depth;
            let found = pair.jam(&shares, &cancel).expect("nobody asks it to end");
            assert_eq!(found.is_some(), is_found, "{depth} m");
        }
    }

    /// So does a belt that runs round them.
    #[test]
    fn a_range_in_whose_middle_wheels_jam_has_that_jam() {
        let (pair, mut certificate) = (pair(0.5), Certificate::default());
        let root = pair.wheels.root();
        let found = pair.status(&root, &mut certificate, &Cancel::default());
        let (status, is_held) = found.expect("nobody asks it to end");
        let RegionStatus::Jams(shares, jam) = status else {
            panic!("{status:?}");
        };
        assert_eq!(shares, root.shares());
        assert_eq!((jam.contacts.len(), is_held), (3, true));
    }

    /// Of two parameters, each on one side of its range, and of a quarter of it.
    fn quarter() -> Cell {
        let mut cell = Cell::ZERO;
        (cell.low[3], cell.high[3]) = (0.25, 0.5);
        (cell.low[4], cell.high[4]) = (0.75, 1.0);
        cell
    }

    #[test]
    fn a_range_of_two_parameters_has_four_corners() {
        let found: Vec<[f64; 2]> = pair(0.1)
            .corners(&quarter())
            .map(|[height, friction, ..]| [height, friction])
            .collect();
        assert_eq!(found, [[0.25, 0.75], [0.5, 0.75], [0.25, 1.0], [0.5, 1.0]]);
    }

    /// None of these asks for a jam at a corner.
    #[test]
    fn a_range_is_split_until_it_is_small_or_nothing_is_left_to_find() {
        let jam = || Jam {
            position: Vector::ZERO,
            angle: 0.0,
            contacts: Vec::new(),
        };
        let jams = || RegionStatus::Jams(vec![0.4, 0.9], jam());
        let cancel = Cancel::default();
        let is_split = |smallest: f64, status: &RegionStatus, is_held: bool| {
            let found = pair(smallest).is_worth_a_split((status, is_held), &quarter(), 4, &cancel);
            found.expect("nobody asks it to end")
        };
        for (smallest, is_wide) in [(0.2, true), (0.25, false), (0.3, false)] {
            assert_eq!(is_split(smallest, &RegionStatus::Undecided, false), is_wide);
            assert_eq!(is_split(smallest, &jams(), true), is_wide);
            assert!(!is_split(smallest, &RegionStatus::Certified(3), false));
            assert!(!is_split(smallest, &RegionStatus::AsBelt, true));
        }
    }

    /// A cell has seven numbers twice, three of a twist and a word for its exclusion, of 8 bytes each.
    #[test]
    fn cells_take_twice_their_bytes_while_their_vector_grows() {
        let refused = ask("cells", 1 << 40).expect_err("no machine has that much");
        let LimitError::Memory { needed, .. } = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(needed, (2 * 18 * 8) << 40);
        assert!(ask("cells", 1000).is_ok());
    }
}
