//! The linear system of a chain of shoes, eliminated into that of the chassis.
//!
//! Each shoe has three rows and meets its two neighbours and the chassis only, so the elimination goes
//! once round the chain. The last shoe closes it: like the chassis and the drive it is carried along as a
//! border.

use crate::dynamics::direct::Damper;
use crate::dynamics::state::Twist;

/// Columns beside a shoe's own: those of the next shoe, ...
const NEXT: usize = 0;
/// ... of the one that closes the chain, ...
const CLOSING: usize = 3;
/// ... of the chassis, ...
const CHASSIS: usize = 6;
/// ... of drive and idler, and the right-hand side.
const DRIVE: usize = 9;
const IDLER: usize = 10;
const RIGHT: usize = 11;
const WIDTH: usize = 12;
/// Rows of the border: those of the closing shoe, the chassis, drive and idler; so are its columns, and
/// the right-hand side.
const BORDER: usize = 8;
const OF_DRIVE: usize = 6;
const OF_IDLER: usize = 7;
const OF_RIGHT: usize = 8;

type Block = [[f64; 3]; 3];
type Wide = [[f64; WIDTH]; 3];

/// What of the system belongs to one shoe.
#[derive(Clone, Copy, Default)]
struct Entry {
    own: Block,
    beside: Wide,
    /// Rows of the chassis in the columns of the shoe, ...
    below: Block,
    /// ... of the drive and of the idler.
    drive: [f64; 3],
    idler: [f64; 3],
}

/// The system of one chain.
pub(super) struct ChainSystem {
    shoes: Vec<Entry>,
    /// Each shoe's row once its own columns are eliminated.
    solved: Vec<Wide>,
    border: [[f64; BORDER + 1]; BORDER],
}

impl ChainSystem {
    pub(super) fn new(count: usize) -> Self {
        Self {
            shoes: vec![Entry::default(); count],
            solved: vec![Wide::default(); count],
            border: [[0.0; BORDER + 1]; BORDER],
        }
    }

    /// Shoes of a mass and inertia that nothing acts on, with such velocities, and an idler on a damper.
    pub(super) fn start(&mut self, (mass, inertia): (f64, f64), free: &[Twist], idler: Damper) {
        for (shoe, twist) in self.shoes.iter_mut().zip(free) {
            *shoe = Entry::default();
            let masses = [mass, mass, inertia];
            for (i, v) in twist.entries().into_iter().enumerate() {
                shoe.own[i][i] = masses[i];
                shoe.beside[i][RIGHT] = masses[i] * v;
            }
        }
        self.border = [[0.0; BORDER + 1]; BORDER];
        self.border[OF_DRIVE][OF_DRIVE] = 1.0;
        self.border[OF_IDLER][OF_IDLER] = idler.stiffness;
        self.border[OF_IDLER][OF_RIGHT] = idler.at(0.0);
    }

    /// Adds a constraint on one shoe: the impulse of a damper along `action` acts along `force`.
    pub(super) fn add(&mut self, shoe: usize, [force, action]: [[f64; 3]; 2], damper: Damper) {
        let entry = &mut self.shoes[shoe];
        for i in 0..3 {
            for j in 0..3 {
                entry.own[i][j] += damper.stiffness * force[i] * action[j];
            }
            entry.beside[i][RIGHT] += force[i] * damper.at(0.0);
        }
    }

    /// The same of a constraint that acts on chassis and idler, too; these are the first three and the last
    /// of `back`.
    pub(super) fn add_between(
        &mut self,
        shoe: usize,
        on_shoe: [[f64; 3]; 2],
        back: [[f64; 4]; 2],
        damper: Damper,
    ) {
        self.add(shoe, on_shoe, damper);
        let entry = &mut self.shoes[shoe];
        let ([force, action], [back_force, back_action]) = (on_shoe, back);
        let stiffness = damper.stiffness;
        for i in 0..3 {
            for j in 0..3 {
                entry.beside[i][CHASSIS + j] += stiffness * force[i] * back_action[j];
                entry.below[i][j] += stiffness * back_force[i] * action[j];
            }
            entry.beside[i][IDLER] += stiffness * force[i] * back_action[3];
            entry.idler[i] += stiffness * back_force[3] * action[i];
        }
        const PLACES: [usize; 4] = [3, 4, 5, OF_IDLER];
        for (i, force) in PLACES.into_iter().zip(back_force) {
            for (j, action) in PLACES.into_iter().zip(back_action) {
                self.border[i][j] += stiffness * force * action;
            }
            self.border[i][OF_RIGHT] += force * damper.at(0.0);
        }
    }

