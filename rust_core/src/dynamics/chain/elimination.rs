//! The elimination of a chain: its shoes, each on its own, then its pins, once round.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, SMatrix, SVector};

use super::system::{
    BESIDE, CHASSIS, CLOSING, ChainSystem, DRIVE, IDLER, OF_SHOE, PinEntry, RIGHT, Solved, WIDTH,
    WIDTH_OF_SHOE,
};
use crate::dynamics::state::Twist;

impl ChainSystem {
    /// Reduces the system to the chassis, adding the chain's part to the chassis' rows. None if the constraints
    /// contradict each other.
    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        self.eliminate_shoes()?;
        self.couple_pins();
        let last = self.pins.len() - 1;
        for k in 0..last {
            let entry = self.pins[k];
            let inverse = entry.own.try_inverse()?;
            let (next, beside) = (inverse * entry.next, inverse * entry.beside);
            self.border.gemm(-1.0, &entry.below, &beside, 1.0);
            if k + 1 < last {
                let ahead = &mut self.pins[k + 1];
                ahead.own.gemm(-1.0, &entry.back, &next, 1.0);
                ahead.beside.gemm(-1.0, &entry.back, &beside, 1.0);
                ahead.below.gemm(-1.0, &entry.below, &next, 1.0);
            }
            self.solved[k] = (next, beside);
        }
        self.solve_border()?;
        for (i, row) in chassis.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let column = if j < 3 { CHASSIS + j } else { RIGHT };
                *entry += self.border[(CHASSIS + i, column)];
            }
        }
        Some(())
    }

    /// Expresses the velocities of the shoes in terms of border and pins.
    fn eliminate_shoes(&mut self) -> Option<()> {
        for (k, entry) in self.shoes.iter().enumerate() {
            let inverse = entry.own.try_inverse()?;
            let behind = (k + self.joints.len() - 1) % self.joints.len();
            let [front, _] = self.joints[k].pushes;
            let [_, back] = self.joints[behind].pushes;
            let beside = inverse * entry.beside;
            let of_shoe = entry.below * beside;
            for i in 0..BESIDE {
                for j in 0..BESIDE {
                    self.border[(i, j)] -= of_shoe[(i, j)];
                }
                self.border[(i, RIGHT)] -= of_shoe[(i, OF_SHOE)];
            }
            self.freed[k] = Solved {
                beside,
                pins: [front, back].map(|rows| inverse * rows.transpose()),
            };
        }
        Some(())
    }

    /// Sets up the rows and columns of the pins; the last one goes into the border.
    fn couple_pins(&mut self) {
        let (count, last) = (self.pins.len(), self.pins.len() - 1);
        let mut closing = PinEntry::default();
        for k in 0..count {
            let ahead = (k + 1) % count;
            let (joint, next_joint) = (&self.joints[k], &self.joints[ahead]);
            let [front, back] = joint.rows;
            let [own, next] = [&self.freed[k], &self.freed[ahead]];
            let mut entry = PinEntry {
                own: front * own.pins[0] + back * next.pins[1],
                next: back * next.pins[0],
                back: next_joint.rows[0] * next.pins[1],
                ..PinEntry::default()
            };
            let of_shoes = front * own.beside + back * next.beside;
            for i in 0..2 {
                for j in 0..BESIDE {
                    entry.beside[(i, j)] = -of_shoes[(i, j)];
                }
                entry.beside[(i, RIGHT)] = joint.speed[i] - of_shoes[(i, OF_SHOE)];
            }
            let below = self.shoes[k].below * own.pins[0] + self.shoes[ahead].below * next.pins[1];
            entry.below.fixed_rows_mut::<BESIDE>(0).copy_from(&below);
            if k == last {
                closing = entry;
            } else {
                self.pins[k] = entry;
            }
        }
        // The closing pin is both before the first and after the last but one.
        let before = self.pins[last - 1];
        let [first, before_last] = [0, last - 1];
        put(&mut self.pins[first].beside, 0, CLOSING, &closing.back);
        put(&mut self.pins[first].below, CLOSING, 0, &closing.next);
        put(&mut self.pins[before_last].beside, 0, CLOSING, &before.next);
        put(&mut self.pins[before_last].below, CLOSING, 0, &before.back);
        self.pins[before_last].next = Matrix2::zeros();
        put(&mut self.border, CLOSING, CLOSING, &closing.own);
        let mut rows = self.border.fixed_rows_mut::<2>(CLOSING);
        rows += closing.beside;
        let mut columns = self.border.fixed_columns_mut::<2>(CLOSING);
        columns += closing.below;
    }

    /// Expresses the closing pin, the drive and the idler in terms of the chassis.
    fn solve_border(&mut self) -> Option<()> {
        for pivot in [CLOSING, CLOSING + 1, IDLER, DRIVE] {
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

    /// Computes the velocities of the shoes and the impulses of the pins from the velocity of the chassis; returns
    /// the velocities of idler and sprocket.
    pub(super) fn follow(&mut self, chassis: [f64; 3], shoes: &mut [Twist]) -> [f64; 2] {
        let mut known = SVector::<f64, WIDTH>::zeros();
        known.fixed_rows_mut::<3>(CHASSIS).copy_from_slice(&chassis);
        known[RIGHT] = -1.0;
        let of_border = -(self.border * known);
        for i in [CLOSING, CLOSING + 1, DRIVE, IDLER] {
            known[i] = of_border[i];
        }
        let last = shoes.len() - 1;
        self.impulses[last] = known.fixed_rows::<2>(CLOSING).into_owned();
        for k in (0..last).rev() {
            let (next, beside) = &self.solved[k];
            self.impulses[k] = -(beside * known + next * self.impulses[k + 1]);
        }
        let mut of_shoe = SVector::<f64, WIDTH_OF_SHOE>::zeros();
        of_shoe.copy_from(&known.fixed_rows::<WIDTH_OF_SHOE>(0));
        of_shoe[OF_SHOE] = -1.0;
        for (k, shoe) in shoes.iter_mut().enumerate() {
            let behind = if k == 0 { last } else { k - 1 };
            let Solved { beside, pins } = &self.freed[k];
            let velocity =
                pins[0] * self.impulses[k] + pins[1] * self.impulses[behind] - beside * of_shoe;
            *shoe = Twist::from(<[f64; 3]>::from(velocity));
        }
        [known[IDLER], known[DRIVE]]
    }
}

fn put<const R: usize, const C: usize>(
    to: &mut SMatrix<f64, R, C>,
    row: usize,
    column: usize,
    block: &Matrix2<f64>,
) {
    to.fixed_view_mut::<2, 2>(row, column).copy_from(block);
}
