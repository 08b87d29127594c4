//! Whatever comes in: an error that names the field, or a run with finite numbers.

use std::panic::catch_unwind;

use crawler2d_core::{
    Error, Ground, MAX_POINTS, Profile, Record, Scenario, Simulation, Surface, Terrain,
    ValidScenario, simulate,
};
use serde_json::{Value, json};

use crate::common::*;
use crate::drawn::{drawn, drawn_on_discs};

#[test]
fn drawn_scenarios_run_finite_and_stay_out_of_the_ground() {
    run_finite_and_stay_out(31, few_or_many(20, 2_000), drawn);
}

#[test]
fn drawn_scenarios_on_discs_run_finite_and_stay_out_of_the_ground() {
    run_finite_and_stay_out(32, few_or_many(10, 1_000), drawn_on_discs);
}

fn run_finite_and_stay_out(seed: u64, cases: u32, drawn: fn(&mut Draw) -> Scenario) {
    let mut draw = Draw(seed);
    let mut deepest = 0.0_f64;
    for case in 0..cases {
        let scenario = drawn(&mut draw);
        let run = simulate(&checked(&scenario), Record::default())
            .unwrap_or_else(|e| panic!("seed {seed} case {case}: {e}\n{}", scenario.to_json()));
        for (name, value) in run.metrics.entries() {
            assert!(
                value.is_finite() || name == "time_to_clear",
                "case {case}: {name} = {value}"
            );
        }
        for column in [
            &run.trace.position,
            &run.trace.velocity,
            &run.contacts.normal_force,
        ] {
            assert!(column.iter().all(|x| x.is_finite()), "case {case}");
        }
        // Coulomb's law in every sample, and nothing pulls.
        let ground =
            Ground::new(&scenario.terrain, scenario.robot.gauge).expect("it was built before");
        for i in 0..run.contacts.time.len() {
            let lane = |lane: &&Profile| lane.side as i64 == run.contacts.lane[i];
            let friction = ground
                .lanes
                .iter()
                .find(lane)
                .expect("a lane")
                .friction
                .most()
                .coefficient;
            let (normal, tangent) = (run.contacts.normal_force[i], run.contacts.friction_force[i]);
            assert!(
                normal >= 0.0 && tangent.abs() <= friction * normal * (1.0 + 1e-9) + 1e-9,
                "case {case}"
            );
        }
        assert!(run.warnings.is_empty(), "case {case}: {:?}", run.warnings);
        let depth = run.metrics.max_penetration / scenario.robot.outline.rear_radius();
        deepest = deepest.max(depth);
    }
    println!("seed {seed}: deepest penetration {deepest:.4} of a radius");
    assert!(deepest < 0.05);
}

/// Every place in a JSON tree, as a pointer.
fn places(value: &Value, here: &str, found: &mut Vec<String>) {
    found.push(here.to_owned());
    match value {
        Value::Object(map) => map
            .iter()
            .for_each(|(key, child)| places(child, &format!("{here}/{key}"), found)),
        Value::Array(items) => {
            items
                .iter()
                .enumerate()
                .for_each(|(i, child)| places(child, &format!("{here}/{i}"), found));
        }
        _ => {}
    }
}

#[test]
fn wrong_json_gets_an_error_that_names_the_place_or_runs() {
    let mut scenario = engineer();
    scenario.robot.track = hybrid(paper_gear());
    let base: Value = serde_json::from_str(&scenario.to_json()).unwrap();
    let mut all = Vec::new();
    places(&base, "", &mut all);
    let odd = [
        json!(null),
        json!(true),
        json!("12"),
        json!("NaN"),
        json!("Infinity"),
        json!(-1),
        json!(0),
        json!(-0.0),
        json!(1e308),
        json!(1e-320),
        json!(2.5),
        json!(10_000_000_000_u64),
        json!([]),
        json!({}),
        json!([1, 2, 3]),
    ];
    let (mut errors, mut fine) = (0, 0);
    for place in &all {
        for value in &odd {
            let mut changed = base.clone();
            *changed.pointer_mut(place).unwrap() = value.clone();
            let text = changed.to_string();
            let result = catch_unwind(|| Scenario::from_json(&text).map(|s| s.duration));
            let Ok(result) = result else {
                panic!("panic at {place} = {value}")
            };
            match result {
                Err(e) => {
                    errors += 1;
                    let Error::Scenario(e) = e else {
                        panic!("{place} = {value}: {e}")
                    };
                    let path = place.trim_start_matches('/').replace('/', ".");
                    let root = path.split('.').next().unwrap_or_default();
                    assert!(
                        path.is_empty() || e.path.starts_with(root) || e.rule.contains(root),
                        "{place} = {value}: {e}"
                    );
                }
                Ok(_) => fine += 1,
            }
        }
    }
    println!("{} places: {errors} errors, {fine} accepted", all.len());
    assert!(errors > 5 * fine);
}

