//! The command, pushes, and how long a robot that stands is simulated.

use super::*;
use crate::scenario::shared_text;

#[test]
#[allow(clippy::float_cmp)] // a sign is exact
fn the_direction_is_that_of_the_command() {
    for (speed, direction) in [(0.4, 1.0), (-0.4, -1.0)] {
        let mut scenario = skids();
        scenario.drive.speed = speed;
        assert_eq!(started(&scenario).direction(), direction);
    }
}

#[test]
fn a_robot_that_stays_is_over_unless_a_push_has_just_risen() {
    let scenario = skids();
    let mut simulation = started(&scenario);
    while !simulation.is_over() {
        assert!(simulation.time() < scenario.duration, "it stands");
        simulation.step().expect("the state stays finite");
    }
    assert!(simulation.ended_as().is_none());
    simulation.raise_push(1.0, 0.1).expect("it is a force");
    assert!(!simulation.is_over(), "it may leave");
}

/// Without friction, 42.4 N give it 42.4 N s in a second, and half as much while they rise. Its track of 2.4 kg moves
/// with its 21.2 kg, but not in the other engine, where the track is only a force.
#[test]
fn a_push_moves_a_robot_in_either_engine() {
    for (engine, mass) in [(Engine::Own, 21.2 + 2.4), (Engine::Rapier, 21.2)] {
        let mut scenario = skids();
        scenario.solver.engine = engine;
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(1e-3));
        if let Track::Force(track) = &mut scenario.robot.track {
            track.skid_friction = 0.0;
        }
        scenario.start.approach = 1.0;
        let mut simulation = started(&scenario);
        run_until(&mut simulation, 0.1);
        simulation.raise_push(42.4, 0.2).expect("it is a force");
        for (time, impulse) in [(0.3, 4.24), (0.5, 12.72)] {
            run_until(&mut simulation, time);
            let found = mass * simulation.reading().velocity.x;
            assert!(
                (found - impulse).abs() < 0.005 * impulse,
                "{engine:?}: {found} N s at {time} s"
            );
        }
    }
}

/// Speeds change at 1 s and 2 s, angles of arms at 1.5 s, and a push has risen at 1.2 s.
#[test]
fn a_command_changes_next_at_an_entry_of_a_schedule_or_when_it_is_reached() {
    let text = shared_text("engineer_flippers_step");
    let mut value: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    value["drive"]["schedule"] = serde_json::json!([[1.0, 0.2], [2.0, 0.1]]);
    value["drive"]["gait"] = serde_json::json!({
        "kind": "hold", "angle": 0.8, "schedule": [[1.5, 0.7]], "front": null, "rear": null,
    });
    let checked = ValidScenario::from_json(&value.to_string()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let command = checked.scenario().drive.speed;
    let rate = checked.scenario().robot.drivetrain.max_acceleration;
    let next = |simulation: &mut Simulation, time: f64| {
        simulation.time = time;
        simulation.next_change()
    };
    // At rest it takes its ramp; here that is longer than a second.
    simulation.commands.speed = 1.3 * rate;
    for (time, change) in [(0.0, 1.0), (1.0, 1.5), (1.5, 2.0), (2.0, 3.3)] {
        let found = next(&mut simulation, time);
        assert!((found - change).abs() < 1e-12, "{found} s, {change} s");
    }
    simulation.commands.speed = command;
    simulation.set_point = command;
    assert!(next(&mut simulation, 2.5).is_infinite());
    simulation.time = 0.7;
    simulation.raise_push(1.0, 0.5).expect("it is a force");
    for (time, change) in [(0.8, 1.0), (1.1, 1.2), (1.2, 1.5)] {
        let found = next(&mut simulation, time);
        assert!((found - change).abs() < 1e-12, "{found} s, {change} s");
    }
}

/// At a tenth of a millimetre most steps of a robot that drives on the level last 16 ms.
#[test]
fn a_climbing_robot_is_commanded_anew_only_where_its_driver_looks() {
    let mut scenario = shared("engineer_flippers_step");
    scenario.solver.accuracy = Some(1e-4);
    scenario.start.approach = 1.0;
    assert!(matches!(scenario.drive.gait, Some(Gait::Climb(_))));
    let mut simulation = started(&scenario);
    let kinds = |simulation: &Simulation| {
        simulation
            .commands
            .flippers
            .map(|c| std::mem::discriminant(&c))
    };
    let (mut last, mut changes, mut longest) = (kinds(&simulation), 0, 0.0_f64);
    while simulation.time() < 8.0 {
        let began = simulation.time();
        simulation.step().expect("the state stays finite");
        longest = longest.max(simulation.last_step());
        let now = kinds(&simulation);
        if now != last {
            let looks = 100.0 * began;
            assert!((looks - looks.round()).abs() < 1e-6, "{began} s");
            (last, changes) = (now, changes + 1);
        }
    }
    assert!(
        changes > 2 && longest > 0.015,
        "{changes} changes, {longest} s"
    );
}

/// A stop counts from as many windows on as the criteria say, after the push has risen.
#[test]
fn a_push_leaves_a_robot_its_windows_to_get_away() {
    let scenario = skids();
    let mut simulation = started(&scenario);
    while !simulation.is_over() {
        simulation.step().expect("the state stays finite");
    }
    let now = simulation.time();
    simulation.raise_push(1.0, 0.5).expect("it is a force");
    let windows = f64::from(scenario.criteria.stationary_windows);
    let end = now + 0.5 + windows * simulation.stop_window();
    for (time, is_over) in [(now, false), (end - 1e-6, false), (end + 1e-6, true)] {
        simulation.time = time;
        assert_eq!(simulation.is_over(), is_over, "{time} s");
    }
}
