//! The linear system of a chain of shoes, reduced by elimination to the system of the chassis.
//!
//! Each shoe has three rows and is coupled only to its two neighbours and the chassis, so the elimination goes
//! once round the chain. The last shoe closes the loop; like the chassis, the drive and the idler, it is part
//! of a border that is carried along.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};

use super::pin::Pin;
use crate::dynamics::damper::Damper;
use crate::dynamics::state::Twist;
use crate::geometry::Vector;

/// Rows and columns of the border: three for the closing shoe, three for the chassis, ...
const CLOSING: usize = 0;
const CHASSIS: usize = 3;
const TURN: usize = 5;
/// ... one for the drive (its force or the spin of its sprocket), one for the idler; then the right-hand side.
const DRIVE: usize = 6;
const IDLER: usize = 7;
const BORDER: usize = 8;
const RIGHT: usize = 8;
const WIDTH: usize = 9;

/// A body that takes part in a contact besides chassis and shoe.
#[derive(Clone, Copy)]
pub(super) enum Beside {
    Idler,
    Sprocket,
}

impl Beside {
    /// Its rows of the border: three of the chassis and its own.
    fn places(self) -> [usize; 4] {
        let own = match self {
            Beside::Idler => IDLER,
            Beside::Sprocket => DRIVE,
        };
        [CHASSIS, CHASSIS + 1, TURN, own]
    }
}

/// The part of the system that belongs to one shoe.
#[derive(Clone, Copy, Default)]
struct Entry {
    own: Matrix3<f64>,
    /// Its rows in the columns of the next shoe; the transpose holds the next shoe's rows in its columns.
    next: Matrix3<f64>,
    /// Its rows in the columns of the border, and the right-hand side.
    beside: SMatrix<f64, 3, WIDTH>,
    /// Rows of the border in its columns.
    below: SMatrix<f64, BORDER, 3>,
}

/// The system of one chain.
pub(super) struct ChainSystem {
    shoes: Vec<Entry>,
    /// The shoes in this piece with their pins only.
    bare: Vec<Entry>,
    /// Columns of the next shoe and of the border after the shoe's own have been eliminated.
    solved: Vec<(Matrix3<f64>, SMatrix<f64, 3, WIDTH>)>,
    border: SMatrix<f64, BORDER, WIDTH>,
}

impl ChainSystem {
    pub(super) fn new(count: usize) -> Self {
        Self {
            shoes: vec![Entry::default(); count],
            bare: vec![Entry::default(); count],
            solved: vec![Default::default(); count],
            border: SMatrix::zeros(),
        }
    }

    /// Sets up shoes of a mass and inertia with their velocities without constraints, and the stiffness of their
    /// pins.
    pub(super) fn link(&mut self, (mass, inertia): (f64, f64), free: &[Twist], pins: &[Pin]) {
        let masses = Vector3::new(mass, mass, inertia);
        for (bare, twist) in self.bare.iter_mut().zip(free) {
            *bare = Entry::default();
            bare.own.set_diagonal(&masses);
            let momentum = masses.component_mul(&Vector3::from(twist.entries()));
            bare.beside.set_column(RIGHT, &momentum);
        }
        for (i, pin) in pins.iter().enumerate() {
            let next = (i + 1) % self.bare.len();
            let [own, of_next] = pin.rows();
            self.bare[i].own += own.tr_mul(&own) * pin.stiffness;
            self.bare[i].next = own.tr_mul(&of_next) * pin.stiffness;
            self.bare[next].own += of_next.tr_mul(&of_next) * pin.stiffness;
        }
    }

