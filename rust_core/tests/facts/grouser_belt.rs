//! A belt whose grousers travel with it: how it rolls, stands, pulls and climbs.

use crawler2d_core::{BodyKind, Model, Outcome, Scenario, Simulation, Surface, Terrain, Track};

use crate::common::*;

fn lugged() -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = grouser_belt();
    scenario
}

/// Sum of the contact forces along x and y [N], the mean over a duration [s].
fn ground_force(simulation: &mut Simulation, duration: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    let end = simulation.time() + duration;
    while simulation.time() < end {
        simulation.step_until(end).expect("finite");
        let (fx, fy, _) = contact_sums(simulation, 0.0, 0.0);
        sum[0] += fx * simulation.last_step();
        sum[1] += fy * simulation.last_step();
    }
    sum.map(|s| s / duration)
}

#[test]
fn the_engineers_belt_has_its_22_grousers_of_48_mm() {
    let model = Model::new(&lugged().robot).expect("it can be built");
    let of_kind = |kind| model.parts.iter().filter(|p| p.kind == kind).count();
    assert_eq!(of_kind(BodyKind::Grouser), 22);
    assert_eq!(of_kind(BodyKind::Belt), 1);
}

/// On the straight run the grousers stand still on the ground, and the robot on their tips.
#[test]
fn on_level_ground_it_goes_as_fast_as_its_belt_and_stands_on_its_tips() {
    let mut scenario = lugged();
    scenario.terrain = slope(0.0, 0.9);
    let mut simulation = after(&scenario, 3.0);
    let (mut speed, mut lowest, mut highest) = (0.0, f64::INFINITY, 0.0_f64);
    for _ in 0..4000 {
        advance(&mut simulation, 1e-3);
        let r = simulation.reading();
        speed += r.velocity.x / 4000.0;
        lowest = lowest.min(r.position.y);
        highest = highest.max(r.position.y);
    }
    println!("speed {speed:.5} m/s, height {lowest:.6} to {highest:.6} m");
    assert!((speed / 0.4 - 1.0).abs() < 0.01);
    // A grouser that comes down round the front stands on its corner first.
    assert!(lowest > 0.064 - 1e-5 && highest < 0.064 + 1e-3);
}

#[test]
fn the_ground_bears_its_weight_on_the_level_and_on_a_ramp() {
    for angle in [0.0, 0.35, -0.35] {
        let mut scenario = lugged();
        scenario.terrain = slope(angle, 0.9);
        scenario.start.angle = angle;
        scenario.robot.drivetrain.max_torque = 20.0;
        let mut simulation = after(&scenario, 3.0);
        let before = simulation.reading();
        let sum = ground_force(&mut simulation, 1.0);
        let now = simulation.reading();
        let inertia = [
            now.velocity.x - before.velocity.x,
            now.velocity.y - before.velocity.y,
        ]
        .map(|change| scenario.robot.mass * change);
        let weight = scenario.robot.mass * G;
        println!("slope {angle}: {sum:?} N, inertia {inertia:?} N, weight {weight:.3} N");
        assert!((sum[0] - inertia[0]).abs() < 2e-3 * weight);
        assert!((sum[1] - inertia[1] - weight).abs() < 2e-3 * weight);
    }
}

/// With no grouser at a joint of the belt, where its corner lifts the robot by some hundredths of a
/// millimetre, a push is held by just what the motors have.
#[test]
fn a_push_is_held_by_the_force_of_the_motors() {
    let mut scenario = lugged();
    scenario.robot.drivetrain.max_torque = 1.0;
    scenario.robot.belly = None;
    scenario.start.track_phase = 0.01;
    let force = 2.0 * 1.0 / 0.052;
    scenario.terrain = slope(0.0, 0.9);
    for (share, forwards) in [(0.99, true), (1.01, false)] {
        let mut simulation = Simulation::new(&checked(&scenario));
        simulation.set_push(-share * force).expect("a push");
        let start = simulation.reading().position.x;
        advance(&mut simulation, 0.3);
        let gained = simulation.reading().position.x - start;
        let expected = 0.5 * (1.0 - share) * force / (21.2 + 2.4) * 0.3 * 0.3;
        println!("push {share}: {gained:+.3e} m in 0.3 s, closed form {expected:+.3e} m");
        assert_eq!(gained > 0.0, forwards);
        assert!((gained / expected - 1.0).abs() < 0.05);
    }
}

