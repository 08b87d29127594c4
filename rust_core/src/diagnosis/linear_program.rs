//! Small linear programs: the smallest value of a linear cost under linear inequalities.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};

/// The solver ends when no constraint is violated, and no cost can be reduced, by more than this.
const ACCURACY: f64 = 1e-9;

/// Rows `a x <= b`.
#[derive(Default)]
pub(super) struct Rows {
    coefficients: Vec<Vec<f64>>,
    bounds: Vec<f64>,
}

impl Rows {
    pub(super) fn push(&mut self, coefficients: Vec<f64>, bound: f64) {
        self.coefficients.push(coefficients);
        self.bounds.push(bound);
    }

    /// The point of smallest `cost`; `None` if there is none.
    pub(super) fn minimise(&self, cost: &[f64]) -> Option<Vec<f64>> {
        let n = cost.len();
        let matrix = CscMatrix::from(&self.coefficients);
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(ACCURACY)
            .tol_gap_rel(ACCURACY)
            .tol_feas(ACCURACY)
            .build()
            .ok()?;
        let cones = [SupportedConeT::NonnegativeConeT(self.bounds.len())];
        let mut solver = DefaultSolver::new(
            &CscMatrix::zeros((n, n)),
            cost,
            &matrix,
            &self.bounds,
            &cones,
            settings,
        )
        .ok()?;
        solver.solve();
        let found = &solver.solution;
        matches!(
            found.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        )
        .then(|| found.x.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_corner_of_least_cost() {
        let mut rows = Rows::default();
        rows.push(vec![-1.0, 0.0], 0.0);
        rows.push(vec![0.0, -1.0], 0.0);
        rows.push(vec![-1.0, -2.0], -2.0);
        let x = rows.minimise(&[1.0, 1.0]).expect("it is bounded");
        assert!((x[0]).abs() < 1e-7 && (x[1] - 1.0).abs() < 1e-7);
    }

    #[test]
    fn says_so_when_nothing_fits_all_rows() {
        let mut rows = Rows::default();
        rows.push(vec![1.0], -1.0);
        rows.push(vec![-1.0], 0.0);
        assert!(rows.minimise(&[1.0]).is_none());
    }
}
