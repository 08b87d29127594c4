//! The hundred problems of studies that took the most linear systems, kept as data.
//!
//! They were written down while 300 random robots, 24 gear wheels with servos before a step, gear wheels on arms and
//! belts in a corner were run: of each the worst, with the velocities and impulses from which their solves started.

use serde_json::Value;

use super::*;

/// A line for each: bodies, velocities, contacts and motors.
const PROBLEMS: &str = include_str!("worst.jsonl");

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn lists(value: &Value) -> impl Iterator<Item = Vec<f64>> + '_ {
    value.as_array().expect("a list").iter().map(numbers)
}

/// Index of a body, if there is one.
fn body_at(number: f64) -> Option<usize> {
    (number >= 0.0).then_some(number as usize)
}

/// Unit, levers and offset of a direction.
fn along(entries: &[f64]) -> Direction {
    Direction {
        unit: Vector::new(entries[0], entries[1]),
        lever: entries[2],
        spin_lever: entries[3],
        back: 0.0,
        joint_lever: entries[4],
        offset: entries[5],
    }
}

fn contact_of(entries: &[f64]) -> Contact {
    const GRIPS: [Grip; 4] = [Grip::Open, Grip::Sticks, Grip::Forwards, Grip::Backwards];

    let acts = ActsOn::Base {
        spin: body_at(entries[0]),
        joint: body_at(entries[1]),
    };
    let mut contact = Contact::new(acts, [along(&entries[2..8]), along(&entries[8..14])]);
    contact.bears = true;
    contact.friction = Friction::dry(entries[14]);
    (contact.bias, contact.compliance) = (entries[15], entries[16]);
    (contact.normal_impulse, contact.friction_impulse) = (entries[17], entries[18]);
    contact.grip = GRIPS[entries[19] as usize];
    contact
}

fn motor_of(entries: &[f64]) -> Motor {
    const HOLDS: [Hold; 4] = [Hold::Holds, Hold::Pushes, Hold::Brakes, Hold::Free];

    let at = entries[1] as usize;
    let on = if entries[0] > 0.0 {
        Driven::Joint(at)
    } else {
        Driven::Spin(at)
    };
    let mut motor = Motor::new(on, entries[2], true);
    motor.aim(entries[3], entries[4]);
    motor.hold = HOLDS[entries[5] as usize];
    motor
}

fn problem_of(line: &str) -> Problem {
    let given: Value = serde_json::from_str(line).expect("a line is JSON");
    let [base, free, start] = ["base", "free", "start"].map(|name| numbers(&given[name]));
    let base = Base {
        mass: base[0],
        inertia: base[1],
    };
    let spins = numbers(&given["spins"])
        .into_iter()
        .map(|inertia| Spin::new(inertia, 0.0));
    let joints = numbers(&given["joints"]).into_iter();
    let joints = joints.map(|inertia| Joint::new(inertia, f64::INFINITY));
    let mut problem = Problem::new(base, spins.collect(), joints.collect(), Vec::new());
    let twist = |v: &[f64]| Twist::from([v[0], v[1], v[2]]);
    problem.free.base = twist(&free);
    problem.free.spins = numbers(&given["free_spins"]);
    problem.velocities.base = twist(&start);
    problem.velocities.spins = numbers(&given["start_spins"]);
    let rates = numbers(&given["start_joints"]);
    problem.velocities.joints.copy_from_slice(&rates);
    problem.mass_on_springs = given["springs"].as_f64();
    let inertia = |entries: Vec<f64>| Inertia {
        acts: ActsOn::on_joint(entries[0] as usize),
        along: along(&entries[1..7]),
        damper: Damper::new(entries[7], entries[8]),
    };
    problem.inertias = lists(&given["hung"]).map(inertia).collect();
    problem.contacts = lists(&given["contacts"]).map(|c| contact_of(&c)).collect();
    problem.motors = lists(&given["motors"]).map(|m| motor_of(&m)).collect();
    problem
}

/// [m/s] By how much a contact breaks its law: it approaches, or moves where it should stick, or is helped on by
/// friction.
fn breach(contact: &Contact, problem: &Problem) -> f64 {
    let v = &problem.velocities;
    let spring = problem.mass_on_springs.expect("a mass").recip();
    let (n, t) = (contact.normal_impulse, contact.friction_impulse);
    let gives = contact.bias + contact.compliance * spring * n;
    let opens = contact.opening_speed(v) + contact.normal.offset + gives;
    let slip = contact.slip(v) + contact.tangent.offset;
    let of_normal = if n > 0.0 {
        opens.abs()
    } else {
        (-opens).max(0.0)
    };
    let sticks = t.abs() < contact.friction.coefficient * n * (1.0 - 1e-9);
    let helps = slip * t > 0.0;
    of_normal.max(if sticks || helps { slip.abs() } else { 0.0 })
}

#[test]
fn the_worst_hundred_problems_of_studies_obey_coulombs_law() {
    for (number, line) in PROBLEMS.lines().enumerate() {
        let mut problem = problem_of(line);
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0, "problem {number}");
        for contact in &problem.contacts {
            let most = contact.friction.coefficient * contact.normal_impulse;
            assert!(contact.normal_impulse >= 0.0);
            assert!(contact.friction_impulse.abs() <= most * (1.0 + 1e-9));
            let breach = breach(contact, &problem);
            // A solve ends when no contact's speed changes by more than this; 9e-8 m/s was seen.
            assert!(breach < AGREEMENT.value(), "problem {number}: {breach} m/s");
        }
    }
}
