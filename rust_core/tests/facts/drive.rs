//! Acceleration, braking and their limits, against closed forms.

use approx::assert_relative_eq;
use crawler2d_core::{Model, Scenario, Simulation, TorqueSharing};

use crate::common::*;

/// A robot on level ground with a drivetrain that only its torque limits, and hardly any track mass.
pub(crate) fn racer() -> Scenario {
    let mut scenario = engineer();
    scenario.robot.belly = None;
    scenario.robot.track_mass = 1e-3;
    let d = &mut scenario.robot.drivetrain;
    (d.max_speed, d.max_acceleration, d.max_deceleration) = (20.0, 1e6, 1e6);
    scenario.terrain = slope(0.0, 0.9);
    scenario.drive.speed = 10.0;
    scenario
}

/// [m/s^2] Mean acceleration along x over a span.
pub(crate) fn acceleration(simulation: &mut Simulation, span: f64) -> f64 {
    let before = simulation.reading().velocity.x;
    advance(simulation, span);
    (simulation.reading().velocity.x - before) / span
}

#[test]
fn torque_limits_the_start_of_robot_and_circulating_track() {
    for track in [belt(), line(3), line(5), force()] {
        for sharing in [TorqueSharing::Track, TorqueSharing::Wheel] {
            if sharing == TorqueSharing::Wheel && !matches!(track, crawler2d_core::Track::Line(_)) {
                continue;
            }
            let mut scenario = racer();
            scenario.robot.track_mass = 2.4;
            scenario.robot.drivetrain.max_torque = 1.0;
            scenario.robot.drivetrain.torque_sharing = sharing;
            scenario.robot.track = track.clone();
            let mut simulation = after(&scenario, 0.2);
            let found = acceleration(&mut simulation, 0.5);
            let expected = (2.0 * 1.0 / 0.052) / (21.2 + 2.4);
            println!("{track:?} {sharing:?}: {found:.5} m/s2, F / (m + track) {expected:.5}");
            assert_relative_eq!(found, expected, max_relative = 5e-3);
        }
    }
}

#[test]
fn friction_limits_the_start_of_a_strong_robot() {
    for mu in [0.2, 0.5] {
        let mut scenario = racer();
        scenario.robot.drivetrain.max_torque = 50.0;
        scenario.terrain = slope(0.0, mu);
        let found = acceleration(&mut after(&scenario, 0.2), 0.4);
        assert_relative_eq!(found, mu * G, max_relative = 1e-3);
    }
}

#[test]
fn nose_lifts_at_the_acceleration_of_the_balance() {
    // Centre of mass far back and high: the nose lifts before the tracks slip.
    let mut scenario = racer();
    scenario.robot.center_of_mass = [-0.12, 0.10];
    scenario.terrain = slope(0.0, 3.0);
    let expected = G * (0.1825 - 0.12) / (0.064 + 0.10);
    let found = bisect(0.5 * expected, 1.5 * expected, |a| {
        let mut s = scenario.clone();
        s.robot.drivetrain.max_torque = a * (21.2 + 1e-3) * 0.052 / 2.0;
        after(&s, 0.4).reading().chassis_angle < 0.01
    });
    println!("nose lifts at {found:.4} m/s2, closed form {expected:.4}");
    assert_relative_eq!(found, expected, max_relative = 0.01);
}

/// [m] Way from the command to stop to the stand, from a speed.
pub(crate) fn braking_distance(scenario: &Scenario, speed: f64) -> f64 {
    let mut scenario = scenario.clone();
    scenario.drive.speed = speed;
    let mut simulation = after(&scenario, 2.0);
    assert_relative_eq!(simulation.reading().velocity.x, speed, max_relative = 1e-3);
    let start = simulation.reading().position.x;
    simulation.set_speed(0.0).unwrap();
    advance(&mut simulation, 3.0);
    assert!(simulation.reading().velocity.length() < 1e-6);
    simulation.reading().position.x - start
}

#[test]
fn friction_and_force_limit_the_braking_distance() {
    let mut strong = racer();
    strong.robot.drivetrain.max_torque = 50.0;
    strong.terrain = slope(0.0, 0.3);
    let found = braking_distance(&strong, 2.0);
    let expected = 2.0_f64.powi(2) / (2.0 * 0.3 * G);
    println!("friction: {found:.5} m, closed form {expected:.5}");
    assert_relative_eq!(found, expected, max_relative = 5e-3);

    let mut weak = racer();
    weak.robot.drivetrain.max_torque = 1.0;
    let found = braking_distance(&weak, 1.0);
    let expected = 0.5 * (21.2 + 1e-3) / (2.0 * 1.0 / 0.052);
    println!("force: {found:.5} m, closed form {expected:.5}");
    assert_relative_eq!(found, expected, max_relative = 5e-3);

    let mut gentle = racer();
    gentle.robot.drivetrain.max_torque = 50.0;
    gentle.robot.drivetrain.max_deceleration = 2.0;
    let found = braking_distance(&gentle, 1.0);
    println!("set-point: {found:.5} m, closed form 0.25");
    assert_relative_eq!(found, 0.25, max_relative = 5e-3);
}

