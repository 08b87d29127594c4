//! Slopes: where a braked robot slips, how fast, and where it tips.

use approx::assert_relative_eq;
use crawler2d_core::{Outcome, Scenario};

use crate::common::*;

/// A robot with its brakes on.
pub(crate) fn braked(angle: f64, friction: f64) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.belly = None;
    scenario.robot.drivetrain.max_torque = 100.0;
    scenario.drive.speed = 0.0;
    scenario.start.angle = angle;
    scenario.terrain = slope(angle, friction);
    scenario
}

#[test]
fn slip_starts_at_the_friction_angle() {
    for mu in [0.3, 0.6, 0.9_f64] {
        for track in [belt(), line(3)] {
            let expected = libm::atan(mu);
            let found = bisect(0.9 * expected, 1.1 * expected, |angle| {
                let mut scenario = braked(angle, mu);
                scenario.robot.track = track.clone();
                let start = after(&scenario, 0.2);
                let later = after(&scenario, 1.2);
                (later.reading().position - start.reading().position).length() < 1e-3
            });
            println!("mu {mu}: slips at {found:.5} rad, closed form {expected:.5}");
            assert_relative_eq!(found, expected, max_relative = 0.01);
        }
    }
}

#[test]
fn robot_below_the_friction_angle_does_not_creep() {
    let scenario = braked(0.97 * libm::atan(0.6), 0.6);
    let early = after(&scenario, 1.0).reading().position;
    let late = after(&scenario, 6.0).reading().position;
    println!("creep {:.1e} m in 5 s", (late - early).length());
    assert!((late - early).length() < 1e-6);
}

#[test]
fn sliding_robot_accelerates_like_a_block() {
    for (angle, mu) in [(0.3, 0.1), (0.5, 0.3), (0.6, 0.0_f64)] {
        let scenario = braked(angle, mu);
        let (a, b) = (
            after(&scenario, 0.2).reading(),
            after(&scenario, 1.2).reading(),
        );
        let found = (a.velocity.length() - b.velocity.length()).abs();
        let (s, c) = libm::sincos(angle);
        let expected = G * (s - mu * c);
        println!("{angle} rad, mu {mu}: {found:.6} m/s2, closed form {expected:.6}");
        assert_relative_eq!(found, expected, max_relative = 1e-3);
    }
}

#[test]
fn robot_tips_backwards_at_the_angle_of_the_balance() {
    for (x, y) in [(-0.10, 0.10), (-0.05, 0.15), (-0.14, 0.05)] {
        let expected = libm::atan((0.1825 + x) / (0.064 + y));
        let found = bisect(0.9 * expected, 1.1 * expected, |angle| {
            let mut scenario = braked(angle, 5.0);
            scenario.robot.center_of_mass = [x, y];
            scenario.criteria.tip_over_angle = angle + 0.2;
            scenario.duration = 5.0;
            summary(&scenario).outcome != Outcome::TippedOver
        });
        println!("centre of mass ({x}, {y}): tips at {found:.5} rad, closed form {expected:.5}");
        assert_relative_eq!(found, expected, max_relative = 0.01);
    }
}
