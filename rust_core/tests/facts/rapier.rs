//! rapier's dynamics behind our door: closed forms, and what they refuse.

use approx::assert_relative_eq;
use crawler2d_core::{
    Cancel, ClosedSurface, ClosedTrack, ContactMethod, Ends, Engine, Error, ForceSupport, Outcome,
    Scenario, Simulation, TorqueSharing, Track, ValidScenario, Wheel, balance,
};

use crate::common::*;
use crate::energy::{follow, scale};
use crate::slopes;

/// On a line of three, without a belly: what rapier holds.
fn on_wheels() -> Scenario {
    let mut scenario = engineer_on(line(3));
    scenario.robot.belly = None;
    in_rapier(&scenario)
}

/// With its brakes on.
fn braked(angle: f64, friction: f64) -> Scenario {
    let mut scenario = slopes::braked(angle, friction);
    scenario.robot.track = line(3);
    in_rapier(&scenario)
}

#[test]
fn forces_on_level_ground_are_the_weight_and_are_shared_by_levers() {
    let mut scenario = on_wheels();
    scenario.robot.track = line(2);
    scenario.robot.center_of_mass = [0.05, 0.02];
    scenario.drive.speed = 0.0;
    let simulation = after(&scenario, 1.0);
    let rear = simulation.reading().position.x - 0.1825;
    let (_, up, moment) = contact_sums(&simulation, rear, 0.0);
    let weight = scenario.robot.mass * G;
    // The centre of mass is this far in front of the rear axle.
    let arm = moment / up;
    println!("{:.6} of the weight at {arm:.6} m", up / weight);
    assert_relative_eq!(up, weight, max_relative = 1e-3);
    assert_relative_eq!(arm, 0.1825 + 0.05, max_relative = 2e-3);
}

#[test]
fn slip_starts_at_the_friction_angle_in_rapier() {
    for mu in [0.3, 0.9_f64] {
        let expected = libm::atan(mu);
        for (share, holds) in [(0.99, true), (1.01, false)] {
            let mut simulation = after(&braked(share * expected, mu), 0.2);
            let start = simulation.reading().position;
            advance(&mut simulation, 1.0);
            let slid = (simulation.reading().position - start).length();
            println!("mu {mu}, {share} of the friction angle: slides by {slid:.2e} m");
            assert_eq!(slid < 1e-3, holds);
        }
    }
}

#[test]
fn sliding_robot_accelerates_like_a_block_in_rapier() {
    for (angle, mu) in [(0.3, 0.1), (0.6, 0.0_f64)] {
        let scenario = braked(angle, mu);
        let [a, b] = [0.2, 1.2].map(|time| after(&scenario, time).reading().velocity.length());
        let (s, c) = libm::sincos(angle);
        let expected = G * (s - mu * c);
        println!(
            "{angle} rad, mu {mu}: {:.6} m/s2, closed form {expected:.6}",
            b - a
        );
        assert_relative_eq!(b - a, expected, max_relative = 2e-3);
    }
}

/// The force of a motor at a wall that the robot cannot climb is its limit.
#[test]
fn one_motor_for_all_wheels_keeps_its_limit_in_rapier() {
    let placed = hybrid(Wheel::Round);
    let tracks = [line(3), placed, line(9), circumferential(24, Wheel::Round)];
    for track in tracks.into_iter().take(few_or_many(2, 4) as usize) {
        let mut scenario = on_wheels();
        scenario.robot.track = track;
        scenario.robot.drivetrain.max_torque = 3.0;
        scenario.terrain = step(0.3, 0.9);
        let simulation = after(&scenario, 2.0);
        let limit = 2.0 * 3.0 / 0.052;
        println!("{:.9} of the limit", simulation.drive_force() / limit);
        assert_relative_eq!(simulation.drive_force(), limit, max_relative = 0.01);
        assert!(simulation.drive_speed(0).abs() < 1e-3);
    }
}

