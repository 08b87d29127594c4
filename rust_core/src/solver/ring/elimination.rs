//! The elimination of a ring, once round, from link to link.
//!
//! When it is a link's turn, all links behind it have become part of its equations. Given the velocity of its hinge in
//! front, the link can only rotate about that: the rotation is eliminated, and the impulse that it then takes to move the
//! hinge becomes part of the next link's equations.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector3};

use super::system::{
    CLOSING_HINGE, DRIVE, Entry, Hinge, ON_BASE, RIGHT, RingSystem, SLIDE, Solved, Twisted, WIDTH,
};
use crate::geometry::{Twist, Vector, left_of};
use crate::solver::row::TURN;

impl RingSystem {
    /// Reduces the system to the border, and the border to the base and, if `spins`, the spinning body that drives the ring.
    /// None if the constraints contradict each other.
    pub(super) fn eliminate(&mut self, hinges: &[Hinge], spins: bool) -> Option<()> {
        let last = self.links.len() - 1;
        self.links[0].close(1, &hinges[last]);
        for (k, hinge) in hinges[..last].iter().enumerate() {
            if hinge.is_stiff() {
                self.resist(k, -1.0, hinge.twist);
                self.resist(k + 1, 1.0, hinge.twist);
            }
            let solved = self.links[k].turn_about_hinge(hinge)?;
            self.hand_on(k, hinge, &solved);
            if hinge.is_stiff() {
                self.hand_on_twist(k, hinge, &solved);
            }
            self.solved[k] = solved;
        }
        self.links[last].close(0, &hinges[last]);
        self.eliminate_last(&hinges[last])?;
        let of_ring = [CLOSING_HINGE, CLOSING_HINGE + 1, SLIDE, DRIVE];
        self.solve_border(&of_ring[..of_ring.len() - usize::from(spins)])
    }

    /// Makes what remains of a link part of the next one and of the border.
    fn hand_on(&mut self, link: usize, hinge: &Hinge, solved: &Solved) {
        let velocity = Vector2::new(hinge.velocity.x, hinge.velocity.y);
        let below = &self.links[link].below;
        let of_turn = below * turning_about(hinge.ends[0]);
        let of_pin = below.fixed_columns::<2>(0) + of_turn * solved.turn.0;
        self.border += of_turn * solved.turn.1.transpose();
        let mut right = self.border.column_mut(RIGHT);
        right += of_pin * velocity;

        let (own, mut beside) = solved.impulse;
        let mut right = beside.row_mut(RIGHT);
        right += (own * velocity).transpose();
        let (end, pushed_at) = (hinge.ends[1], hinge.pushed_at[1]);
        let own = on_link(own, end).transpose();
        let next = &mut self.links[link + 1];
        next.own += on_link(own, pushed_at).transpose();
        next.beside += on_link(beside, pushed_at);
        next.below += on_link(of_pin, end);
    }

    /// The same for the resistance of the hinge between them to rotation.
    fn hand_on_twist(&mut self, link: usize, hinge: &Hinge, solved: &Solved) {
        let stiffness = hinge.twist.damping;
        let velocity = Vector2::new(hinge.velocity.x, hinge.velocity.y);
        let Entry { own, below, .. } = self.links[link];
        let turning = turning_about(hinge.ends[0]);
        let of_turn = own * turning;
        let turn = stiffness / turning_about(hinge.pushed_at[0]).dot(&of_turn);
        let impulse = of_turn.fixed_rows::<2>(0) * turn;
        self.twisted[link] = Twisted { turn, impulse };

        let (of_pin, of_border) = solved.turn;
        let next = &mut self.links[link + 1];
        let mut column = next.own.column_mut(TURN);
        column += on_link(impulse.transpose(), hinge.pushed_at[1]).transpose();
        let mut row = next.own.row_mut(TURN);
        row -= on_link(of_pin, hinge.ends[1]) * stiffness;
        next.own[(TURN, TURN)] -= stiffness * turn;
        let mut column = next.beside.column_mut(TURN);
        column -= of_border * stiffness;
        next.beside[(RIGHT, TURN)] -= stiffness * (of_pin * velocity).x;
        let mut column = next.below.column_mut(TURN);
        column += below * turning * turn;
    }

