//! Random problems, and what holds of a solution: the laws of contacts and motors, and that momentum is kept.

use super::*;
use crate::draw::{Draw, Source};
use crate::geometry::{Vector, cross, direction, right_of};
use crate::scenario::Friction;

/// A contact of the body at `arm` from its centre, which bears.
pub(crate) fn contact(arm: Vector, normal: Vector, friction: f64) -> Contact {
    let rows = [normal, right_of(normal)];
    let rows = rows.map(|unit| Row::on_base([unit.x, unit.y, cross(arm, unit)]));
    bearing(rows, friction)
}

/// A contact of the surface of a belt that a spin drives, at a radius.
pub(crate) fn on_belt(
    arm: Vector,
    normal: Vector,
    friction: f64,
    (spin, radius): (usize, f64),
) -> Contact {
    let rows = [(normal, 0.0), (right_of(normal), radius)];
    let rows = rows.map(|(unit, lever)| {
        Row::on_base([unit.x, unit.y, cross(arm, unit) - lever]).and(spin, lever)
    });
    bearing(rows, friction)
}

pub(crate) fn bearing(rows: [Row; 2], friction: f64) -> Contact {
    let mut contact = Contact::new(rows);
    (contact.friction, contact.bears) = (Friction::dry(friction), true);
    contact.mass = Some(2.0);
    contact
}

impl Problem {
    pub(super) fn set_free(&mut self, velocity: Vector, turn: f64) {
        self.free[..3].copy_from_slice(&[velocity.x, velocity.y, turn]);
    }
}

/// A random problem: a body, up to two others that spin on it with a motor each, and contacts from all sides.
pub(crate) fn drawn<S: Source>(draw: &mut Draw<S>) -> Problem {
    let base = [draw.size(0.5, 50.0), draw.size(0.01, 5.0)];
    let spins: Vec<f64> = (0..draw.below(3)).map(|_| draw.size(1e-4, 0.1)).collect();
    let mut problem = Problem::new(base, 0, &spins, &[]);
    let mut speed = |most: f64| draw.between(-most, most);
    let velocity = Vector::new(speed(1.0), speed(1.0));
    problem.set_free(velocity, speed(3.0));
    for k in 0..spins.len() {
        problem.free[problem.layout.spin(k)] = speed(10.0);
    }
    for k in 0..spins.len() {
        let on = Driven::Body(problem.layout.spin(k));
        let mut motor = Motor::new(on, -0.1, draw.chance(0.8));
        motor.aim(draw.between(-1.0, 1.0), draw.size(1e-3, 10.0));
        problem.motors.push(motor);
    }
    let friction = if draw.chance(0.1) {
        0.0
    } else {
        draw.between(0.05, 1.2)
    };
    for _ in 0..=draw.below(8) {
        let (arm, normal) = (
            0.3 * direction(draw.between(0.0, 6.3)),
            direction(draw.between(0.0, 6.3)),
        );
        let mut next = if !spins.is_empty() && draw.chance(0.7) {
            let spin = problem.layout.spin(draw.below(spins.len()));
            on_belt(arm, normal, friction, (spin, 0.1))
        } else {
            contact(arm, normal, friction)
        };
        next.mass = Some(base[0]);
        if draw.chance(0.3) {
            (next.bias, next.compliance) = (draw.between(-0.1, 0.1), draw.size(1e-3, 1.0));
        }
        problem.contacts.push(next);
    }
    problem
}

/// [m/s] By how much a contact breaks its law: it approaches, or moves where it should stick, or is helped on by
/// friction.
pub(crate) fn breach(contact: &Contact, problem: &Problem) -> f64 {
    let v = &problem.unknowns;
    let spring = contact.mass.expect("a mass").recip();
    let (n, t) = (contact.normal_impulse, contact.friction_impulse);
    let gives = contact.bias + contact.compliance * spring * n;
    let opens = contact.normal.speed(v) + gives;
    let slip = contact.tangent.speed(v);
    let of_normal = if n > 0.0 {
        opens.abs()
    } else {
        (-opens).max(0.0)
    };
    let sticks = t.abs() < contact.friction.coefficient * n * (1.0 - 1e-9);
    let helps = slip * t > 0.0;
    of_normal.max(if sticks || helps { slip.abs() } else { 0.0 })
}

/// [m/s], [N s] How far a motor is off its law: at its target, or between its two stops behind a lock, with an impulse that it
/// may give there.
pub(crate) fn off_its_law(problem: &Problem, motor: &Motor) -> [f64; 2] {
    let way = motor.target.signum();
    let now = [problem.motor_speed(motor), problem.motor_impulse(motor)];
    let [speed, impulse] = now.map(|x| way * x);
    let (most, far) = (motor.limits[0].at(0.0), motor.target.abs());
    if !motor.locks {
        return match motor.state {
            MotorState::Holds => [(speed - far).abs(), (impulse.abs() - most).max(0.0)],
            MotorState::LimitForwards | MotorState::LimitBackwards => {
                let ahead = now[1].signum() * (now[0] - motor.target);
                [ahead.max(0.0), (impulse.abs() - most).abs()]
            }
            MotorState::Absent | MotorState::Locked => [0.0; 2],
        };
    }
    match motor.state {
        // At rest both stops hold it.
        MotorState::Holds if far == 0.0 => [speed.abs(), 0.0],
        MotorState::Holds => [(speed - far).abs(), (impulse - most).max(0.0)],
        MotorState::Locked => [speed.abs(), (most - impulse).max(0.0)],
        MotorState::LimitForwards | MotorState::LimitBackwards => {
            let beyond = (-speed).max(speed - far).max(0.0);
            [beyond, (impulse - most).abs()]
        }
        MotorState::Absent => [f64::INFINITY; 2],
    }
}

/// [N s, N m s] The most by which the momentum along a coordinate changes otherwise than by the impulses.
pub(crate) fn momentum_lost(problem: &Problem) -> f64 {
    let changes = problem.unknowns.iter().zip(&problem.free);
    let changes = changes.zip(&problem.masses);
    let mut left: Vec<f64> = changes
        .map(|((now, free), mass)| mass * (now - free))
        .collect();
    for c in &problem.contacts {
        for (row, impulse) in [
            (&c.normal, c.normal_impulse),
            (&c.tangent, c.friction_impulse),
        ] {
            for (at, lever) in row.entries() {
                left[at] -= lever * impulse;
            }
        }
    }
    for motor in &problem.motors {
        if let Driven::Body(at) = motor.on {
            let torque = motor.lever * problem.motor_impulse(motor);
            left[at] -= torque;
            left[TURN] += torque;
        }
    }
    left.into_iter().fold(0.0, |most, off| most.max(off.abs()))
}
