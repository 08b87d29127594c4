//! Trials of stops whose reason is known.

use super::*;
use crate::run::{Record, escape_force, simulate};
use crate::scenario::{
    ForceSupport, ForceTrack, LineOfWheels, Scenario, Terrain, TorqueSharing, Track, Wheel,
};

fn engineer() -> Scenario {
    let text = include_str!("../../../../tests/scenarios/engineer_belt_step.json");
    Scenario::from_json(text).expect("the shared scenario is valid")
}

/// Round wheels on a line before a step [m].
fn wheels(count: u32, height: f64) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.terrain = Terrain::Step {
        height,
        edge_radius: 0.0,
        friction: 0.9,
    };
    scenario
}

fn why(scenario: &Scenario, wanted: Wanted) -> Diagnosis {
    let checked = Checked::new(scenario).expect("the scenario is valid");
    let record = Record {
        trials: wanted,
        ..Record::summary()
    };
    let run = simulate(&checked, record).expect("the state stays finite");
    run.diagnosis.expect("it has stopped")
}

fn freed(found: &Diagnosis) -> Vec<&str> {
    let freed = found.trials.iter().filter(|trial| trial.freed);
    freed.map(|trial| trial.name).collect()
}

#[test]
fn a_jammed_robot_that_a_closed_track_frees_is_seized_whatever_else_it_does() {
    let mut scenario = wheels(2, 0.0);
    scenario.terrain = Terrain::Barrier {
        height: 0.065,
        thickness: 0.05,
        edge_radius: 0.0,
        friction: 0.9,
    };
    let found = why(&scenario, Wanted::default());
    assert!(found.jammed);
    assert_eq!(
        (found.symptom, found.outcome),
        (Outcome::HungUp, Outcome::Seized)
    );
    assert!(freed(&found).contains(&"closed track"));
}

#[test]
fn a_jammed_robot_that_one_motor_for_all_wheels_frees_is_stalled() {
    let mut scenario = wheels(3, 0.0524);
    scenario.robot.drivetrain.max_torque = 5.26;
    scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    let found = why(&scenario, Wanted::default());
    assert!(found.jammed);
    assert!(freed(&found).contains(&"closed track") && freed(&found).contains(&"one motor"));
    assert_eq!(found.outcome, Outcome::Stalled);
}

#[test]
fn a_stop_that_the_robot_leaves_by_itself_is_passing() {
    // A belt that climbs a step slowly counts as stopped with these criteria, and drives on.
    let mut scenario = engineer();
    scenario.terrain = Terrain::Step {
        height: 0.07,
        edge_radius: 0.0,
        friction: 0.9,
    };
    let criteria = &mut scenario.criteria;
    (
        criteria.stop_window,
        criteria.stop_pitches,
        criteria.stop_progress,
    ) = (0.2, 0.1, 0.9);
    scenario.duration = 1.2;
    let found = why(&scenario, Wanted::of(Change::ALL));
    assert!(found.is_passing());
    assert_eq!(found.outcome, Outcome::TimedOut);
    assert_eq!(freed(&found), ["unchanged"]);
    assert_eq!(
        found.trials.len(),
        1,
        "of a passing stop nothing else is tried"
    );
}

#[test]
fn what_makes_no_sense_for_a_robot_is_not_tried() {
    let mut scenario = wheels(4, 0.1);
    scenario.robot.belly = None;
    let found = why(&scenario, Wanted::of(Change::ALL));
    let names: Vec<&str> = found.trials.iter().map(|trial| trial.name).collect();
    assert_eq!(
        names,
        [
            "unchanged",
            "rebuilt",
            "closed track",
            "closed track, clear of the ground",
            "torque x 2",
            "torque x 10",
            "friction x 2"
        ]
    );
}

#[test]
fn between_wheels_that_stand_for_no_track_nothing_is_jammed() {
    let mut scenario = wheels(2, 0.1);
    scenario.robot.belly = None;
    scenario.robot.center_of_mass[0] = -0.03;
    assert!(why(&scenario, Wanted::default()).intrusion.is_some());
    let Track::Line(line) = &mut scenario.robot.track else {
        unreachable!("it is a line");
    };
    line.as_track = false;
    let found = why(&scenario, Wanted::of(Change::ALL));
    assert!(!found.jammed && found.intrusion.is_none());
    assert!(
        found
            .trials
            .iter()
            .all(|trial| !trial.name.starts_with("closed"))
    );
}

#[test]
fn skids_that_nothing_pushes_hold_the_friction_of_their_weight() {
    let mut scenario = engineer();
    scenario.robot.track = Track::Force(ForceTrack {
        support: ForceSupport::Skids,
        skid_friction: 0.3,
        wheel_count: 5,
    });
    scenario.robot.drivetrain.max_torque = 0.0;
    let at = why(&scenario, Wanted::default()).time;
    let checked = Checked::new(&scenario).expect("the scenario is valid");
    let found = escape_force(&checked, at, &Cancel::default()).expect("the state stays finite");
    let hold = 0.3 * scenario.robot.mass * scenario.gravity;
    assert!(
        found.low < hold && hold < found.high && !found.tips,
        "{found:?}, {hold} N"
    );
    assert!((found.high / found.low - 1.1).abs() < 1e-9);
}
