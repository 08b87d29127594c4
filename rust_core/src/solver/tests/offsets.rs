//! Offsets of contacts that ask for more energy than bodies have.
#![allow(clippy::float_cmp)] // offsets are set to 0

use super::*;

/// A body that falls between two walls at an angle [rad] from vertical, which are to move away from it at a speed [m/s].
fn in_a_gap(angle: f64, speed: f64) -> Problem {
    let mut problem = body(Vector::new(0.0, -1.0), 0.0);
    for side in [-1.0, 1.0] {
        let normal = Vector::new(-side * angle.cos(), angle.sin());
        let mut wall = contact(Vector::new(0.1 * side, 0.0), normal, 0.0);
        wall.normal.offset = -speed;
        problem.contacts.push(wall);
    }
    problem
}

/// To follow both walls it would have to rise at 0.2 or 20 m/s; it falls at 1 m/s.
#[test]
fn walls_lift_a_body_as_far_as_it_has_the_energy() {
    for (angle, rises) in [(0.1_f64, 0.02 / 0.1_f64.sin()), (1e-3, 0.0)] {
        let mut problem = in_a_gap(angle, 0.02);
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0);
        assert_relative_eq!(problem.base().velocity.y, rises, epsilon = 1e-5);
    }
}

/// Of all bodies counts, whatever it is hinged to; the drive of a ring has no inertia of its own.
#[test]
fn the_work_of_offsets_is_held_against_the_energy_of_all_that_moves() {
    let ring = RingSpec {
        links: 3,
        mass: 0.1,
        inertia: 0.001,
        spin: None,
    };
    let mut problem = Problem::new([2.0, 0.1], 1, &[5.0, 0.01], &[ring]);
    problem.set_free(Vector::new(0.3, -0.4), 2.0);
    let (joint, of_ring, spin) = (BASE, problem.layout.spin(0), problem.layout.spin(1));
    problem.free[spin] = 30.0;
    problem.free[of_ring] = 1e3;
    let arm = Row::on_base([0.0; 3]).and(joint, 0.5);
    problem.inertias.push(Inertia::new(arm, 0.8, -1.5));
    (problem.motors).push(Motor::new(Driven::Ring(0), 1.0, true));
    let links = problem.layout.link(0);
    (problem.free[links], problem.free[links + TURN]) = (0.7, 20.0);
    let energy = 0.5 * (2.0 * 0.25 + 0.1 * 4.0 + 0.01 * 900.0 + 0.8 * 2.25 + 0.1 * 0.49 + 0.4);
    // Half of the work is the friction's; either may be of any sign.
    for (work, is_too_much) in [(0.999 * energy, false), (1.001 * energy, true)] {
        problem.contacts = vec![contact(Vector::ZERO, Vector::Y, 0.5)];
        let pushed = &mut problem.contacts[0];
        (pushed.normal.offset, pushed.tangent.offset) = (-0.2, 0.1);
        pushed.set_impulses([0.5 * work / 0.2, -0.5 * work / 0.1]);
        assert_eq!(problem.offsets_do_too_much(), is_too_much, "{work} J");
    }
    assert!(problem.forget_offsets());
    let contact = &problem.contacts[0];
    let left = [
        contact.normal.offset,
        contact.tangent.offset,
        contact.normal_impulse,
    ];
    assert_eq!(left, [0.0; 3]);
    assert!(!problem.forget_offsets());
}

#[test]
fn an_offset_of_the_tangent_alone_is_forgotten_too() {
    let mut problem = body(Vector::ZERO, 0.0);
    problem.contacts.push(contact(Vector::ZERO, Vector::Y, 0.5));
    problem.contacts[0].tangent.offset = 0.1;
    assert!(problem.forget_offsets());
}
