//! Steps of an accuracy: how long they are, and that what is recorded does not depend on where they end.

use std::collections::HashSet;

use approx::assert_relative_eq;
use crawler2d_core::{
    ForceSupport, ForceTrack, Outcome, Record, Run, Scenario, Simulation, Surface, Terrain, Track,
    simulate,
};

use crate::common::*;

fn sampled(scenario: &Scenario, sample_interval: f64) -> Run {
    let record = Record {
        sample_interval,
        ..Record::default()
    };
    simulate(&checked(scenario), record).expect("the scenario runs")
}

fn with_accuracy(mut scenario: Scenario, accuracy: f64) -> Scenario {
    (scenario.solver.accuracy, scenario.solver.time_step) = (Some(accuracy), None);
    scenario
}

/// Over an edge, where impacts and slips cut steps short.
fn climbing() -> Scenario {
    let mut scenario = engineer_on(line(5));
    scenario.terrain = step(0.06, 0.9);
    scenario.duration = 4.0;
    scenario
}

/// Skids that hit an edge just below the middle of their end press on it with 2.3 kN, which compresses a contact by 2.8 um. As
/// long as it had just closed, it was rigid for a whole step: 1.4 mm at 1.3 s between accuracies of 0.3 um and 0.01 um.
#[test]
fn a_contact_that_has_just_closed_gives_way_as_it_does_later() {
    let mut scenario = engineer_on(Track::Force(ForceTrack {
        support: ForceSupport::Skids,
        skid_friction: 0.0,
        wheel_count: 5,
    }));
    scenario.robot.center_of_mass = [-0.014, 0.03];
    scenario.robot.moment_of_inertia = 0.44;
    scenario.robot.drivetrain.max_torque = 60.0;
    scenario.terrain = step(0.0615, 0.56);
    scenario.drive.speed = 0.26;
    scenario.start.approach = 0.133;
    let place = |accuracy: f64| {
        let simulation = after(&with_accuracy(scenario.clone(), accuracy), 1.3);
        simulation.reading().position
    };
    let off = (place(3e-7) - place(1e-8)).length();
    println!("{off:.1e} m");
    assert!(off < 1e-4);
}

/// The Engineer comes from afar; from 2 s on it drives at its speed.
#[test]
fn steps_grow_on_smooth_ground() {
    for track in [belt(), line(3), line(9)] {
        let mut scenario = engineer_on(track);
        scenario.terrain = slope(0.0, 0.9);
        let mut simulation = after(&scenario, 2.5);
        let before = simulation.steps();
        advance(&mut simulation, 2.0);
        // 16 ms is the longest step.
        let taken = simulation.steps() - before;
        assert!((125..200).contains(&taken), "{taken} steps in 2 s");
    }
}

#[test]
fn a_stop_that_stands_is_waited_for_in_the_longest_steps() {
    let mut scenario = engineer_on(line(3));
    scenario.terrain = step(0.12, 0.9);
    let mut simulation = after(&scenario, 4.0);
    let before = (simulation.steps(), simulation.reading().position);
    advance(&mut simulation, 1.6);
    let taken = simulation.steps() - before.0;
    assert!((simulation.reading().position - before.1).length() < 1e-5);
    assert!(taken < 110, "{taken} steps in 1.6 s");
}

/// The local error bounds no path, but paths come closer to their limits as steps get more accurate. Single ones may
/// fall apart at a late impact: the median of nine counts.
#[test]
fn paths_over_an_edge_converge_with_the_accuracy() {
    let path = |height: f64, accuracy: f64| {
        let mut scenario = climbing();
        scenario.terrain = step(height, 0.9);
        let run = sampled(&with_accuracy(scenario, accuracy), 0.05);
        // Without the last sample: runs end with the step in which they arrive.
        let mut path = run.trace.position;
        path.truncate(path.len() - 2);
        path
    };
    let off = |height: f64| {
        let finest = path(height, 1e-9);
        [1e-5, 1e-6, 1e-7].map(|accuracy| {
            let path = path(height, accuracy);
            let apart = path.iter().zip(&finest).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max)
        })
    };
    let errors: Vec<[f64; 3]> = (0..9).map(|i| off(0.05 + 0.002 * f64::from(i))).collect();
    let median = |k: usize| {
        let mut own: Vec<f64> = errors.iter().map(|errors| errors[k]).collect();
        own.sort_by(f64::total_cmp);
        own[4]
    };
    let medians = [0, 1, 2].map(median);
    println!("off by {medians:?} m");
    // Some tens of micrometres remain: fixed steps of 10 and 20 us are as far from each other.
    assert!(medians[0] < 5e-4 && medians[2] < 5e-5);
    assert!(medians[2] < 0.5 * medians[0], "{medians:?}");
}

