//! The linear system of a solve: the base, what is hinged to it, and what spins on it.
//!
//! Spinning bodies are eliminated first, one by one, as each is coupled to little else. What a motor holds turns with the
//! base, and is no unknown.
//!
//! The equations: docs/physics.md, "The linear system".

use super::damper::{Damper, Inertia};
use super::row::{BASE, Layout, Row, TURN};

/// Maximum number of bodies hinged to the base.
const JOINTS: usize = 2;
const BODIES: usize = BASE + JOINTS;
/// From so many unknowns on it is cheaper to clear only the entries that can have been written.
const MANY: usize = 12;

/// The linear system of the unknowns on the base.
pub(super) struct System {
    /// Number of unknowns of the base and of what is hinged to it, ...
    bodies: usize,
    /// ... and of these and what spins.
    count: usize,
    /// The matrix, row by row, each with its right-hand side at the end.
    rows: Vec<f64>,
    /// Whether there are entries off the diagonal, ...
    is_coupled: bool,
    /// ... and whether there may be some that couple two bodies other than the base.
    spins_meet: bool,
    /// [1/kg, 1/kg, 1/(kg m^2), ...] The weight of each row: one over the inertia of its unknown, 0 for those of rings.
    pub weights: Vec<f64>,
    /// [rad/s] Rate relative to the base of each body that turns with it.
    held: Vec<Option<f64>>,
}

impl System {
    pub(super) fn new(layout: Layout) -> Self {
        let count = layout.on_base();
        debug_assert!(layout.joints <= JOINTS);
        Self {
            bodies: BASE + layout.joints,
            count,
            rows: vec![0.0; count * (count + 1)],
            is_coupled: false,
            spins_meet: false,
            weights: vec![0.0; layout.link(0)],
            held: vec![None; layout.link(0)],
        }
    }

    /// Makes the body with the rate at index `at` turn with the base, at a rate relative to it [rad/s], or releases it.
    pub(super) fn hold(&mut self, at: usize, rate: Option<f64>) {
        self.held[at] = rate;
    }

    /// A row in which what is held counts as part of the base.
    pub(super) fn tied(&self, row: &Row) -> Row {
        row.tied(&self.held)
    }

    /// Sets the system up for bodies without constraints, with these inertias [kg, kg, kg m^2, ...] and velocities.
    pub(super) fn start(&mut self, masses: &[f64], free: &[f64]) {
        self.clear();
        for (at, mass) in masses.iter().enumerate() {
            match self.held[at] {
                None => {
                    *self.entry(at, at) += mass;
                    *self.right(at) += mass * free[at];
                }
                Some(rate) => {
                    *self.entry(at, at) = 1.0;
                    *self.entry(TURN, TURN) += mass;
                    *self.right(TURN) += mass * (free[at] - rate);
                }
            }
        }
    }

    /// Clears all entries that can have been written: few of them, if many bodies spin.
    fn clear(&mut self) {
        if self.spins_meet || self.count < MANY {
            self.rows.fill(0.0);
        } else {
            let stride = self.count + 1;
            let (whole, sparse) = self.rows.split_at_mut(self.bodies * stride);
            whole.fill(0.0);
            for (k, row) in sparse.chunks_exact_mut(stride).enumerate() {
                row[..BODIES].fill(0.0);
                (row[self.bodies + k], row[self.count]) = (0.0, 0.0);
            }
        }
        (self.is_coupled, self.spins_meet) = (false, false);
    }

    /// Finds the weights of all unknowns from the inertias of bodies and along rows.
    pub(super) fn weigh(&mut self, masses: &[f64], inertias: &[Inertia]) {
        let Self { weights, held, .. } = self;
        weights[BASE..].fill(0.0);
        weights[..BASE].copy_from_slice(&masses[..BASE]);
        for (at, mass) in masses.iter().enumerate().skip(BASE) {
            weights[held[at].map_or(at, |_| TURN)] += mass;
        }
        for inertia in inertias {
            for (at, lever) in inertia.action.entries() {
                weights[at] += inertia.damper.damping * lever * lever;
            }
        }
        for (weight, held) in weights.iter_mut().zip(held).take(self.count) {
            *weight = if held.is_some() { 1.0 } else { weight.recip() };
        }
    }

