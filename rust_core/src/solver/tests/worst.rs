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

/// A row by its unit, levers and offset, with what spins and is hinged there.
fn row(entries: &[f64], layout: Layout, [spin, joint]: [Option<usize>; 2]) -> Row {
    let mut row = Row::on_base([entries[0], entries[1], entries[2]]);
    if let Some(k) = joint {
        row = row.and(layout.joint(k), entries[4]);
    }
    if let Some(k) = spin {
        row = row.and(layout.spin(k), entries[3]);
    }
    row.offset = entries[5];
    row
}

fn contact_of(entries: &[f64], layout: Layout) -> Contact {
    const GRIPS: [Grip; 4] = [Grip::Open, Grip::Sticks, Grip::Forwards, Grip::Backwards];

    let on = [entries[0], entries[1]].map(body_at);
    let rows = [2, 8].map(|at| row(&entries[at..at + 6], layout, on));
    let mut contact = bearing(rows, entries[14]);
    (contact.bias, contact.compliance) = (entries[15], entries[16]);
    (contact.normal_impulse, contact.friction_impulse) = (entries[17], entries[18]);
    contact.grip = GRIPS[entries[19] as usize];
    contact
}

fn motor_of(entries: &[f64], layout: Layout) -> Motor {
    const HOLDS: [MotorState; 4] = [
        MotorState::Holds,
        MotorState::LimitForwards,
        MotorState::LimitBackwards,
        MotorState::Absent,
    ];

    let at = entries[1] as usize;
    let on = if entries[0] > 0.0 {
        layout.joint(at)
    } else {
        layout.spin(at)
    };
    let mut motor = Motor::new(Driven::Body(on), entries[2], true);
    motor.aim(entries[3], entries[4]);
    motor.state = HOLDS[entries[5] as usize];
    motor
}

fn problem_of(line: &str) -> Problem {
    let given: Value = serde_json::from_str(line).expect("a line is JSON");
    let [base, free, start] = ["base", "free", "start"].map(|name| numbers(&given[name]));
    let joints = numbers(&given["joints"]).len();
    let mut problem = Problem::new([base[0], base[1]], joints, &numbers(&given["spins"]), &[]);
    let layout = problem.layout;
    problem.free[..3].copy_from_slice(&free);
    problem.unknowns[..3].copy_from_slice(&start);
    for (k, rate) in numbers(&given["free_spins"]).into_iter().enumerate() {
        problem.free[layout.spin(k)] = rate;
    }
    for (k, rate) in numbers(&given["start_spins"]).into_iter().enumerate() {
        problem.unknowns[layout.spin(k)] = rate;
    }
    let rates = numbers(&given["start_joints"]).into_iter();
    for (k, rate) in rates.take(joints).enumerate() {
        problem.unknowns[layout.joint(k)] = rate;
    }
    let inertia = |entries: Vec<f64>| {
        let row = row(&entries[1..7], layout, [None, body_at(entries[0])]);
        Inertia::new(row, entries[8], entries[7] / entries[8])
    };
    problem.inertias = lists(&given["hung"]).map(inertia).collect();
    let contacts = lists(&given["contacts"]).map(|c| contact_of(&c, layout));
    problem.contacts = contacts.collect();
    for contact in &mut problem.contacts {
        contact.mass = given["springs"].as_f64();
    }
    problem.motors = lists(&given["motors"])
        .map(|m| motor_of(&m, layout))
        .collect();
    problem
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
