//! Ranges of directions, tested without computing angles during a step.
//!
//! The equations: docs/physics.md, "Contacts".

use std::f64::consts::{PI, TAU};

use crate::geometry::{Vector, cross, direction};

/// A range of directions.
pub(super) struct Sector {
    /// The first and the last direction, counter-clockwise.
    ends: [Vector; 2],
    /// Whether it spans more than half a turn.
    is_wide: bool,
}

impl Sector {
    /// The range that starts at an angle [rad] and sweeps another, counter-clockwise.
    pub(super) fn new(from: f64, sweep: f64) -> Self {
        let sweep = sweep.min(TAU);
        Self {
            ends: [from, from + sweep].map(direction),
            is_wide: sweep > PI,
        }
    }

    /// Whether a direction lies in the range, ends included.
    pub(super) fn holds(&self, d: Vector) -> bool {
        let [first, last] = self.ends;
        if self.is_wide {
            cross(last, d) <= 0.0 || cross(d, first) <= 0.0
        } else {
            cross(first, d) >= 0.0 && cross(d, last) >= 0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sector_holds_what_lies_between_its_ends_however_wide_it_is() {
        for sweep in [0.1, 1.5, 3.0, 3.3, 5.0, 6.2] {
            for from in [-3.0, -0.4, 1.0, 2.9] {
                let sector = Sector::new(from, sweep);
                for i in 0..100 {
                    let angle = TAU * (f64::from(i) + 0.37) / 100.0;
                    let is_between = (angle - from).rem_euclid(TAU) < sweep;
                    assert_eq!(sector.holds(direction(angle)), is_between);
                }
            }
        }
    }

    #[test]
    fn a_whole_turn_holds_every_direction() {
        let sector = Sector::new(0.3, 7.0);
        assert!((0..100).all(|i| sector.holds(direction(0.0628 * f64::from(i)))));
    }
}
