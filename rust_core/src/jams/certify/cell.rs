//! Cells: ranges of pose and parameters.

use std::ops::{Add, Mul, Sub};

use super::interval::{Interval, Rectangle};
use crate::geometry::Vector;

/// Largest number of parameters.
pub(crate) const MOST_PARAMETERS: usize = 4;
/// Count of numbers of a cell: x, y and angle of the chassis frame, then fractions of the parameters' ranges from 0 to
/// 1.
pub(super) const NUMBERS: usize = 3 + MOST_PARAMETERS;

/// A range of each number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub low: [f64; NUMBERS],
    pub high: [f64; NUMBERS],
}

impl Cell {
    pub(super) const ZERO: Self = Self {
        low: [0.0; NUMBERS],
        high: [0.0; NUMBERS],
    };

    pub(super) fn middle(&self, number: usize) -> f64 {
        0.5 * (self.low[number] + self.high[number])
    }

    pub(super) fn half(&self, number: usize) -> f64 {
        0.5 * (self.high[number] - self.low[number])
    }

    /// Its halves along one number.
    pub(super) fn split(&self, number: usize) -> [Self; 2] {
        let middle = self.middle(number);
        let (mut lower, mut upper) = (*self, *self);
        lower.high[number] = middle;
        upper.low[number] = middle;
        [lower, upper]
    }

    /// Its middle as a cell.
    pub(super) fn at_middle(&self) -> Self {
        let middle = std::array::from_fn(|number| self.middle(number));
        Self {
            low: middle,
            high: middle,
        }
    }

    /// Fractions of the parameters' ranges in the middle.
    pub(super) fn shares(&self) -> Shares {
        std::array::from_fn(|k| self.middle(3 + k))
    }

    /// Position of the chassis frame.
    pub(super) fn position(&self) -> Rectangle {
        Rectangle {
            middle: Vector::new(self.middle(0), self.middle(1)),
            half: Vector::new(self.half(0), self.half(1)),
        }
    }
}

/// A value that is linear in each parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine<T> {
    pub base: T,
    pub slopes: [T; MOST_PARAMETERS],
}

/// A fraction of each parameter's range.
pub(super) type Shares = [f64; MOST_PARAMETERS];

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Affine<T> {
    /// Interpolates its value with all parameters at the smallest, and those with each alone at the largest.
    pub(super) fn through(values: impl Iterator<Item = T>) -> Self {
        let values: Vec<T> = values.collect();
        let base = values[0];
        Self {
            base,
            slopes: std::array::from_fn(|k| *values.get(k + 1).unwrap_or(&base) - base),
        }
    }

    pub(super) fn at(&self, shares: &Shares) -> T {
        let parts = self.slopes.iter().zip(shares);
        parts.fold(self.base, |sum, (slope, share)| sum + *slope * *share)
    }
}

impl Affine<f64> {
    pub(super) fn over(&self, cell: &Cell) -> Interval {
        let (mut middle, mut half) = (self.base, 0.0);
        for (k, slope) in self.slopes.iter().enumerate() {
            middle += slope * cell.middle(3 + k);
            half += slope.abs() * cell.half(3 + k);
        }
        Interval::around(middle, half)
    }
}

impl Affine<Vector> {
    pub(super) fn over(&self, cell: &Cell) -> Rectangle {
        let mut sum = Rectangle::at(self.base);
        for (k, slope) in self.slopes.iter().enumerate() {
            sum.middle += *slope * cell.middle(3 + k);
            sum.half += slope.abs() * cell.half(3 + k);
        }
        sum
    }
}

/// Rotations by the angles of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns {
    cosine: f64,
    sine: f64,
    /// [rad] Half the range.
    pub half: f64,
}

impl Turns {
    pub(super) fn of(cell: &Cell) -> Self {
        let (sine, cosine) = libm::sincos(cell.middle(2));
        Self {
            cosine,
            sine,
            half: cell.half(2),
        }
    }

    /// The vector turned by the angle in the middle.
    pub(super) fn middle(&self, v: Vector) -> Vector {
        Vector::new(
            self.cosine * v.x - self.sine * v.y,
            self.sine * v.x + self.cosine * v.y,
        )
    }

    /// A vector from a rectangle in the robot's frame: the middle, and the largest distance \[m\] from that.
    pub(super) fn seen(&self, all: Rectangle) -> (Vector, f64) {
        let v = all.middle;
        let middle = Vector::new(
            self.cosine * v.x + self.sine * v.y,
            self.cosine * v.y - self.sine * v.x,
        );
        let reach = all.half.length();
        (middle, reach + (v.length() + reach) * self.half)
    }

    /// The range of a vector: moved along its circle by at most the sine, and back by at most one minus the cosine.
    pub(super) fn apply(&self, v: Vector) -> Rectangle {
        let middle = self.middle(v);
        let across = Vector::new(middle.y, middle.x).abs() * self.half;
        let back = middle.abs() * (0.5 * self.half * self.half);
        Rectangle {
            middle,
            half: across + back,
        }
    }

    /// The range of a vector from a rectangle.
    pub(super) fn apply_all(&self, all: Rectangle) -> Rectangle {
        let mut turned = self.apply(all.middle);
        let reach = Vector::new(
            self.cosine.abs() * all.half.x + self.sine.abs() * all.half.y,
            self.sine.abs() * all.half.x + self.cosine.abs() * all.half.y,
        );
        // The vector turned by the middle angle also turns by the rest.
        turned.half += reach + Vector::new(reach.y, reach.x) * self.half;
        turned
    }
}
