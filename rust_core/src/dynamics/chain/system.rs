//! The linear system of a chain of shoes, reduced by elimination to the system of the chassis.
//!
//! The pins are exact: their impulses are unknowns, beside the velocities. Each shoe is coupled only to its own
//! two pins, the chassis, the drive and the idler, so the elimination goes once round the chain, from shoe to shoe. The
//! last pin closes the ring; like the chassis, the drive and the idler, it is part of a border that is carried
//! along. Stiff springs in place of the pins would cost as many digits as they are stiffer than shoes are heavy,
//! and what is lost acts like blows that shake the robot, harder the shorter the step.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, Matrix2x3, Matrix3, RowVector2, SMatrix, SVector, Vector2, Vector3};

use super::pin::Pin;
use crate::dynamics::damper::Damper;
use crate::dynamics::state::Twist;
use crate::geometry::Vector;

/// Rows and columns of the border: three for the chassis, ...
pub(super) const CHASSIS: usize = 0;
const TURN: usize = 2;
/// ... one for the drive (its force or the spin of its sprocket), one for the idler, ...
pub(super) const DRIVE: usize = 3;
pub(super) const IDLER: usize = 4;
/// ... two for the closing pin; then the right-hand side, a column without a row.
pub(super) const CLOSING: usize = 5;
pub(super) const RIGHT: usize = 7;
pub(super) const WIDTH: usize = 8;

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
pub(super) struct Entry {
    pub(super) own: Matrix3<f64>,
    /// Its rows in the columns of the border, and the right-hand side; each is a column here.
    pub(super) beside: SMatrix<f64, WIDTH, 3>,
    /// Rows of the border in its columns.
    pub(super) below: SMatrix<f64, WIDTH, 3>,
}

/// How a pin holds its two shoes.
#[derive(Clone, Copy, Default)]
pub(super) struct Joint {
    /// Entries of both shoes' velocities in its speed, and of its impulse on them.
    pub(super) rows: [Matrix2x3<f64>; 2],
    pub(super) pushes: [Matrix2x3<f64>; 2],
    /// [m/s] Its speed.
    pub(super) speed: Vector2<f64>,
}

/// What follows for a shoe, once eliminated, from the velocity of its pin in front and from the border.
#[derive(Clone, Copy, Default)]
pub(super) struct Solved {
    /// Its turn ...
    pub(super) turn: (RowVector2<f64>, SVector<f64, WIDTH>),
    /// ... and the impulse of the pin on it.
    pub(super) impulse: (Matrix2<f64>, SMatrix<f64, WIDTH, 2>),
}

/// The system of one chain.
pub(super) struct ChainSystem {
    pub(super) shoes: Vec<Entry>,
    /// Masses, inertia and momentum of the shoes in this step without constraints.
    free: Vec<[Vector3<f64>; 2]>,
    pub(super) joints: Vec<Joint>,
    /// What the elimination keeps of each shoe but the last, and of that one: its velocity in terms of the border.
    pub(super) solved: Vec<Solved>,
    pub(super) last: SMatrix<f64, WIDTH, 3>,
    pub(super) border: SMatrix<f64, WIDTH, WIDTH>,
    /// [N s] Impulse of each pin on the next shoe.
    pub(super) impulses: Vec<Vector2<f64>>,
}

impl ChainSystem {
    pub(super) fn new(count: usize) -> Self {
        Self {
            shoes: vec![Entry::default(); count],
            free: vec![Default::default(); count],
            joints: vec![Joint::default(); count],
            solved: vec![Solved::default(); count],
            last: SMatrix::zeros(),
            border: SMatrix::zeros(),
            impulses: vec![Vector2::zeros(); count],
        }
    }

    /// Sets up shoes of a mass, and inertias, with their velocities without constraints.
    pub(super) fn free(&mut self, mass: f64, inertias: &[f64], free: &[Twist]) {
        for ((own, inertia), twist) in self.free.iter_mut().zip(inertias).zip(free) {
            let masses = Vector3::new(mass, mass, *inertia);
            *own = [
                masses,
                masses.component_mul(&Vector3::from(twist.entries())),
            ];
        }
    }

    /// Links the shoes by pins that close their gaps in `h` [s].
    pub(super) fn link(&mut self, pins: &[Pin], h: f64) {
        for (joint, pin) in self.joints.iter_mut().zip(pins) {
            *joint = Joint {
                rows: pin.rows(),
                pushes: pin.rows(),
                speed: Vector2::new(pin.gap.x, pin.gap.y) / -h,
            };
        }
    }

    /// Lets the pins hold the shoes together.
    pub(super) fn hold(&mut self, pins: &[Pin]) {
        for (joint, pin) in self.joints.iter_mut().zip(pins) {
            joint.rows = pin.rows();
            joint.speed = Vector2::zeros();
        }
    }

    /// Lets the pins push in their present directions.
    pub(super) fn push_along(&mut self, pins: &[Pin]) {
        for (joint, pin) in self.joints.iter_mut().zip(pins) {
            joint.pushes = pin.rows();
        }
    }

    /// Starts from the shoes without constraints and an idler on a damper.
    pub(super) fn start(&mut self, idler: Damper) {
        for (shoe, [masses, momentum]) in self.shoes.iter_mut().zip(&self.free) {
            *shoe = Entry::default();
            shoe.own.set_diagonal(masses);
            shoe.beside.set_row(RIGHT, &momentum.transpose());
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
        let mut right = entry.beside.row_mut(RIGHT);
        right += force.transpose() * damper.at(0.0);
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
                entry.beside[(at, k)] += stiffness * force[k] * action_there;
                entry.below[(at, k)] += force_there * action[k];
            }
            self.border[(at, RIGHT)] += back_force[i] * impulse;
        }
    }

    /// Couples a shoe to the drive: how its velocity, and that of the chassis, enter the drive's speed.
    pub(super) fn add_drive(&mut self, shoe: usize, on_shoe: [f64; 3], on_chassis: [f64; 3]) {
        let entry = &mut self.shoes[shoe];
        for i in 0..3 {
            entry.beside[(DRIVE, i)] += on_shoe[i];
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
            self.shoes[shoe].beside[(RIGHT, i)] += on_shoe[i] * impulse;
            self.border[(CHASSIS + i, RIGHT)] += on_chassis[i] * impulse;
        }
    }

    /// [N s] Impulse of each pin on the next shoe in the last solution.
    pub(super) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.impulses.iter().map(|p| Vector::new(p.x, p.y))
    }
}