/// [m] How deep contacts are at the end of the step in which they begin to bear.
fn depths_at_first(scenario: &Scenario) -> Vec<f64> {
    let mut simulation = Simulation::new(&checked(scenario));
    let (mut known, mut depths) = (HashSet::new(), Vec::new());
    while simulation.time() < scenario.duration {
        simulation.step().expect("finite");
        let table = simulation.contact_table();
        for (number, depth) in table.contact.iter().zip(&table.penetration) {
            if known.insert(*number) {
                depths.push(*depth);
            }
        }
    }
    depths
}

/// A contact that a search misses is found in the ground later. Where an impact falls into one of the shortest steps, half a
/// step of 20 us at 0.4 m/s is 4 um. On three gear wheels that is one contact in some 1,500, almost all of them on steps higher
/// than 75 mm, one in each run.
#[test]
fn contacts_are_found_before_they_are_in_the_ground() {
    let robots = [
        ("line of 3 gear wheels", line_of(3, paper_gear())),
        ("line of 5 gear wheels", line_of(5, paper_gear())),
        ("belt with grousers", grouser_belt()),
        ("line of 5", line(5)),
    ];
    for (name, track) in robots {
        let mut depths: Vec<f64> = Vec::new();
        let heights = few_or_many(12, 25);
        for step_of_heights in 0..heights {
            let height = 0.03 + 0.05 * f64::from(step_of_heights) / f64::from(heights);
            let mut scenario = engineer_on(track.clone());
            scenario.terrain = step(height, 0.9);
            scenario.duration = 5.0;
            depths.extend(depths_at_first(&scenario));
        }
        let count = depths.len();
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        // As deep as an impact of 1 kN drives one in.
        let deep = depths.into_iter().filter(|depth| *depth > 2e-6).count();
        println!(
            "{name}: {count} contacts, at most {deepest:.1e} m deep at first, {deep} above 2 um"
        );
        assert!(count > 100);
        assert!(deep <= 1 + count / 1000 && deepest < 1e-4, "{name}");
    }
}

/// In a long step a grouser may come down so far that nothing of it faces the edge any more.
#[test]
fn a_grouser_that_comes_down_on_a_thin_wall_does_not_pass_into_it() {
    let mut deepest = 0.0_f64;
    for i in 0..23 {
        let mut scenario = engineer_on(grouser_belt());
        scenario.terrain = Terrain::Barrier {
            height: 0.06,
            thickness: 0.01,
            surface: Surface::sharp(0.9),
        };
        // The same grouser comes down on the wall each time.
        scenario.start.approach = 0.05 + 0.001 * f64::from(i);
        scenario.start.track_phase = 0.073 - scenario.start.approach;
        scenario.duration = 1.5;
        let depths = depths_at_first(&scenario);
        deepest = depths.into_iter().fold(deepest, f64::max);
    }
    println!("at most {deepest:.1e} m deep at first");
    assert!(deepest < 2e-6);
}

#[test]
fn samples_move_no_step() {
    let scenario = climbing();
    let summary = simulate(&checked(&scenario), Record::summary()).expect("it runs");
    for interval in [1e-3, 7e-3, 0.01, 0.3] {
        let run = sampled(&scenario, interval);
        assert_eq!(run.metrics, summary.metrics, "every {interval} s");
        assert_eq!(run.outcome, summary.outcome);
    }
}

#[test]
fn samples_lie_at_multiples_of_their_interval_and_at_the_end() {
    let mut scenario = climbing();
    scenario.duration = 1.0005;
    let times = sampled(&scenario, 7e-3).trace.time;
    let (last, regular) = times.split_last().expect("there are samples");
    assert_eq!(*last, 1.0005);
    for (i, time) in regular.iter().enumerate() {
        assert_eq!(*time, i as f64 * 7e-3);
    }
    assert_eq!(regular.len(), 143);
}

