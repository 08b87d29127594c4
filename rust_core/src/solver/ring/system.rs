//! The linear system of a ring of links, reduced by elimination to the system of the base.
//!
//! The hinges are exact: their impulses are unknowns, beside the velocities. Each link is coupled only to its own
//! two hinges, the base, the drive and the slide, so the elimination goes once round the ring, from link to link. The
//! last hinge closes it; like the base, the drive and the slide, it is part of a border that is carried
//! along. Stiff springs in place of the hinges would cost as many digits as they are stiffer than links are heavy,
//! and what is lost acts like blows that shake all of it, harder the shorter the step.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, Matrix3, RowVector2, SMatrix, SVector, Vector2, Vector3};

use super::drive::Grasp;
use crate::geometry::Vector;
use crate::solver::damper::Damper;
use crate::solver::direction::Direction;
use crate::solver::twist::Twist;

/// Rows and columns of the border: three for the base, ...
pub(super) const BASE: usize = 0;
const TURN: usize = 2;
/// ... one for the drive (its force or the spin through which it acts), one for the slide, ...
pub(super) const DRIVE: usize = 3;
pub(super) const SLIDE: usize = 4;
/// ... two for the closing hinge; then the right-hand side, a column without a row.
pub(super) const CLOSING_HINGE: usize = 5;
pub(super) const RIGHT: usize = 7;
pub(super) const WIDTH: usize = 8;

/// A body that takes part in a contact besides base and link.
#[derive(Clone, Copy)]
pub(in crate::solver) enum Beside {
    Slide,
    Spin,
}

impl Beside {
    /// Its rows of the border: three of the base and its own.
    fn places(self) -> [usize; 4] {
        let own = match self {
            Beside::Slide => SLIDE,
            Beside::Spin => DRIVE,
        };
        [BASE, BASE + 1, TURN, own]
    }
}

/// The part of the system that belongs to one link.
#[derive(Clone, Copy, Default)]
pub(super) struct Entry {
    pub(super) own: Matrix3<f64>,
    /// Its rows in the columns of the border, and the right-hand side; each is a column here.
    pub(super) beside: SMatrix<f64, WIDTH, 3>,
    /// Rows of the border in its columns.
    pub(super) below: SMatrix<f64, WIDTH, 3>,
}

/// What follows for a link, once eliminated, from the velocity of its hinge in front and from the border.
#[derive(Clone, Copy, Default)]
pub(super) struct Solved {
    /// Its turn ...
    pub(super) turn: (RowVector2<f64>, SVector<f64, WIDTH>),
    /// ... and the impulse of the hinge on it.
    pub(super) impulse: (Matrix2<f64>, SMatrix<f64, WIDTH, 2>),
}

/// The system of one ring.
pub(super) struct RingSystem {
    pub(super) links: Vec<Entry>,
    /// Masses, inertia and momentum of the links without constraints.
    free: Vec<[Vector3<f64>; 2]>,
    /// What the elimination keeps of each link but the last, and of that one: its velocity in terms of the border.
    pub(super) solved: Vec<Solved>,
    pub(super) last: SMatrix<f64, WIDTH, 3>,
    pub(super) border: SMatrix<f64, WIDTH, WIDTH>,
    /// [N s] Impulse of each hinge on the next link.
    pub(super) impulses: Vec<Vector2<f64>>,
}

impl RingSystem {
    pub(super) fn new(count: usize) -> Self {
        Self {
            links: vec![Entry::default(); count],
            free: vec![Default::default(); count],
            solved: vec![Solved::default(); count],
            last: SMatrix::zeros(),
            border: SMatrix::zeros(),
            impulses: vec![Vector2::zeros(); count],
        }
    }

    /// Sets up links of a mass, and inertias, with their velocities without constraints.
    pub(super) fn free(&mut self, mass: f64, inertias: &[f64], free: &[Twist]) {
        for ((own, inertia), twist) in self.free.iter_mut().zip(inertias).zip(free) {
            let masses = Vector3::new(mass, mass, *inertia);
            *own = [
                masses,
                masses.component_mul(&Vector3::from(twist.entries())),
            ];
        }
    }

