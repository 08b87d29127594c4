//! A ring of links that are hinged to each other, with its drive and a slide on the base.
//!
//! The equations: docs/physics.md, "Chains".

mod elimination;
mod system;

use super::Motor;
use super::damper::Damper;
use super::row::{BASE, Layout, Link, Row};
use crate::geometry::Vector;
use crate::solver::system::System;
use system::{DRIVE, RIGHT, RingSystem, SLIDE};
pub(crate) use system::{Grasp, Hinge};

/// The links of a ring, and what drives it.
pub(crate) struct RingSpec {
    /// Number of links.
    pub links: usize,
    /// [kg] Mass of a link, ...
    pub mass: f64,
    /// [kg m^2] ... and its moment of inertia.
    pub inertia: f64,
    /// The body that spins on the base and drives the ring, if any; if not, a motor pulls at some of its links.
    pub spin: Option<usize>,
}

/// One closed ring of links.
pub(crate) struct Ring {
    /// Indices of the first velocity of its links, of its slide, of its drive, and of the spinning body that drives it.
    first: usize,
    slide_at: usize,
    drive_at: usize,
    spin: Option<usize>,
    /// [kg] Mass of a link, ...
    mass: f64,
    /// [1/kg, 1/kg, 1/(kg m^2)] ... and one over its inertia in x, y and rotation.
    pub(super) weights: [f64; BASE],
    /// The hinge in front of each link.
    pub hinges: Vec<Hinge>,
    /// Spring and damper of the slide.
    pub slide: Damper,
    /// The links at which its motor pulls, if it spins nothing.
    pub grasps: Vec<Grasp>,
    /// The impulse with which the rotor of that motor acts at a speed.
    pub rotor: Damper,
    system: RingSystem,
}

impl Ring {
    /// All rings of a problem.
    pub(super) fn all(layout: Layout, specs: &[RingSpec]) -> Vec<Self> {
        let mut links = 0;
        let ring = |(number, spec): (usize, &RingSpec)| {
            links += spec.links;
            Self {
                first: layout.link(links - spec.links),
                slide_at: layout.slide(number),
                drive_at: layout.drive(number),
                spin: spec.spin.map(|k| layout.spin(k)),
                mass: spec.mass,
                weights: [spec.mass, spec.mass, spec.inertia].map(f64::recip),
                hinges: vec![Hinge::default(); spec.links],
                slide: Damper::default(),
                grasps: Vec::new(),
                rotor: Damper::default(),
                system: RingSystem::new(spec.links),
            }
        };
        specs.iter().enumerate().map(ring).collect()
    }

    /// The velocities of its links among all unknowns.
    fn links<'a>(&self, unknowns: &'a [f64]) -> &'a [f64] {
        &unknowns[self.first..][..BASE * self.hinges.len()]
    }

    /// [J] Kinetic energy of its links at these velocities.
    pub(super) fn energy(&self, unknowns: &[f64]) -> f64 {
        let links = self.links(unknowns).iter();
        let of_entry = |(v, weight): (&f64, &f64)| 0.5 * v * v / weight;
        links.zip(self.weights.iter().cycle()).map(of_entry).sum()
    }

    /// Sets the velocities of the links without constraints, which are among those of all unknowns, and the moments of
    /// inertia of the links [kg m^2].
    pub(crate) fn start(&mut self, inertias: &[f64], free: &[f64]) {
        let free = self.links(free);
        self.system.free(self.mass, inertias, free);
    }

    /// [N s] Impulse of the hinge in front of each link on the next one.
    pub(crate) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.system.impulses()
    }

    /// [m/s] Speed of a drive that pulls at links.
    pub(crate) fn drive_speed(&self, unknowns: &[f64]) -> f64 {
        let along = |levers: &[f64; 3], velocities: &[f64]| -> f64 {
            levers.iter().zip(velocities).map(|(a, v)| a * v).sum()
        };
        let links = self.links(unknowns);
        let grasps = self.grasps.iter();
        grasps
            .map(|g| along(&g.on_link, &links[BASE * g.link..]) + along(&g.on_base, unknowns))
            .sum()
    }

    /// [N s] Impulse of the motor of such a drive if it holds its speed.
    pub(super) fn drive_impulse(&self, unknowns: &[f64]) -> f64 {
        -unknowns[self.drive_at] - self.rotor.at(self.drive_speed(unknowns))
    }

    /// Starts the system of its links and its slide.
    pub(super) fn start_system(&mut self) {
        self.system.start(self.slide);
    }

    /// Makes a motor pull at its links.
    pub(super) fn drive(&mut self, motor: &Motor) {
        if self.grasps.is_empty() {
            return self.system.let_go();
        }
        match motor.given().map(|given| given.plus(self.rotor)) {
            Some(given) if given.damping == 0.0 => {
                self.system.let_go();
                for grasp in &self.grasps {
                    self.system.push(grasp, given.at(0.0));
                }
            }
            given => {
                for grasp in &self.grasps {
                    self.system.add_grasp(grasp);
                }
                match given {
                    Some(given) => self.system.give(given),
                    None => self.system.hold(motor.held_speed()),
                }
            }
        }
    }

    /// Adds a constraint on a link: its impulse acts along the first of two rows, and is that of a damper at the speed along
    /// the second.
    pub(super) fn add(&mut self, link: Link, rows: [&Row; 2], damper: Damper) {
        let number = (link.at() - self.first) / BASE;
        if !rows[1].is_on_base() {
            return self.system.add(number, rows, damper);
        }
        // A spinning body that is held is part of the base, and has no entry here.
        let slides = rows[1].beside_base().any(|(at, _)| at == self.slide_at);
        let column = if slides { SLIDE } else { DRIVE };
        self.system.add_between((number, column), rows, damper);
    }

    /// Reduces its system to the unknowns on the base, and adds the result to their rows; none if the constraints contradict
    /// each other.
    pub(super) fn eliminate(&mut self, system: &mut System) -> Option<()> {
        self.system.eliminate(&self.hinges, self.spin.is_some())?;
        let on_base = (0..BASE).map(|i| (i, i));
        let shared = on_base.chain(self.spin.map(|at| (at, DRIVE)));
        let border = &self.system.border;
        for (row, i) in shared.clone() {
            for (column, j) in shared.clone() {
                *system.coupling(row, column) += border[(i, j)];
            }
            *system.right(row) += border[(i, RIGHT)];
        }
        Some(())
    }

    /// Finds the velocities of links and slide from those of the base and of the spinning body.
    pub(super) fn back_substitute(&mut self, unknowns: &mut [f64]) {
        let base = [unknowns[0], unknowns[1], unknowns[2]];
        let spin = self.spin.map(|at| unknowns[at]);
        let links = &mut unknowns[self.first..][..BASE * self.hinges.len()];
        let [slide, drive] = self
            .system
            .back_substitute(&self.hinges, (base, spin), links);
        unknowns[self.slide_at] = slide;
        if spin.is_none() {
            unknowns[self.drive_at] = drive;
        }
    }
}
