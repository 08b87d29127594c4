//! The same scenario gives the same bits, wherever and whenever it runs.

use crawler2d_core::{
    Finished, Progress, Record, Run, Scenario, ValidScenario, Wheel, simulate, simulate_many,
};

use crate::common::*;

/// A hash of every number of a run's motion. Its metrics are named, so that one more leaves the hash as it is.
fn motion(run: &Run) -> u64 {
    const OF_MOTION: &str = "time time_to_clear final_x final_y final_angle distance track_distance path_length \
        max_angle min_angle max_penetration drive_work stopped_time time_to_free progress \
        vertical_acceleration angular_velocity intrusion_depth intrusion_root_depth intrusion_force \
        max_track_tension max_pin_gap max_guide_penetration max_sprocket_slip";

    let t = &run.trace;
    let columns = [
        &t.time,
        &t.position,
        &t.velocity,
        &t.chassis_angle,
        &t.drive_speeds,
        &t.drive_forces,
    ];
    let metrics = run.metrics.entries().into_iter();
    let metrics = metrics.filter(|(name, _)| OF_MOTION.split(' ').any(|each| each == *name));
    let numbers = columns.into_iter().flatten().copied();
    hash(numbers.chain(metrics.map(|(_, value)| value)))
}

/// The same of all that is meant to repeat, the table of contacts included.
fn fingerprint(run: &Run) -> u64 {
    let forces = run.contacts.normal_force.iter().copied();
    let metrics = run.metrics.entries().into_iter().map(|(_, value)| value);
    motion(run) ^ hash(forces.chain(metrics))
}

/// FNV-1a over the bit patterns.
fn hash(numbers: impl Iterator<Item = f64>) -> u64 {
    numbers.fold(0xcbf2_9ce4_8422_2325, |hash, x| {
        x.to_bits().to_le_bytes().iter().fold(hash, |h, b| {
            (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3)
        })
    })
}

fn batch() -> Vec<Scenario> {
    let mut draw = Draw(5);
    let tracks = [
        belt(),
        line(3),
        line(5),
        line_of(3, paper_gear()),
        circumferential(24, paper_gear()),
        hybrid(Wheel::Round),
        force_on_wheels(),
        segmental(None),
    ];
    let with_arms = [
        grouser_belt(),
        sprocketed(None),
        belt(),
        line_of(3, paper_gear()),
    ];
    let robots = tracks.map(engineer_on).into_iter();
    let robots = robots.chain(with_arms.map(|track| on_arms(0.5, track)));
    robots
        .cycle()
        .take(16)
        .map(|mut scenario| {
            scenario.drive.gait = Some(climb());
            scenario.terrain = step(draw.between(0.03, 0.12), draw.between(0.5, 1.1));
            scenario.duration = 4.0;
            scenario
        })
        .collect()
}

fn fingerprints(mut results: Vec<Finished>) -> Vec<u64> {
    results.sort_by_key(|(place, _)| *place);
    let runs = results.into_iter().map(|(_, run)| run.expect("finite"));
    runs.map(|run| fingerprint(&run)).collect()
}

#[test]
fn threads_and_order_do_not_change_a_bit() {
    let scenarios: Vec<ValidScenario> = batch().iter().map(checked).collect();
    let go = |scenarios: &[ValidScenario], threads| {
        let mut results = Vec::new();
        let done = simulate_many(scenarios, threads, Record::default(), |finished| {
            results.extend(finished);
            Progress::Continue
        });
        done.expect("it fits in memory");
        fingerprints(results)
    };
    let alone: Vec<u64> = scenarios
        .iter()
        .map(|s| fingerprint(&simulate(s, Record::default()).expect("finite")))
        .collect();
    let threads: &[usize] = if is_soak() { &[1, 2, 3, 8] } else { &[3] };
    for &threads in threads {
        assert_eq!(go(&scenarios, threads), alone);
    }
    let reversed: Vec<ValidScenario> = scenarios.iter().rev().cloned().collect();
    let mut back = go(&reversed, 2);
    back.reverse();
    assert_eq!(back, alone);
}

#[test]
fn hundredth_run_repeats_the_first() {
    let mut scenario = batch()[2].clone();
    scenario.duration = 1.0;
    let first = fingerprint(&run(&scenario));
    for _ in 0..100 {
        assert_eq!(fingerprint(&run(&scenario)), first);
    }
}

#[test]
fn recording_does_not_change_the_run() {
    let scenario = &batch()[1];
    let (full, short) = (run(scenario), summary(scenario));
    assert_eq!(full.metrics, short.metrics);
    assert_eq!(full.outcome, short.outcome);
}

/// Debug and release builds give the same bits: both must find these values.
///
/// They change only together with the physics. A commit that changes one says which and why.
#[test]
fn every_build_finds_the_same_values() {
    let robots = [
        ("line of 5", engineer_on(line(5)), 0xf76b_ced4_1275_adac),
        (
            "line of 3 gear wheels",
            engineer_on(line_of(3, paper_gear())),
            0x7d98_c765_ab4a_8a72,
        ),
        (
            "belt with grousers",
            engineer_on(grouser_belt()),
            0x129b_7897_e594_10fb,
        ),
        ("chain", engineer_on(segmental(None)), 0x8d1e_a32e_33a4_487b),
        (
            "chain on a sprocket",
            engineer_on(sprocketed(None)),
            0x9b4f_bced_0bbf_be70,
        ),
        ("belt, arms", on_arms(0.5, belt()), 0x7857_aa3e_c471_2558),
        (
            "chain, arms",
            on_arms(0.5, segmental(None)),
            0x058e_5a82_bd07_fba4,
        ),
    ];
    let other = robots.into_iter().filter_map(|(name, robot, expected)| {
        let mut scenario = batch()[2].clone();
        scenario.robot = robot.robot;
        scenario.duration = 2.5;
        let found = motion(&run(&scenario));
        (found != expected).then(|| format!("{name}: {found:#018x}"))
    });
    let other: Vec<String> = other.collect();
    assert!(
        other.is_empty(),
        "{other:#?}; if the physics was meant to change, write these values down"
    );
}

#[test]
fn cancelled_batch_keeps_what_is_finished() {
    let scenarios = vec![checked(&batch()[0]); 40];
    let mut results = Vec::new();
    let done = simulate_many(scenarios, 2, Record::summary(), |finished| {
        results.extend(finished);
        if results.len() >= 3 {
            Progress::Stop
        } else {
            Progress::Continue
        }
    });
    done.expect("it fits in memory");
    assert!((3..40).contains(&results.len()), "{}", results.len());
    assert!(results.iter().all(|(_, run)| run.is_ok()));
}