    /// Starts from the links without constraints and a slide on a damper.
    pub(super) fn start(&mut self, slide: Damper) {
        for (link, [masses, momentum]) in self.links.iter_mut().zip(&self.free) {
            *link = Entry::default();
            link.own.set_diagonal(masses);
            link.beside.set_row(RIGHT, &momentum.transpose());
        }
        self.border = SMatrix::zeros();
        self.border[(DRIVE, DRIVE)] = 1.0;
        self.border[(SLIDE, SLIDE)] = slide.stiffness;
        self.border[(SLIDE, RIGHT)] = slide.at(0.0);
    }

    /// Adds a constraint on one link: its impulse acts along the first of two directions, with a damper along the second.
    pub(super) fn add(&mut self, link: usize, along: [&Direction; 2], damper: Damper) {
        let entry = &mut self.links[link];
        let [force, action] = along.map(|along| Vector3::from(along.body()));
        entry.own += force * action.transpose() * damper.stiffness;
        let mut right = entry.beside.row_mut(RIGHT);
        right += force.transpose() * damper.at(along[1].offset);
    }

    /// The same between a link and the base with what is beside it.
    pub(super) fn add_between(
        &mut self,
        link: usize,
        beside: Beside,
        along: [&Direction; 2],
        damper: Damper,
    ) {
        self.add(link, along, damper);
        let (stiffness, impulse) = (damper.stiffness, damper.at(along[1].offset));
        let [force, action] = along.map(Direction::body);
        let [back_force, back_action] = along.map(Direction::reaction);
        let entry = &mut self.links[link];
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

    /// Couples a link to the drive: how its velocity, and that of the base, enter the drive's speed.
    pub(super) fn add_grasp(&mut self, grasp: &Grasp) {
        let Grasp {
            link,
            on_link,
            on_base,
        } = grasp;
        let entry = &mut self.links[*link];
        for i in 0..3 {
            entry.beside[(DRIVE, i)] += on_link[i];
            entry.below[(DRIVE, i)] += on_link[i];
            self.border[(BASE + i, DRIVE)] += on_base[i];
            self.border[(DRIVE, BASE + i)] += on_base[i];
        }
    }

    /// Adds a constant impulse of the drive on a link and on the base.
    pub(super) fn push(&mut self, grasp: &Grasp, impulse: f64) {
        for i in 0..3 {
            self.links[grasp.link].beside[(RIGHT, i)] += grasp.on_link[i] * impulse;
            self.border[(BASE + i, RIGHT)] += grasp.on_base[i] * impulse;
        }
    }

    /// Sets the damper of the drive.
    pub(super) fn set_drive(&mut self, damper: Damper) {
        self.border[(DRIVE, DRIVE)] = -1.0 / damper.stiffness;
        self.border[(DRIVE, RIGHT)] = damper.at(0.0) / damper.stiffness;
    }

    /// Adds a body that spins on the base to the drive: its inertia [kg m^2] and its rate [rad/s] without constraints.
    pub(super) fn add_spin(&mut self, inertia: f64, rate: f64) {
        self.border[(DRIVE, DRIVE)] = inertia;
        self.border[(DRIVE, RIGHT)] = inertia * rate;
    }

    /// Adds a damper at a lever [m] that turns base and spin against each other; its speed is that of the base relative
    /// to the spin.
    pub(super) fn turn_spin(&mut self, lever: f64, damper: Damper) {
        let levers = [(TURN, lever), (DRIVE, -lever)];
        for (row, of_row) in levers {
            for (column, of_column) in levers {
                self.border[(row, column)] += of_row * of_column * damper.stiffness;
            }
            self.border[(row, RIGHT)] += of_row * damper.at(0.0);
        }
    }

    /// [N s] Impulse of each hinge on the next link in the last solution.
    pub(super) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.impulses.iter().map(|p| Vector::new(p.x, p.y))
    }
}