    /// Starts from the linked shoes, with the impulses of their pins at rest, and an idler on a damper.
    pub(super) fn start(&mut self, pins: &[Pin], idler: Damper) {
        self.shoes.copy_from_slice(&self.bare);
        for (i, pin) in pins.iter().enumerate() {
            let impulse = pin.at(Vector::ZERO);
            let next = (i + 1) % self.shoes.len();
            for (shoe, rows) in [i, next].into_iter().zip(pin.rows()) {
                let mut right = self.shoes[shoe].beside.column_mut(RIGHT);
                right += rows.tr_mul(&Vector2::new(impulse.x, impulse.y));
            }
        }
        self.border = SMatrix::zeros();
        self.border[(DRIVE, DRIVE)] = 1.0;
        self.border[(IDLER, IDLER)] = idler.stiffness;
        self.border[(IDLER, RIGHT)] = idler.at(0.0);
    }

    /// Adds a constraint on one shoe; `rows` holds the directions of the speed and of the impulse.
    pub(super) fn add(&mut self, shoe: usize, rows: [[f64; 3]; 2], damper: Damper) {
        let entry = &mut self.shoes[shoe];
        let [force, action] = rows.map(Vector3::from);
        entry.own += force * action.transpose() * damper.stiffness;
        let mut right = entry.beside.column_mut(RIGHT);
        right += force * damper.at(0.0);
    }

    /// Adds a constraint between a shoe and the chassis with idler or sprocket; `back` holds three entries for the
    /// chassis and one for the other.
    pub(super) fn add_between(
        &mut self,
        shoe: usize,
        on_shoe: [[f64; 3]; 2],
        (back, beside): ([[f64; 4]; 2], Beside),
        damper: Damper,
    ) {
        self.add(shoe, on_shoe, damper);
        let (stiffness, impulse) = (damper.stiffness, damper.at(0.0));
        let ([force, action], [back_force, back_action]) = (on_shoe, back);
        let entry = &mut self.shoes[shoe];
        for (i, at) in beside.places().into_iter().enumerate() {
            let (force_there, action_there) = (stiffness * back_force[i], back_action[i]);
            for (k, there) in beside.places().into_iter().enumerate() {
                self.border[(there, at)] += stiffness * back_force[k] * action_there;
            }
            for k in 0..3 {
                entry.beside[(k, at)] += stiffness * force[k] * action_there;
                entry.below[(at, k)] += force_there * action[k];
            }
            self.border[(at, RIGHT)] += back_force[i] * impulse;
        }
    }

    /// Couples a shoe to the drive: how its velocity, and that of the chassis, enter the drive's speed.
    pub(super) fn add_drive(&mut self, shoe: usize, on_shoe: [f64; 3], on_chassis: [f64; 3]) {
        let entry = &mut self.shoes[shoe];
        for i in 0..3 {
            entry.beside[(i, DRIVE)] += on_shoe[i];
            entry.below[(DRIVE, i)] += on_shoe[i];
            self.border[(CHASSIS + i, DRIVE)] += on_chassis[i];
            self.border[(DRIVE, CHASSIS + i)] += on_chassis[i];
        }
    }

    /// Sets the damper of the drive.
    pub(super) fn set_drive(&mut self, damper: Damper) {
        self.border[(DRIVE, DRIVE)] = -1.0 / damper.stiffness;
        self.border[(DRIVE, RIGHT)] = damper.at(0.0) / damper.stiffness;
    }

    /// Adds a sprocket to the drive: its inertia [kg m^2] and its spin [rad/s] without constraints.
    pub(super) fn add_sprocket(&mut self, inertia: f64, spin: f64) {
        self.border[(DRIVE, DRIVE)] = inertia;
        self.border[(DRIVE, RIGHT)] = inertia * spin;
    }

    /// Adds a damper at a lever [m] that turns chassis and sprocket against each other; its speed is that of the
    /// chassis relative to the sprocket.
    pub(super) fn turn_sprocket(&mut self, lever: f64, damper: Damper) {
        let levers = [(TURN, lever), (DRIVE, -lever)];
        for (row, of_row) in levers {
            for (column, of_column) in levers {
                self.border[(row, column)] += of_row * of_column * damper.stiffness;
            }
            self.border[(row, RIGHT)] += of_row * damper.at(0.0);
        }
    }

