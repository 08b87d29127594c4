//! Arms in free flight, and on a chassis so heavy that they do not move it.

use approx::assert_relative_eq;

use super::*;
use crate::dynamics::tests::STEP;
use crate::robot::Flipper;
use crate::robot::Model;
use crate::scenario::{Ends, Flippers, Friction, Scenario, shared};
use crate::terrain::GroundFriction;

/// The Engineer with arms at both ends.
fn scenario(torque_limit: f64) -> Scenario {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.flippers = Some(Flippers {
        length: 0.34,
        root_radius: 0.064,
        tip_radius: 0.037,
        mass: 0.775,
        ends: Ends::Both,
        angle: 0.0,
        rate_limit: 2.0,
        torque_limit,
        rotor_inertia: 0.0,
        self_locking: false,
        track: None,
    });
    scenario
}

fn built(scenario: &Scenario) -> (Dynamics, State) {
    let model = Model::new(&scenario.robot).expect("the robot can be built");
    let state = State::at_rest(&model, Vector::new(0.0, 1.0), 0.0, 0.0);
    let solver = scenario.solver.clone();
    let dynamics = Dynamics::new(
        model,
        vec![GroundFriction::everywhere(Friction::dry(0.5))],
        scenario.gravity,
        solver,
    );
    (dynamics, state)
}

fn advance(dynamics: &mut Dynamics, state: &mut State, time: f64, h: f64) {
    for _ in 0..(time / h).round() as u64 {
        dynamics.take(state, &[], 0.0, h);
    }
}

/// Momentum [kg m/s], angular momentum about the origin [kg m^2/s] and kinetic energy [J].
fn sums(dynamics: &mut Dynamics, state: &State) -> (Vector, f64, f64) {
    dynamics.place_flippers(state, 0.0);
    let m = &dynamics.model;
    let of_drives: f64 = (0..state.drives.len())
        .map(|k| m.drive_inertia(k) * state.drives[k].spin)
        .sum();
    let mut sums = (
        state.velocity * m.mass,
        crate::geometry::cross(state.center, state.velocity) * m.mass
            + m.moment_of_inertia * state.angular_velocity
            + of_drives,
        0.5 * m.mass * state.velocity.length_squared()
            + 0.5 * m.moment_of_inertia * state.angular_velocity * state.angular_velocity,
    );
    for (arm, turn) in dynamics.flippers.iter().zip(&state.flippers) {
        let (velocity, mass) = (arm.velocity(state.twist(), turn.rate), arm.rule.mass);
        let center = state.center + arm.pivot + arm.center;
        let inertia = arm.rule.moment_of_inertia;
        sums.0 += velocity * mass;
        sums.1 += crate::geometry::cross(center, velocity) * mass + inertia * turn.rate;
        sums.2 += 0.5 * mass * velocity.length_squared() + 0.5 * inertia * turn.rate * turn.rate;
    }
    sums
}

#[test]
fn arms_that_swing_in_the_air_keep_momentum_and_energy_to_second_order() {
    let mut losses = Vec::new();
    for time_step in [1e-3, 5e-4] {
        let mut scenario = scenario(0.0);
        scenario.gravity = 0.0;
        scenario.robot.drivetrain.max_torque = 0.0;
        let (mut dynamics, mut state) = built(&scenario);
        state.velocity = Vector::new(0.3, -0.2);
        state.angular_velocity = 1.0;
        (state.flippers[0].rate, state.flippers[1].rate) = (5.0, -3.0);
        let before = sums(&mut dynamics, &state);
        advance(&mut dynamics, &mut state, 2.0, time_step);
        let after = sums(&mut dynamics, &state);
        let lost = [
            (after.0 - before.0).length() / before.0.length(),
            (after.1 / before.1 - 1.0).abs(),
            (after.2 / before.2 - 1.0).abs(),
        ];
        losses.push(lost);
        assert!(lost.iter().all(|share| *share < 1e-5), "{lost:?}");
    }
    // Half the step leaves a quarter of the error.
    for (coarse, fine) in losses[0].iter().zip(losses[1]) {
        assert!(fine < 0.3 * coarse || *coarse < 1e-9, "{losses:?}");
    }
}

