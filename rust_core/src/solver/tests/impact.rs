//! Impacts, and what they give back.

use super::*;
use crate::draw::Draw;

/// [J] Kinetic energy of the base and what spins on it.
fn energy(problem: &Problem) -> f64 {
    let moving = problem.masses.iter().zip(&problem.unknowns);
    0.5 * moving.map(|(mass, v)| mass * v * v).sum::<f64>()
}

/// A flank at the centre of the body, without friction, that a spin moves along its normal.
fn flank(normal: Vector, (spin, lever): (usize, f64)) -> Contact {
    let rows = [(normal, lever), (right_of(normal), 0.0)];
    let rows = rows.map(|(unit, lever)| Row::on_base([unit.x, unit.y, 0.0]).and(spin, lever));
    bearing(rows, 0.0)
}

#[test]
fn a_ball_that_falls_goes_up_with_its_share_of_the_speed() {
    for share in [0.0, 0.3, 1.0] {
        let mut ball = body(Vector::new(0.0, -2.0), 0.0);
        ball.contacts
            .push(contact(Vector::new(0.0, -0.1), Vector::Y, 0.5));
        ball.solve();
        ball.rebound(share);
        assert_relative_eq!(ball.unknowns[1], 2.0 * share, epsilon = AGREEMENT.value());
        let impulse = ball.contacts[0].normal_impulse;
        assert_relative_eq!(impulse, 2.0 * 2.0 * (1.0 + share), max_relative = 1e-6);
    }
}

/// Two contacts hold a body that turns between them by impulses that balance each other. Springs there give it back its
/// turn, the other way round.
#[test]
fn a_body_that_jams_between_two_edges_turns_back() {
    let jammed = |share: f64| {
        let mut problem = body(Vector::ZERO, 1.0);
        for side in [-1.0, 1.0] {
            let arm = Vector::new(0.1 * side, -0.02 * side);
            problem
                .contacts
                .push(contact(arm, Vector::new(-side, 0.0), 0.8));
        }
        problem.solve();
        let impact = problem.contacts[0].normal_impulse;
        problem.rebound(share);
        (problem.unknowns[TURN], impact)
    };
    let (turn, impact) = jammed(0.0);
    assert!(
        impact > 0.1 && turn.abs() < 1e-6,
        "{turn} rad/s, {impact} N s"
    );
    assert_relative_eq!(jammed(1.0).0, -1.0, max_relative = 1e-5);
    assert_relative_eq!(jammed(0.4).0, -0.4, max_relative = 1e-5);
}

/// A flank on what a motor turns strikes at the speed that the motor holds. The impact meets the body and what spins on it, as if
/// there were no motor, and the solve before it keeps what the motor gave.
#[test]
fn an_impact_meets_inertia_and_no_motor() {
    let (radius, speed, inertia) = (0.1, 0.5, 0.01);
    for most in [1e-3, 1.0, 1e3] {
        let mut problem = body_with(&[inertia], Vector::ZERO, 0.0);
        let spin = problem.layout.spin(0);
        problem.free[spin] = speed / radius;
        let mut motor = Motor::new(Driven::Body(spin), radius, true);
        motor.aim(speed, most);
        problem.motors.push(motor);
        let mut flank = flank(Vector::X, (spin, -radius));
        flank.bears = false;
        problem.contacts.push(flank);
        problem.solve();
        assert_relative_eq!(problem.unknowns[spin], speed / radius, epsilon = 1e-9);
        problem.contacts[0].bears = true;
        problem.impact(0.0);
        let per_impulse = 1.0 / 2.0 + radius * radius / inertia;
        let impact = speed / per_impulse;
        assert_relative_eq!(
            problem.contacts[0].normal_impulse,
            impact,
            max_relative = 1e-6
        );
        assert_relative_eq!(problem.unknowns[0], impact / 2.0, max_relative = 1e-6);
        assert!(problem.motor_impulses().all(|impulse| impulse.abs() < 1e-9));
        assert_eq!(problem.motors[0].state, MotorState::Holds);
    }
}

/// What a motor turns behind a gear that locks itself is struck ahead and back. It turns on more slowly or stands, and never
/// turns back nor faster, and motor and target are as they were.
#[test]
fn an_impact_on_a_drive_behind_a_lock_stops_it_at_most() {
    let (radius, speed, inertia) = (0.1, 0.5, 0.01);
    // The speed at which the body comes: the impact slows the drive down, would turn it back, and would turn it faster.
    for (comes, expected) in [(-0.1, 0.1), (-3.0, 0.0), (2.0, 0.5)] {
        let mut problem = body_with(&[inertia], Vector::new(comes, 0.0), 0.0);
        let spin = problem.layout.spin(0);
        problem.free[spin] = speed / radius;
        let mut motor = Motor::new(Driven::Body(spin), radius, true).behind_lock();
        motor.aim(speed, 1.0);
        problem.motors.push(motor);
        let side = if comes > 0.0 { -1.0 } else { 1.0 };
        let mut flank = flank(Vector::X * side, (spin, -radius * side));
        flank.bears = false;
        problem.contacts.push(flank);
        problem.solve();
        problem.contacts[0].bears = true;
        problem.impact(0.0);
        let found = radius * (problem.unknowns[spin] - problem.unknowns[TURN]);
        assert_relative_eq!(found, expected, epsilon = 1e-6);
        assert_eq!(problem.motors[0].state, MotorState::Holds);
        assert_relative_eq!(problem.motors[0].target, speed);
    }
}

