//! Forces that could balance a stop: the effect of a unit of each, and the choice with the smallest residual.

use super::linear_program::Rows;

/// Multiple of the weight above which a force counts as unlimited.
pub(super) const WITHOUT_LIMIT: f64 = 1e3;
/// Residuals allowed besides, as shares of the weight: rounding errors, far too small for a push to matter. The
/// next is tried if the solver finds no solution with the one before.
const SLACKS: [f64; 3] = [1e-8, 1e-7, 1e-6];

/// Columns of a linear program: the effect of a unit of each force, its bounds and its owner.
#[derive(Clone, Default)]
pub(super) struct Forces {
    columns: Vec<Vec<f64>>,
    bounds: Vec<(f64, f64)>,
    sources: Vec<Source>,
    /// Loads of the last balances: the moments of the arms' weights about their pivots.
    hung: Vec<f64>,
}

/// The owner of a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    Support(usize),
    Motor(usize),
    Outside,
}

/// The largest push that can be balanced, and how.
#[derive(Clone, Debug)]
pub(super) struct Push {
    /// The push in weights; infinite if any can be balanced.
    pub force: f64,
    /// Supports that bear under that push.
    pub bearing: Vec<usize>,
    /// Drives with the forces of their motors, in weights.
    pub motors: Vec<(usize, f64)>,
}

impl Forces {
    /// No columns yet; the last balances carry these loads.
    pub(super) fn bearing(hung: Vec<f64>) -> Self {
        Self {
            hung,
            ..Self::default()
        }
    }

    pub(super) fn push(&mut self, source: Source, column: Vec<f64>, bounds: (f64, f64)) {
        self.columns.push(column);
        self.bounds.push(bounds);
        self.sources.push(source);
    }

    /// Two inequalities for each balance with the weight. The variables are the forces and, last, the imbalance. A
    /// balance may have a residual of `slack.0` times the imbalance, plus `slack.1`.
    fn rows(&self, slack: (f64, f64)) -> Rows {
        let n = self.columns.len();
        let mut rows = Rows::default();
        let first_hung = self.size() - self.hung.len();
        for i in 0..self.size() {
            let weight = match i.checked_sub(first_hung) {
                Some(k) => self.hung[k],
                None if i == 1 => 1.0,
                None => 0.0,
            };
            for sign in [1.0, -1.0] {
                let mut row: Vec<f64> = self.columns.iter().map(|c| sign * c[i]).collect();
                row.push(-slack.0);
                rows.push(row, sign * weight + slack.1);
            }
        }
        for (j, (low, high)) in self.bounds.iter().enumerate() {
            for (sign, bound) in [(-1.0, -low), (1.0, *high)] {
                if bound.is_finite() {
                    let mut row = vec![0.0; n + 1];
                    row[j] = sign;
                    rows.push(row, bound);
                }
            }
        }
        let mut row = vec![0.0; n + 1];
        row[n] = -1.0;
        rows.push(row, 0.0);
        rows
    }

    fn size(&self) -> usize {
        self.columns.first().map_or(3 + self.hung.len(), Vec::len)
    }

    fn cost(&self, of_last: f64) -> Vec<f64> {
        let mut cost = vec![0.0; self.columns.len()];
        cost.push(of_last);
        cost
    }

    pub(super) fn imbalance(&self) -> Option<f64> {
        let rows = self.rows((1.0, 0.0));
        let found = rows.minimise(&self.cost(1.0))?;
        found.last().map(|t| t.max(0.0))
    }

    pub(super) fn largest_push(&self, direction: f64, tolerance: f64) -> Option<Push> {
        /// Smallest share of the weight at which a support bears.
        const BEARS: f64 = 1e-6;

        let n = self.columns.len();
        let mut pushed = self.clone();
        let mut push = vec![0.0; self.size()];
        push[0] = direction;
        pushed.push(Source::Outside, push, (0.0, WITHOUT_LIMIT));
        let missed = pushed.imbalance().filter(|missed| *missed <= tolerance)?;
        let mut cost = pushed.cost(0.0);
        cost[n] = -1.0;
        let found = SLACKS
            .iter()
            .find_map(|slack| pushed.rows((0.0, missed + slack)).minimise(&cost))?;
        let mut bearing: Vec<usize> = (0..n)
            .filter(|j| found[*j] > BEARS)
            .filter_map(|j| match self.sources[j] {
                Source::Support(i) => Some(i),
                _ => None,
            })
            .collect();
        bearing.dedup();
        let motors = (0..n).filter_map(|j| match self.sources[j] {
            Source::Motor(k) => Some((k, found[j])),
            _ => None,
        });
        Some(Push {
            force: if found[n] > 0.999 * WITHOUT_LIMIT {
                f64::INFINITY
            } else {
                found[n].max(0.0)
            },
            bearing,
            motors: motors.collect(),
        })
    }
}
