//! Bounds that no run comes near, to recognise implausible numbers.

use super::Vector;

/// In any SI unit: a thousand times the weight of the heaviest robot. What is formed of such numbers is finite.
const MOST: f64 = 1e18;

/// Whether a run can have produced these numbers; NaN is implausible.
pub(crate) fn plausible(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.abs() < MOST)
}

/// The same for vectors.
pub(crate) fn plausible_vectors(vectors: &[Vector]) -> bool {
    vectors.iter().all(|v| plausible(&[v.x, v.y]))
}
