//! An impact: contacts that close stop at once, by impulses alone, and may rebound.
//!
//! The equations: docs/physics.md, "Impacts".

use super::damper::{Damper, Inertia};
use super::motor::Motor;
use super::{Contact, MotorState, Problem};

impl Problem {
    /// Adds an impact to the velocities of a solve. No time passes in it: weight and motors do nothing, and only self-locking
    /// gears hold. After it no contact that bears still approaches, and contacts have returned a share of the impact. Its impulses
    /// are added to those of the solve.
    pub(crate) fn impact(&mut self, restitution: f64) {
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

    /// Continues after a solve that was an impact: contacts return a share of its impulses along normals and tangents, and motors
    /// do nothing.
    pub(super) fn rebound(&mut self, share: f64) {
        let impact: Vec<[f64; 2]> = self.contacts.iter().map(Contact::impulses).collect();
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
        for (contact, [normal, friction]) in self.contacts.iter_mut().zip(impact) {
            contact.normal_impulse += (1.0 + share) * normal;
            contact.friction_impulse += (1.0 + share) * friction;
        }
        for (bilateral, impact) in self.bilaterals.iter_mut().zip(along) {
            bilateral.impulse += impact;
        }
    }

    /// Takes the present velocities as those without constraints, and releases what motors turn.
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

    /// Lets self-locking gears hold.
    fn lock(&mut self) {
        for motor in self.motors.iter_mut().filter(|motor| motor.locks) {
            motor.state = MotorState::Holds;
        }
    }

    /// Solves, starting with contacts without impulses.
    fn solve_anew(&mut self) {
        for contact in &mut self.contacts {
            contact.set_impulses([0.0; 2]);
        }
        self.solve();
    }
}

impl Motor {
    /// Gives no impulse, as no time passes. A self-locking gear lets what turned at a speed [m/s] become slower, but neither
    /// faster nor turn back.
    fn have_no_time(&mut self, speed: f64) {
        (self.target, self.limits, self.correction) = (speed, [Damper::default(); 2], None);
    }
}
