//! A ring of links that are hinged to each other, with its drive and a slide on the base.
//!
//! The equations: docs/physics.md, "Chains".

mod drive;
mod elimination;
mod hinge;
mod system;

pub(crate) use drive::{Drive, Grasp};
pub(crate) use hinge::Hinge;
pub(super) use system::Beside;

use std::ops::Range;

use super::damper::Damper;
use super::direction::Direction;
use super::motor::Motor;
use super::twist::Twist;
use super::velocities::{Link, Velocities};
use crate::geometry::Vector;
use system::RingSystem;

/// One closed ring of links.
pub(crate) struct Ring {
    /// Their numbers among the links of all rings.
    pub links: Range<usize>,
    /// [kg] Mass of a link, ...
    pub mass: f64,
    /// [kg m^2] ... and its moment of inertia.
    pub inertia: f64,
    /// What its drive spins, if anything.
    pub spin: Option<usize>,
    /// The hinge in front of each link.
    pub hinges: Vec<Hinge>,
    /// What holds the slide.
    pub slide: Damper,
    pub drive: Drive,
    system: RingSystem,
}

impl Ring {
    /// Links of a mass [kg] and a moment of inertia [kg m^2].
    pub(crate) fn new(
        links: Range<usize>,
        [mass, inertia]: [f64; 2],
        spin: Option<usize>,
        drive: Drive,
    ) -> Self {
        Self {
            mass,
            inertia,
            spin,
            hinges: vec![Hinge::default(); links.len()],
            slide: Damper::default(),
            drive,
            system: RingSystem::new(links.len()),
            links,
        }
    }

    /// Sets the velocities of the links without constraints, and the moments of inertia with which they turn from there
    /// [kg m^2].
    pub(crate) fn start(&mut self, inertias: &[f64], free: &[Twist]) {
        self.system
            .free(self.mass, inertias, &free[self.links.clone()]);
    }

    /// [N s] Impulse of the hinge in front of each link on the next one.
    pub(crate) fn impulses(&self) -> impl Iterator<Item = Vector> + '_ {
        self.system.impulses()
    }

    /// [m/s] Speed of the drive.
    pub(crate) fn drive_speed(&self, velocities: &Velocities) -> f64 {
        let base = velocities.base;
        if let (Some(lever), Some(spin)) = (self.drive.lever, self.spin) {
            return lever * (base.turn - velocities.spins[spin]);
        }
        let along = |row: &[f64; 3], twist: Twist| -> f64 {
            row.iter().zip(twist.entries()).map(|(a, v)| a * v).sum()
        };
        let links = &velocities.links[self.links.clone()];
        let grasps = self.drive.grasps.iter();
        grasps
            .map(|g| along(&g.on_link, links[g.link]) + along(&g.on_base, base))
            .sum()
    }

    /// Impulse of the drive at a speed, if its motor does not hold that.
    pub(super) fn given(&self, motor: &Motor) -> Option<Damper> {
        if self.drive.has_hold() {
            motor.given()
        } else {
            Some(Damper::default())
        }
    }

    /// Assembles the system of links and drive; what the drive spins has an inertia [kg m^2], and a rate without
    /// constraints [rad/s].
    pub(super) fn assemble(&mut self, motor: &Motor, spin: Option<[f64; 2]>) {
        self.system.start(self.slide);
        let holds = self.drive.damper().shifted(motor.held_speed());
        let damper = self.given(motor).unwrap_or(holds).plus(self.drive.rotor);
        if let (Some([inertia, rate]), Some(lever)) = (spin, self.drive.lever) {
            self.system.add_spin(inertia, rate);
            self.system.turn_spin(lever, damper);
            return;
        }
        let is_constant = damper.stiffness == 0.0;
        for grasp in &self.drive.grasps {
            if is_constant {
                self.system.push(grasp, damper.at(0.0));
            } else {
                self.system.add_grasp(grasp);
            }
        }
        if !is_constant {
            self.system.set_drive(damper);
        }
    }

    /// Adds a constraint on a link: its impulse acts along the first of two directions, with a damper along the second.
    pub(super) fn add(&mut self, link: Link, along: [&Direction; 2], damper: Damper) {
        self.system
            .add(link.number - self.links.start, along, damper);
    }

    /// The same between a link and the base with what is beside it.
    pub(super) fn add_between(
        &mut self,
        link: Link,
        beside: Beside,
        along: [&Direction; 2],
        damper: Damper,
    ) {
        let link = link.number - self.links.start;
        self.system.add_between(link, beside, along, damper);
    }

    /// Reduces the system to the base, adding the ring's part to the rows of that; none if the constraints contradict
    /// each other.
    pub(super) fn eliminate(&mut self, base: &mut [[f64; 4]; 3]) -> Option<()> {
        self.system.eliminate(&self.hinges, base)
    }

    /// Finds the velocities of the links from that of the base; returns those of slide and spin.
    pub(super) fn follow(&mut self, base: Twist, links: &mut [Twist]) -> [f64; 2] {
        let links = &mut links[self.links.clone()];
        self.system.follow(&self.hinges, base.entries(), links)
    }
}
