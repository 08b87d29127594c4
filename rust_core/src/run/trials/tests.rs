//! Trials of stops whose reason is known.
#![allow(clippy::float_cmp)] // twice a number is exact

use super::*;
use crate::run::{Record, escape_force, simulate};
use crate::scenario::{
    ForceSupport, ForceTrack, LineOfWheels, Scenario, Surface, Terrain, TorqueSharing, Track,
    Wheel, shared,
};

/// The Engineer on a belt, 0.1 m before a step.
pub(in crate::run) fn engineer() -> Scenario {
    shared("engineer_belt_step")
}

/// Round wheels on a line before a step [m].
pub(in crate::run) fn wheels(count: u32, height: f64) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.terrain = Terrain::Step {
        height,
        surface: Surface::sharp(0.9),
    };
    scenario
}

fn barrier(height: f64, thickness: f64) -> Terrain {
    Terrain::Barrier {
        height,
        thickness,
        surface: Surface::sharp(0.9),
    }
}

fn why(scenario: &Scenario, wanted: Wanted) -> Diagnosis {
    let checked = ValidScenario::new(scenario).expect("the scenario is valid");
    let record = Record {
        trials: wanted,
        ..Record::summary()
    };
    let run = simulate(&checked, record).expect("the state stays finite");
    run.diagnosis.expect("it has stopped")
}

#[test]
fn of_a_stop_of_which_nothing_is_wanted_only_the_symptom_is_known() {
    let scenario = wheels(4, 0.08);
    let judged = why(&scenario, Wanted::default());
    let seen = why(&scenario, Wanted::NOTHING);
    assert!(seen.jammed && seen.trials.is_empty() && !judged.trials.is_empty());
    assert_eq!(
        (seen.outcome, judged.outcome),
        (judged.symptom, Outcome::Seized)
    );
    assert_eq!(seen.time.to_bits(), judged.time.to_bits());
}

fn freed(found: &Diagnosis) -> Vec<&str> {
    let freed = found.trials.iter().filter(|trial| trial.freed);
    freed.map(|trial| trial.name).collect()
}

#[test]
fn a_jammed_robot_that_a_closed_track_frees_is_seized_whatever_else_it_does() {
    let mut scenario = wheels(2, 0.0);
    scenario.terrain = barrier(0.06, 0.2);
    let found = why(&scenario, Wanted::default());
    assert!(found.jammed);
    assert_eq!(
        (found.symptom, found.outcome),
        (Outcome::HungUp, Outcome::Seized)
    );
    assert!(freed(&found).contains(&"closed track"));
}

#[test]
fn ground_that_only_the_belly_rests_on_jams_nothing_whatever_lane_the_belly_has() {
    let mut scenario = wheels(2, 0.0);
    for terrain in [
        barrier(0.065, 0.05),
        Terrain::Lanes {
            left: Box::new(barrier(0.065, 0.05)),
            right: Box::new(barrier(0.065 - 1e-7, 0.05)),
            middle: None,
        },
    ] {
        scenario.terrain = terrain;
        let found = why(&scenario, Wanted::default());
        assert!(!found.jammed && found.intrusion.is_none());
        assert_eq!(found.outcome, Outcome::HungUp);
        assert_eq!(freed(&found), ["closed track", "no belly"]);
    }
}

#[test]
fn a_robot_that_tips_over_after_it_got_away_is_not_freed() {
    // With twice the friction it climbs the wall until it falls over backwards.
    let mut scenario = wheels(5, 0.3);
    scenario.terrain.scale_friction(0.5 / 0.9);
    let found = why(&scenario, Wanted::of([Change::TwiceTheFriction]));
    let Some(tried) = found.trials.iter().find(|t| t.name == "friction x 2") else {
        unreachable!("it was asked for");
    };
    assert_eq!(tried.outcome, Outcome::TippedOver);
    assert!(tried.distance > scenario.criteria.escape_distance);
    assert!(!tried.freed && tried.time.is_infinite());
}