#[test]
fn tail_lifts_at_the_deceleration_of_the_balance() {
    let mut scenario = racer();
    scenario.robot.center_of_mass = [0.12, 0.10];
    scenario.terrain = slope(0.0, 3.0);
    scenario.robot.drivetrain.max_acceleration = 1.0;
    scenario.robot.drivetrain.max_torque = 50.0;
    scenario.drive.speed = 4.0;
    let expected = G * (0.1825 - 0.12) / (0.064 + 0.10);
    let found = bisect(0.5 * expected, 1.5 * expected, |a| {
        let mut s = scenario.clone();
        s.robot.drivetrain.max_deceleration = a;
        let mut simulation = after(&s, 4.2);
        simulation.set_speed(0.0).unwrap();
        advance(&mut simulation, 0.8);
        simulation.reading().chassis_angle > -0.005
    });
    println!("tail lifts at {found:.4} m/s2, closed form {expected:.4}");
    assert_relative_eq!(found, expected, max_relative = 0.01);
}

#[test]
fn robot_runs_at_the_commanded_speed_on_flat_ground() {
    for track in [belt(), force(), line(3), line(4), line(9)] {
        let mut scenario = engineer();
        scenario.terrain = slope(0.0, 0.9);
        scenario.robot.track = track;
        let mut simulation = after(&scenario, 3.0);
        let before = simulation.reading();
        advance(&mut simulation, 2.0);
        let now = simulation.reading();
        assert_relative_eq!(
            (now.position.x - before.position.x) / 2.0,
            0.4,
            max_relative = 1e-3
        );
        // Rolling without slip: the way over ground is the way of the surface.
        let (way, surface) = (
            now.position.x - before.position.x,
            now.track_position - before.track_position,
        );
        assert_relative_eq!(way, surface, max_relative = 1e-3);
    }
}

#[test]
fn equal_commands_drive_towards_plus_x_and_minus_x_alike() {
    let mut robots = articulated();
    robots.extend([("belt", engineer()), ("line of 5", engineer_on(line(5)))]);
    for (name, mut forward) in robots {
        forward.terrain = slope(0.0, 0.9);
        forward.robot.center_of_mass = [0.0, 0.02];
        let mut backward = forward.clone();
        backward.drive.speed = -0.4;
        // The sprocket of a chain is at the rear, and grousers and shoes come down in other phases: these are compared
        // over several. On arms the robot stands on those that go round the tips, which are faster than the belt by
        // turns.
        let (phases, limit) = if strikes(name) {
            (few_or_many(2, 8), 0.015)
        } else {
            (1, 2e-7)
        };
        let way = |s: &Scenario| {
            let from = |phase: u32| {
                let mut s = s.clone();
                s.start.track_phase = 0.048 * f64::from(phase) / f64::from(phases);
                let start = after(&s, 0.0).reading().position.x;
                after(&s, 2.0).reading().position.x - start
            };
            (0..phases).map(from).sum::<f64>() / f64::from(phases)
        };
        let (ahead, back) = (way(&forward), way(&backward));
        println!("{name}: {ahead:.6} m and {back:.6} m");
        assert_relative_eq!(ahead, -back, epsilon = limit);
    }
}

/// A push that is more than grip or motors hold drives every robot back, whatever it stands on.
#[test]
fn no_robot_pulls_harder_than_its_grip_or_its_motors() {
    for (name, mut scenario) in articulated() {
        if name.starts_with("force") {
            continue; // it needs no grip
        }
        for (torque, friction) in [(1.0, 0.9), (20.0, 0.1)] {
            scenario.robot.belly = None;
            scenario.robot.drivetrain.max_torque = torque;
            scenario.robot.drivetrain.max_acceleration = 10.0;
            scenario.terrain = slope(0.0, friction);
            let model = Model::new(&scenario.robot).expect("it can be built");
            let of_motors = model.motors as f64 * model.motor.force;
            let of_grip = friction * scenario.robot.mass * G;
            // What turns as a polygon of shoes or tips has a lever of up to 1.4 of the mean, and holds where it
            // stands.
            let of_motors = if strikes(name) {
                1.4 * of_motors
            } else {
                of_motors
            };
            let push = 1.1 * of_motors.min(of_grip);
            let mut simulation = Simulation::new(&checked(&scenario));
            simulation.set_push(-push).expect("a push");
            let (mut farthest, mut hardest) = (0.0_f64, 0.0_f64);
            let start = simulation.reading().position.x;
            while simulation.time() < 1.0 {
                simulation.step_until(1.0).expect("finite");
                farthest = farthest.max(simulation.reading().position.x - start);
                hardest = simulation
                    .drive_forces()
                    .fold(hardest, |most, f| most.max(f.abs()));
            }
            let gained = simulation.reading().position.x - start;
            println!(
                "{name}: {} motors of {:.1} N, grip {of_grip:.1} N, push {push:.1} N: {gained:+.3} m, \
                 hardest {hardest:.2} N",
                model.motors, model.motor.force
            );
            assert!(hardest <= model.motor.force * (1.0 + 1e-9));
            // Where a polygon stands on its side it gives way by millimetres and holds.
            assert!(gained < 0.0 && farthest < 0.01, "{name}");
        }
    }
}
