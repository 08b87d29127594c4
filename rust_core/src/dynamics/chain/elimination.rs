//! The elimination of a chain, shoe by shoe, once round.
//!
//! All that hangs on a shoe from behind has become part of its equations. What is left to it is to turn about its pin
//! in front: that turn is eliminated, and what it then takes to move the pin becomes part of the next shoe.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2x3, SVector, Vector3};

use super::system::{
    CHASSIS, CLOSING, ChainSystem, DRIVE, Entry, IDLER, Joint, RIGHT, Solved, WIDTH,
};
use crate::dynamics::state::Twist;

impl ChainSystem {
    /// Reduces the system to the chassis, adding the chain's part to the chassis' rows. None if the constraints
    /// contradict each other.
    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        let last = self.shoes.len() - 1;
        self.shoes[0].close(1, &self.joints[last]);
        for k in 0..last {
            let joint = &self.joints[k];
            let solved = self.shoes[k].turn_about_pin(joint)?;
            self.hand_on(k, &solved);
            self.solved[k] = solved;
        }
        self.shoes[last].close(0, &self.joints[last]);
        self.eliminate_last()?;
        self.solve_border()?;
        for (i, row) in chassis.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let column = if j < 3 { CHASSIS + j } else { RIGHT };
                *entry += self.border[(CHASSIS + i, column)];
            }
        }
        Some(())
    }

    /// Makes what is left of a shoe part of the next one and of the border.
    fn hand_on(&mut self, shoe: usize, solved: &Solved) {
        let Joint {
            rows: [front, back],
            pushes: [_, push],
            speed,
        } = self.joints[shoe];
        let below = self.shoes[shoe].below;
        let of_turn = below * turning_about(&front);
        let of_pin = below.fixed_columns::<2>(0) + of_turn * solved.turn.0;
        self.border += of_turn * solved.turn.1.transpose();
        let mut right = self.border.column_mut(RIGHT);
        right += of_pin * speed;

        let (own, mut beside) = solved.impulse;
        let mut right = beside.row_mut(RIGHT);
        right += (own * speed).transpose();
        let next = &mut self.shoes[shoe + 1];
        next.own += push.transpose() * own * back;
        next.beside += beside * push;
        next.below += of_pin * back;
    }

    /// Expresses the velocity of the last shoe in terms of the border.
    fn eliminate_last(&mut self) -> Option<()> {
        let last = self.shoes.len() - 1;
        let Entry { own, beside, below } = &self.shoes[last];
        self.last = -beside * own.try_inverse()?.transpose();
        self.border += below * self.last.transpose();
        let closes = self.joints[last].speed;
        let mut right = self.border.fixed_view_mut::<2, 1>(CLOSING, RIGHT);
        right += closes;
        Some(())
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
            self.border -= column * row;
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
        let mut velocity = self.last.tr_mul(&known);
        shoes[last] = Twist::from(<[f64; 3]>::from(velocity));
        for k in (0..last).rev() {
            let Joint { rows, speed, .. } = &self.joints[k];
            let Solved { turn, impulse } = &self.solved[k];
            let pin = rows[1] * velocity - speed;
            let turn = (turn.0 * pin).x + turn.1.dot(&known);
            velocity = turning_about(&rows[0]) * turn + Vector3::new(pin.x, pin.y, 0.0);
            self.impulses[k] = -(impulse.0 * pin + impulse.1.tr_mul(&known));
            shoes[k] = Twist::from(<[f64; 3]>::from(velocity));
        }
        [known[IDLER], known[DRIVE]]
    }
}

impl Entry {
    /// Adds the pin that closes the ring, of which it is the shoe before or after.
    fn close(&mut self, end: usize, joint: &Joint) {
        let mut below = self.below.fixed_rows_mut::<2>(CLOSING);
        below += joint.rows[end];
        let mut beside = self.beside.fixed_rows_mut::<2>(CLOSING);
        beside -= joint.pushes[end];
    }

    /// Solves for its turn about its pin in front.
    fn turn_about_pin(&self, joint: &Joint) -> Option<Solved> {
        let turning = turning_about(&joint.rows[0]);
        // The moment about the pin, of which the pin has no part.
        let moment = turning_about(&joint.pushes[0]);
        let (of_turn, resists) = (self.own * turning, moment.transpose() * self.own);
        let pivot = moment.dot(&of_turn);
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        let of_pin = resists.fixed_columns::<2>(0) / -pivot;
        let of_border = self.beside * moment / -pivot;
        let of_turn = of_turn.fixed_rows::<2>(0);
        Some(Solved {
            turn: (of_pin, of_border),
            impulse: (
                self.own.fixed_view::<2, 2>(0, 0) + of_turn * of_pin,
                self.beside.fixed_columns::<2>(0) + of_border * of_turn.transpose(),
            ),
        })
    }
}

/// The velocity of a shoe that turns at rate 1 about its pin in front, which has these rows.
fn turning_about(rows: &Matrix2x3<f64>) -> Vector3<f64> {
    Vector3::new(rows.m13, rows.m23, 1.0)
}