    /// Adds a pin between a shoe and the next: one row `[of the shoe, of the next]` of its velocity.
    pub(super) fn add_pin(&mut self, shoe: usize, [a, b]: [[f64; 3]; 2], damper: Damper) {
        let next = (shoe + 1) % self.shoes.len();
        self.add(shoe, [a, a], damper);
        self.add(next, [b, b], damper);
        let beside = &mut self.shoes[shoe].beside;
        for i in 0..3 {
            for j in 0..3 {
                beside[i][NEXT + j] += damper.stiffness * a[i] * b[j];
            }
        }
    }

    /// Joins a shoe to the drive: how the drive's speed counts its velocity, and that of the chassis.
    pub(super) fn add_drive(&mut self, shoe: usize, on_shoe: [f64; 3], on_chassis: [f64; 3]) {
        for i in 0..3 {
            self.shoes[shoe].beside[i][DRIVE] += on_shoe[i];
            self.shoes[shoe].drive[i] += on_shoe[i];
            self.border[3 + i][OF_DRIVE] += on_chassis[i];
            self.border[OF_DRIVE][3 + i] += on_chassis[i];
        }
    }

    /// The damper of the drive.
    pub(super) fn set_drive(&mut self, damper: Damper) {
        self.border[OF_DRIVE][OF_DRIVE] = -1.0 / damper.stiffness;
        self.border[OF_DRIVE][OF_RIGHT] = damper.at(0.0) / damper.stiffness;
    }

    /// A constant impulse on a shoe and on the chassis.
    pub(super) fn push(
        &mut self,
        shoe: usize,
        on_shoe: [f64; 3],
        on_chassis: [f64; 3],
        impulse: f64,
    ) {
        for i in 0..3 {
            self.shoes[shoe].beside[i][RIGHT] += on_shoe[i] * impulse;
            self.border[3 + i][OF_RIGHT] += on_chassis[i] * impulse;
        }
    }

