//! A chain that whirls freely in the air, off its guide.

use approx::assert_relative_eq;

use super::*;
use crate::contact::Contact;
use crate::dynamics::Shoe;
use crate::geometry::{Rotation, Twist, cross, left_of};
use crate::robot::{Bushing, Model, Mount};
use crate::scenario::{Friction, shared};
use crate::terrain::GroundFriction;

/// Momentum [kg m/s], angular momentum about the origin [kg m^2/s] and energy [J] of the shoes and bushings.
fn sums(dynamics: &Dynamics, state: &State) -> (Vector, f64, f64) {
    let rule = &dynamics.chains[0].rule;
    let (mass, inertia) = (rule.shoe_mass, rule.shoe_inertia);
    let mut sums = (Vector::ZERO, 0.0, 0.0);
    for shoe in &state.shoes {
        let Twist { velocity, turn } = shoe.twist;
        sums.0 += velocity * mass;
        sums.1 += cross(shoe.center, velocity) * mass + inertia * turn;
        sums.2 += 0.5 * mass * velocity.length_squared() + 0.5 * inertia * turn * turn;
    }
    for pair in state.shoes.windows(2) {
        sums.2 += 0.5 * rule.bushing.stiffness * pair[0].bend(&pair[1]).powi(2);
    }
    sums
}

/// The Engineer without gravity and motors, and its chain 3 m away: still in the shape of the track, but turning as
/// a whole and flying off.
fn whirling(bushing: Bushing) -> (Dynamics, State) {
    let mut scenario = shared("engineer_chain_step");
    scenario.robot.drivetrain.max_torque = 0.0;
    let model = Model::new(&scenario.robot).expect("the robot can be built");
    let mut state = State::at_rest(&model, Vector::ZERO, 0.0, 0.0);
    let (away, turn) = (Vector::new(0.0, 3.0), 8.0);
    let turned = Rotation::new(0.4);
    for shoe in &mut state.shoes {
        let arm = turned * shoe.center;
        shoe.center = away + arm;
        shoe.angle += 0.4;
        shoe.twist = Twist {
            velocity: Vector::new(0.2, 0.3) + left_of(arm) * turn,
            turn,
        };
    }
    let mut dynamics = Dynamics::new(
        model,
        vec![GroundFriction::everywhere(Friction::dry(0.9))],
        0.0,
        scenario.solver,
    );
    dynamics.chains[0].rule.bushing = bushing;
    (dynamics, state)
}

#[test]
fn a_chain_that_whirls_in_the_air_keeps_momentum_and_energy_to_second_order() {
    keeps_momentum_and_energy(Bushing::default());
}

/// Its hinges hold springs of a tenth of a newton metre a radian, which turn a shoe some ten times a second.
#[test]
fn springs_in_its_pins_keep_them_as_well() {
    let stiffness = 0.1;
    keeps_momentum_and_energy(Bushing {
        stiffness,
        damping: 0.0,
    });
}

/// However strong: what is damped comes to turn as one, with the momentum that it has.
#[test]
fn dampers_in_its_pins_take_energy_until_it_turns_as_one() {
    for damping in [1e-3, 0.1, 1e3] {
        let stiffness = 0.0;
        let (mut dynamics, mut state) = whirling(Bushing { stiffness, damping });
        let before = sums(&dynamics, &state);
        let mut energy = before.2;
        for _ in 0..4000 {
            dynamics.take(&mut state, &[], 0.0, 1e-3);
            let now = sums(&dynamics, &state);
            assert!((now.0 - before.0).length() < 1e-12 * before.0.length());
            assert!((now.1 / before.1 - 1.0).abs() < 1e-3);
            assert!(now.2 < energy * (1.0 + 1e-6), "{} of {energy} J", now.2);
            energy = energy.min(now.2);
        }
        let turns = state.shoes.iter().map(|shoe| shoe.twist.turn);
        let (low, high) = turns.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), turn| {
            (low.min(turn), high.max(turn))
        });
        // 1 mN m s/rad take longer.
        let is_one = high - low < 0.01 * high;
        assert!(damping < 0.1 || is_one, "{damping}: {low} to {high} rad/s");
    }
}

fn keeps_momentum_and_energy(bushing: Bushing) {
    let mut losses = Vec::new();
    for h in [1e-3_f64, 5e-4] {
        let (mut dynamics, mut state) = whirling(bushing);
        let before = sums(&dynamics, &state);
        let (mut turned, mut energy, mut estimate): (f64, f64, f64) = (0.0, 0.0, 0.0);
        let mut last = state.clone();
        for _ in 0..(1.0 / h).round() as u64 {
            last.copy(&state);
            dynamics.take(&mut state, &[], 0.0, h);
            let now = sums(&dynamics, &state);
            assert!((now.0 - before.0).length() < 1e-12 * before.0.length());
            turned = turned.max((now.1 / before.1 - 1.0).abs());
            energy = energy.max((now.2 / before.2 - 1.0).abs());
            estimate = estimate.max(dynamics.local_error([&last, &state], h, 0.0));
        }
        losses.push([turned, energy, estimate]);
    }
    for (coarse, fine) in losses[0].into_iter().zip(losses[1]) {
        // Half the step leaves a quarter of the error.
        assert!(coarse < 1e-3 && fine < 0.3 * coarse, "{losses:?}");
    }
}

