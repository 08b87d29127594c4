//! The judge judged: mechanics that can be solved by hand, at three degrees of refinement.

use crawler2d_core::{Scenario, TorqueSharing, Vector};

use super::motion::{Judge, Settings};
use crate::common::*;

/// Coarse, with half the step, and with four times the stiffness on top: the judge's own settings.
fn refinements() -> [Settings; 3] {
    let with = |time_step, stiffness| Settings {
        time_step,
        stiffness,
        ..Settings::default()
    };
    [with(1e-5, 1e7), with(5e-6, 1e7), Settings::default()]
}

/// Two round wheels, brakes on, motors of any strength, on a slope.
fn braked(angle: f64, friction: f64) -> Scenario {
    let mut scenario = slow_and_strong();
    scenario.robot.track = line(2);
    scenario.drive.speed = 0.0;
    scenario.start.angle = angle;
    scenario.terrain = slope(angle, friction);
    scenario
}

const MASS: f64 = 21.2;
const LENGTH: f64 = 0.365;
const RADIUS: f64 = 0.064;

#[test]
fn falls_freely() {
    let mut scenario = braked(0.0, 0.9);
    scenario.robot.track = line_of(3, paper_gear());
    for settings in refinements() {
        let mut judge = Judge::new(&scenario, settings);
        judge.launch(Vector::new(0.0, 1.0), Vector::new(0.8, 0.0));
        let start = judge.position();
        judge.advance(0.4);
        let way = judge.position() - start;
        // Speeds are stepped before places: a fall is ahead by half a step.
        assert!((way.y + 0.5 * G * 0.16).abs() < G * 0.4 * settings.time_step);
        assert!((way.x - 0.32).abs() < 1e-12 && judge.angle().abs() < 1e-12);
    }
}

#[test]
fn two_wheels_share_the_weight_by_their_levers() {
    let mut scenario = braked(0.0, 0.9);
    scenario.robot.center_of_mass = [0.04, 0.03];
    for settings in refinements() {
        let mut judge = Judge::new(&scenario, settings);
        judge.advance(1.0);
        let front = MASS * G * (0.04 / LENGTH + 0.5);
        let rear = MASS * G - front;
        println!(
            "{settings:?}: loads {:?}, by hand {rear} and {front} N",
            judge.loads
        );
        assert!((judge.loads[0].y / rear - 1.0).abs() < 1e-4);
        assert!((judge.loads[1].y / front - 1.0).abs() < 1e-4);
        assert!(judge.deepest < 20e-6);
    }
}

#[test]
fn slips_at_the_friction_angle_and_no_sooner() {
    for friction in [0.3, 0.8_f64] {
        let way = |angle: f64, settings| {
            let mut judge = Judge::new(&braked(angle, friction), settings);
            judge.advance(1.0);
            let (start, speed) = (judge.position(), judge.velocity());
            judge.advance(0.5);
            let gain = (judge.velocity() - speed).length() / 0.5;
            ((judge.position() - start).length(), gain)
        };
        for settings in refinements() {
            let limit = friction.atan();
            let (holds, _) = way(limit - 1e-3, settings);
            let (_, creeps) = way(limit + 1e-3, settings);
            let angle = limit + 0.1;
            let (_, slides) = way(angle, settings);
            let by_hand = |angle: f64| G * (angle.sin() - friction * angle.cos());
            println!(
                "friction {friction}: {holds:.1e} m below the angle; {creeps:.5} m/s^2 above it, by hand {:.5}; \
                 {slides:.4} m/s^2 at 0.1 rad more, by hand {:.4}",
                by_hand(limit + 1e-3),
                by_hand(angle)
            );
            assert!(holds < 1e-5);
            assert!((creeps / by_hand(limit + 1e-3) - 1.0).abs() < 0.02);
            assert!((slides / by_hand(angle) - 1.0).abs() < 1e-3);
        }
    }
}

#[test]
fn weak_motors_spin_up_by_their_force() {
    let mut scenario = braked(0.0, 0.9);
    scenario.robot.track = line_of(3, paper_gear());
    scenario.robot.drivetrain.max_acceleration = 1e3;
    scenario.robot.drivetrain.max_torque = 0.5;
    scenario.robot.drivetrain.max_speed = 20.0;
    scenario.drive.speed = 20.0;
    for sharing in [TorqueSharing::Track, TorqueSharing::Wheel] {
        scenario.robot.drivetrain.torque_sharing = sharing;
        let robot = &scenario.robot;
        let force = robot.drivetrain.max_force(&robot.outline);
        let inertia = robot.moment_of_inertia - robot.track_mass * RADIUS * RADIUS;
        for settings in refinements() {
            // In the air the chassis turns the other way.
            let mut judge = Judge::new(&scenario, settings);
            judge.launch(Vector::new(0.0, 2.0), Vector::ZERO);
            judge.advance(0.1);
            let speed = 0.1 * force * (1.0 / robot.track_mass + RADIUS * RADIUS / inertia);
            for found in judge.speeds() {
                assert!((found / speed - 1.0).abs() < 1e-9);
            }
            assert!((judge.angle() - 0.005 * force * RADIUS / inertia).abs() < 1e-5);
        }
        scenario.robot.track = line(2);
        for settings in refinements() {
            // On the ground the motors speed up chassis and track.
            let mut judge = Judge::new(&scenario, settings);
            judge.advance(0.5);
            let early = judge.velocity().x;
            judge.advance(0.5);
            let gain = (judge.velocity().x - early) / 0.5;
            let by_hand = force / (MASS + scenario.robot.track_mass);
            println!("{sharing:?}: {gain:.6} m/s^2 on the ground, by hand {by_hand:.6}");
            // The ground pulls on the radius that the overlap leaves.
            assert!((gain / by_hand - 1.0).abs() < judge.deepest / RADIUS);
        }
        scenario.robot.track = line_of(3, paper_gear());
    }
}

