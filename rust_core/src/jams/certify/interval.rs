//! Intervals of numbers. Bounds are rounded to the nearest, not outwards: decisions by them keep a margin far above the
//! rounding errors of the few operations in one cell.

use std::ops::{Add, Mul, Neg, Sub};

use crate::geometry::Vector;

/// Margin of a decision, in metres, radians or fractions of the weight.
pub(super) const MARGIN: f64 = 1e-9;

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub(super) const fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    pub(super) const fn at(value: f64) -> Self {
        Self::new(value, value)
    }

    /// All numbers that differ from a number by no more than another one.
    pub(super) fn around(middle: f64, half: f64) -> Self {
        Self::new(middle - half, middle + half)
    }

    pub(super) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    pub(super) fn half(self) -> f64 {
        0.5 * (self.high - self.low)
    }

    pub(super) fn is_above(self, limit: f64) -> bool {
        self.low > limit + MARGIN
    }

    pub(super) fn is_below(self, limit: f64) -> bool {
        self.high < limit - MARGIN
    }

    /// Whether it has a number in common with another, up to the margin.
    pub(super) fn meets(self, other: Self) -> bool {
        self.low <= other.high + MARGIN && other.low <= self.high + MARGIN
    }

    /// Whether it certainly has one sign.
    pub(super) fn is_signed(self) -> bool {
        self.is_above(0.0) || self.is_below(0.0)
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.low + other.low, self.high + other.high)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.low - other.high, self.high - other.low)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        Self::new(
            products.into_iter().fold(f64::INFINITY, f64::min),
            products.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

/// All vectors of a rectangle along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    pub middle: Vector,
    pub half: Vector,
}

impl Rectangle {
    pub(super) fn at(middle: Vector) -> Self {
        Self {
            middle,
            half: Vector::ZERO,
        }
    }

    /// The component along a vector.
    pub(super) fn along(self, vector: Vector) -> Interval {
        let half = vector.abs().dot(self.half);
        Interval::around(vector.dot(self.middle), half)
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            middle: self.middle * factor,
            half: self.half * factor.abs(),
        }
    }

    /// Range of the lengths of its vectors.
    pub(super) fn distance(self) -> Interval {
        let middle = self.middle.abs();
        let least = (middle - self.half).max(Vector::ZERO);
        Interval::new(least.length(), (middle + self.half).length())
    }

    pub(super) fn x(self) -> Interval {
        Interval::around(self.middle.x, self.half.x)
    }

    pub(super) fn y(self) -> Interval {
        Interval::around(self.middle.y, self.half.y)
    }
}

impl Add for Rectangle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            middle: self.middle + other.middle,
            half: self.half + other.half,
        }
    }
}

impl Sub for Rectangle {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            middle: self.middle - other.middle,
            half: self.half + other.half,
        }
    }
}