/// A corner that comes down round the front makes a small impact, and an impact passes differences of rounding
/// on: of a dozen shifts half led 30 um off, the others 1 um. Smooth belts keep a nanometre.
#[test]
fn a_shift_by_a_hundred_metres_changes_hundredths_of_a_millimetre_at_most() {
    let path = |x: f64| {
        let mut scenario = lugged();
        scenario.terrain = Terrain::Points {
            points: vec![[x - 5.0, 0.0], [x, 0.0], [x, 0.1], [x + 5.0, 0.1]],
            goal: x,
            surface: Surface::sharp(0.9),
            segment_friction: None,
        };
        scenario.start.approach = 1.0;
        fixed(&mut scenario, 1e-3);
        // At 0.2 m/s^2 up to 0.4 m/s, three seconds end 0.2 m before the edge.
        let r = after(&scenario, 3.0).reading();
        [r.position.x - x, r.position.y, r.chassis_angle]
    };
    let here = path(0.0);
    for shift in [100.0, 103.7, 107.4] {
        let there = path(shift);
        println!("{here:?} and {there:?}");
        assert!((0..3).all(|i| (here[i] - there[i]).abs() < 5e-5));
    }
}

/// Rails of 10 mm across the way, hardly any friction: a flank that stands against a rail holds what the
/// motors give, where friction alone would give 8 N.
#[test]
fn a_flank_against_a_rail_pulls_with_all_the_motors_have() {
    let mut points = vec![[-5.0, 0.0]];
    for rail in 0..60 {
        let x = -2.0 + 0.1 * f64::from(rail);
        points.extend([[x, 0.0], [x, 0.01], [x + 0.03, 0.01], [x + 0.03, 0.0]]);
    }
    points.push([5.0, 0.0]);
    let mut scenario = lugged();
    scenario.robot.belly = None;
    scenario.robot.drivetrain.max_torque = 2.0;
    scenario.terrain = Terrain::Points {
        points,
        goal: 4.9,
        surface: Surface::sharp(0.05),
        segment_friction: None,
    };
    let force = 2.0 * 2.0 / 0.052;
    for (share, holds) in [(0.97, true), (1.05, false)] {
        let mut simulation = Simulation::new(&checked(&scenario));
        advance(&mut simulation, 2.0);
        simulation.set_push(-share * force).expect("a push");
        let before = simulation.reading().position.x;
        advance(&mut simulation, 6.0);
        let gained = simulation.reading().position.x - before;
        println!(
            "pull {:.1} N of {force:.1} N: {gained:+.4} m in 6 s",
            share * force
        );
        assert_eq!(gained > -0.01, holds);
    }
}

/// With grousers of a tenth of a millimetre it is the smooth belt.
#[test]
fn with_vanishing_grousers_it_climbs_as_high_as_the_belt() {
    let highest = |track: Track| {
        let mut base = slow_and_strong();
        base.robot.outline.grouser_height = 1e-4;
        base.robot.track = track;
        bisect(0.06, 0.12, |height| {
            let mut scenario = base.clone();
            scenario.terrain = step(height, 1.5);
            summary(&scenario).outcome == Outcome::Cleared
        })
    };
    let [smooth, lugged] = [belt(), grouser_belt()].map(highest);
    println!("belt {smooth:.5} m, with grousers {lugged:.5} m");
    assert!((lugged / smooth - 1.0).abs() < 0.03);
}