#[test]
fn a_robot_without_motors_gains_no_energy() {
    for (track, height) in [
        (line_of(3, paper_gear()), 0.05),
        (line(3), 0.05),
        (circumferential(24, paper_gear()), 0.03),
    ] {
        let mut scenario = engineer();
        scenario.robot.track = track;
        scenario.robot.drivetrain.max_torque = 0.0;
        scenario.terrain = step(height, 0.8);
        scenario.start.approach = 0.1;
        for settings in refinements().into_iter().take(few_or_many(2, 3) as usize) {
            let mut judge = Judge::new(&scenario, settings);
            let rest = judge.energy();
            judge.launch(Vector::new(0.0, 0.3), Vector::new(0.8, 0.0));
            let begin = judge.energy() - rest;
            let (mut least, mut gained) = (begin, 0.0_f64);
            for _ in 0..2000 {
                judge.advance(1e-3);
                let now = judge.energy() - rest;
                gained = gained.max(now - least);
                least = least.min(now);
            }
            println!("of {begin:.2} J {least:.2} J are left, at most {gained:.1e} J came back");
            assert!(gained < 1e-3 * begin);
        }
    }
}

#[test]
fn an_impact_leaves_little_speed() {
    let mut scenario = braked(0.0, 0.8);
    scenario.robot.center_of_mass = [0.0, 0.0];
    for settings in refinements() {
        let mut judge = Judge::new(&scenario, settings);
        judge.launch(Vector::new(0.0, 0.05), Vector::ZERO);
        let (mut down, mut up) = (0.0_f64, 0.0_f64);
        for _ in 0..2000 {
            judge.advance(1e-4);
            down = down.max(-judge.velocity().y);
            up = up.max(judge.velocity().y);
        }
        println!("falls at {down:.4} m/s, comes back at {up:.4} m/s");
        assert!(up < 0.03 * down);
    }
}

#[test]
fn climbs_a_slope_at_the_commanded_speed_with_the_force_of_its_weight() {
    let angle = 0.4_f64;
    let mut scenario = braked(angle, 0.9);
    scenario.drive.speed = 0.3;
    for settings in refinements() {
        let mut judge = Judge::new(&scenario, settings);
        judge.advance(1.0);
        let along = Vector::new(angle.cos(), angle.sin());
        let speed = judge.velocity().dot(along);
        let force = judge.loads.iter().map(|load| load.dot(along)).sum::<f64>();
        let by_hand = MASS * G * angle.sin();
        println!("{speed:.6} m/s, {force:.3} N, by hand {by_hand:.3} N");
        // A wheel rolls on the radius that its overlap leaves.
        assert!((speed / 0.3 - 1.0).abs() < judge.deepest / RADIUS);
        assert!((force / by_hand - 1.0).abs() < 1e-3);
    }
}

/// With the rear wheel on the ground and the front wheel at a face, both slide: the front wheel lifts
/// from the friction of this balance on.
#[test]
fn a_nose_climbs_a_face_from_the_friction_of_the_balance_on() {
    let behind = 0.5 * LENGTH;
    let holds = |mu: f64| behind * (1.0 + mu * mu) > mu * mu * (LENGTH + RADIUS) + mu * RADIUS;
    let by_hand = bisect(0.1, 2.0, holds);
    let mut scenario = slow_and_strong();
    scenario.robot.track = line(2);
    scenario.robot.center_of_mass = [0.0, 0.0];
    // Little of an impact: once the nose is up the climb gets easier.
    scenario.drive.speed = 0.01;
    scenario.start.approach = 1e-3;
    for settings in refinements().into_iter().take(few_or_many(2, 3) as usize) {
        let mut rises = |friction: f64| {
            scenario.terrain = step(0.5, friction);
            let mut judge = Judge::new(&scenario, settings);
            judge.advance(4.0);
            judge.angle() > 0.02
        };
        println!("{settings:?}: by hand it climbs from {by_hand:.4} on");
        assert!(!rises(0.99 * by_hand) && rises(1.01 * by_hand));
    }
}
