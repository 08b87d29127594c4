//! The path to a solution.

use super::*;
use crate::draw::Draw;

/// A belt that drives off on two contacts, with its motor at its limit; solved.
fn driving_off() -> Problem {
    let mut problem = body_with(&[0.01], Vector::new(0.0, -GRAVITY * TIME), 0.0);
    let (spin, radius) = (problem.layout.spin(0), 0.05);
    let mut motor = Motor::new(Driven::Body(spin), -radius, true);
    motor.aim(5.0, 0.05);
    problem.motors.push(motor);
    for x in [-0.2, 0.15] {
        let arm = Vector::new(x, -0.1);
        problem
            .contacts
            .push(on_belt(arm, Vector::Y, 0.5, (spin, radius)));
    }
    problem.solve();
    problem
}

fn impulses(problem: &Problem) -> Vec<f64> {
    let of_contact = |c: &Contact| [c.normal_impulse, c.friction_impulse];
    problem.contacts.iter().flat_map(of_contact).collect()
}

#[test]
fn the_path_from_wrong_states_leads_to_what_right_ones_give() {
    for grips in [
        [Grip::Open, Grip::Open],
        [Grip::Sticks, Grip::Open],
        [Grip::Backwards, Grip::Sticks],
    ] {
        let mut problem = driving_off();
        let (right, before) = (impulses(&problem), problem.unknowns.clone());
        assert_eq!(problem.motors[0].state, MotorState::LimitForwards);
        problem.motors[0].state = MotorState::Holds;
        for (contact, grip) in problem.contacts.iter_mut().zip(grips) {
            contact.grip = grip;
        }
        problem.tie();
        let mut starts = [Start::LastStates, Start::Air].into_iter();
        let off = starts.find_map(|start| problem.follow_path(start));
        assert!(off.expect("a path ends") < 1e-9, "{off:?} m/s");
        assert_eq!(problem.motors[0].state, MotorState::LimitForwards);
        for (pivoted, guessed) in impulses(&problem).into_iter().zip(right) {
            assert_relative_eq!(pivoted, guessed, max_relative = 1e-6);
        }
        for (pivoted, before) in problem.unknowns.iter().zip(before) {
            assert!((pivoted - before).abs() < AGREEMENT.value());
        }
    }
}

/// Relaxed by as much as the worst condition asks for, a law holds in any state, and its impulses there stay what they were.
#[test]
fn a_relaxed_law_holds_in_any_state_with_the_same_impulses() {
    let mut draw = Draw(21);
    let mut violated = 0;
    for _ in 0..2000 {
        let mut problem = drawn(&mut draw);
        problem.tie();
        problem.center();
        let unknowns: Vec<f64> = (problem.unknowns.iter())
            .map(|_| draw.between(-1.0, 1.0))
            .collect();
        for contact in &mut problem.contacts {
            let grips = [Grip::Open, Grip::Sticks, Grip::Forwards, Grip::Backwards];
            contact.grip = grips[draw.below(4)];
            let least = contact.violation(&unknowns);
            violated += u32::from(least > 0.0);
            let before = contact.held(&unknowns, 0.0);
            contact.relax(&unknowns, least);
            let scale = 1e-12 * (contact.dampers[0].damping + contact.dampers[1].damping);
            contact.conditions(&unknowns, 1.0, |next, value| {
                assert!(value >= -scale, "{:?} to {next:?}: {value}", contact.grip);
            });
            for (now, before) in contact.held(&unknowns, 1.0).into_iter().zip(before) {
                assert!((now - before).abs() <= scale, "{:?}", contact.grip);
            }
        }
    }
    assert!(violated > 3000, "{violated} states violate a law");
}

/// Two motors behind locks, and a contact that sticks, solved from the states of other velocities.
#[test]
fn a_motor_at_the_end_of_a_path_gives_no_more_than_its_limit() {
    let found: [u8; 71] = [
        0x00, 0x05, 0x12, 0x27, 0x44, 0x69, 0xa4, 0x4b, 0xf5, 0x1d, 0xc4, 0x78, 0x58, 0xc7, 0x43,
        0xc2, 0x4e, 0xdd, 0x38, 0xf3, 0xbf, 0x93, 0xac, 0x6b, 0xd3, 0x24, 0x99, 0x32, 0x01, 0x0f,
        0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x88, 0x7f, 0x7e, 0x85, 0x94, 0xab, 0xca, 0x2f,
        0xf1, 0x25, 0x5c, 0x9b, 0xe2, 0x36, 0x8d, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00,
        0x25, 0x5c, 0x9b, 0xe2, 0x36, 0x8d, 0x88, 0x7f, 0x7e, 0x85, 0x25,
    ];
    crate::fuzz::solver(&found);
}
