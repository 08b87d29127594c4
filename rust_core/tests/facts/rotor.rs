//! Rotors of motors: they turn with the drives over the chassis, and with nothing else.

use approx::assert_relative_eq;
use crawler2d_core::{Model, Simulation, TorqueSharing};
use nalgebra::{Matrix5, RowVector5, SMatrix, Vector5};

use crate::basics::models;
use crate::common::*;
use crate::drive::{acceleration, racer};
use crate::energy::{follow, scale};

/// [m] Radius of the Engineer's belt, and of its wheels.
const BELT: f64 = 0.052;
const WHEEL: f64 = 0.064;
/// Friction at which wheels stick to the ground through an impact.
const STICKING: f64 = 10.0;

#[test]
fn the_rotor_starts_with_robot_and_track_as_its_mass_at_the_belt() {
    let inertia = 0.05;
    for track in [belt(), line(3), line(5), force()] {
        let mut scenario = racer();
        scenario.robot.track_mass = 2.4;
        scenario.robot.drivetrain.max_torque = 1.0;
        scenario.robot.drivetrain.rotor_inertia = inertia;
        scenario.robot.track = track.clone();
        let found = acceleration(&mut after(&scenario, 0.2), 0.5);
        let moved = 21.2 + 2.4 + 2.0 * inertia / (BELT * BELT);
        let expected = (2.0 * 1.0 / BELT) / moved;
        println!("{track:?}: {found:.6} m/s2, closed form {expected:.6}");
        assert_relative_eq!(found, expected, max_relative = 1e-6);
    }
}

#[test]
fn the_rotor_resists_a_drive_that_runs_free_by_its_mass_whatever_the_model() {
    // So much that the shoes of a chain, which do not start evenly, do not count.
    let inertia = 0.5;
    // Drives of arms run on what swings itself.
    let rigid = models();
    for (name, mut scenario) in rigid.filter(|(_, s)| s.robot.flippers.is_none()) {
        scenario.gravity = 0.0;
        scenario.terrain = slope(0.0, 0.0);
        scenario.robot.drivetrain.max_torque = 1.0;
        scenario.robot.drivetrain.max_speed = 20.0;
        scenario.robot.drivetrain.max_acceleration = 1e6;
        scenario.drive.speed = 20.0;
        let mut per_speed = |inertia: f64| {
            scenario.robot.drivetrain.rotor_inertia = inertia;
            let mut simulation = after(&scenario, 0.01);
            let before = simulation.drive_speed(0);
            advance(&mut simulation, 0.02);
            let impulse = simulation.drive_forces().next().unwrap() * 0.02;
            impulse / (simulation.drive_speed(0) - before)
        };
        let found = per_speed(inertia) - per_speed(0.0);
        let motors = simulation_motors(&scenario);
        let expected = 2.0 * inertia / (BELT * BELT) / motors;
        println!("{name}: {found:.4} kg, closed form {expected:.4}");
        // The tension of a chain on a guide pulls at the drive, too: with 1 N of its 38 N here.
        let tolerance = if is_on_chain(&scenario) { 0.03 } else { 1e-3 };
        assert_relative_eq!(found, expected, max_relative = tolerance);
    }
}

/// The motors among which a robot's torque is shared.
fn simulation_motors(scenario: &crawler2d_core::Scenario) -> f64 {
    Model::new(&scenario.robot).expect("it can be built").motors as f64
}