#[test]
fn cut_json_is_never_taken_for_a_whole_one() {
    let text = engineer().to_json();
    for end in 0..text.len() {
        assert!(Scenario::from_json(&text[..end]).is_err());
    }
}

#[test]
fn nested_json_is_refused_before_the_stack_runs_out() {
    let text = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(Scenario::from_json(&text).is_err());
}

fn with_points(points: Vec<[f64; 2]>) -> Result<ValidScenario, Error> {
    let mut scenario = engineer();
    scenario.terrain = Terrain::Points {
        points,
        goal: 1.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    ValidScenario::new(&scenario)
}

fn rule(result: Result<ValidScenario, Error>) -> String {
    match result {
        Err(Error::Scenario(e)) => e.to_string(),
        Err(e) => panic!("{e}"),
        Ok(_) => panic!("it was accepted"),
    }
}

#[test]
fn profiles_that_cannot_be_ground_are_refused_by_row() {
    assert!(rule(with_points(vec![])).contains("2 distinct points"));
    assert!(rule(with_points(vec![[0.0, 0.0], [0.0, 0.0]])).contains("2 distinct points"));
    assert!(rule(with_points(vec![[0.0, 0.0], [0.0, 1.0]])).contains("along x"));
    let overhang = rule(with_points(vec![
        [-5.0, 0.0],
        [0.0, 0.0],
        [-0.1, 0.1],
        [5.0, 0.1],
    ]));
    assert!(
        overhang.starts_with("terrain.points[2]") && overhang.contains("overhang"),
        "{overhang}"
    );
    let spike = rule(with_points(vec![
        [-5.0, 0.0],
        [0.0, 0.0],
        [0.0, 1.0],
        [0.0, 0.5],
        [5.0, 0.5],
    ]));
    assert!(
        spike.starts_with("terrain.points[2]") && spike.contains("segments 1 and 2"),
        "{spike}"
    );
    assert!(rule(with_points(vec![[0.0, 0.0], [5.0, 0.0]])).contains("under the whole robot"));
}

#[test]
fn order_duplicates_and_collinear_points_do_not_matter() {
    let clean = vec![[-5.0, 0.0], [0.0, 0.0], [0.0, 0.05], [5.0, 0.05]];
    let mut messy = vec![
        [-5.0, 0.0],
        [-3.0, 0.0],
        [-3.0, 0.0],
        [0.0, 0.0],
        [0.0, 0.02],
        [0.0, 0.05],
        [2.0, 0.05],
        [5.0, 0.05],
    ];
    messy.reverse();
    let profile =
        |s: Result<ValidScenario, Error>| s.map(|s| s.ground().lanes[0].clone()).expect("accepted");
    let (a, b) = (profile(with_points(clean)), profile(with_points(messy)));
    assert_eq!(a.points, b.points);
    assert_eq!((a.merged, b.merged), (0, 4));
}

#[test]
fn hundred_thousand_points_build_and_run() {
    let points: Vec<[f64; 2]> = (-50_000..50_000)
        .map(|i| [1e-3 * f64::from(i), 1e-3 * libm::sin(0.01 * f64::from(i))])
        .collect();
    assert!(points.len() <= MAX_POINTS);
    let mut simulation = Simulation::new(&with_points(points).expect("accepted"));
    advance(&mut simulation, 0.05);
    assert!(simulation.reading().position.x.is_finite());
}

#[test]
fn robot_that_drives_off_the_ground_has_left_the_terrain() {
    let mut scenario = engineer();
    scenario.terrain = Terrain::Points {
        points: vec![[-5.0, 0.0], [0.2, 0.0], [0.3, -0.01], [1.0, -0.01]],
        goal: 1.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    let run = run(&scenario);
    assert_eq!(run.outcome.name(), "left_terrain");
    assert!(run.trace.time.len() > 100);
}

#[test]
fn zero_duration_gives_the_start_alone() {
    let mut scenario = engineer();
    scenario.duration = 0.0;
    let run = run(&scenario);
    assert_eq!(run.trace.time, vec![0.0]);
    assert_eq!(run.metrics.distance, 0.0);
}

#[test]
fn offset_of_the_whole_scene_changes_nothing() {
    let at = |x: f64| {
        let mut scenario = engineer();
        let points = vec![[x - 5.0, 0.0], [x, 0.0], [x, 0.05], [x + 5.0, 0.05]];
        scenario.terrain = Terrain::Points {
            points,
            goal: x,
            surface: Surface::sharp(0.9),
            segment_friction: None,
        };
        scenario.robot.track = line(5);
        scenario.duration = 0.9; // the front wheel is about to meet the edge
        summary(&scenario).metrics.final_x - x
    };
    let here = at(0.0);
    for x in [100.0, 10_000.0] {
        println!("offset {x} m: {:.1e} m", at(x) - here);
        assert!((at(x) - here).abs() < 1e-9);
    }
}
