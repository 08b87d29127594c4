//! Convex quadratic programs with bounds, solved by a primal-dual interior-point method: another way to the velocities
//! of a problem whose limits of friction are given.

use nalgebra::{DMatrix, DVector};

/// Newton steps at most; a typical program takes fifteen.
const STEPS: usize = 100;
/// Where the products of distances and multipliers are small enough, relative to the program's numbers.
const CENTRED: f64 = 1e-15;

/// Minimises `x.quadratic.x / 2 + linear.x` with `low <= x <= high`, where every low bound is finite and below the high
/// one.
pub(super) fn minimised(
    quadratic: &DMatrix<f64>,
    linear: &DVector<f64>,
    bounds: &[(f64, f64)],
) -> DVector<f64> {
    let count = bounds.len();
    let inside = |&(low, high): &(f64, f64)| {
        if high.is_finite() {
            0.5 * (low + high)
        } else {
            low + 1.0
        }
    };
    let mut x = DVector::from_iterator(count, bounds.iter().map(inside));
    let (mut below, mut above) = (DVector::repeat(count, 1.0), DVector::repeat(count, 1.0));
    let finite: Vec<bool> = bounds.iter().map(|(_, high)| high.is_finite()).collect();
    for (k, finite) in finite.iter().enumerate() {
        above[k] *= f64::from(*finite);
    }
    let sides = (count + finite.iter().filter(|finite| **finite).count()).max(1) as f64;
    for _ in 0..STEPS {
        let low = |k: usize| x[k] - bounds[k].0;
        let high = |k: usize| bounds[k].1 - x[k];
        let products =
            |k: usize| low(k) * below[k] + if finite[k] { high(k) * above[k] } else { 0.0 };
        // Rounding may put it on a bound.
        let is_inside = |k: usize| low(k) > 0.0 && high(k) > 0.0;
        if !(0..count).all(is_inside) {
            break;
        }
        let gap = (0..count).map(products).sum::<f64>() / sides;
        let gradient = quadratic * &x + linear - &below + &above;
        if gap < CENTRED && gradient.amax() < 1e-12 {
            break;
        }
        let aim = 0.1 * gap;
        let mut matrix = quadratic.clone();
        let mut right = -&gradient;
        for k in 0..count {
            matrix[(k, k)] += below[k] / low(k);
            right[k] += aim / low(k) - below[k];
            if finite[k] {
                matrix[(k, k)] += above[k] / high(k);
                right[k] -= aim / high(k) - above[k];
            }
        }
        let Some(factors) = matrix.cholesky() else {
            break;
        };
        let way = factors.solve(&right);
        let to_below =
            DVector::from_fn(count, |k, _| (aim - below[k] * way[k]) / low(k) - below[k]);
        let to_above = DVector::from_fn(count, |k, _| {
            if finite[k] {
                (aim + above[k] * way[k]) / high(k) - above[k]
            } else {
                0.0
            }
        });
        let mut share: f64 = 1.0;
        let mut limit = |room: f64, change: f64| {
            if change < 0.0 {
                share = share.min(-0.99 * room / change);
            }
        };
        for k in 0..count {
            limit(low(k), way[k]);
            limit(below[k], to_below[k]);
            if finite[k] {
                limit(high(k), -way[k]);
                limit(above[k], to_above[k]);
            }
        }
        x += way * share;
        below += to_below * share;
        above += to_above * share;
    }
    x
}

#[test]
fn a_program_with_a_bound_that_counts_is_solved() {
    let quadratic = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
    let linear = DVector::from_row_slice(&[-4.0, 1.0]);
    // Without bounds (3, -2); at y = 0 the best x is 2, of which 1.5 is allowed.
    let free = minimised(&quadratic, &linear, &[(-9.0, 9.0), (-9.0, f64::INFINITY)]);
    assert!((free - DVector::from_row_slice(&[3.0, -2.0])).amax() < 1e-9);
    let bound = minimised(&quadratic, &linear, &[(0.0, 1.5), (0.0, f64::INFINITY)]);
    assert!((bound - DVector::from_row_slice(&[1.5, 0.0])).amax() < 1e-9);
}
