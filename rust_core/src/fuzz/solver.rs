//! Random problems: what is found obeys the laws of contacts and motors, and keeps momentum. These are all the conditions of
//! the convex program that tests solve by an interior-point method; where a base is jammed, that method is less exact.

use crate::draw::Draw;
use crate::solver::Problem;
use crate::solver::judge::{breach, drawn, momentum_lost, off_its_law};

/// [m/s] By how much the speed at a contact or a motor may be off. A solve agrees to 1e-7 m/s; close to a jam it ends where the
/// base still moves by 1e-6 m/s, and after eight rounds also where contacts pass their load round: 8.5e-6 m/s were met.
const OFF: f64 = 5e-5;
/// [N s] By how much an impulse may be off: by 1e-7 m/s, to which a solve agrees, of 50 kg.
const IMPULSE_OFF: f64 = 5e-6;

/// Solves the problem that bytes describe, and once more from where that ended, with other velocities.
///
/// # Panics
/// If a rule is broken.
pub fn solver(data: &[u8]) {
    let mut draw = Draw(data);
    let locked = draw.chance(0.2);
    let mut problem = drawn(&mut draw);
    if locked {
        for motor in &mut problem.motors {
            *motor = motor.behind_lock();
        }
    }
    check(&mut problem);
    for free in &mut problem.free {
        *free = draw.between(-1.0, 1.0);
    }
    check(&mut problem);
}

/// Of a solve that says that it found no solution, the laws may be off, but for signs and limits.
fn check(problem: &mut Problem) {
    let before = problem.effort.unresolved;
    problem.solve();
    assert!(problem.unknowns.iter().all(|v| v.is_finite()));
    let solved = problem.effort.unresolved == before;
    for contact in &problem.contacts {
        let (normal, friction) = (contact.normal_impulse, contact.friction_impulse);
        let most = contact.friction.coefficient * normal;
        assert!(normal >= 0.0 && friction.abs() <= most * (1.0 + 1e-9));
        let off = breach(contact, problem);
        assert!(
            !solved || off < OFF,
            "a contact is off its law by {off:e} m/s"
        );
    }
    for motor in problem.motors.iter().filter(|_| solved) {
        let [speed, impulse] = off_its_law(problem, motor);
        assert!(
            speed < OFF && impulse < IMPULSE_OFF,
            "a motor is off its law: {speed:e} m/s, {impulse:e} N s; {motor:?}"
        );
    }
    let off = momentum_lost(problem);
    assert!(off < IMPULSE_OFF, "momentum is off by {off:e} N s");
}
