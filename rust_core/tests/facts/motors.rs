//! Motors whose force depends on their speed: torque curves, and controllers.

use approx::assert_relative_eq;
use crawler2d_core::{
    ClosedSurface, ClosedTrack, Ends, Model, Pi, Scenario, Simulation, Track, Wheel,
};

use crate::basics::models;
use crate::common::*;
use crate::drive::racer;
use crate::energy::{follow, scale};

/// [m] Radius of the Engineer's belt.
const BELT: f64 = 0.052;

/// [kg] What the Engineer's motors speed up: the robot, its tracks once more, and their rotors.
fn moved(scenario: &Scenario) -> f64 {
    let rotors = 2.0 * scenario.robot.drivetrain.rotor_inertia / (BELT * BELT);
    scenario.robot.mass + scenario.robot.track_mass + rotors
}

/// On level ground, with 1 N m a sprocket and a rotor.
fn weak() -> Scenario {
    let mut scenario = racer();
    scenario.robot.track_mass = 2.4;
    scenario.robot.drivetrain.max_torque = 1.0;
    scenario.robot.drivetrain.rotor_inertia = 0.02;
    scenario
}

#[test]
fn a_line_of_torque_brings_drive_and_rotor_to_its_speed_exponentially() {
    let mut scenario = weak();
    let (fastest, time) = (2.0, 1.5);
    scenario.robot.drivetrain.no_load_speed = Some(fastest);
    let force = 2.0 * 1.0 / BELT;
    let expected = fastest * (1.0 - libm::exp(-force * time / (moved(&scenario) * fastest)));
    let found = after(&scenario, time).reading().velocity.x;
    println!("{found:.9} m/s, closed form {expected:.9}");
    assert_relative_eq!(found, expected, max_relative = 1e-6);
    // The same line in two pieces.
    scenario.robot.drivetrain.no_load_speed = None;
    scenario.robot.drivetrain.torque_curve = Some(vec![[0.0, 1.0], [0.5, 0.75], [2.0, 0.0]]);
    let in_pieces = after(&scenario, time).reading().velocity.x;
    assert_relative_eq!(in_pieces, expected, max_relative = 1e-5);
}

#[test]
fn a_drive_that_runs_free_reaches_the_speed_without_load_and_no_more() {
    for (name, mut scenario) in models() {
        scenario.gravity = 0.0;
        scenario.terrain = slope(0.0, 0.0);
        let drivetrain = &mut scenario.robot.drivetrain;
        (drivetrain.max_acceleration, drivetrain.no_load_speed) = (1e6, Some(0.3));
        scenario.drive.speed = 0.4;
        let (from, to) = (1.0, 2.0);
        let mut simulation = after(&scenario, from);
        let mut travel = 0.0;
        while simulation.time() < to {
            simulation.step_until(to).expect("the state stays finite");
            travel += simulation.drive_speed(0) * simulation.last_step();
        }
        let found = travel / (to - from);
        println!("{name}: {found:.5} m/s");
        // The tension of a chain on a guide pulls at its drive to and fro, and what runs faster than without load is not
        // braked.
        assert_relative_eq!(
            found,
            0.3,
            max_relative = if is_on_chain(&scenario) { 0.04 } else { 1e-3 }
        );
    }
}

#[test]
fn a_proportional_controller_leaves_an_error_of_the_speed_under_load_and_an_integral_none() {
    let angle = 0.2_f64;
    let mut scenario = engineer_on(belt());
    scenario.terrain = slope(angle, 0.9);
    scenario.start.angle = angle;
    scenario.drive.speed = 0.4;
    let gain = 1.0;
    let held = scenario.robot.mass * G * libm::sin(angle);
    for (integral, error) in [(0.0, held / (2.0 * gain / (BELT * BELT))), (20.0, 0.0)] {
        scenario.robot.drivetrain.controller = Some(Pi { gain, integral });
        let found = after(&scenario, 6.0).drive_speed(0);
        println!(
            "integral {integral}: {found:.6} m/s, closed form {:.6}",
            0.4 - error
        );
        assert_relative_eq!(found, 0.4 - error, epsilon = 1e-5);
    }
}