#[test]
fn rotors_never_gain_energy() {
    let mut draw = Draw(11);
    for (name, mut scenario) in models() {
        for _ in 0..few_or_many(1, 2) {
            scenario.robot.drivetrain.rotor_inertia = libm::exp(draw.between(-6.0, 0.0));
            if let Some(flippers) = &mut scenario.robot.flippers {
                flippers.rotor_inertia = libm::exp(draw.between(-6.0, 0.0));
            }
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

/// [rad/s] Rate at which a robot at a speed `u` [m/s] pitches right after its front wheel has struck the corner of a step
/// `height` [m] high, whose wheels stick to the ground: of its five velocities (x, y, pitch, and the wheels' rates) one is
/// left free, and along that one momentum is kept.
fn pitch_rate_after(scenario: &crawler2d_core::Scenario, u: f64, height: f64) -> f64 {
    let robot = &scenario.robot;
    let half = 0.5 * robot.outline.axle_distance();
    let of_wheel = 0.5 * robot.track_mass * WHEEL * WHEEL;
    let of_chassis = robot.moment_of_inertia - 2.0 * of_wheel;
    let rotor = robot.drivetrain.rotor_inertia * (WHEEL / BELT).powi(2);
    let masses = [robot.mass, robot.mass, of_chassis, of_wheel, of_wheel];
    let mut mass = Matrix5::from_diagonal(&Vector5::from(masses));
    for over_chassis in [[0.0, 0.0, -1.0, 1.0, 0.0], [0.0, 0.0, -1.0, 0.0, 1.0]] {
        let along = RowVector5::from(over_chassis);
        mass += along.transpose() * along * rotor;
    }
    let down = WHEEL - height;
    let ahead = (WHEEL * WHEEL - down * down).sqrt();
    // Velocity along x and y of the point of each wheel that touches: at the bottom of one, at the corner of the other.
    let held = SMatrix::<f64, 4, 5>::from_rows(&[
        RowVector5::new(1.0, 0.0, 0.0, WHEEL, 0.0),
        RowVector5::new(0.0, 1.0, -half, 0.0, 0.0),
        RowVector5::new(1.0, 0.0, 0.0, 0.0, down),
        RowVector5::new(0.0, 1.0, half, 0.0, ahead),
    ]);
    let before = Vector5::new(u, 0.0, 0.0, -u / WHEEL, -u / WHEEL);
    // Where x moves at 1 m/s, the wheels turn at -1 / WHEEL and -1 / down, and the front axle rises at ahead / down.
    let rise = ahead / down;
    let free = Vector5::new(
        1.0,
        0.5 * rise,
        0.5 * rise / half,
        -1.0 / WHEEL,
        -1.0 / down,
    );
    assert!((held * free).norm() < 1e-12, "it breaks no contact");
    let kept = free.dot(&(mass * before)) / free.dot(&(mass * free));
    // What the contacts have given must press and stick.
    let given = mass * (free * kept - before);
    let impulses = (held * held.transpose()).try_inverse().unwrap() * held * given;
    let sticks = impulses[0].abs() < STICKING * impulses[1];
    assert!(sticks, "the rear wheel stays down and sticks: {impulses}");
    kept * free[2]
}

#[test]
fn an_impact_on_a_driven_wheel_meets_its_rotor() {
    let (u, height) = (0.5, 0.02);
    // Motors that are strong enough to start, and ones that would hold the speed through anything that takes time.
    for (inertia, torque) in [
        (0.0, 20.0),
        (0.0, 2000.0),
        (0.02, 20.0),
        (0.05, 20.0),
        (0.05, 2000.0),
        (0.1, 20.0),
    ] {
        let mut scenario = engineer_on(line(2));
        scenario.robot.belly = None;
        scenario.robot.center_of_mass = [0.0, 0.0];
        scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
        scenario.robot.drivetrain.rotor_inertia = inertia;
        scenario.robot.drivetrain.max_acceleration = 1.0;
        scenario.robot.drivetrain.max_torque = torque;
        scenario.start.approach = 0.6;
        scenario.terrain = step(height, STICKING);
        scenario.drive.speed = u;
        let mut simulation = Simulation::new(&checked(&scenario));
        advance(&mut simulation, 1.0);
        while simulation.reading().angular_velocity.abs() < 0.05 {
            simulation.step().expect("the state stays finite");
            assert!(simulation.time() < 5.0, "it strikes");
        }
        let found = simulation.reading().angular_velocity;
        let expected = pitch_rate_after(&scenario, u, height);
        println!("J = {inertia} kg m2, {torque} N m: {found:.5} rad/s, momentum {expected:.5}");
        // The impact ends a step of 20 us of weight, of 0.2 mm/s.
        assert_relative_eq!(found, expected, max_relative = 1e-3);
    }
}
