//! The way down onto the contacts.

use super::*;

/// A belt that drives off on two contacts, with its motor at its limit; solved.
fn driving_off() -> Problem {
    let mut problem = body(Vector::new(0.0, -GRAVITY * TIME), 0.0);
    let (base, radius) = (problem.base, 0.05);
    let free = problem.free.base;
    problem = Problem::new(base, vec![Spin::new(0.01, 0.0)], Vec::new(), Vec::new());
    problem.mass_on_springs = Some(base.mass);
    problem.free.base = free;
    let mut motor = Motor::new(Driven::Spin(0), -radius, true);
    motor.aim(5.0, 0.05);
    problem.motors.push(motor);
    for x in [-0.2, 0.15] {
        let mut on_belt = contact(Vector::new(x, -0.1), Vector::Y, 0.5);
        on_belt.acts = ActsOn::Base {
            joint: None,
            spin: Some(0),
        };
        (on_belt.tangent.spin_lever, on_belt.tangent.lever) = (radius, 0.1 - radius);
        problem.contacts.push(on_belt);
    }
    problem.solve();
    problem
}

fn impulses(problem: &Problem) -> Vec<f64> {
    let of_contact = |c: &Contact| [c.normal_impulse, c.friction_impulse];
    problem.contacts.iter().flat_map(of_contact).collect()
}

#[test]
fn lowering_finds_what_a_right_guess_finds() {
    let mut problem = driving_off();
    let (found, before) = (impulses(&problem), problem.velocities.clone());
    assert_eq!(problem.motors[0].hold, Hold::Pushes);
    problem.motors[0].hold = Hold::Holds;
    problem.tie();
    assert!(problem.lower(), "it gets down");
    assert!(problem.follow_velocities() < 1e-9);
    assert_eq!(problem.motors[0].hold, Hold::Pushes);
    for (lowered, guessed) in impulses(&problem).into_iter().zip(found) {
        assert_relative_eq!(lowered, guessed, max_relative = 1e-6);
    }
    let velocities = &problem.velocities;
    let off = velocities.base.velocity - before.base.velocity;
    assert!(off.length() < AGREEMENT.value());
    let off = velocities.spins[0] - before.spins[0];
    assert!(0.05 * off.abs() < AGREEMENT.value());
}

#[test]
fn the_way_down_touches_with_one_contact_after_the_other() {
    let mut problem = driving_off();
    problem.settle();
    let mut touching = Vec::new();
    for turns in 1..4 {
        let lowest = problem.go_down(turns, 0.0).expect("a way");
        let touches = problem.contacts.iter().filter(|c| c.grip != Grip::Open);
        touching.push(touches.count());
        if lowest.lift == 0.0 {
            break;
        }
    }
    assert_eq!(touching[0], 1);
    assert!(touching.is_sorted());
    assert_eq!(touching.last(), Some(&2));
}