/// A random problem whose contacts are hard and push nothing out.
fn drawn_hard(draw: &mut Draw) -> Problem {
    let mut problem = drawn(draw);
    for contact in &mut problem.contacts {
        (contact.bias, contact.compliance) = (0.0, 0.0);
    }
    problem
}

/// In Poisson's hypothesis with friction given back as well, no impact can gain energy. Its impulses are all that changes the
/// momentum.
#[test]
fn no_impact_gives_back_more_energy_than_it_took() {
    let (mut draw, mut solved) = (Draw(11), 0);
    for case in 0..4000 {
        let mut problem = drawn_hard(&mut draw);
        for motor in &mut problem.motors {
            motor.aim(0.0, 0.0);
        }
        problem.unknowns.clone_from(&problem.free);
        let before = energy(&problem);
        let (free, share) = (problem.free.clone(), draw.between(0.0, 1.0));
        problem.solve();
        problem.rebound(share);
        problem.free = free;
        let given: f64 = problem.contacts.iter().map(|c| c.normal_impulse).sum();
        let lost = momentum_lost(&problem);
        assert!(
            lost < 1e-9 * (1.0 + given),
            "case {case}: {lost} N s of {given}"
        );
        if problem.effort.unresolved > 0 {
            continue;
        }
        solved += 1;
        let after = energy(&problem);
        assert!(
            after < before * (1.0 + 1e-5),
            "case {case}: {after} J of {before} J, share {share}"
        );
        for c in &problem.contacts {
            let most = c.friction.coefficient * c.normal_impulse;
            assert!(c.normal_impulse >= 0.0 && c.friction_impulse.abs() <= most * (1.0 + 1e-9));
        }
    }
    assert!(solved > 3900, "{solved} of 4000");
}

/// The same where gears lock themselves: what turned turns on more slowly at most.
#[test]
fn no_impact_on_drives_behind_locks_gains_energy() {
    let (mut draw, mut solved) = (Draw(12), 0);
    for case in 0..4000 {
        let mut problem = drawn_hard(&mut draw);
        for motor in &mut problem.motors {
            *motor = motor.behind_lock();
        }
        problem.unknowns.clone_from(&problem.free);
        let before = energy(&problem);
        let speeds = |p: &Problem| -> Vec<f64> {
            let of = p.motors.iter().map(|motor| p.motor_speed(motor));
            of.collect()
        };
        let had = speeds(&problem);
        let share = draw.between(0.0, 1.0);
        problem.impact(share);
        if problem.effort.unresolved > 0 {
            continue;
        }
        solved += 1;
        let after = energy(&problem);
        assert!(
            after < before * (1.0 + 1e-5),
            "case {case}: {after} J of {before} J, share {share}"
        );
        for (had, has) in had.iter().zip(speeds(&problem)) {
            let within = had.min(0.0) - 1e-6..=had.max(0.0) + 1e-6;
            assert!(within.contains(&has), "case {case}: {has} m/s of {had}");
        }
    }
    assert!(solved > 3900, "{solved} of 4000");
}

/// A body on a rail along a slope strikes the ground and bounces: the rail has turned what the ground gave.
#[test]
fn what_a_rail_does_to_an_impact_counts_in_both_of_its_parts() {
    let along = Vector::new(0.6, 0.8);
    for share in [0.0, 0.3, 1.0] {
        let mut problem = body(along * -2.0, 0.0);
        let across = right_of(along);
        let rail = Row::on_base([across.x, across.y, 0.0]);
        problem.bilaterals.push(Bilateral::new(rail));
        problem.contacts.push(contact(Vector::ZERO, Vector::Y, 0.0));
        problem.contacts[0].bears = false;
        problem.solve();
        problem.contacts[0].bears = true;
        let before = problem.base().velocity;
        problem.impact(share);
        let gained = (problem.base().velocity - before) * 2.0;
        let of_ground = Vector::Y * problem.contacts[0].normal_impulse;
        let given = of_ground + across * problem.bilaterals[0].impulse;
        assert!(
            (given - gained).length() < 1e-6,
            "{given} N s, {gained} N s"
        );
        assert_relative_eq!(
            problem.base().velocity.dot(along),
            2.0 * share,
            epsilon = 1e-6
        );
    }
}