#[test]
fn a_controller_that_was_at_its_limit_does_not_overshoot() {
    let mut scenario = weak();
    scenario.drive.speed = 0.5;
    scenario.robot.drivetrain.controller = Some(Pi {
        gain: 5.0,
        integral: 5.0,
    });
    let mut simulation = Simulation::new(&checked(&scenario));
    let mut fastest: f64 = 0.0;
    while simulation.time() < 4.0 {
        simulation.step().expect("the state stays finite");
        fastest = fastest.max(simulation.drive_speed(0));
    }
    println!("fastest {fastest:.5} m/s");
    // It starts for 1 s at its limit: a sum of the errors until then would ask for 15 times that.
    assert!(fastest < 0.5 * 1.02, "{fastest} m/s");
    assert_relative_eq!(simulation.drive_speed(0), 0.5, epsilon = 1e-3);
}

#[test]
fn motors_with_curves_and_controllers_give_no_more_energy_than_their_work() {
    let mut draw = Draw(13);
    for (name, mut scenario) in models() {
        for _ in 0..few_or_many(1, 2) {
            let drivetrain = &mut scenario.robot.drivetrain;
            drivetrain.no_load_speed = Some(draw.between(0.1, 1.0));
            drivetrain.rotor_inertia = libm::exp(draw.between(-8.0, -2.0));
            drivetrain.controller = Some(Pi {
                gain: libm::exp(draw.between(-2.0, 3.0)),
                integral: draw.between(0.0, 50.0),
            });
            let angle = draw.between(-0.4, 0.4);
            scenario.terrain = slope(angle, draw.between(0.0, 1.2));
            scenario.start.angle = angle;
            let account = follow(&scenario, 2.0);
            assert!(
                account.gained <= 1e-3 * scale(&scenario, &account),
                "{name} gained {} J",
                account.gained
            );
        }
    }
}

#[test]
fn a_proportional_controller_of_no_speed_runs_a_drive_down_like_a_damper() {
    let mut scenario = weak();
    scenario.drive.speed = 0.5;
    let gain = 0.02;
    scenario.robot.drivetrain.max_torque = 10.0;
    scenario.robot.drivetrain.controller = Some(Pi {
        gain,
        integral: 0.0,
    });
    let mut simulation = after(&scenario, 5.0);
    let began = simulation.reading().velocity.x;
    simulation.set_speed(0.0).unwrap();
    advance(&mut simulation, 2.0);
    let damping = 2.0 * gain / (BELT * BELT);
    let expected = began * libm::exp(-damping * 2.0 / moved(&scenario));
    let found = simulation.reading().velocity.x;
    println!("{found:.9} m/s of {began:.6}, closed form {expected:.9}");
    assert_relative_eq!(found, expected, max_relative = 1e-6);
}

#[test]
fn motors_with_a_curve_give_no_more_in_a_step_than_at_rest() {
    let torque = 4.0;
    let most = 2.0 * torque / BELT;
    // Arms beside a chain have as much again.
    let one_force = models().into_iter().filter(|(_, s)| !is_on_chain(s));
    for (name, mut scenario) in one_force {
        scenario.robot.drivetrain.max_torque = torque;
        scenario.robot.drivetrain.torque_curve = Some(vec![[0.0, torque], [1.0, 0.0]]);
        scenario.terrain = step(0.1, 0.8);
        scenario.drive.speed = 0.5;
        let mut simulation = Simulation::new(&checked(&scenario));
        let (mut found, mut backwards): (f64, f64) = (0.0, 0.0);
        while simulation.time() < 4.0 {
            simulation.step().expect("the state stays finite");
            found = found.max(simulation.drive_forces().map(f64::abs).sum());
            let speeds = (0..simulation.drives()).map(|k| -simulation.drive_speed(k));
            backwards = speeds.fold(backwards, f64::max);
        }
        println!(
            "{name}: {:.4} of the force at rest, {backwards:.4} m/s back",
            found / most
        );
        // Within a step the line goes on below a speed of 0.
        assert!(
            found < (1.001 + backwards) * most,
            "{name}: {found} N of {most}"
        );
    }
}

/// Flippers on a chain have motors of their own, because a chain can share none with a belt.
#[test]
fn a_closed_track_has_the_force_of_the_motors_of_the_track_that_it_closes() {
    for open in [line(4), circumferential(24, Wheel::Round), segmental(None)] {
        for mut scenario in [engineer_on(open.clone()), with_flippers(Ends::Both, open)] {
            let robot = &mut scenario.robot;
            robot.track = Track::Closed(ClosedTrack {
                of: Box::new(robot.track.clone()),
                surface: ClosedSurface::Own,
            });
            let model = Model::new(robot).expect("it can be built");
            let expected = 2.0 * robot.drivetrain.max_torque / BELT;
            assert_eq!(model.motors, 1);
            assert_relative_eq!(model.motor.force, expected, max_relative = 1e-12);
        }
    }
}