#[test]
fn unpowered_robots_gain_no_energy_in_rapier() {
    for track in [line(3), line_of(3, paper_gear()), hybrid(Wheel::Round)] {
        let mut scenario = on_wheels();
        scenario.robot.track = track;
        scenario.robot.drivetrain.max_torque = 0.0;
        scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
        scenario.terrain = slope(0.3, 0.6);
        scenario.start.angle = 0.3;
        let account = follow(&scenario, 1.0);
        let gained = account.gained / scale(&scenario, &account);
        println!("gains {gained:.1e}");
        // Gaps that close when it comes down are pushed out: 10 um of the weight.
        assert!(gained < 1e-3);
    }
}

#[test]
fn stops_of_both_engines_are_equilibria_of_one_friction() {
    let mut scenario = engineer_on(line(3));
    scenario.robot.drivetrain.max_torque = 60.0;
    scenario.terrain = step(0.11, 0.9);
    let highest = [scenario.clone(), in_rapier(&scenario)].map(|scenario| {
        let run = summary(&scenario);
        let stop = run.diagnosis.expect("it stops");
        let found = balance(&checked(&scenario), stop.time, &Cancel::default());
        let found = found.expect("it runs").expect("it has stopped");
        println!("{}: {found:?}", run.outcome);
        assert!(found.holds() && found.pulls.is_empty());
        found.holds_between.expect("it holds")[1]
    });
    assert_relative_eq!(highest[0], highest[1], max_relative = 0.02);
}

#[test]
fn the_same_scenario_gives_the_same_bits_in_rapier() {
    let mut scenario = on_wheels();
    scenario.robot.track = line_of(3, paper_gear());
    scenario.terrain = step(0.08, 0.9);
    let [one, other] = [(); 2].map(|()| after(&scenario, 1.0).reading());
    assert_eq!(one.position.x.to_bits(), other.position.x.to_bits());
    assert_eq!(one.chassis_angle.to_bits(), other.chassis_angle.to_bits());
}

#[test]
fn a_force_along_the_chassis_drives_on_skids_and_on_wheels_in_rapier() {
    for support in [ForceSupport::Skids, ForceSupport::Wheels] {
        let mut scenario = engineer_on(force());
        if let Track::Force(track) = &mut scenario.robot.track {
            (track.support, track.skid_friction) = (support, 0.1);
        }
        scenario.robot.drivetrain.max_acceleration = 1.0;
        scenario.terrain = slope(0.0, 0.9);
        let simulation = after(&in_rapier(&scenario), 1.0);
        let (speed, force) = (simulation.reading().velocity.x, simulation.drive_force());
        let drag = match support {
            ForceSupport::Skids => 0.1 * scenario.robot.mass * G,
            ForceSupport::Wheels => 0.0,
        };
        println!("{speed} m/s by {force} N against {drag} N");
        assert_relative_eq!(speed, 0.4, max_relative = 0.01);
        assert!((force - drag).abs() < 0.01 * scenario.robot.mass * G);
    }
}

/// The path of the field that is refused.
fn refused(scenario: &Scenario) -> String {
    match ValidScenario::new(scenario) {
        Err(Error::Scenario(error)) => error.path,
        other => panic!("it is refused, not {:?}", other.map(|_| ())),
    }
}

#[test]
fn what_rapier_cannot_hold_is_refused_by_field() {
    let closed = Track::Closed(ClosedTrack {
        of: Box::new(line(3)),
        surface: ClosedSurface::Own,
    });
    for track in [belt(), grouser_belt(), segmental(None), closed] {
        let mut scenario = on_wheels();
        scenario.robot.track = track;
        assert_eq!(refused(&scenario), "robot.track.kind");
    }
    let arms = in_rapier(&with_flippers(Ends::Both, line(3)));
    assert_eq!(refused(&arms), "robot.flippers");
}

