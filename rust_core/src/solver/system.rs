//! The linear system of a solve: the base, what is hinged to it, and what spins on its own.
//!
//! The equations: docs/physics.md, "The linear system".

use super::damper::Damper;
use super::direction::Direction;
use super::twist::Twist;
use super::velocities::{ActsOn, JOINTS, Velocities};
use crate::geometry::Vector;

/// Columns of the base, of the bodies hinged to it, and the right-hand side.
const BASE: usize = 3;
const UNKNOWNS: usize = BASE + JOINTS;
const RIGHT: usize = UNKNOWNS;

/// The linear system, and the equations of what spins on its own.
pub(super) struct System {
    /// Rows of the base and of what is hinged to it.
    rows: [[f64; UNKNOWNS + 1]; UNKNOWNS],
    /// [1/kg, 1/kg, 1/(kg m^2), ...] Weights of the rows: those of forces and of moments have no unit in common.
    weights: [f64; UNKNOWNS],
    joints: usize,
    spins: Vec<Spin>,
}

/// The equation of one spin: `inertia x spin + columns . velocity = moment`; the equations of the velocity contain
/// `rows x spin`.
#[derive(Clone, Copy, Default)]
struct Spin {
    inertia: f64,
    moment: f64,
    columns: [f64; UNKNOWNS],
    rows: [f64; UNKNOWNS],
    /// Whether a constraint acts on it.
    acts: bool,
}

impl System {
    /// The system of so many bodies that spin on the base or are hinged to it.
    pub(super) fn new(spins: usize, joints: usize) -> Self {
        Self {
            rows: [[0.0; UNKNOWNS + 1]; UNKNOWNS],
            weights: [1.0; UNKNOWNS],
            joints,
            spins: vec![Spin::default(); spins],
        }
    }

    /// Starts from a base on which nothing acts.
    pub(super) fn start(&mut self, mass: f64, inertia: f64, velocity: Vector, moment: f64) {
        self.rows = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        let (of_force, of_moment) = (1.0 / mass, 1.0 / inertia);
        self.weights = [of_force, of_force, of_moment, of_moment, of_moment];
        let momentum = [mass * velocity.x, mass * velocity.y, moment];
        for (i, mass) in [mass, mass, inertia].into_iter().enumerate() {
            self.rows[i][i] = mass;
            self.rows[i][RIGHT] = momentum[i];
        }
    }

    /// Starts a body that spins from its rate without constraints [rad/s].
    pub(super) fn spin(&mut self, spin: usize, inertia: f64, rate: f64) {
        self.spins[spin] = Spin {
            inertia,
            moment: inertia * rate,
            ..Spin::default()
        };
    }

    /// Adds an angular impulse on it [N m s].
    pub(super) fn turn(&mut self, spin: usize, impulse: f64) {
        self.spins[spin].moment += impulse;
    }

    /// Gives a trivial row to what is hinged to the base, and turns with it.
    pub(super) fn hold(&mut self, joint: usize) {
        self.rows[BASE + joint][BASE + joint] = 1.0;
    }

    /// The rows of the base: three columns and the right-hand side.
    pub(super) fn of_base(&self) -> [[f64; 4]; 3] {
        let row = |i: usize| {
            let [a, b, c, ..] = self.rows[i];
            [a, b, c, self.rows[i][RIGHT]]
        };
        [row(0), row(1), row(2)]
    }

    pub(super) fn set_of_base(&mut self, rows: [[f64; 4]; 3]) {
        for (own, [a, b, c, right]) in self.rows.iter_mut().zip(rows) {
            own[..BASE].copy_from_slice(&[a, b, c]);
            own[RIGHT] = right;
        }
    }

    /// Adds a constraint on the base: its impulse acts along the first of two directions, with a damper along the second.
    pub(super) fn add(&mut self, acts: ActsOn, [force, action]: [&Direction; 2], damper: Damper) {
        let (f, d) = (force.body(), action.body());
        let (impulse, stiffness) = (damper.at(action.offset), damper.stiffness);
        for (row, f) in self.rows.iter_mut().zip(f) {
            for (entry, d) in row.iter_mut().zip(d) {
                *entry += stiffness * f * d;
            }
            row[RIGHT] += f * impulse;
        }
        if let Some(k) = acts.joint() {
            let own = BASE + k;
            for i in 0..BASE {
                self.rows[i][own] += stiffness * f[i] * action.joint_lever;
                self.rows[own][i] += stiffness * force.joint_lever * d[i];
            }
            self.rows[own][own] += stiffness * force.joint_lever * action.joint_lever;
            self.rows[own][RIGHT] += force.joint_lever * impulse;
        }
        let has_lever = action.spin_lever != 0.0 || force.spin_lever != 0.0;
        let Some(k) = acts.spin().filter(|_| has_lever) else {
            return;
        };
        let spin = &mut self.spins[k];
        spin.acts = true;
        spin.inertia += stiffness * force.spin_lever * action.spin_lever;
        spin.moment += force.spin_lever * impulse;
        for i in 0..BASE {
            spin.rows[i] += stiffness * f[i] * action.spin_lever;
            spin.columns[i] += stiffness * force.spin_lever * d[i];
        }
        if let Some(k) = acts.joint() {
            let own = BASE + k;
            spin.rows[own] += stiffness * force.joint_lever * action.spin_lever;
            spin.columns[own] += stiffness * force.spin_lever * action.joint_lever;
        }
    }

    /// Finds the velocities of the base, of what is hinged to it, and of what spins; none if the constraints contradict
    /// each other.
    pub(super) fn solve(&mut self, into: &mut Velocities) -> Option<()> {
        match self.joints {
            0 => self.solve_for::<BASE>(into),
            1 => self.solve_for::<{ BASE + 1 }>(into),
            _ => self.solve_for::<UNKNOWNS>(into),
        }
    }

    /// The same for a fixed number of unknowns: most problems have three, and the compiler can use that.
    fn solve_for<const COUNT: usize>(&mut self, into: &mut Velocities) -> Option<()> {
        for spin in self.spins.iter().filter(|spin| spin.acts) {
            for i in 0..COUNT {
                let share = spin.rows[i] / spin.inertia;
                for j in 0..COUNT {
                    self.rows[i][j] -= share * spin.columns[j];
                }
                self.rows[i][RIGHT] -= share * spin.moment;
            }
        }
        let known = eliminate::<COUNT>(&mut self.rows, self.weights)?;
        into.base = Twist {
            velocity: Vector::new(known[0], known[1]),
            turn: known[2],
        };
        into.joints[..COUNT - BASE].copy_from_slice(&known[BASE..]);
        for (rate, spin) in into.spins.iter_mut().zip(&self.spins) {
            let of_body: f64 = (0..COUNT).map(|i| spin.columns[i] * known[i]).sum();
            *rate = (spin.moment - of_body) / spin.inertia;
        }
        Some(())
    }
}

/// Gaussian elimination with pivoting; none if the system is singular. The squares of pivots are compared by the weights
/// of their rows, so that a copy of a robot on another scale has the same pivots.
fn eliminate<const COUNT: usize>(
    a: &mut [[f64; UNKNOWNS + 1]; UNKNOWNS],
    mut weights: [f64; UNKNOWNS],
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
            for j in (i + 1..COUNT).chain([RIGHT]) {
                row[j] -= share * above[j];
            }
        }
    }
    let mut known = [0.0; COUNT];
    for i in (0..COUNT).rev() {
        let of_known: f64 = (i + 1..COUNT).map(|j| a[i][j] * known[j]).sum();
        known[i] = (a[i][RIGHT] - of_known) / a[i][i];
    }
    Some(known)
}
