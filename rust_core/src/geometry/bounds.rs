//! What no run comes near: numbers beyond are not those of a run.

use super::Vector;

/// [m], [m/s], [N], [kg] alike.
const MOST: f64 = 1e9;

/// Whether a run can have come to such numbers; not to NaN.
pub(crate) fn plausible(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.abs() < MOST)
}

/// The same of vectors.
pub(crate) fn plausible_vectors(vectors: &[Vector]) -> bool {
    vectors.iter().all(|v| plausible(&[v.x, v.y]))
}
