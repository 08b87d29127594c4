//! The belt under its force limit: starting, stalling, two opposed contacts, braking; no oscillation.

use approx::assert_relative_eq;
use crawler2d_core::{Run, Scenario, Surface, Terrain};

use crate::common::*;

fn weak_belt(force: f64) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.belly = None;
    scenario.robot.drivetrain.max_torque = force * 0.052 / 2.0;
    scenario.robot.drivetrain.max_acceleration = 10.0;
    scenario.duration = 6.0;
    scenario.criteria.stationary_windows = 1000;
    scenario
}

/// Mean and largest deviation of a column over its last second (100 samples).
fn last_second(column: &[f64]) -> (f64, f64) {
    let tail = &column[column.len() - 100..];
    let mean = tail.iter().sum::<f64>() / 100.0;
    (
        mean,
        tail.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max),
    )
}

/// The last forces (normal, traction) of the contact whose normal points most towards (x, y).
fn contact_towards(run: &Run, x: f64, y: f64) -> (f64, f64) {
    let c = &run.contacts;
    let last = *c.time.last().unwrap();
    let toward = |i: &usize| c.normal_x[*i] * x + c.normal_y[*i] * y;
    let i = (0..c.time.len())
        .filter(|i| c.time[*i] == last)
        .max_by(|a, b| toward(a).total_cmp(&toward(b)))
        .unwrap();
    (c.normal_force[i], c.friction_force[i])
}

#[test]
fn belt_stalls_against_a_wall_at_its_force_limit() {
    for force in [30.0, 80.0] {
        let mut scenario = weak_belt(force);
        scenario.terrain = step(1.0, 0.9);
        let run = run(&scenario);
        let (mean, ripple) = last_second(&run.trace.drive_force);
        let (speed, speed_ripple) = last_second(&run.trace.track_speed);
        println!(
            "{force} N: force {mean:.4} N, ripple {ripple:.1e} N, belt {speed:.1e} m/s, ripple {speed_ripple:.1e}"
        );
        assert_relative_eq!(mean, force, max_relative = 5e-3);
        assert!(ripple < 5e-3 * force);
        assert!(speed.abs() < 1e-5 && speed_ripple < 1e-5);
        // The push on the wall is the traction on the ground; with the traction up the wall it is the limit.
        let (push, up) = contact_towards(&run, -1.0, 0.0);
        println!("    wall {push:.3} N, traction on it {up:.3} N");
        assert_relative_eq!(push + up, force, max_relative = 5e-3);
    }
}

/// Level ground, then a pit with two equal walls and a narrow floor.
fn pit(slope: f64, friction: f64) -> Terrain {
    let (depth, floor) = (0.4, 0.05);
    let wall = depth / libm::tan(slope);
    let points = vec![
        [-3.0, 0.0],
        [0.0, 0.0],
        [wall, -depth],
        [wall + floor, -depth],
        [2.0 * wall + floor, 0.0],
        [9.0, 0.0],
    ];
    Terrain::Points {
        points,
        goal: 8.0,
        surface: Surface::sharp(friction),
        segment_friction: None,
    }
}

#[test]
fn belt_stalled_in_a_pit_holds_its_force_limit() {
    for (slope, force) in [(0.5, 20.0), (0.6, 40.0), (0.55, 30.0)] {
        let mut scenario = weak_belt(force);
        scenario.terrain = pit(slope, 2.0);
        scenario.duration = 20.0;
        let run = run(&scenario);
        let (mean, ripple) = last_second(&run.trace.drive_force);
        let (_, speed_ripple) = last_second(&run.trace.track_speed);
        assert!(ripple < 5e-3 * force && speed_ripple < 1e-5);
        let c = &run.contacts;
        let last = *c.time.last().unwrap();
        let (mut fx, mut fy, mut net) = (0.0, 0.0, 0.0);
        for i in (0..c.time.len()).filter(|i| c.time[*i] == last) {
            // A traction acts along its normal turned by -90 degrees.
            fx += c.normal_force[i] * c.normal_x[i] + c.friction_force[i] * c.normal_y[i];
            fy += c.normal_force[i] * c.normal_y[i] - c.friction_force[i] * c.normal_x[i];
            net += c.friction_force[i];
        }
        println!("walls {slope} rad: motor {mean:.4} N of {force}, tractions {net:.4} N");
        assert!(fx.abs() < 5e-3 * 21.2 * G);
        assert_relative_eq!(fy, 21.2 * G, max_relative = 5e-3);
        assert_relative_eq!(net, force, max_relative = 5e-3);
        assert_relative_eq!(mean, force, max_relative = 5e-3);
    }
}

#[test]
fn belt_is_not_driven_when_it_is_free() {
    let mut scenario = weak_belt(0.0);
    scenario.terrain = slope(-0.2, 0.9);
    scenario.start.angle = -0.2;
    let (a, b) = (
        after(&scenario, 0.5).reading(),
        after(&scenario, 1.5).reading(),
    );
    // A free belt rolls down: gravity moves the robot and its circulating mass.
    let expected = 21.2 * G * libm::sin(0.2) / (21.2 + 2.4);
    assert_relative_eq!(
        b.velocity.length() - a.velocity.length(),
        expected,
        max_relative = 5e-3
    );
}