    /// Leaves only the chassis: adds what the chain does to its rows. None if the constraints contradict
    /// each other.
    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        let last = self.shoes.len() - 1;
        let closing = self.shoes[last];
        // Rows of the border in the columns of the shoe.
        let mut below = [[0.0; 3]; BORDER];
        for i in 0..3 {
            for j in 0..3 {
                below[i][j] = closing.beside[i][NEXT + j];
                self.shoes[0].beside[i][CLOSING + j] += closing.beside[j][NEXT + i];
            }
        }
        for k in 0..last {
            let Entry {
                own,
                mut beside,
                below: of_chassis,
                drive,
                idler,
            } = self.shoes[k];
            for i in 0..3 {
                for j in 0..3 {
                    below[3 + i][j] += of_chassis[i][j];
                }
                below[OF_DRIVE][i] += drive[i];
                below[OF_IDLER][i] += idler[i];
            }
            let link: Block = [0, 1, 2].map(|i| [0, 1, 2].map(|j| beside[i][NEXT + j]));
            if k + 1 == last {
                for i in 0..3 {
                    for j in 0..3 {
                        beside[i][CLOSING + j] += link[i][j];
                        below[i][j] += link[j][i];
                    }
                    beside[i][NEXT..NEXT + 3].fill(0.0);
                }
            }
            let solved = product(&inverse(&own)?, &beside);
            for (row, share) in self.border.iter_mut().zip(&below) {
                for (j, solved) in solved.iter().enumerate() {
                    for (entry, x) in row.iter_mut().zip(&solved[CLOSING..]) {
                        *entry -= share[j] * x;
                    }
                }
            }
            if k + 1 < last {
                let next = &mut self.shoes[k + 1];
                for i in 0..3 {
                    for j in 0..3 {
                        let share = link[j][i];
                        for c in 0..3 {
                            next.own[i][c] -= share * solved[j][NEXT + c];
                        }
                        for c in CLOSING..WIDTH {
                            next.beside[i][c] -= share * solved[j][c];
                        }
                    }
                }
                for row in &mut below {
                    let share = *row;
                    for c in 0..3 {
                        row[c] = -(0..3).map(|j| share[j] * solved[j][NEXT + c]).sum::<f64>();
                    }
                }
            }
            self.solved[k] = solved;
        }
        let closing = self.shoes[last];
        for i in 0..3 {
            for j in 0..3 {
                self.border[i][j] += closing.own[i][j];
                self.border[i][3 + j] += closing.beside[i][CHASSIS + j];
                self.border[3 + i][j] += closing.below[i][j];
            }
            self.border[i][OF_DRIVE] += closing.beside[i][DRIVE];
            self.border[i][OF_IDLER] += closing.beside[i][IDLER];
            self.border[i][OF_RIGHT] += closing.beside[i][RIGHT];
            self.border[OF_DRIVE][i] += closing.drive[i];
            self.border[OF_IDLER][i] += closing.idler[i];
        }
        // The closing shoe, the drive and the idler in terms of the chassis.
        for pivot in [0, 1, 2, OF_IDLER, OF_DRIVE] {
            let by = self.border[pivot][pivot];
            if by == 0.0 || !by.is_finite() {
                return None;
            }
            let row = self.border[pivot].map(|entry| entry / by);
            self.border[pivot] = row;
            for (i, other) in self.border.iter_mut().enumerate() {
                if i != pivot {
                    let share = other[pivot];
                    for (entry, x) in other.iter_mut().zip(row) {
                        *entry -= share * x;
                    }
                }
            }
        }
        for (i, row) in chassis.iter_mut().enumerate() {
            for (entry, x) in row.iter_mut().zip(&self.border[3 + i][3..6]) {
                *entry += x;
            }
            row[3] += self.border[3 + i][OF_RIGHT];
        }
        Some(())
    }

    /// The velocities of the shoes with those of the chassis; returns that of the idler.
    pub(super) fn follow(&self, chassis: [f64; 3], shoes: &mut [Twist]) -> f64 {
        let of_border = |i: usize| {
            let row = &self.border[i];
            row[OF_RIGHT] - (0..3).map(|j| row[3 + j] * chassis[j]).sum::<f64>()
        };
        let (drive, idler) = (of_border(OF_DRIVE), of_border(OF_IDLER));
        let closing = [0, 1, 2].map(of_border);
        let last = shoes.len() - 1;
        shoes[last] = Twist::from(closing);
        let mut next = [0.0; 3];
        for k in (0..last).rev() {
            let mut of_shoe = [0.0; 3];
            for (v, row) in of_shoe.iter_mut().zip(&self.solved[k]) {
                *v = row[RIGHT] - row[DRIVE] * drive - row[IDLER] * idler;
                for j in 0..3 {
                    *v -= row[NEXT + j] * next[j]
                        + row[CLOSING + j] * closing[j]
                        + row[CHASSIS + j] * chassis[j];
                }
            }
            shoes[k] = Twist::from(of_shoe);
            next = of_shoe;
        }
        idler
    }
}

/// The inverse; none of a singular one.
fn inverse(a: &Block) -> Option<Block> {
    let minor = |i: usize, j: usize| {
        let (r, c) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        a[r[0]][c[0]] * a[r[1]][c[1]] - a[r[0]][c[1]] * a[r[1]][c[0]]
    };
    let determinant: f64 = (0..3).map(|j| a[0][j] * minor(0, j)).sum();
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    Some([0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / determinant)))
}

fn product(a: &Block, b: &Wide) -> Wide {
    let mut c = [[0.0; WIDTH]; 3];
    for (row, shares) in c.iter_mut().zip(a) {
        for (share, b) in shares.iter().zip(b) {
            for (entry, x) in row.iter_mut().zip(b) {
                *entry += share * x;
            }
        }
    }
    c
}
