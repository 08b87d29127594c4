//! The linear system of a ring of links, reduced by elimination to the system of the base.
//!
//! Hinges are exact: their impulses are unknowns, like the velocities. A link is coupled only to its own two hinges, the
//! base, the drive and the slide, so the elimination goes once round the ring, from link to link. The last hinge closes
//! the ring; like the base, the drive and the slide it belongs to a border that is carried along. With stiff springs
//! instead of hinges, the impulses of the springs would swamp the momentum of light links in rounding errors. These act
//! like impacts that shake the whole ring, the harder the shorter the step.
//!
//! The equations: docs/physics.md, "Chains".

use nalgebra::{Matrix2, Matrix3, RowVector2, SMatrix, SVector, Vector2, Vector3};

use crate::geometry::Vector;
use crate::solver::damper::Damper;
use crate::solver::row::{Row, TURN};

/// How a hinge holds its two links: it keeps one end of each together, and may resist their relative rotation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hinge {
    /// [m] From the centre of each link to the end that the hinge holds, ...
    pub ends: [Vector; 2],
    /// [m] ... and to the point where its impulse acts.
    pub pushed_at: [Vector; 2],
    /// [m/s] Velocity of the second end relative to the first, which closes a gap between them.
    pub velocity: Vector,
    /// Torque on the next link, as a function of its rate relative to this one [rad/s]; the hinge that closes the ring has
    /// none.
    pub twist: Damper,
}

impl Hinge {
    /// Whether anything resists the turn of its links against each other.
    pub(super) fn is_stiff(&self) -> bool {
        self.twist != Damper::default()
    }
}

/// How a drive that pulls at links acts on one of them and on the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grasp {
    /// Index in the ring.
    pub link: usize,
    pub on_link: [f64; 3],
    pub on_base: [f64; 3],
}

/// Rows and columns of the border: three for the base, ...
pub(super) const ON_BASE: usize = 0;
/// ... one for the drive (its impulse, or the rate of the body that drives), one for the slide, ...
pub(super) const DRIVE: usize = 3;
pub(super) const SLIDE: usize = 4;
/// ... two for the closing hinge; last the right-hand side, a column without a row.
pub(super) const CLOSING_HINGE: usize = 5;
pub(super) const RIGHT: usize = 7;
pub(super) const WIDTH: usize = 8;

/// The part of the system that belongs to one link.
#[derive(Clone, Copy, Default)]
pub(super) struct Entry {
    pub(super) own: Matrix3<f64>,
    /// Its rows in the columns of the border and of the right-hand side, transposed.
    pub(super) beside: SMatrix<f64, WIDTH, 3>,
    /// The rows of the border in its columns.
    pub(super) below: SMatrix<f64, WIDTH, 3>,
}

/// What the elimination keeps of a link: how it depends on the velocity of its hinge in front and on the border.
#[derive(Clone, Copy, Default)]
pub(super) struct Solved {
    /// Its rate ...
    pub(super) turn: (RowVector2<f64>, SVector<f64, WIDTH>),
    /// ... and the impulse of the hinge on it.
    pub(super) impulse: (Matrix2<f64>, SMatrix<f64, WIDTH, 2>),
}

/// The same for the rate of the next link, if the hinge resists rotation.
#[derive(Clone, Copy, Default)]
pub(super) struct Twisted {
    pub(super) turn: f64,
    pub(super) impulse: Vector2<f64>,
}

