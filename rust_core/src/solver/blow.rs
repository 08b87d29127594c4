//! A blow: what closes stops at once, by impulses of contacts and inertia alone, and contacts may give back of it.
//!
//! The equations: docs/physics.md, "Impacts".

use super::damper::{Damper, Inertia};
use super::motor::Motor;
use super::{Contact, MotorState, Problem};

impl Problem {
    /// Goes on from the velocities of a solve by a blow, in which no time passes: no weight acts, and motors do nothing, but gears
    /// that lock themselves hold. Contacts that bear leave nothing that approaches, and give back a share of the blow. Its
    /// impulses are added to those of the solve.
    pub(crate) fn blow(&mut self, restitution: f64) {
        let before: Vec<[f64; 2]> = self.contacts.iter().map(Contact::impulses).collect();
        let along: Vec<f64> = self.bilaterals.iter().map(|each| each.impulse).collect();
        let motors = self.motors.clone();
        let speeds: Vec<f64> = motors.iter().map(|motor| self.motor_speed(motor)).collect();
        for (motor, speed) in self.motors.iter_mut().zip(speeds) {
            motor.have_no_time(speed);
        }
        self.start_from_here();
        self.lock();
        self.solve_anew();
        if restitution > 0.0 {
            self.rebound(restitution);
        }
        for (contact, [normal, friction]) in self.contacts.iter_mut().zip(before) {
            contact.normal_impulse += normal;
            contact.friction_impulse += friction;
        }
        for (bilateral, before) in self.bilaterals.iter_mut().zip(along) {
            bilateral.impulse += before;
        }
        self.motors = motors;
    }

    /// Goes on from the velocities of a solve that was a blow: contacts give back a share of its impulses, along normals
    /// and tangents, and motors have no time to do anything.
    pub(super) fn rebound(&mut self, share: f64) {
        let blow: Vec<[f64; 2]> = self.contacts.iter().map(Contact::impulses).collect();
        let along: Vec<f64> = self.bilaterals.iter().map(|each| each.impulse).collect();
        self.start_from_here();
        for contact in &mut self.contacts {
            contact.normal_impulse *= share;
            contact.friction_impulse *= share;
        }
        self.tie();
        self.find_velocities();
        self.start_from_here();
        self.lock();
        self.solve_anew();
        for (contact, [normal, friction]) in self.contacts.iter_mut().zip(blow) {
            contact.normal_impulse += (1.0 + share) * normal;
            contact.friction_impulse += (1.0 + share) * friction;
        }
        for (bilateral, blow) in self.bilaterals.iter_mut().zip(along) {
            bilateral.impulse += blow;
        }
    }

    /// Takes the present velocities as those without constraints, and lets go of what motors turn.
    fn start_from_here(&mut self) {
        self.free.clone_from(&self.unknowns);
        for inertia in &mut self.inertias {
            let free = inertia.row.along(&self.unknowns);
            *inertia = Inertia::new(inertia.row, inertia.damper.damping, free);
        }
        for motor in &mut self.motors {
            motor.state = MotorState::Absent;
        }
        for bilateral in &mut self.bilaterals {
            bilateral.impulse = 0.0;
        }
    }

    /// Has the gears hold that lock themselves.
    fn lock(&mut self) {
        for motor in self.motors.iter_mut().filter(|motor| motor.locks) {
            motor.state = MotorState::Holds;
        }
    }

    /// Solves from contacts without impulses.
    fn solve_anew(&mut self) {
        for contact in &mut self.contacts {
            contact.set_impulses([0.0; 2]);
        }
        self.solve();
    }
}

impl Motor {
    /// Gives nothing where no time passes. Its gear, if that locks itself, lets what turned with a speed [m/s] turn on more
    /// slowly, and neither faster nor back.
    fn have_no_time(&mut self, speed: f64) {
        (self.target, self.limits, self.correction) = (speed, [Damper::default(); 2], None);
    }
}