#[test]
fn a_belt_from_the_start_is_tried_where_the_run_can_begin_anew() {
    let checked = ValidScenario::new(&wheels(4, 0.075)).expect("the scenario is valid");
    let names = |simulation: &mut Simulation| -> Vec<&str> {
        simulation.advance(10.0).expect("the state stays finite");
        let found = diagnose(simulation, Wanted::default(), &Cancel::default());
        let found = found.expect("trials can be made").expect("it has stopped");
        assert_eq!(found.outcome, Outcome::Seized);
        found.trials.iter().map(|trial| trial.name).collect()
    };
    let mut simulation = Simulation::new(&checked);
    assert!(names(&mut simulation).contains(&"belt, from the start"));
    let mut commanded = Simulation::new(&checked);
    commanded
        .set_speed(0.39)
        .expect("the speed is within limits");
    assert!(!names(&mut commanded).contains(&"belt, from the start"));
    let mut restored = Simulation::from_snapshot(&commanded.snapshot().expect("it is finite"))
        .expect("the snapshot is whole");
    assert!(!names(&mut restored).contains(&"belt, from the start"));
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
fn a_stop_that_the_robot_leaves_by_itself_is_transient() {
    // A belt that climbs a step slowly counts as stopped with these criteria, and drives on.
    let mut scenario = engineer();
    scenario.terrain = Terrain::Step {
        height: 0.07,
        surface: Surface::sharp(0.9),
    };
    let criteria = &mut scenario.criteria;
    (
        criteria.stop_window,
        criteria.stop_pitches,
        criteria.stop_progress,
    ) = (0.2, 0.1, 0.9);
    scenario.duration = 1.2;
    let found = why(&scenario, Wanted::of(Change::ALL));
    assert!(found.is_transient());
    assert_eq!(found.outcome, Outcome::TimedOut);
    assert_eq!(freed(&found), ["unchanged"]);
    assert_eq!(
        found.trials.len(),
        1,
        "of a transient stop nothing else is tried"
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
            "belt",
            "belt, from the start",
            "closed track, from the start",
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
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let found = escape_force(&checked, at, &Cancel::default()).expect("the state stays finite");
    let hold = 0.3 * scenario.robot.mass * scenario.gravity;
    assert!(
        found.low < hold && hold < found.high && !found.tips,
        "{found:?}, {hold} N"
    );
    assert!((found.high / found.low - 1.1).abs() < 1e-9);
}

#[test]
fn a_line_of_torques_and_its_curve_have_the_same_trials() {
    let [line, curve] = [false, true].map(|is_curve| {
        let mut scenario = engineer();
        scenario.terrain = Terrain::Step {
            height: 0.1,
            surface: Surface::sharp(0.9),
        };
        let motor = &mut scenario.robot.drivetrain;
        motor.max_torque = 0.7;
        if is_curve {
            motor.torque_curve = Some(vec![[0.0, motor.max_torque], [2.0, 0.0]]);
        } else {
            motor.no_load_speed = Some(2.0);
        }
        let wanted = Wanted::of([Change::TwiceTheTorque, Change::TenTimesTheTorque]);
        let trials = why(&scenario, wanted).trials;
        let of_torque = trials.iter().filter(|trial| trial.name.contains("torque"));
        let ends = of_torque.map(|trial| (trial.name, trial.outcome));
        ends.collect::<Vec<_>>()
    });
    assert_eq!(line.len(), 2);
    assert_eq!(curve, line);
}

/// Wheels that a step of 80 mm stops, after some time.
fn stopped(schedule: Option<Vec<[f64; 2]>>) -> (Scenario, Simulation) {
    let mut scenario = wheels(4, 0.08);
    scenario.drive.schedule = schedule;
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let mut simulation = Simulation::new(&checked);
    simulation.advance(5.0).expect("the state stays finite");
    (scenario, simulation)
}

#[test]
fn a_stop_is_over_with_the_command_that_it_resists() {
    for speed in [0.0, -0.4] {
        let (_, mut robot) = stopped(None);
        assert!(robot.is_stopped());
        robot.set_speed(speed).expect("it is within limits");
        assert!(!robot.is_stopped());
        let found = diagnose(&robot, Wanted::default(), &Cancel::default());
        assert!(found.expect("the state stays finite").is_none());
    }
    let mut scenario = wheels(4, 0.08);
    scenario.drive.schedule = Some(vec![[5.0, 0.0]]);
    scenario.duration = 5.005;
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let run = simulate(&checked, Record::summary()).expect("the state stays finite");
    assert_eq!(run.outcome, Outcome::TimedOut);
}

#[test]
fn what_is_commanded_later_changes_no_verdict() {
    let verdict = |schedule| {
        let (_, robot) = stopped(schedule);
        let found = diagnose(&robot, Wanted::default(), &Cancel::default());
        let found = found
            .expect("the state stays finite")
            .expect("it is stopped");
        let trials = found.trials.into_iter();
        let made: Vec<_> = trials.map(|trial| (trial.name, trial.freed)).collect();
        (found.outcome, made)
    };
    let without = verdict(None);
    assert_eq!(without.0, Outcome::Seized);
    assert_eq!(verdict(Some(vec![[5.01, 0.0]])), without);
    assert_eq!(verdict(Some(vec![[5.2, -0.4]])), without);
}

#[test]
fn the_next_start_is_a_fifth_of_a_stop_window_later() {
    let checked = ValidScenario::new(&engineer()).expect("the scenario is valid");
    let mut robot = Simulation::new(&checked);
    robot.advance(0.05).expect("the state stays finite");
    let next = next_start(&robot, &Cancel::default()).expect("nobody asks it to end");
    let later = next.time() - robot.time();
    assert!(
        (later - 0.2 * robot.stop_window()).abs() < 1e-9,
        "{later} s"
    );
    let cancel = Cancel::default();
    cancel.ask();
    assert!(next_start(&robot, &cancel).is_err());
}

#[test]
fn no_trial_takes_for_ever() {
    let (_, mut robot) = stopped(None);
    // It goes as far as it has to at the speed of the command, and after that stays on its way for as long as it has to.
    let (criteria, speed) = (&robot.scenario().criteria, robot.command().abs());
    let (way, time) = (criteria.escape_distance, criteria.escape_time);
    let after = (pose_duration(&robot) - time) * speed;
    assert!((after - way).abs() < 1e-12 && time > 0.0 && speed < 1.0);
    robot.set_speed(1e-6).expect("it is within limits");
    assert!(pose_duration(&robot) <= LONGEST);
}

#[test]
fn without_gravity_there_is_no_escape_force() {
    let mut scenario = engineer();
    scenario.gravity = 0.0;
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let Err(Error::Scenario(error)) = escape_force(&checked, 1.0, &Cancel::default()) else {
        panic!("it is refused")
    };
    assert_eq!(error.path, "gravity");
}

#[test]
fn variants_of_valid_scenarios_are_valid() {
    let mut scenario = wheels(4, 0.08);
    scenario.robot.track = Track::Force(ForceTrack {
        support: ForceSupport::Skids,
        skid_friction: 60.0,
        wheel_count: 5,
    });
    scenario.terrain = Terrain::Step {
        height: 0.08,
        surface: Surface::sharp(60.0),
    };
    scenario.robot.drivetrain.max_torque = 5e16;
    for change in Change::ALL {
        if let Some(variant) = variant_of(&scenario, change) {
            let read = Scenario::from_json(&variant.to_json());
            assert_eq!(read.expect("it is valid"), variant, "{}", change.name());
        }
    }
}

/// No motor is stronger, and no ground rougher, than a scenario may have them.
#[test]
fn twice_the_torque_and_twice_the_friction_are_twice_as_much_up_to_what_there_may_be() {
    let mut scenario = engineer();
    let drivetrain = &mut scenario.robot.drivetrain;
    drivetrain.torque_curve = Some(vec![[0.0, 6.0], [0.5, 4.0]]);
    drivetrain.max_torque = 6.0;
    drivetrain.scale_torque(2.0);
    assert_eq!(drivetrain.max_torque, 12.0);
    assert_eq!(drivetrain.torque_curve, Some(vec![[0.0, 12.0], [0.5, 8.0]]));
    drivetrain.scale_torque(1e30);
    assert_eq!(drivetrain.max_torque, 1e17);
    let rubs = |terrain: &Terrain| match terrain {
        Terrain::Step { surface, .. } => surface.friction.coefficient,
        other => panic!("{other:?}"),
    };
    let mut ground = wheels(4, 0.05).terrain;
    ground.scale_friction(2.0);
    assert_eq!(rubs(&ground), 1.8);
    ground.scale_friction(1e9);
    assert_eq!(rubs(&ground), 100.0);
}

/// Of a stop without ground inside the track only time is tried; of a jam a belt, too, and the belly only if nothing is jammed.
#[test]
fn only_what_decides_the_verdict_is_tried_unless_more_is_asked_for() {
    let made = |scenario: &Scenario| -> (Outcome, Vec<&str>) {
        let found = why(scenario, Wanted::default());
        assert!(!found.is_transient());
        let names = found.trials.iter().map(|trial| trial.name);
        (found.symptom, names.collect())
    };
    let mut weak = engineer();
    weak.robot.drivetrain.max_torque = 0.7;
    assert_eq!(made(&weak), (Outcome::Stalled, vec!["unchanged"]));
    let of_jam = [
        "unchanged",
        "rebuilt",
        "closed track",
        "closed track, clear of the ground",
        "belt, from the start",
    ];
    assert_eq!(made(&wheels(4, 0.08)).1, of_jam);
    let mut on_a_barrier = wheels(2, 0.0);
    on_a_barrier.terrain = barrier(0.06, 0.2);
    assert_eq!(made(&on_a_barrier), (Outcome::HungUp, of_jam.to_vec()));
    // A belt that stops there, too, leaves it open whether the track comes so far.
    let (_, high) = made(&wheels(4, 0.1));
    assert_eq!(high[..5], of_jam);
    assert_eq!(high[5..], ["closed track, from the start"]);
}

#[test]
fn of_a_stop_that_rattles_two_starts_that_stay_decide_or_four_that_get_away() {
    let (_, stop) = stopped(None);
    let found = stop.examine().expect("it is stopped");
    let cancel = Cancel::default();
    let mut series = TrialSeries::new(&stop, &found, &cancel);
    series.rattles = true;
    let mut counts = |change| {
        let freed = series.frees(change).expect("the state stays finite");
        let made = series.trials.last().expect("it makes sense");
        (freed, made.starts, made.freeing)
    };
    assert_eq!(counts(Change::Rebuilt), (false, 2, 0));
    assert_eq!(counts(Change::ClosedTrack), (true, 4, 4));
    // Of a run that goes on one is enough.
    assert_eq!(counts(Change::Nothing), (false, 1, 0));
}

/// At 0.4 m/s for 0.25 s, on level ground.
#[test]
fn a_trial_ends_after_its_time_wherever_the_robot_is() {
    let (scenario, stop) = stopped(None);
    let found = stop.examine().expect("it is stopped");
    let cancel = Cancel::default();
    let series = TrialSeries::new(&stop, &found, &cancel);
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let mut begin = stop.reading().position;
    begin.x -= 1.0;
    begin.y = 0.064;
    let driving = Simulation::driven_at(&checked, begin, 0.0);
    let made = series.follow(driving, "driving", 0.25);
    let made = made.expect("the state stays finite");
    assert!((made.duration - 0.25).abs() < 1e-15);
    let way = made.pose[0] - begin.x;
    assert!(way > 0.01 && way < 0.4 * 0.25 + 1e-3, "{way} m");
}