/// The system of one ring.
pub(super) struct RingSystem {
    pub(super) links: Vec<Entry>,
    /// Masses, inertia and momentum of the links without constraints.
    free: Vec<[Vector3<f64>; 2]>,
    /// What the elimination keeps of each link except the last, and of the last: its velocity in terms of the border.
    pub(super) solved: Vec<Solved>,
    pub(super) twisted: Vec<Twisted>,
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
            twisted: vec![Twisted::default(); count],
            last: SMatrix::zeros(),
            border: SMatrix::zeros(),
            impulses: vec![Vector2::zeros(); count],
        }
    }

    /// Sets up links with these masses and moments of inertia, by their velocities without constraints.
    pub(super) fn free(&mut self, mass: f64, inertias: &[f64], free: &[f64]) {
        let free = free.chunks_exact(3);
        for ((own, inertia), free) in self.free.iter_mut().zip(inertias).zip(free) {
            let masses = Vector3::new(mass, mass, *inertia);
            *own = [
                masses,
                masses.component_mul(&Vector3::from_column_slice(free)),
            ];
        }
    }

    /// Starts with links without constraints, and with the slide on its damper.
    pub(super) fn start(&mut self, slide: Damper) {
        for (link, [masses, momentum]) in self.links.iter_mut().zip(&self.free) {
            *link = Entry::default();
            link.own.set_diagonal(masses);
            link.beside.set_row(RIGHT, &momentum.transpose());
        }
        self.border = SMatrix::zeros();
        self.border[(SLIDE, SLIDE)] = slide.damping;
        self.border[(SLIDE, RIGHT)] = slide.at(0.0);
    }

    /// Adds a constraint on a link alone: its impulse acts along the first of two rows, and is that of a damper at the speed
    /// along the second.
    pub(super) fn add(&mut self, link: usize, [force, action]: [&Row; 2], damper: Damper) {
        let entry = &mut self.links[link];
        let [force, along] = [force, action].map(|row| Vector3::from(row.on_link));
        entry.own += force * along.transpose() * damper.damping;
        let mut right = entry.beside.row_mut(RIGHT);
        right += force.transpose() * damper.at(action.offset);
    }

    /// The same on a link and the base, with a slide or a spinning body that has this column of the border.
    pub(super) fn add_between(
        &mut self,
        (link, column): (usize, usize),
        rows: [&Row; 2],
        damper: Damper,
    ) {
        self.add(link, rows, damper);
        let (stiffness, impulse) = (damper.damping, damper.at(rows[1].offset));
        let [force, action] = rows.map(|row| row.on_link);
        let [force_beside, action_beside] = rows.map(|row| {
            let [x, y, turn] = row.of_base();
            let own = row.beside_base().map(|(_, lever)| lever).sum();
            [x, y, turn, own]
        });
        let columns = [ON_BASE, ON_BASE + 1, ON_BASE + 2, column];
        let entry = &mut self.links[link];
        for (i, at) in columns.into_iter().enumerate() {
            let (of_force, of_action) = (stiffness * force_beside[i], action_beside[i]);
            for (k, there) in columns.into_iter().enumerate() {
                self.border[(there, at)] += stiffness * force_beside[k] * of_action;
            }
            for k in 0..3 {
                entry.beside[(at, k)] += stiffness * force[k] * of_action;
                entry.below[(at, k)] += of_force * action[k];
            }
            self.border[(at, RIGHT)] += force_beside[i] * impulse;
        }
    }

    /// Adds the resistance of a hinge to the rotation of one of its links, the other one being at rest.
    pub(super) fn resist(&mut self, link: usize, sign: f64, twist: Damper) {
        let entry = &mut self.links[link];
        entry.own[(TURN, TURN)] += twist.damping;
        entry.beside[(RIGHT, TURN)] += sign * twist.at(0.0);
    }

    /// Couples a link to the drive: its velocity and that of the base add to the drive's speed.
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
            self.border[(ON_BASE + i, DRIVE)] += on_base[i];
            self.border[(DRIVE, ON_BASE + i)] += on_base[i];
        }
    }

    /// Makes the drive give no impulse.
    pub(super) fn let_go(&mut self) {
        self.border[(DRIVE, DRIVE)] = 1.0;
    }

    /// Makes the drive hold a speed [m/s].
    pub(super) fn hold(&mut self, speed: f64) {
        self.border[(DRIVE, RIGHT)] = speed;
    }

    /// Makes the drive give the impulse of a damper that is not constant.
    pub(super) fn give(&mut self, damper: Damper) {
        self.border[(DRIVE, DRIVE)] = -1.0 / damper.damping;
        self.border[(DRIVE, RIGHT)] = damper.at(0.0) / damper.damping;
    }

    /// Makes the drive give a constant impulse [N s] to a link and the base.
    pub(super) fn push(&mut self, grasp: &Grasp, impulse: f64) {
        for i in 0..3 {
            self.links[grasp.link].beside[(RIGHT, i)] += grasp.on_link[i] * impulse;
            self.border[(ON_BASE + i, RIGHT)] += grasp.on_base[i] * impulse;
        }
    }

    /// [N s] Impulse of each hinge on the next link in the last solution.
    pub(super) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.impulses.iter().map(|p| Vector::new(p.x, p.y))
    }
}
