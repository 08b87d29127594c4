//! The robot as a problem for the solver: its bodies and motors.
//!
//! The equations: docs/physics.md, "The problem".

use super::arm::Arm;
use super::chain::Chain;
use super::push::push_axis;
use crate::robot::Model;
use crate::scenario::Solver;
use crate::solver::{ActsOn, Base, Bilateral, Driven, Motor, Problem, Spin};

/// A robot's bodies and motors: those of its drives, then those of its arms.
pub(super) fn built(model: &Model, chains: &[Chain], arms: &[Arm], solver: &Solver) -> Problem {
    let base = Base {
        mass: model.mass,
        inertia: model.moment_of_inertia,
    };
    let spin = |k: usize| {
        let sprocket = chains.get(k).and_then(|chain| chain.rule.sprocket.as_ref());
        let inertia = match sprocket {
            Some(sprocket) => sprocket.inertia,
            // The drive of a chain on a guide has no inertia of its own.
            None if model.has_chain(k) => 1.0,
            None => model.drive_inertia(k),
        };
        Spin::new(inertia, model.rotor_inertia(k))
    };
    let shoe_mass = chains.first().map(|chain| chain.rule.shoe_mass);
    let mut problem = Problem::new(
        base,
        (0..model.drives).map(spin).collect(),
        arms.iter().map(|arm| arm.joint(shoe_mass)).collect(),
        chains.iter().map(Chain::ring).collect(),
    );
    let of_drive = |k: usize| {
        let has_motor = model.has_motor(k) && model.motor.force > 0.0;
        let on = if model.has_chain(k) {
            Driven::Ring(k)
        } else {
            Driven::Spin(k)
        };
        // The surface runs forwards while its drive spins clockwise.
        let locks = model.has_motor(k) && model.motor.self_locking;
        behind_gear(Motor::new(on, -model.drive_radius, has_motor), locks)
    };
    let of_arm = |(k, arm): (usize, &Arm)| {
        let motor = Motor::new(Driven::Joint(k), 1.0, arm.rule.torque_limit > 0.0);
        behind_gear(motor, arm.rule.self_locking)
    };
    let of_arms = arms.iter().enumerate().map(of_arm);
    problem.motors = (0..model.drives).map(of_drive).chain(of_arms).collect();
    if let Some(drive) = model.push_drive() {
        let acts = ActsOn::Base {
            joint: None,
            spin: Some(drive),
        };
        let push = Bilateral::new(acts, push_axis(model, 0.0));
        problem.bilaterals.push(push);
    }
    // Ground is as stiff below an arm as below the chassis; shoes, which are light, have springs of their own.
    problem.mass_on_springs = chains.is_empty().then(|| model.total_mass());
    problem.iterations = solver.iterations;
    problem
}

/// A motor behind a gear, which may lock itself.
fn behind_gear(motor: Motor, locks: bool) -> Motor {
    if locks { motor.behind_lock() } else { motor }
}