    /// Adds a constant impulse on a shoe and on the chassis.
    pub(super) fn push(
        &mut self,
        shoe: usize,
        on_shoe: [f64; 3],
        on_chassis: [f64; 3],
        impulse: f64,
    ) {
        for i in 0..3 {
            self.shoes[shoe].beside[(i, RIGHT)] += on_shoe[i] * impulse;
            self.border[(CHASSIS + i, RIGHT)] += on_chassis[i] * impulse;
        }
    }

    /// Reduces the system to the chassis, adding the chain's part to the chassis' rows. None if the constraints
    /// contradict each other.
    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        let last = self.shoes.len() - 1;
        let closing = self.shoes[last];
        let mut before = closing.next.transpose();
        for k in 0..last {
            let mut entry = self.shoes[k];
            // The closing shoe is both before the first and after the last but one.
            if k + 1 == last {
                before += std::mem::take(&mut entry.next);
            }
            add_block(&mut entry.beside, 0, CLOSING, &before);
            add_block(&mut entry.below, CLOSING, 0, &before.transpose());
            before = Matrix3::zeros();
            let inverse = entry.own.try_inverse()?;
            let (next, beside) = (inverse * entry.next, inverse * entry.beside);
            self.border.gemm(-1.0, &entry.below, &beside, 1.0);
            let back = entry.next.transpose();
            let behind = &mut self.shoes[k + 1];
            behind.own.gemm(-1.0, &back, &next, 1.0);
            behind.beside.gemm(-1.0, &back, &beside, 1.0);
            behind.below.gemm(-1.0, &entry.below, &next, 1.0);
            self.solved[k] = (next, beside);
        }
        add_block(&mut self.border, CLOSING, CLOSING, &closing.own);
        let mut rows = self.border.fixed_rows_mut::<3>(CLOSING);
        rows += closing.beside;
        let mut columns = self.border.fixed_columns_mut::<3>(CLOSING);
        columns += closing.below;
        self.solve_border()?;
        for (i, row) in chassis.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let column = if j < 3 { CHASSIS + j } else { RIGHT };
                *entry += self.border[(CHASSIS + i, column)];
            }
        }
        Some(())
    }

    /// Expresses the closing shoe, the drive and the idler in terms of the chassis.
    fn solve_border(&mut self) -> Option<()> {
        for pivot in [0, 1, 2, IDLER, DRIVE] {
            let by = self.border[(pivot, pivot)];
            if by == 0.0 || !by.is_finite() {
                return None;
            }
            let row = self.border.row(pivot) / by;
            let mut column = self.border.column(pivot).into_owned();
            column[pivot] = 0.0;
            self.border.gemm(-1.0, &column, &row, 1.0);
            self.border.set_row(pivot, &row);
        }
        Some(())
    }

    /// Computes the velocities of the shoes from that of the chassis; returns those of idler and sprocket.
    pub(super) fn follow(&self, chassis: [f64; 3], shoes: &mut [Twist]) -> [f64; 2] {
        let mut known = SVector::<f64, WIDTH>::zeros();
        known.fixed_rows_mut::<3>(CHASSIS).copy_from_slice(&chassis);
        known[RIGHT] = -1.0;
        let of_border = -(self.border * known);
        for i in [0, 1, 2, DRIVE, IDLER] {
            known[i] = of_border[i];
        }
        let last = shoes.len() - 1;
        let closing = known.fixed_rows::<3>(CLOSING).into_owned();
        shoes[last] = Twist::from(<[f64; 3]>::from(closing));
        let mut behind = Vector3::zeros();
        for k in (0..last).rev() {
            let (next, beside) = &self.solved[k];
            behind = -(beside * known + next * behind);
            shoes[k] = Twist::from(<[f64; 3]>::from(behind));
        }
        [known[IDLER], known[DRIVE]]
    }
}

fn add_block<const R: usize, const C: usize>(
    to: &mut SMatrix<f64, R, C>,
    row: usize,
    column: usize,
    block: &Matrix3<f64>,
) {
    let mut place = to.fixed_view_mut::<3, 3>(row, column);
    place += block;
}
