//! The linear system of a solve: chassis, flippers that turn freely, and drives with a spin of their own.
//!
//! The equations: docs/physics.md, "The linear system".

use super::action::Action;
use super::damper::Damper;
use crate::geometry::Vector;

/// Flippers at most: one pair at either end.
const FLIPPERS: usize = 2;
/// Columns of the chassis, of the flippers, and the right-hand side.
const CHASSIS: usize = 3;
const UNKNOWNS: usize = CHASSIS + FLIPPERS;
const RIGHT: usize = UNKNOWNS;

/// The linear system, and the equations of the drives with a spin of their own.
pub(super) struct System {
    /// Rows of the chassis and of the flippers that turn freely.
    rows: [[f64; UNKNOWNS + 1]; UNKNOWNS],
    flippers: usize,
    pub(super) spins: Vec<Spin>,
    /// [rad/s] Solved rates of the flippers.
    pub(super) turns: [f64; FLIPPERS],
    /// [rad/s] Changes of these rates on the way to a solution.
    pub(super) changes: [f64; FLIPPERS],
}

/// What an impulse acts on besides the chassis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Acts {
    pub drive: Option<usize>,
    pub flipper: Option<usize>,
}

/// The equation of one drive's spin: `inertia x spin + columns . velocity = moment`; the equations of the
/// velocity contain `rows x spin`.
#[derive(Clone, Copy, Default)]
pub(super) struct Spin {
    inertia: f64,
    moment: f64,
    columns: [f64; UNKNOWNS],
    rows: [f64; UNKNOWNS],
    /// Whether a constraint acts on it.
    acts: bool,
    /// [rad/s] Solved spin.
    pub value: f64,
    /// [rad/s] Change of the spin on the way to a solution.
    pub change: f64,
}

impl Spin {
    /// The equation of a drive on which nothing acts.
    pub(super) fn new(inertia: f64, moment: f64) -> Self {
        Self {
            inertia,
            moment,
            ..Self::default()
        }
    }
}

impl System {
    /// The system of a robot with this number of drives and flippers.
    pub(super) fn new(drives: usize, flippers: usize) -> Self {
        Self {
            rows: [[0.0; UNKNOWNS + 1]; UNKNOWNS],
            flippers,
            spins: vec![Spin::default(); drives],
            turns: [0.0; FLIPPERS],
            changes: [0.0; FLIPPERS],
        }
    }

    /// Starts from a chassis on which nothing acts.
    pub(super) fn start(&mut self, mass: f64, inertia: f64, velocity: Vector, moment: f64) {
        self.rows = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        let momentum = [mass * velocity.x, mass * velocity.y, moment];
        for (i, mass) in [mass, mass, inertia].into_iter().enumerate() {
            self.rows[i][i] = mass;
            self.rows[i][RIGHT] = momentum[i];
        }
    }

    /// Gives a trivial row to a flipper that turns with the chassis.
    pub(super) fn hold(&mut self, flipper: usize) {
        self.rows[CHASSIS + flipper][CHASSIS + flipper] = 1.0;
    }

    /// The rows of the chassis: three columns and the right-hand side.
    pub(super) fn of_chassis(&self) -> [[f64; 4]; 3] {
        let row = |i: usize| {
            let [a, b, c, ..] = self.rows[i];
            [a, b, c, self.rows[i][RIGHT]]
        };
        [row(0), row(1), row(2)]
    }

    pub(super) fn set_of_chassis(&mut self, rows: [[f64; 4]; 3]) {
        for (own, [a, b, c, right]) in self.rows.iter_mut().zip(rows) {
            own[..CHASSIS].copy_from_slice(&[a, b, c]);
            own[RIGHT] = right;
        }
    }

    /// Adds a constraint whose impulse acts along `force`, with a damper along `action`.
    pub(super) fn add(&mut self, force: &Action, action: &Action, acts: Acts, damper: Damper) {
        let (f, d) = (force.body(), action.body());
        let (impulse, stiffness) = (damper.at(action.offset), damper.stiffness);
        for (row, f) in self.rows.iter_mut().zip(f) {
            for (entry, d) in row.iter_mut().zip(d) {
                *entry += stiffness * f * d;
            }
            row[RIGHT] += f * impulse;
        }
        if let Some(k) = acts.flipper {
            let own = CHASSIS + k;
            for i in 0..CHASSIS {
                self.rows[i][own] += stiffness * f[i] * action.flipper_lever;
                self.rows[own][i] += stiffness * force.flipper_lever * d[i];
            }
            self.rows[own][own] += stiffness * force.flipper_lever * action.flipper_lever;
            self.rows[own][RIGHT] += force.flipper_lever * impulse;
        }
        let Some(k) = acts
            .drive
            .filter(|_| action.spin_lever != 0.0 || force.spin_lever != 0.0)
        else {
            return;
        };
        let spin = &mut self.spins[k];
        spin.acts = true;
        spin.inertia += stiffness * force.spin_lever * action.spin_lever;
        spin.moment += force.spin_lever * impulse;
        for i in 0..CHASSIS {
            spin.rows[i] += stiffness * f[i] * action.spin_lever;
            spin.columns[i] += stiffness * force.spin_lever * d[i];
        }
        if let Some(k) = acts.flipper {
            let own = CHASSIS + k;
            spin.rows[own] += stiffness * force.flipper_lever * action.spin_lever;
            spin.columns[own] += stiffness * force.spin_lever * action.flipper_lever;
        }
    }

    /// Velocity and angular velocity; none if the constraints contradict each other.
    pub(super) fn solve(&mut self) -> Option<(Vector, f64)> {
        match self.flippers {
            0 => self.solve_for::<CHASSIS>(),
            1 => self.solve_for::<{ CHASSIS + 1 }>(),
            _ => self.solve_for::<UNKNOWNS>(),
        }
    }

    /// The same for a fixed number of unknowns: most robots have three, and the compiler can use that.
    fn solve_for<const COUNT: usize>(&mut self) -> Option<(Vector, f64)> {
        for spin in self.spins.iter().filter(|spin| spin.acts) {
            for i in 0..COUNT {
                let share = spin.rows[i] / spin.inertia;
                for j in 0..COUNT {
                    self.rows[i][j] -= share * spin.columns[j];
                }
                self.rows[i][RIGHT] -= share * spin.moment;
            }
        }
        let known = eliminate::<COUNT>(&mut self.rows)?;
        self.turns[..COUNT - CHASSIS].copy_from_slice(&known[CHASSIS..]);
        for spin in &mut self.spins {
            let of_body: f64 = (0..COUNT).map(|i| spin.columns[i] * known[i]).sum();
            spin.value = (spin.moment - of_body) / spin.inertia;
        }
        Some((Vector::new(known[0], known[1]), known[2]))
    }
}

/// Gaussian elimination with pivoting; none if the system is singular.
fn eliminate<const COUNT: usize>(a: &mut [[f64; UNKNOWNS + 1]; UNKNOWNS]) -> Option<[f64; COUNT]> {
    for i in 0..COUNT {
        let pivot = (i..COUNT).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))?;
        a.swap(i, pivot);
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