#[test]
fn settings_of_our_own_dynamics_are_refused_in_rapier() {
    type Change = fn(&mut Scenario);
    let changes: [(&str, Change); 7] = [
        ("accuracy", |s| {
            (s.solver.accuracy, s.solver.time_step) = (Some(1e-6), None);
        }),
        ("contact", |s| s.solver.contact = ContactMethod::Reference),
        ("iterations", |s| s.solver.iterations = Some(10)),
        ("contact_frequency", |s| s.solver.contact_frequency = 500.0),
        ("contact_damping_ratio", |s| {
            s.solver.contact_damping_ratio = 4.0;
        }),
        ("max_push_speed", |s| s.solver.max_push_speed = 1.0),
        ("prediction_distance", |s| {
            s.solver.prediction_distance = 1e-3;
        }),
    ];
    for (name, change) in changes {
        let mut scenario = on_wheels();
        change(&mut scenario);
        assert_eq!(refused(&scenario), format!("solver.{name}"));
        scenario.solver.engine = Engine::Own;
        assert!(ValidScenario::new(&scenario).is_ok(), "{name}");
    }
}

#[test]
fn a_simulation_in_rapier_has_no_snapshot() {
    let simulation = Simulation::new(&checked(&on_wheels()));
    let error = simulation.snapshot().expect_err("it is refused");
    assert!(error.to_string().starts_with("solver.engine"), "{error}");
}

/// Two lanes: each side has its own wheels, and bears its share.
#[test]
fn a_robot_on_two_lanes_drives_in_rapier() {
    let mut scenario = on_wheels();
    let lane = |height| Box::new(step(height, 0.9));
    scenario.terrain = crawler2d_core::Terrain::Lanes {
        left: lane(0.02),
        right: lane(0.03),
        middle: None,
    };
    assert_eq!(summary(&scenario).outcome, Outcome::Cleared);
    scenario.drive.speed = 0.0;
    let contacts = after(&scenario, 1.0).contact_table();
    let borne = [1, 2].map(|side| {
        let on_it = (0..contacts.lane.len()).filter(|i| contacts.lane[*i] == side);
        on_it.map(|i| contacts.normal_force[i]).sum::<f64>()
    });
    println!("{borne:?} N");
    let weight = scenario.robot.mass * G;
    assert_relative_eq!(borne[0] + borne[1], weight, max_relative = 1e-6);
    // Which of two wheels on one axle bears how much, statics does not say.
    assert_relative_eq!(borne[0], borne[1], max_relative = 0.01);
}

#[test]
fn wheels_of_unlike_radii_climb_on_one_motor_and_on_a_motor_each_in_rapier() {
    for (sharing, torque) in [(TorqueSharing::Wheel, 60.0), (TorqueSharing::Track, 30.0)] {
        let mut scenario = on_wheels();
        scenario.robot.track = hybrid(Wheel::Round);
        let drive = &mut scenario.robot.drivetrain;
        (drive.torque_sharing, drive.max_torque) = (sharing, torque);
        scenario.terrain = step(0.02, 0.9);
        assert_eq!(summary(&scenario).outcome, Outcome::Cleared);
    }
}

/// Axles hold exactly, so a wheel needs no mass of its own.
#[test]
fn wheels_that_weigh_next_to_nothing_climb_in_rapier() {
    let tracks = [(3.0, line(3)), (24.0, circumferential(24, Wheel::Round))];
    for (wheels, track) in tracks.into_iter().take(few_or_many(1, 2) as usize) {
        let mut scenario = on_wheels();
        scenario.robot.track = track;
        scenario.robot.track_mass = 2e-5 * wheels * scenario.robot.mass;
        scenario.terrain = step(0.05, 0.9);
        let run = summary(&scenario);
        println!(
            "{}, {:.1e} m deep",
            run.outcome, run.metrics.max_penetration
        );
        assert_eq!(run.outcome, Outcome::Cleared);
        assert!(run.metrics.max_penetration < 5e-5);
    }
}