    /// Expresses the velocity of the last link in terms of the border.
    fn eliminate_last(&mut self, hinge: &Hinge) -> Option<()> {
        let last = self.links.len() - 1;
        let Entry { own, beside, below } = &self.links[last];
        self.last = -beside * own.try_inverse()?.transpose();
        self.border += below * self.last.transpose();
        self.border[(CLOSING_HINGE, RIGHT)] += hinge.velocity.x;
        self.border[(CLOSING_HINGE + 1, RIGHT)] += hinge.velocity.y;
        Some(())
    }

    /// Expresses unknowns of the border in terms of the others.
    fn solve_border(&mut self, of_ring: &[usize]) -> Option<()> {
        for &pivot in of_ring {
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

    /// Computes the velocities of the links and the impulses of the hinges from the velocity of the base and the rate of the
    /// spinning body that drives the ring, if there is one. Returns the unknowns of the slide and the drive.
    pub(super) fn back_substitute(
        &mut self,
        hinges: &[Hinge],
        (base, spin): ([f64; 3], Option<f64>),
        links: &mut [f64],
    ) -> [f64; 2] {
        let mut known = SVector::<f64, WIDTH>::zeros();
        known.fixed_rows_mut::<3>(ON_BASE).copy_from_slice(&base);
        known[DRIVE] = spin.unwrap_or_default();
        known[RIGHT] = -1.0;
        let of_border = -(self.border * known);
        for i in [CLOSING_HINGE, CLOSING_HINGE + 1, SLIDE] {
            known[i] = of_border[i];
        }
        if spin.is_none() {
            known[DRIVE] = of_border[DRIVE];
        }
        let last = self.links.len() - 1;
        self.impulses[last] = known.fixed_rows::<2>(CLOSING_HINGE).into_owned();
        let mut next = Twist::from(<[f64; 3]>::from(self.last.tr_mul(&known)));
        let mut links = links.chunks_exact_mut(3).rev();
        let mut set = |twist: Twist| {
            if let Some(link) = links.next() {
                link.copy_from_slice(&twist.entries());
            }
        };
        set(next);
        for k in (0..last).rev() {
            let hinge = &hinges[k];
            let Solved { turn, impulse } = &self.solved[k];
            let end = next.at(hinge.ends[1]) - hinge.velocity;
            let pin = Vector2::new(end.x, end.y);
            let mut rate = (turn.0 * pin).x + turn.1.dot(&known);
            let mut pull = impulse.0 * pin + impulse.1.tr_mul(&known);
            if hinge.is_stiff() {
                let twisted = self.twisted[k];
                rate += twisted.turn * next.turn;
                pull += twisted.impulse * next.turn;
            }
            next = Twist {
                velocity: end - rate * left_of(hinge.ends[0]),
                turn: rate,
            };
            self.impulses[k] = -pull;
            set(next);
        }
        [known[SLIDE], known[DRIVE]]
    }
}

impl Entry {
    /// Adds the hinge that closes the ring to the link before it (side 0) or after it (side 1).
    fn close(&mut self, side: usize, hinge: &Hinge) {
        let sign = if side == 0 { -1.0 } else { 1.0 };
        let at_hinge = Matrix2::identity() * sign;
        let mut below = self.below.fixed_rows_mut::<2>(CLOSING_HINGE);
        below += on_link(at_hinge, hinge.ends[side]);
        let mut beside = self.beside.fixed_rows_mut::<2>(CLOSING_HINGE);
        beside -= on_link(at_hinge, hinge.pushed_at[side]);
    }

    /// Solves for its rotation about its hinge in front.
    fn turn_about_hinge(&self, hinge: &Hinge) -> Option<Solved> {
        let turning = turning_about(hinge.ends[0]);
        // The moment about the hinge, to which the hinge's own impulse does not contribute.
        let moment = turning_about(hinge.pushed_at[0]);
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

/// The velocities of a link that rotates at rate 1 about a point at `arm` [m] from its centre.
fn turning_about(arm: Vector) -> Vector3<f64> {
    let lever = left_of(arm);
    Vector3::new(-lever.x, -lever.y, 1.0)
}

/// Coefficients of the impulse or the velocity of a point on a link, at `arm` [m] from its centre, as those of the link.
fn on_link<const ROWS: usize>(
    at_point: SMatrix<f64, ROWS, 2>,
    arm: Vector,
) -> SMatrix<f64, ROWS, 3> {
    let (x, y, lever) = (at_point.column(0), at_point.column(1), left_of(arm));
    SMatrix::from_columns(&[x.into_owned(), y.into_owned(), x * lever.x + y * lever.y])
}