#[test]
fn a_shoe_that_is_no_number_or_too_fast_is_seen() {
    let (_, state) = whirling(Bushing::default());
    assert!(state.is_finite());
    let spoils: [fn(&mut Shoe); 4] = [
        |shoe| shoe.center.x = f64::NAN,
        |shoe| shoe.angle = f64::INFINITY,
        |shoe| shoe.twist.turn = f64::NAN,
        |shoe| shoe.twist.velocity.y = 4e8,
    ];
    for spoil in spoils {
        let mut state = state.clone();
        spoil(&mut state.shoes[5]);
        assert!(!state.is_finite());
    }
}

#[test]
fn the_fastest_point_of_a_shoe_is_at_its_end() {
    let (dynamics, mut state) = whirling(Bushing::default());
    state.shoes[7].twist = Twist {
        velocity: Vector::new(3.0, 4.0),
        turn: -200.0,
    };
    let pitch = dynamics.chains[0].rule.path.pitch;
    assert_relative_eq!(dynamics.fastest(&state, 0.3), 5.0 + 200.0 * pitch);
}

#[test]
fn a_step_is_off_by_a_tenth_of_what_its_pins_are() {
    let (mut dynamics, state) = whirling(Bushing::default());
    let moving = |speed: f64, turn: f64| {
        let mut state = state.clone();
        state.shoes[7].twist = Twist {
            velocity: Vector::new(0.0, speed),
            turn,
        };
        state
    };
    dynamics.motion = moving(1.0, 2.0);
    let ends = [moving(3.0, -5.0), moving(0.0, 4.0)];
    let half_pitch = 0.5 * dynamics.chains[0].rule.path.pitch;
    let error = dynamics.local_error(ends.each_ref(), 2e-3, 0.3);
    let expected = 2e-3 * 0.1 * (0.5 + half_pitch * 2.5);
    assert_relative_eq!(error, expected, max_relative = 1e-12);
}

#[test]
fn a_shoe_meets_the_ground_with_its_own_speed_and_drives() {
    let (mut dynamics, mut state) = whirling(Bushing::default());
    let (shoe, half) = (7, 1e-3);
    state.shoes[shoe].twist = Twist {
        velocity: Vector::new(0.2, -0.3),
        turn: 0.0,
    };
    let (layout, unknowns) = (dynamics.problem.layout, &mut dynamics.problem.unknowns);
    state.write_velocities(layout, unknowns);
    let part = dynamics
        .model
        .parts
        .iter()
        .position(|part| part.mount == Mount::Shoe(shoe));
    let part = part.expect("it has a plate");
    let point = state.shoes[shoe].center + Vector::new(0.01, -0.02);
    let contact = Contact::new(part, (0, -1), (point, Vector::Y), 1e-4);
    let start = Start::new((&state, &dynamics.model), (layout, unknowns), half);
    let (touch, _) = Touch::of_shoe(&contact, None, shoe, &start);
    assert_eq!((touch.on, touch.drive), (On::Shoe, Some(0)));
    // The contact was found in the middle of the step, half a step ahead.
    assert_relative_eq!(touch.gap, 1e-4 + 0.3 * half, max_relative = 1e-12);
    let travel = state.shoes[shoe].along();
    let levers = [travel.y, travel.x].map(|along| -dynamics.model.drive_radius * along);
    assert_relative_eq!(touch.spin_levers[0], levers[0], max_relative = 1e-12);
    assert_relative_eq!(touch.spin_levers[1], levers[1], max_relative = 1e-12);
}

#[test]
fn chains_report_the_deepest_shoe_in_their_guide() {
    let (mut dynamics, _) = whirling(Bushing::default());
    let at = |on: On, gap: f64| Touch {
        on,
        gap,
        ..Touch::default()
    };
    let guide = On::Guide { chain: 0, shoe: 1 };
    dynamics.touches = vec![
        at(guide, 2e-3),
        at(guide, -3e-4),
        at(guide, -1e-4),
        at(On::Shoe, -0.1),
    ];
    assert_relative_eq!(dynamics.chain_reading().guide_penetration, 3e-4);
}

#[test]
fn shoes_that_run_go_round_with_the_chassis_and_once_round_their_chain() {
    let (dynamics, _) = whirling(Bushing::default());
    let mut state = State::at_rest(&dynamics.model, Vector::ZERO, 0.2, 0.0);
    state.angular_velocity = 0.7;
    let speed = 0.4;
    state.run_shoes(&dynamics.model, speed);
    let rule = &dynamics.chains[0].rule;
    let shoes = &state.shoes[rule.shoes.clone()];
    let turns = shoes.iter().map(|shoe| 0.7 - shoe.twist.turn);
    // Each shoe turns as the place of its middle does: a whole number of them is on each arc.
    let round = turns.sum::<f64>() * rule.path.pitch / std::f64::consts::TAU;
    assert_relative_eq!(round, speed, max_relative = 0.1);
    for shoe in shoes {
        let over_chassis = shoe.twist.velocity - state.velocity_at(shoe.center);
        assert_relative_eq!(over_chassis.length(), speed, max_relative = 0.05);
        assert!(over_chassis.dot(shoe.along()) > 0.9 * speed);
    }
}
