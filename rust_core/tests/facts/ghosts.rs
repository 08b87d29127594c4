//! Flat ground is flat however it is cut, and wherever it lies.

use crawler2d_core::{Ground, Profile, Scenario, Simulation, Terrain, Track};

use crate::common::*;

/// Level ground from -5 to 5 m in so many pieces, the inner vertices off by up to `jitter` [m].
fn cut(pieces: usize, jitter: f64, draw: &mut Draw) -> Ground {
    let points: Vec<[f64; 2]> = (0..=pieces)
        .map(|i| {
            let end = i == 0 || i == pieces;
            let x = -5.0 + 10.0 * i as f64 / pieces as f64;
            [
                x,
                if end {
                    0.0
                } else {
                    draw.between(-jitter, jitter)
                },
            ]
        })
        .collect();
    let profile = Profile::new("ground", &points, 0.0, 0.9, false).expect("a level profile");
    assert_eq!(profile.points.len(), pieces + 1, "nothing is merged");
    Ground {
        lanes: vec![profile],
        tracks: 1,
        goal: 4.0,
        first_edge: 0.0,
    }
}

/// Positions [m] every 10 ms over 5 s, and the largest upward speed [m/s] after the start.
fn drive(scenario: &Scenario, ground: Ground) -> (Vec<[f64; 3]>, f64) {
    let mut simulation = Simulation::on_ground(scenario, ground).expect("it fits");
    let (mut path, mut upward) = (Vec::new(), f64::NEG_INFINITY);
    for step in 1..=5000 {
        simulation.step().expect("finite");
        let r = simulation.reading();
        if step > 500 {
            upward = upward.max(r.velocity.y);
        }
        if step % 10 == 0 {
            // An angle counts as the way of the end axles.
            path.push([r.position.x, r.position.y, 0.1825 * r.chassis_angle]);
        }
    }
    (path, upward)
}

fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter()
        .zip(b)
        .flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()))
        .fold(0.0, f64::max)
}

fn scenarios() -> Vec<(&'static str, Scenario)> {
    let with = |track: Track| {
        let mut scenario = engineer();
        scenario.robot.track = track;
        scenario
    };
    vec![
        ("belt", with(belt())),
        ("line of 3", with(line(3))),
        ("line of 9", with(line(9))),
        ("line of 3 gear wheels", with(line_of(3, paper_gear()))),
        (
            "14 gear wheels round the outline",
            with(circumferential(14, paper_gear())),
        ),
        ("force", with(force())),
    ]
}

#[test]
fn pieces_of_flat_ground_leave_no_trace() {
    for (name, scenario) in scenarios() {
        let whole = drive(&scenario, cut(1, 0.0, &mut Draw(0))).0;
        for pieces in [3, 101, 1000, 100_000] {
            let (path, upward) = drive(&scenario, cut(pieces, 0.0, &mut Draw(0)));
            let off = apart(&whole, &path);
            println!("{name}, {pieces} pieces: off {off:.1e} m, upwards {upward:.1e} m/s");
            assert!(off < 1e-6);
        }
    }
}

#[test]
fn vertices_off_by_a_ten_millionth_leave_none_either() {
    let mut draw = Draw(3);
    // Grousers strike the ground: what a blow finds differs by more than the ground does.
    let smooth = |(name, _): &(&str, Scenario)| !name.contains("gear");
    for (name, scenario) in scenarios().into_iter().filter(smooth) {
        let whole = drive(&scenario, cut(1, 0.0, &mut draw)).0;
        for pieces in [10, 100, 1000, 100_000] {
            let (path, upward) = drive(&scenario, cut(pieces, 1e-7, &mut draw));
            let off = apart(&whole, &path);
            println!("{name}, {pieces} jittered pieces: off {off:.1e} m, upwards {upward:.1e} m/s");
            assert!(off < 1e-6);
        }
    }
}

#[test]
fn a_shift_by_a_hundred_metres_changes_nothing_before_the_edge() {
    let step_at = |x: f64| Terrain::Points {
        points: vec![[x - 5.0, 0.0], [x, 0.0], [x, 0.1], [x + 5.0, 0.1]],
        goal: x,
        edge_radius: 0.0,
        friction: 0.9,
    };
    for (name, scenario) in scenarios() {
        let path = |x: f64| {
            let mut scenario = scenario.clone();
            scenario.terrain = step_at(x);
            scenario.start.approach = 1.0;
            let mut simulation = Simulation::new(&scenario).expect("it fits");
            let mut path = Vec::new();
            // At 0.2 m/s^2 up to 0.4 m/s, three seconds end 0.2 m before the edge.
            for _ in 0..3000 {
                simulation.step().expect("finite");
                let r = simulation.reading();
                path.push([r.position.x - x, r.position.y, 0.1825 * r.chassis_angle]);
            }
            path
        };
        let off = apart(&path(0.0), &path(100.0));
        println!("{name}: off {off:.1e} m");
        assert!(off < 1e-9);
    }
}