    /// The entry that couples two unknowns.
    pub(super) fn coupling(&mut self, row: usize, column: usize) -> &mut f64 {
        self.is_coupled = true;
        self.spins_meet |= row.min(column) >= BASE && row != column;
        self.entry(row, column)
    }

    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.rows[row * (self.count + 1) + column]
    }

    /// The right-hand side of a row.
    pub(super) fn right(&mut self, row: usize) -> &mut f64 {
        self.entry(row, self.count)
    }

    /// Adds a constraint: its impulse acts along the first of two tied rows, and is that of a damper at the speed along the
    /// second.
    pub(super) fn add(&mut self, [force, action]: [&Row; 2], damper: Damper) {
        self.push(force, damper.at(action.offset));
        if damper.damping == 0.0 {
            return;
        }
        self.is_coupled = true;
        self.spins_meet |= action.is_on_two_beside_base();
        let stride = self.count + 1;
        let of_base = action.of_base();
        for (i, f) in force.entries() {
            let row = &mut self.rows[i * stride..][..stride];
            let share = damper.damping * f;
            for (entry, d) in row[..BASE].iter_mut().zip(of_base) {
                *entry += share * d;
            }
            for (j, d) in action.beside_base() {
                row[j] += share * d;
            }
        }
    }

    /// Adds an impulse [N s] along a tied row.
    pub(super) fn push(&mut self, row: &Row, impulse: f64) {
        for (i, lever) in row.entries() {
            *self.right(i) += lever * impulse;
        }
    }

    /// Finds the unknowns; none if the constraints contradict each other.
    pub(super) fn solve(&mut self, into: &mut [f64]) -> Option<()> {
        if self.is_coupled {
            for at in self.bodies..self.count {
                if self.held[at].is_none() {
                    self.eliminate_spin(at);
                }
            }
            match self.bodies {
                BASE => self.solve_bodies::<BASE>(into)?,
                BODIES => self.solve_bodies::<BODIES>(into)?,
                _ => self.solve_bodies::<{ BASE + 1 }>(into)?,
            }
        } else {
            for (at, known) in into.iter_mut().enumerate().take(self.bodies) {
                *known = *self.right(at) / *self.entry(at, at);
            }
        }
        let turn = into[TURN];
        for at in (BASE..self.count).rev() {
            if let Some(rate) = self.held[at] {
                into[at] = turn + rate;
            } else if at >= self.bodies {
                let row = &self.rows[at * (self.count + 1)..][..=self.count];
                let of_known = |at: usize| row[at] * into[at];
                let known = (0..self.bodies).chain(at + 1..self.count);
                let of_others: f64 = known.map(of_known).sum();
                into[at] = (row[self.count] - of_others) / row[at];
            }
        }
        Some(())
    }

    /// Eliminates a spinning body from the rows of the base, of what is hinged to it, and of the spinning bodies after it.
    fn eliminate_spin(&mut self, at: usize) {
        let (count, bodies) = (self.count, self.bodies);
        let stride = count + 1;
        let (above, from) = self.rows.split_at_mut(at * stride);
        let (own, below) = from.split_at_mut(stride);
        let bodies_above = above.chunks_exact_mut(stride).take(bodies);
        for row in bodies_above.chain(below.chunks_exact_mut(stride)) {
            if row[at] == 0.0 {
                continue;
            }
            let share = row[at] / own[at];
            for j in (0..bodies).chain(at + 1..stride) {
                row[j] -= share * own[j];
            }
        }
    }

    /// Solves for the base and what is hinged to it. The number of unknowns, mostly three, is a constant, so that the compiler
    /// can unroll the loops.
    fn solve_bodies<const COUNT: usize>(&self, into: &mut [f64]) -> Option<()> {
        let mut rows = [[0.0; BODIES + 1]; COUNT];
        let stride = self.count + 1;
        for (row, from) in rows.iter_mut().zip(self.rows.chunks_exact(stride)) {
            row[..COUNT].copy_from_slice(&from[..COUNT]);
            row[BODIES] = from[self.count];
        }
        let mut weights = [0.0; COUNT];
        weights.copy_from_slice(&self.weights[..COUNT]);
        into[..COUNT].copy_from_slice(&eliminate(&mut rows, weights)?);
        Some(())
    }
}

/// Gaussian elimination with pivoting; none if the system is singular. The squares of possible pivots are weighted by their
/// rows, so that a copy of a robot on another scale gets the same pivots.
fn eliminate<const COUNT: usize>(
    a: &mut [[f64; BODIES + 1]; COUNT],
    mut weights: [f64; COUNT],
) -> Option<[f64; COUNT]> {
    for i in 0..COUNT {
        let size = |row: usize| a[row][i] * a[row][i] * weights[row];
        let pivot = (i..COUNT).max_by(|p, q| size(*p).total_cmp(&size(*q)))?;
        a.swap(i, pivot);
        weights.swap(i, pivot);
        if a[i][i] == 0.0 || !a[i][i].is_finite() {
            return None;
        }
        let above = a[i];
        for row in &mut a[i + 1..COUNT] {
            let share = row[i] / above[i];
            for j in (i + 1..COUNT).chain([BODIES]) {
                row[j] -= share * above[j];
            }
        }
    }
    let mut known = [0.0; COUNT];
    for i in (0..COUNT).rev() {
        let of_known: f64 = (i + 1..COUNT).map(|j| a[i][j] * known[j]).sum();
        known[i] = (a[i][BODIES] - of_known) / a[i][i];
    }
    Some(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The solution of a system of three unknowns with these rows and right-hand sides.
    fn solution(rows: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; BASE]> {
        let mut system = [[0.0; BODIES + 1]; BASE];
        for (i, row) in system.iter_mut().enumerate() {
            row[..BASE].copy_from_slice(&rows[i]);
            row[BODIES] = right[i];
        }
        eliminate(&mut system, [1.0; BASE])
    }

    #[test]
    fn a_system_is_solved_unless_it_is_singular() {
        let rows = [[0.0, 2.0, 0.0], [4.0, 1.0, 0.0], [0.0, 1.0, 8.0]];
        assert_eq!(solution(rows, [2.0, 9.0, 17.0]), Some([2.0, 1.0, 2.0]));
        let equal = [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 0.0, 1.0]];
        assert_eq!(solution(equal, [1.0, 2.0, 3.0]), None);
        for wrong in [f64::NAN, f64::INFINITY] {
            assert_eq!(solution([[wrong; 3]; 3], [1.0; 3]), None);
        }
    }
}
