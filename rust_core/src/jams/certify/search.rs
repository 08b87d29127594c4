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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use crate::geometry::Vector;
    use crate::jams::certify::family::check_wheels;
    use crate::jams::certify::interval::Rectangle;
    use crate::jams::certify::tests::family_on_a_step;
    use crate::jams::certify::touch::Normals;
    use crate::jams::layout::{Grip, Outline};

    /// A cell that is so wide in x, y [m] and angle [rad].
    fn cell(widths: [f64; 3]) -> Cell {
        let mut cell = Cell::ZERO;
        for (number, width) in widths.into_iter().enumerate() {
            (cell.low[number], cell.high[number]) = (1.0, 1.0 + width);
        }
        cell
    }

    /// On the level face before the step.
    fn on_level() -> Touch {
        Touch {
            surface: 0,
            place: 0,
            normals: Normals {
                bisector: Vector::Y,
                sines: [0.0; 2],
                circle: None,
                is_on_face: true,
            },
            slopes: [0.5; 2],
            arm: Rectangle::at(Vector::ZERO),
            radius: 0.05,
            slides: true,
        }
    }

    /// Lengths count in radii of the smallest wheel, and a turn by how far it moves the middle between centre and
    /// farthest point.
    #[test]
    fn a_cell_is_split_where_contacts_move_most() {
        let family = family_on_a_step();
        let radius = family.radius;
        let tilted = Touch {
            normals: Normals {
                bisector: Vector::new(0.6, 0.8),
                ..on_level().normals
            },
            ..on_level()
        };
        let on_edge = Touch {
            normals: Normals {
                is_on_face: false,
                ..on_level().normals
            },
            ..on_level()
        };
        let half_reach = 0.5 * family.reach;
        for (widths, touches, number, moved) in [
            ([0.4, 0.3, 0.0], vec![tilted], 0, 0.4),
            ([0.2, 0.3, 0.0], vec![tilted], 1, 0.3),
            ([0.2, 0.3, 0.31 / half_reach], vec![tilted], 2, 0.31),
            ([0.2, 0.3, 0.29 / half_reach], vec![tilted], 1, 0.3),
            // Along level ground everything stays as it is, unless a wheel may leave it.
            ([0.4, 0.3, 0.0], vec![on_level()], 1, 0.3),
            ([0.4, 0.3, 0.0], vec![on_level(), tilted], 0, 0.4),
            ([0.4, 0.3, 0.0], vec![on_level(), on_edge], 0, 0.4),
            // Three hundredths of a radius up or down are little.
            (
                [0.4, 0.031 * radius, 0.0],
                vec![on_level()],
                1,
                0.031 * radius,
            ),
            ([0.4, 0.029 * radius, 0.0], vec![on_level()], 0, 0.4),
        ] {
            let (found, size) = family.widest(&cell(widths), &touches);
            assert_eq!(found, number, "{widths:?}");
            assert!((size - moved / radius).abs() < 1e-12, "{widths:?}: {size}");
        }
    }

    /// What comes nearest to excluding a cell need not exclude it.
    #[test]
    fn a_cell_that_is_unbalanced_is_so_in_the_motion_that_says_so() {
        let (family, mut draw) = (family_on_a_step(), Draw(91));
        let down = [0.0, -1.0, 0.0];
        let (mut unbalanced, mut open) = (0, 0);
        for _ in 0..400 {
            let at = [
                draw.between(-0.4, 0.4),
                draw.between(0.0, 0.2),
                draw.between(-0.2, 0.9),
            ];
            let mut cell = Cell::ZERO;
            for (number, middle) in at.into_iter().enumerate() {
                (cell.low[number], cell.high[number]) = (middle - 0.03, middle + 0.03);
            }
            let Possible::Touches(touches) = family.possible(&cell) else {
                continue;
            };
            match family.judge(&cell, down, 1e-3) {
                Verdict::Excluded(Exclusion::Unbalanced, twist) => {
                    unbalanced += 1;
                    assert!(excludes(twist, &touches, family.reach), "{at:?}");
                }
                Verdict::Open(twist, _) => {
                    let is_near = candidate(&touches, family.reach).is_some();
                    open += u32::from(is_near);
                    assert!(!is_near || !excludes(twist, &touches, family.reach));
                }
                Verdict::Excluded(..) => {}
            }
        }
        assert!(unbalanced > 10 && open > 3, "{unbalanced} {open}");
    }

    #[test]
    fn a_driven_run_is_a_belt_and_a_belly_is_none() {
        let mut layout = family_on_a_step().layout;
        assert!(check_wheels(&layout).is_ok());
        let is_run = |shape: &Outline| matches!(shape, Outline::Flat { .. });
        let runs = layout.surfaces.iter_mut().filter(|s| is_run(&s.shape));
        runs.last().expect("it has a belly").grip = Grip::Driven(1.0);
        let error = check_wheels(&layout).expect_err("it is a belt");
        assert_eq!(
            (error.path.as_str(), error.value.as_str()),
            ("robot.track", "belt")
        );
    }
}
