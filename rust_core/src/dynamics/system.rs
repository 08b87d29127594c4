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
/// A pivot below this share of the largest entry counts as zero.
const SINGULAR: f64 = 1e-12;

/// The linear system, and the equations of the drives with a spin of their own.
pub(super) struct System {
    /// Rows of the chassis and of the flippers that turn freely.
    rows: [[f64; UNKNOWNS + 1]; UNKNOWNS],
    flippers: usize,
    pub(super) spins: Vec<Spin>,
    /// [rad/s] Solved rates of the flippers.
    pub(super) turns: [f64; FLIPPERS],
    /// [rad/s] Changes of these rates in a step of the descent.
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
    /// [rad/s] Change of the spin in a step of the descent.
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
        for own in (CHASSIS..COUNT).rev() {
            self.eliminate_flipper(own)?;
        }
        let body = eliminate(self.of_chassis())?;
        let mut known = [0.0; COUNT];
        known[..CHASSIS].copy_from_slice(&body);
        for own in CHASSIS..COUNT {
            let row = &self.rows[own];
            let of_known: f64 = (0..own).map(|j| row[j] * known[j]).sum();
            known[own] = (row[RIGHT] - of_known) / row[own];
            self.turns[own - CHASSIS] = known[own];
        }
        for spin in &mut self.spins {
            let of_body: f64 = (0..COUNT).map(|i| spin.columns[i] * known[i]).sum();
            spin.value = (spin.moment - of_body) / spin.inertia;
        }
        let [x, y, turn] = body;
        Some((Vector::new(x, y), turn))
    }

    /// Eliminates the rate of a flipper from the rows before its own; none if it has no inertia.
    fn eliminate_flipper(&mut self, own: usize) -> Option<()> {
        let pivot = self.rows[own];
        if pivot[own] <= 0.0 || !pivot[own].is_finite() {
            return None;
        }
        for row in &mut self.rows[..own] {
            let share = row[own] / pivot[own];
            for j in (0..own).chain([RIGHT]) {
                row[j] -= share * pivot[j];
            }
        }
        Some(())
    }
}

/// Gaussian elimination with pivoting.
fn eliminate(mut a: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    let largest = a
        .iter()
        .flat_map(|r| &r[..3])
        .fold(0.0, |m: f64, e| m.max(e.abs()));
    for i in 0..3 {
        let pivot = (i..3).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))?;
        a.swap(i, pivot);
        if a[i][i].abs() <= SINGULAR * largest {
            return None;
        }
        for j in i + 1..3 {
            let share = a[j][i] / a[i][i];
            let above = a[i];
            for (entry, above) in a[j].iter_mut().zip(above) {
                *entry -= share * above;
            }
        }
    }
    let turn = a[2][3] / a[2][2];
    let y = (a[1][3] - a[1][2] * turn) / a[1][1];
    let x = (a[0][3] - a[0][1] * y - a[0][2] * turn) / a[0][0];
    Some([x, y, turn])
}
