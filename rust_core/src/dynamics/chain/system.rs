//! The linear system of a chain of shoes, reduced by elimination to the system of the chassis.
//!
//! The pins are exact: their impulses are unknowns, beside the velocities. Each shoe is coupled only to its own
//! two pins, the chassis, the drive and the idler, so shoes are eliminated first, each on its own. What is left
//! has two rows for each pin, which is coupled to its two neighbours: the elimination goes once round the chain.
//! The last pin closes the ring; like the chassis, the drive and the idler, it is part of a border that is carried
//! along. Stiff springs in place of the pins would cost as many digits as they are stiffer than shoes are heavy,
//! and what is lost acts like blows that shake the robot, harder the shorter the step.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, Matrix2x3, Matrix3, SMatrix, SVector, Vector2, Vector3};

use super::pin::Pin;
use crate::dynamics::damper::Damper;
use crate::dynamics::state::Twist;
use crate::geometry::Vector;

/// Rows and columns of the border: three for the chassis, ...
const CHASSIS: usize = 0;
const TURN: usize = 2;
/// ... one for the drive (its force or the spin of its sprocket), one for the idler, ...
const DRIVE: usize = 3;
const IDLER: usize = 4;
/// ... which are those that act on shoes; two for the closing pin; then the right-hand side.
const BESIDE: usize = 5;
const CLOSING: usize = BESIDE;
const BORDER: usize = 7;
const RIGHT: usize = BORDER;
const WIDTH: usize = BORDER + 1;
/// The right-hand side of a shoe.
const OF_SHOE: usize = BESIDE;
const WIDTH_OF_SHOE: usize = BESIDE + 1;

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
    /// Its rows in the columns of chassis, drive and idler, and the right-hand side.
    beside: SMatrix<f64, 3, WIDTH_OF_SHOE>,
    /// Rows of chassis, drive and idler in its columns.
    below: SMatrix<f64, BESIDE, 3>,
}

/// How a pin holds its two shoes.
#[derive(Clone, Copy, Default)]
struct Joint {
    /// Entries of both shoes' velocities in its speed.
    rows: [Matrix2x3<f64>; 2],
    /// [m/s] Its speed.
    speed: Vector2<f64>,
}

/// The velocity of a shoe after its elimination.
#[derive(Clone, Copy, Default)]
struct Solved {
    /// In terms of chassis, drive and idler, and its constant part, both with opposite sign as in the equations.
    beside: SMatrix<f64, 3, WIDTH_OF_SHOE>,
    /// Per impulse of the pin in front and of the pin behind.
    pins: [SMatrix<f64, 3, 2>; 2],
}

/// The rows of a pin, and its columns, after the elimination of the shoes.
#[derive(Clone, Copy, Default)]
struct PinEntry {
    own: Matrix2<f64>,
    /// Its rows in the columns of the next pin, and the next pin's rows in its own.
    next: Matrix2<f64>,
    back: Matrix2<f64>,
    /// Its rows in the columns of the border, and the right-hand side.
    beside: SMatrix<f64, 2, WIDTH>,
    /// Rows of the border in its columns.
    below: SMatrix<f64, BORDER, 2>,
}

/// The system of one chain.
pub(super) struct ChainSystem {
    shoes: Vec<Entry>,
    /// The shoes in this piece without constraints.
    bare: Vec<Entry>,
    joints: Vec<Joint>,
    freed: Vec<Solved>,
    pins: Vec<PinEntry>,
    /// Columns of the next pin and of the border after the pin's own have been eliminated.
    solved: Vec<(Matrix2<f64>, SMatrix<f64, 2, WIDTH>)>,
    border: SMatrix<f64, BORDER, WIDTH>,
    /// [N s] Impulse of each pin on the next shoe.
    impulses: Vec<Vector2<f64>>,
}

impl ChainSystem {
    pub(super) fn new(count: usize) -> Self {
        Self {
            shoes: vec![Entry::default(); count],
            bare: vec![Entry::default(); count],
            joints: vec![Joint::default(); count],
            freed: vec![Solved::default(); count],
            pins: vec![PinEntry::default(); count],
            solved: vec![Default::default(); count],
            border: SMatrix::zeros(),
            impulses: vec![Vector2::zeros(); count],
        }
    }

    /// Sets up shoes of a mass and inertia with their velocities without constraints, and pins that close their
    /// gaps in `h` [s].
    pub(super) fn link(
        &mut self,
        (mass, inertia): (f64, f64),
        free: &[Twist],
        pins: &[Pin],
        h: f64,
    ) {
        let masses = Vector3::new(mass, mass, inertia);
        for (bare, twist) in self.bare.iter_mut().zip(free) {
            *bare = Entry::default();
            bare.own.set_diagonal(&masses);
            let momentum = masses.component_mul(&Vector3::from(twist.entries()));
            bare.beside.set_column(OF_SHOE, &momentum);
        }
        for (joint, pin) in self.joints.iter_mut().zip(pins) {
            *joint = Joint {
                rows: pin.rows(),
                speed: Vector2::new(pin.gap.x, pin.gap.y) / -h,
            };
        }
    }

    /// Starts from the bare shoes and an idler on a damper.
    pub(super) fn start(&mut self, idler: Damper) {
        self.shoes.copy_from_slice(&self.bare);
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
        let mut right = entry.beside.column_mut(OF_SHOE);
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
            self.shoes[shoe].beside[(i, OF_SHOE)] += on_shoe[i] * impulse;
            self.border[(CHASSIS + i, RIGHT)] += on_chassis[i] * impulse;
        }
    }

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
            let [front, _] = self.joints[k].rows;
            let [_, back] = self.joints[behind].rows;
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

    /// [N s] Impulse of each pin on the next shoe in the last solution.
    pub(super) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.impulses.iter().map(|p| Vector::new(p.x, p.y))
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