/// A uniform rod about its end, of length l: T = 2 pi sqrt(2 l / (3 g)), longer by 1 + a^2/16 at amplitude a.
#[test]
fn a_free_arm_of_a_heavy_robot_is_a_pendulum() {
    let mut scenario = scenario(0.0);
    scenario.robot.mass = 1e6;
    scenario.robot.moment_of_inertia = 1e6;
    scenario.robot.center_of_mass = [0.0, 0.0];
    let (mut dynamics, mut state) = built(&scenario);
    // The pivot falls freely unless something holds the robot up.
    dynamics.outer_force = Vector::new(0.0, dynamics.model.mass * scenario.gravity);
    let (down, amplitude) = (-0.5 * std::f64::consts::PI, 0.2);
    state.flippers[0].angle = down + amplitude;
    state.flippers[1].angle = -down;
    let mut crossings = Vec::new();
    let mut largest: f64 = 0.0;
    for step in 0..5000 {
        let before = state.flippers[0].angle - down;
        dynamics.take(&mut state, &[], 0.0, STEP);
        let now = state.flippers[0].angle - down;
        if before > 0.0 && now <= 0.0 {
            crossings.push(1e-3 * (f64::from(step) + before / (before - now)));
        }
        if step > 4000 {
            largest = largest.max(now);
        }
    }
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    let small = std::f64::consts::TAU * (2.0 * 0.34 / (3.0 * scenario.gravity)).sqrt();
    let expected = small * (1.0 + amplitude * amplitude / 16.0);
    assert_relative_eq!(period, expected, max_relative = 1e-4);
    assert_relative_eq!(largest, amplitude, max_relative = 1e-4);
}

#[test]
fn a_motor_turns_its_arm_at_the_limit_of_its_rate_and_the_chassis_back() {
    let mut scenario = scenario(1e4);
    scenario.gravity = 0.0;
    let (mut dynamics, mut state) = built(&scenario);
    // From 2 rad/s it comes to rest as fast as the motor can slow it down.
    let slows = 2.0 / dynamics.flippers[0].deceleration();
    let arrives = 0.8 / 2.0 + 0.5 * slows;
    for step in 0..500 {
        dynamics.command_flippers(&state, [0.8, 0.0].map(FlipperCommand::Angle), STEP, None);
        dynamics.take(&mut state, &[], 0.0, STEP);
        let left = (arrives - STEP * f64::from(step + 1)).max(0.0);
        let slowing = left.min(slows);
        let turned = 0.8 - 2.0 * (left - slowing) - slowing * slowing / slows;
        assert_relative_eq!(state.over_chassis(0), turned, epsilon = 1e-9);
        assert_relative_eq!(state.over_chassis(1), 0.0, epsilon = 1e-9);
    }
    assert!(state.angle < -0.01, "{} rad", state.angle);
    let (momentum, moment, _) = sums(&mut dynamics, &state);
    // The rate jumps within a step, so the centripetal effect is known to within one step only.
    let arm = &dynamics.flippers[0].rule;
    let in_a_step = arm.mass * arm.arm.length() * 2.0 * 2.0 * 1e-3;
    assert!(momentum.length() < in_a_step, "{momentum}");
    assert!(moment.abs() < in_a_step, "{moment}"); // about a point less than 1 m away
}

#[test]
fn arms_that_are_to_keep_level_get_there_at_their_full_rate() {
    let (mut dynamics, mut state) = built(&scenario(30.0));
    state.angular_velocity = 0.7;
    // Front arms have to go down, against the chassis that turns up, and rear arms up.
    dynamics.command_flippers(&state, [-0.5, 0.5].map(FlipperCommand::Level), STEP, None);
    let rates: Vec<f64> = dynamics.flippers.iter().map(|arm| arm.rate).collect();
    assert_eq!(rates, [-2.0, -2.0]);
    // The other way round.
    dynamics.command_flippers(&state, [0.5, -0.5].map(FlipperCommand::Level), STEP, None);
    let rates: Vec<f64> = dynamics.flippers.iter().map(|arm| arm.rate).collect();
    assert_eq!(rates, [2.0, 2.0]);
}