/// Two grids have every tenth of a second in common, most of which are within a step.
#[test]
fn a_sample_does_not_depend_on_those_beside_it() {
    let [fine, coarse] = [0.01, 0.1].map(|interval| sampled(&climbing(), interval).trace);
    for (i, time) in coarse.time.iter().enumerate() {
        let twin = fine.time.iter().position(|t| (t - time).abs() < 1e-9);
        let twin = twin.expect("the finer grid has it");
        for axis in 0..2 {
            let [a, b] = [
                coarse.position[2 * i + axis],
                fine.position[2 * twin + axis],
            ];
            // The times differ by rounding.
            assert_relative_eq!(a, b, epsilon = 1e-12);
        }
    }
}

/// Forces are means over the time between two samples, however steps lie: on level ground their normals are all
/// upwards, so weight and inertia show it.
#[test]
fn forces_between_two_samples_give_the_change_of_momentum() {
    let mut scenario = engineer_on(line(3));
    scenario.terrain = slope(0.0, 0.9);
    scenario.duration = 3.0;
    let run = sampled(&scenario, 0.013);
    let (trace, contacts) = (&run.trace, &run.contacts);
    for i in 1..trace.time.len() {
        let dt = trace.time[i] - trace.time[i - 1];
        let of_sample = (0..contacts.time.len()).filter(|k| contacts.time[*k] == trace.time[i]);
        let (mut pull, mut lift) = (0.0, 0.0);
        for k in of_sample {
            pull += contacts.friction_force[k];
            lift += contacts.normal_force[k];
        }
        let gained = trace.velocity[2 * i] - trace.velocity[2 * i - 2];
        let (mass, weight) = (scenario.robot.mass, scenario.robot.mass * G);
        // The chassis frame is not the centre of mass, but the robot hardly turns.
        assert_relative_eq!(pull, mass * gained / dt, epsilon = 1e-3 * weight);
        assert_relative_eq!(lift, weight, max_relative = 2e-3);
    }
}

/// A command that changes in the middle of a step would be noticed too late.
#[test]
fn steps_end_where_the_schedule_has_an_entry() {
    let mut scenario = engineer_on(belt());
    scenario.terrain = slope(0.0, 0.9);
    scenario.drive.schedule = Some(vec![[0.5123, 0.1], [1.9997, 0.0]]);
    let mut simulation = Simulation::new(&checked(&scenario));
    let mut ends = Vec::new();
    while simulation.time() < 2.5 {
        simulation.step().expect("finite");
        ends.push(simulation.time());
    }
    for [time, _] in scenario.drive.schedule.iter().flatten() {
        assert!(ends.contains(time), "no step ends at {time} s");
    }
}

/// The drivetrain brakes at 1 m/s^2; the way is the closed form, whatever steps are taken.
#[test]
fn a_ramp_of_the_set_point_is_exact() {
    for accuracy in [1e-4, 1e-6] {
        let mut scenario = with_accuracy(engineer_on(belt()), accuracy);
        scenario.terrain = slope(0.0, 0.9);
        scenario.robot.drivetrain.max_acceleration = 1.0;
        scenario.drive.speed = 0.4;
        let run = |time: f64| after(&scenario, time).reading().track_position;
        // From rest: 0.4 s and 0.08 m of acceleration, then 0.4 m/s.
        assert_relative_eq!(run(0.4), 0.08, epsilon = 1e-6);
        assert_relative_eq!(run(1.4), 0.48, epsilon = 1e-6);
    }
}

#[test]
fn steps_of_a_given_length_end_at_its_multiples() {
    let mut scenario = engineer_on(line(3));
    scenario.terrain = slope(0.0, 0.9);
    fixed(&mut scenario, 3e-3);
    let mut simulation = Simulation::new(&checked(&scenario));
    for i in 1..=300 {
        simulation.step().expect("finite");
        assert_eq!(simulation.time(), f64::from(i) * 3e-3);
    }
}

/// What an advance asks for is where it ends, and that takes no other path than the accuracy allows.
#[test]
fn an_advance_ends_at_its_time() {
    let scenario = climbing();
    let mut simulation = Simulation::new(&checked(&scenario));
    for i in 1..=37 {
        advance(&mut simulation, 0.0317);
        assert_relative_eq!(
            simulation.time(),
            f64::from(i) * 0.0317,
            max_relative = 1e-12
        );
    }
    let alone = after(&scenario, simulation.time());
    let apart = (simulation.reading().position - alone.reading().position).length();
    println!("{apart:.1e} m apart");
    assert!(apart < 1e-4);
}

#[test]
fn a_run_ends_with_its_duration() {
    let mut scenario = climbing();
    scenario.duration = 0.7771;
    let run = summary(&scenario);
    assert_eq!((run.metrics.time, run.outcome), (0.7771, Outcome::TimedOut));
}
