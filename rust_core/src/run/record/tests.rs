//! Samples of a run, and the memory reserved for them.

use super::*;
use crate::scenario::{Terrain, Track, shared};

/// The Engineer with a belt on level ground.
fn level() -> Scenario {
    let mut scenario = shared("engineer_belt_step");
    if let Terrain::Step { surface, .. } = scenario.terrain {
        let friction = surface.friction;
        let length = 5.0;
        scenario.terrain = Terrain::Flat { length, friction };
    }
    scenario
}

/// It accelerates at 0.2 m/s^2, for which a friction of 0.9 is ample: only softness and creep remain.
#[test]
fn a_belt_on_level_ground_hardly_slips() {
    let checked = ValidScenario::new(&level()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let budget = Budget::new().expect("there is memory");
    let record = Record {
        sample_interval: 0.1,
        ..Record::default()
    };
    let mut recorder = Recorder::new(&simulation, record, &budget).expect("it fits");
    while simulation.time() < 0.5 {
        simulation.step_until(0.5).expect("the state stays finite");
        recorder.step(&simulation).expect("it fits");
    }
    let (trace, contacts) = recorder.finish(&simulation).expect("it fits");
    assert_eq!(trace.time.len(), 6);
    assert!(trace.slip_ratio[0].abs() < 1e-15, "it stands");
    for (k, slip) in trace.slip_ratio.iter().enumerate().skip(1) {
        let time = 0.1 * k as f64;
        assert!((trace.time[k] - time).abs() < 1e-9);
        let speed = trace.track_speed[k];
        assert!((speed - 0.2 * time).abs() < 2e-3, "{speed} m/s at {time} s");
        let command = trace.commanded_speed[k];
        assert!((command - 0.2 * time).abs() < 1e-9, "{command} m/s");
        assert!(slip.abs() < 0.02, "{slip} at {time} s");
        // The mean over an interval accelerates the robot, and turns its track.
        let force = trace.tractive_effort[k];
        assert!((force - 21.2 * 0.2).abs() < 0.1, "{force} N at {time} s");
        let force = trace.drive_force[k];
        assert!(
            (force - (21.2 + 2.4) * 0.2).abs() < 0.1,
            "{force} N at {time} s"
        );
        let bears: f64 = (contacts.time.iter().zip(&contacts.normal_force))
            .filter(|(at, _)| (**at - time).abs() < 1e-9)
            .map(|(_, force)| force)
            .sum();
        assert!((bears - 21.2 * 9.81).abs() < 0.5, "{bears} N at {time} s");
    }
    // All of the weight presses a contact in by g / (2 pi 1000 Hz)^2 = 0.25 um.
    let deepest = contacts.penetration.iter().copied().fold(0.0, f64::max);
    assert!(deepest > 1e-8 && deepest < 1e-6, "{deepest} m");
}

/// Room doubles from 64 rows on, of samples and of contacts. One of 65 samples is the first with more.
#[test]
fn what_a_run_records_is_taken_from_its_budget() {
    let checked = ValidScenario::new(&level()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let budget = Budget::of(1 << 20);
    let record = Record {
        sample_interval: 1e-3,
        ..Record::default()
    };
    let mut recorder = Recorder::new(&simulation, record, &budget).expect("it fits");
    let columns = recorder.columns;
    let of_samples = |rows: u64| rows * Trace::bytes(columns);
    assert_eq!(budget.taken(), of_samples(64));
    for (time, rows) in [(0.063, 64), (0.064, 128)] {
        while simulation.time() < time {
            simulation.step_until(time).expect("the state stays finite");
            recorder.step(&simulation).expect("it fits");
        }
        let contacts = recorder.contacts.time.len() as u64;
        assert!(contacts > 64, "{contacts}");
        let of_contacts = contacts.next_power_of_two() * ContactTable::bytes(columns);
        assert_eq!(budget.taken(), of_samples(rows) + of_contacts, "{time} s");
    }
    let too_little = Budget::of(of_samples(64) - 1);
    assert!(Recorder::new(&simulation, record, &too_little).is_err());
}

/// It accelerates at 0.2 m/s^2. The samples are those of all multiples of 0.1 s, of the begin and of the end.
#[test]
fn a_record_may_begin_and_end_between_two_samples() {
    let checked = ValidScenario::new(&level()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let advance = |simulation: &mut Simulation, time: f64| {
        let left = time - simulation.time();
        simulation.advance(left).expect("the state stays finite");
    };
    advance(&mut simulation, 0.14);
    let budget = Budget::of(1 << 20);
    let record = Record {
        sample_interval: 0.1,
        ..Record::default()
    };
    let mut recorder = Recorder::new(&simulation, record, &budget).expect("it fits");
    while simulation.time() < 0.33 {
        simulation.step_until(0.33).expect("the state stays finite");
        recorder.step(&simulation).expect("it fits");
    }
    let (trace, contacts) = recorder.finish(&simulation).expect("it fits");
    let expected = [0.14, 0.2, 0.3, 0.33];
    assert_eq!(trace.time.len(), expected.len());
    for (k, time) in expected.into_iter().enumerate() {
        assert!((trace.time[k] - time).abs() < 1e-9, "{:?}", trace.time);
        let (speed, way) = (0.2 * time, 0.1 * time * time);
        assert!((trace.drive_speeds[k] - speed).abs() < 2e-3, "{time} s");
        assert!((trace.drive_positions[k] - way).abs() < 1e-3, "{time} s");
        if k > 0 {
            // Robot and track, however long the interval is.
            let force = trace.drive_force[k];
            assert!(
                (force - (21.2 + 2.4) * 0.2).abs() < 0.1,
                "{force} N at {time} s"
            );
            assert_eq!(trace.drive_forces[k].to_bits(), force.to_bits());
            let bears: f64 = (contacts.time.iter().zip(&contacts.normal_force))
                .filter(|(at, _)| (**at - time).abs() < 1e-9)
                .map(|(_, force)| force)
                .sum();
            assert!((bears - 21.2 * 9.81).abs() < 1.0, "{bears} N at {time} s");
        }
    }
    // What is recorded is kept, and nothing beyond it.
    let columns = Columns::of(simulation.model());
    let rows = contacts.time.len() as u64;
    let kept = 4 * Trace::bytes(columns) + rows * ContactTable::bytes(columns);
    assert_eq!(budget.taken(), kept);
}

/// Arms of 1.55 kg in all are held at 0.8 rad, their middle 0.17 m from the pivot: 1.55 kg x 9.81 m/s^2 x 0.17 m cos
/// 0.8.
#[test]
fn the_torque_that_holds_arms_is_recorded_as_a_mean() {
    let mut scenario = shared("engineer_flippers_step");
    (scenario.drive.gait, scenario.drive.speed) = (None, 0.0);
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let budget = Budget::of(1 << 20);
    let record = Record {
        sample_interval: 0.05,
        ..Record::default()
    };
    let mut recorder = Recorder::new(&simulation, record, &budget).expect("it fits");
    while simulation.time() < 0.2 {
        simulation.step_until(0.2).expect("the state stays finite");
        recorder.step(&simulation).expect("it fits");
    }
    let (trace, _) = recorder.finish(&simulation).expect("it fits");
    assert_eq!(trace.flipper_torques.len(), trace.time.len());
    for (time, torque) in trace.time.iter().zip(&trace.flipper_torques).skip(2) {
        assert!((torque - 1.801).abs() < 0.01, "{torque} N m at {time} s");
    }
    assert!(
        trace
            .flipper_angles
            .iter()
            .all(|angle| (angle - 0.8).abs() < 1e-3)
    );
}

/// In 2.5 s there are three intervals of 1 s, and both ends.
#[test]
fn a_batch_asks_for_all_samples_of_its_runs() {
    let mut scenario = level();
    scenario.duration = 2.5;
    let record = |sample_interval: f64, history: bool| Record {
        sample_interval,
        history,
        ..Record::default()
    };
    assert_eq!(record(1.0, true).samples(&scenario), 3 + 2);
    let runs = vec![ValidScenario::new(&scenario).expect("it is valid"); 2];
    let room = batch_budget(&runs, record(1e-12, false), 1);
    let of_runs = bytes_besides([1000, 1000].into_iter(), 1);
    assert_eq!(room.expect("nothing is recorded").taken(), of_runs);
    let refused = batch_budget(&runs, record(1e-12, true), 1);
    let Err(LimitError::Memory { needed, what, .. }) = refused else {
        panic!("no machine has that much");
    };
    let samples = 2_500_000_000_000 + 2;
    let of_sample = bytes_of_sample(runs[0].model());
    assert_eq!(needed, of_runs + 2 * samples * of_sample);
    assert!(
        what.starts_with("a batch of 2 runs sampled every"),
        "{what}"
    );
}

/// A thread has a stack of 2 MiB, and 600 bytes for each corner of the largest ground; a run gives back 64 KiB, and 128
/// bytes for each corner of its own.
#[test]
fn a_batch_needs_room_for_its_threads_and_for_what_its_runs_give_back() {
    let found = bytes_besides([1000, 3000].into_iter(), 2);
    let threads = 2 * (2_097_152 + 1_800_000);
    let runs = (65_536 + 128_000) + (65_536 + 384_000);
    assert_eq!(found, threads + runs);
    assert_eq!(bytes_besides([].into_iter(), 1), 2_097_152);
}

/// A sample has 14 numbers, 3 for each drive, 3 for each shoe and 2 for the arms at each end, a contact 15; 8 bytes
/// each.
#[test]
fn a_sample_needs_room_for_its_numbers_and_for_contacts_of_half_of_the_parts() {
    let columns = Columns {
        parts: 0,
        drives: 2,
        shoes: 3,
        flippers: 1,
    };
    assert_eq!(Trace::bytes(columns), 8 * (14 + 6 + 9 + 2));
    assert_eq!(ContactTable::bytes(columns), 8 * 15);
    // A belt and a belly: two contacts nevertheless.
    let belt = level();
    let bytes = |robot| bytes_of_sample(&Model::new(robot).expect("it is valid"));
    assert_eq!(bytes(&belt.robot), 8 * (14 + 3) + 2 * 8 * 15);
    let mut chain = shared("engineer_chain_step");
    if let Track::Segmental(track) = &mut chain.robot.track {
        track.shoe_count = Some(40);
    }
    // 40 plates and grousers, the guide and the belly.
    let expected = 8 * (14 + 3 + 3 * 40) + 41 * 8 * 15;
    assert_eq!(bytes(&chain.robot), expected);
}

#[test]
fn a_message_says_how_many_runs_need_the_room_and_what_would_need_less() {
    let run = ValidScenario::new(&level()).expect("it is valid");
    let two = [run.clone(), run];
    let sampled =
        "a run sampled every 0.01 s (a longer sample_interval, or \"summary\", takes less)";
    assert_eq!(described(&two[..1], Record::default()), sampled);
    assert_eq!(described(&two[..1], Record::summary()), "a run");
    assert_eq!(described(&two, Record::summary()), "a batch of 2 runs");
}
