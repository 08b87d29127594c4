//! Excludes all poses for a range of parameters, cell by cell.

use super::balance::{Twist, candidate, excludes};
use super::cell::{Cell, NUMBERS, Shares};
use super::family::Family;
use super::found::{ExcludedCell, Exclusion};
use super::touch::{Possible, Touch};
use crate::error::Error;
use crate::limits::Cancel;

/// Cells this small, relative to the smallest wheel's radius, are not split.
const SMALLEST: f64 = 1e-3;

/// The result of a search.
pub(super) enum Found {
    /// Every cell is excluded.
    Excluded(Vec<ExcludedCell>),
    /// A cell at these parameters could not be excluded or split further, or there are too many cells.
    Left(Shares),
}

enum Verdict {
    Excluded(Exclusion, Twist),
    /// Nothing excludes it yet: the twist that came closest, the number along which to split it, and its width there.
    Open(Twist, (usize, f64)),
}

impl Family {
    /// Splits a cell until each part is excluded, one is as small as `SMALLEST`, or there are too many.
    pub(super) fn search(
        &self,
        root: Cell,
        most: usize,
        depth: f64,
        cancel: &Cancel,
    ) -> Result<Found, Error> {
        let down = [0.0, -1.0, 0.0];
        let mut excluded = Vec::new();
        let mut open = vec![(root, down)];
        while let Some((cell, near)) = open.pop() {
            cancel.check()?;
            match self.judge(&cell, near, depth) {
                Verdict::Excluded(exclusion, twist) => excluded.push(ExcludedCell {
                    low: cell.low,
                    high: cell.high,
                    exclusion,
                    twist,
                }),
                Verdict::Open(twist, (number, size)) => {
                    if size < SMALLEST || excluded.len() + open.len() >= most {
                        return Ok(Found::Left(cell.shares()));
                    }
                    let [lower, upper] = cell.split(number);
                    open.extend([(upper, twist), (lower, twist)]);
                }
            }
        }
        Ok(Found::Excluded(excluded))
    }

    fn judge(&self, cell: &Cell, near: Twist, depth: f64) -> Verdict {
        let touches = match self.possible(cell) {
            Possible::Overlap => return Verdict::Excluded(Exclusion::Overlap, near),
            Possible::Touches(touches) => touches,
        };
        if touches.is_empty() {
            return Verdict::Excluded(Exclusion::Apart, near);
        }
        // What excludes the whole often excludes its halves.
        if excludes(near, &touches, self.reach) {
            return Verdict::Excluded(Exclusion::Unbalanced, near);
        }
        if self.is_as_on_belt(cell, depth) {
            return Verdict::Excluded(Exclusion::Belt, near);
        }
        let twist = candidate(&touches, self.reach);
        match twist {
            Some(twist) if excludes(twist, &touches, self.reach) => {
                Verdict::Excluded(Exclusion::Unbalanced, twist)
            }
            _ if self.tips(&touches) => Verdict::Excluded(Exclusion::Tips, near),
            _ => Verdict::Open(twist.unwrap_or(near), self.widest(cell, &touches)),
        }
    }

    /// The number along which a cell is widest, and this width, weighted by the effect on contacts.
    fn widest(&self, cell: &Cell, touches: &[Touch]) -> (usize, f64) {
        /// If the effect on contacts is smaller, other places may matter.
        const SMALL: f64 = 0.03;
        let widest = |along: f64| {
            let weights = self.weights(along, touches);
            let wider = |best: (usize, f64), number: usize| {
                let size = weights[number] * (cell.high[number] - cell.low[number]);
                if size > best.1 { (number, size) } else { best }
            };
            (0..NUMBERS).fold((0, 0.0), wider)
        };
        // If all contacts are on level faces, x does not matter.
        let on_level = |touch: &Touch| touch.normals.is_on_face && touch.normals.bisector.x == 0.0;
        if touches.iter().all(on_level) {
            let found = widest(0.0);
            if found.1 > SMALL {
                return found;
            }
        }
        widest(1.0)
    }

    fn weights(&self, along: f64, touches: &[Touch]) -> [f64; NUMBERS] {
        let of_parameter = |k: usize| {
            let of_touch = |touch: &Touch| {
                let spot = &self.places[touch.place];
                let moved = spot.ends.iter().map(|end| end.slopes[k].length());
                moved.fold(0.0, f64::max) / self.radius + spot.friction.slopes[k].abs()
            };
            let of_center = 2.0 * self.center_of_mass.slopes[k].length() / self.reach;
            touches.iter().map(of_touch).fold(of_center, f64::max)
        };
        std::array::from_fn(|number| match number {
            0 => along / self.radius,
            1 => 1.0 / self.radius,
            2 => 0.5 * self.reach / self.radius,
            _ => of_parameter(number - 3),
        })
    }
}