#[test]
fn arms_that_keep_level_are_aimed_at_the_chassis_in_the_middle_of_the_step() {
    let (mut dynamics, mut state) = built(&scenario(5.0));
    let mut before = state.clone();
    (before.angular_velocity, state.angular_velocity) = (0.3, 0.5);
    let level = [0, 1].map(|k| {
        let sign = dynamics.flippers[k].rule.sign();
        FlipperCommand::Level(sign * state.over_chassis(k))
    });
    let trend = Trend::since(&before, 0.02);
    dynamics.command_flippers(&state, level, 0.01, trend);
    // It gains 10 rad/s^2.
    for arm in &dynamics.flippers {
        assert_relative_eq!(arm.rate, -0.55, max_relative = 1e-12);
    }
}

#[test]
fn the_fastest_point_is_at_the_end_of_what_turns_fastest() {
    let (_, mut state) = built(&scenario(5.0));
    state.velocity = Vector::new(0.3, -0.4);
    state.angular_velocity = -2.0;
    assert_relative_eq!(state.fastest(0.5), 1.5);
    state.flippers[1].rate = 3.0;
    assert_relative_eq!(state.fastest(0.5), 2.0);
}

#[test]
fn a_step_is_off_by_what_its_rates_differ_from_the_mean_of_those_at_its_ends() {
    let (mut dynamics, state) = built(&scenario(5.0));
    let moving = |speed: f64, rate: f64| {
        let mut state = state.clone();
        state.velocity.x = speed;
        state.flippers[1].rate = rate;
        state
    };
    dynamics.motion = moving(0.15, 1.2);
    let ends = [moving(0.3, 1.0), moving(0.1, 2.0)];
    // 0.05 m/s of the chassis, and 0.3 rad/s of an arm.
    let error = dynamics.local_error(ends.each_ref(), 2e-3, 0.5);
    assert_relative_eq!(error, 2e-3 * (0.05 + 0.5 * 0.3), max_relative = 1e-12);
}

#[test]
fn any_value_of_a_state_that_is_no_number_is_seen() {
    let (_, state) = built(&scenario(5.0));
    assert!(state.is_finite());
    let spoils: [fn(&mut State, f64); 9] = [
        |state, value| state.center.y = value,
        |state, value| state.velocity.x = value,
        |state, value| state.angle = value,
        |state, value| state.angular_velocity = value,
        |state, value| state.drives[0].spin = value,
        |state, value| state.drives[0].position = value,
        |state, value| state.drives[0].integral = value,
        |state, value| state.flippers[1].angle = value,
        |state, value| state.flippers[1].rate = value,
    ];
    for spoil in spoils {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut state = state.clone();
            spoil(&mut state, value);
            assert!(!state.is_finite());
        }
    }
}

#[test]
fn arms_and_chassis_together_are_the_robot() {
    let scenario = scenario(30.0);
    let robot = &scenario.robot;
    let model = Model::new(robot).expect("the robot can be built");
    let place = |arm: &Flipper| arm.pivot + arm.arm;
    let arms = || model.flippers.iter();
    assert_relative_eq!(model.total_mass(), robot.mass, max_relative = 1e-12);
    let moment: Vector = arms().map(|arm| place(arm) * arm.mass).sum();
    let center = (model.center_of_mass * model.mass + moment) / robot.mass;
    let expected = Vector::from(robot.center_of_mass);
    assert!((center - expected).length() < 1e-12);
    let about = |point: Vector| (point - center).length_squared();
    let of_arms: f64 = arms()
        .map(|arm| arm.moment_of_inertia + arm.mass * about(place(arm)))
        .sum();
    let inertia = model.locked_inertia() + model.mass * about(model.center_of_mass) + of_arms;
    assert_relative_eq!(inertia, robot.moment_of_inertia, max_relative = 1e-12);
}
