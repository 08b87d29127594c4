//! The robot as a problem for the solver: its bodies and motors.
//!
//! The equations: docs/physics.md, "The problem".

use super::arm::Arm;
use super::chain::Chain;
use super::push::push_row;
use crate::robot::Model;
use crate::scenario::Solver;
use crate::solver::{Bilateral, Driven, Motor, Problem, RingSpec};

/// A robot's bodies and motors: those of its drives, then those of its arms.
pub(super) fn built(model: &Model, chains: &[Chain], arms: &[Arm], solver: &Solver) -> Problem {
    let spin = |k: usize| {
        let sprocket = chains.get(k).and_then(|chain| chain.rule.sprocket.as_ref());
        match sprocket {
            Some(sprocket) => sprocket.inertia,
            // The drive of a chain on a guide has no inertia of its own.
            None if model.has_chain(k) => 1.0,
            None => model.drive_inertia(k),
        }
    };
    let spins: Vec<f64> = (0..model.drives).map(spin).collect();
    let rings: Vec<RingSpec> = chains.iter().map(Chain::ring).collect();
    let of_chassis = [model.mass, model.moment_of_inertia];
    let mut problem = Problem::new(of_chassis, arms.len(), &spins, &rings);
    let layout = problem.layout;
    let of_drive = |k: usize| {
        let has_motor = model.has_motor(k) && model.motor.force > 0.0;
        let on = match chains.get(k) {
            Some(chain) if !chain.has_sprocket() => Driven::Ring(k),
            _ => Driven::Body(layout.spin(k)),
        };
        // The surface runs forwards while its drive spins clockwise.
        let locks = model.has_motor(k) && model.motor.self_locking;
        behind_gear(Motor::new(on, -model.drive_radius, has_motor), locks)
    };
    let of_arm = |(k, arm): (usize, &Arm)| {
        let on = Driven::Body(layout.joint(k));
        let motor = Motor::new(on, 1.0, arm.rule.torque_limit > 0.0);
        behind_gear(motor, arm.rule.self_locking)
    };
    let of_arms = arms.iter().enumerate().map(of_arm);
    problem.motors = (0..model.drives).map(of_drive).chain(of_arms).collect();
    if model.push_drive().is_some() {
        let push = Bilateral::new(push_row(model, layout, 0.0));
        problem.bilaterals.push(push);
    }
    problem.iterations = solver.iterations;
    problem
}

/// A motor with a gear, which may be self-locking.
fn behind_gear(motor: Motor, locks: bool) -> Motor {
    if locks { motor.behind_lock() } else { motor }
}
