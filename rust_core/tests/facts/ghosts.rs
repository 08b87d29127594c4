//! Flat ground is flat however it is cut, and wherever it lies.

use crawler2d_core::{Ground, Profile, Scenario, Simulation, Surface, Terrain};

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
    let profile =
        Profile::new("ground", &points, Surface::sharp(0.9), false).expect("a level profile");
    assert_eq!(profile.points.len(), pieces + 1, "nothing is merged");
    Ground {
        lanes: vec![profile],
        tracks: 1,
        goal: 4.0,
        first_edge: 0.0,
    }
}

/// Positions [m] every 10 ms over so many seconds, and the largest upward speed [m/s] after the start.
fn drive_for(seconds: u32, scenario: &Scenario, ground: Ground) -> (Vec<[f64; 3]>, f64) {
    let mut simulation = Simulation::on_ground(scenario, ground).expect("it fits");
    let (mut path, mut upward) = (Vec::new(), f64::NEG_INFINITY);
    for step in 1..=1000 * seconds {
        advance(&mut simulation, 1e-3);
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

fn drive(scenario: &Scenario, ground: Ground) -> (Vec<[f64; 3]>, f64) {
    drive_for(5, scenario, ground)
}

fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter()
        .zip(b)
        .flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()))
        .fold(0.0, f64::max)
}

/// Robots of [`articulated`] that nothing of strikes the ground run as exactly as belts and wheels.
fn scenarios() -> Vec<(&'static str, Scenario)> {
    let mut scenarios = articulated();
    scenarios.retain(|(name, _)| !strikes(name));
    scenarios.extend([
        ("belt", engineer_on(belt())),
        ("line of 3", engineer_on(line(3))),
        ("line of 9", engineer_on(line(9))),
        (
            "line of 3 gear wheels",
            engineer_on(line_of(3, paper_gear())),
        ),
        (
            "14 gear wheels round the outline",
            engineer_on(circumferential(14, paper_gear())),
        ),
        ("force", engineer_on(force())),
    ]);
    for (_, scenario) in scenarios.iter_mut().filter(|(name, _)| strikes(name)) {
        fixed(scenario, 1e-3);
    }
    scenarios
}

/// The second and the last of some numbers of pieces; with `CRAWLER2D_SOAK` all of them.
fn some_of(all: [usize; 4]) -> impl Iterator<Item = usize> {
    let chosen = move |k: &usize| is_soak() || k % 2 == 1;
    (0..all.len()).filter(chosen).map(move |k| all[k])
}

#[test]
fn pieces_of_flat_ground_leave_no_trace() {
    for (name, scenario) in scenarios() {
        let (whole, upward_on_whole) = drive(&scenario, cut(1, 0.0, &mut Draw(0)));
        for pieces in some_of([3, 101, 1000, 100_000]) {
            let (path, upward) = drive(&scenario, cut(pieces, 0.0, &mut Draw(0)));
            let off = apart(&whole, &path);
            println!("{name}, {pieces} pieces: off {off:.1e} m, upwards {upward:.1e} m/s");
            assert!(off < 1e-6 && upward < upward_on_whole + 1e-6);
        }
    }
}

#[test]
fn vertices_off_by_a_ten_millionth_leave_none_either() {
    let mut draw = Draw(3);
    // Grousers strike the ground: what an impact finds differs by more than the ground does.
    let smooth = |(name, _): &(&str, Scenario)| !strikes(name);
    for (name, scenario) in scenarios().into_iter().filter(smooth) {
        let whole = drive(&scenario, cut(1, 0.0, &mut draw)).0;
        for pieces in some_of([10, 100, 1000, 100_000]) {
            let (path, upward) = drive(&scenario, cut(pieces, 1e-7, &mut draw));
            let off = apart(&whole, &path);
            println!("{name}, {pieces} jittered pieces: off {off:.1e} m, upwards {upward:.1e} m/s");
            assert!(off < 1e-6);
        }
    }
}

#[test]
fn vertices_off_by_a_ten_millionth_are_no_edges_inside_a_track() {
    // Flat ground reaches into the belt round gear wheels, between two grousers, but has no edge there.
    let scenario = engineer_on(line_of(3, paper_gear()));
    for pieces in [1, 100_000] {
        let ground = cut(pieces, if pieces > 1 { 1e-7 } else { 0.0 }, &mut Draw(4));
        let mut simulation = Simulation::on_ground(&scenario, ground).expect("it fits");
        let (mut inside, mut edges) = (0, 0);
        for _ in 0..1000 {
            simulation.step().expect("finite");
            let intrusions = simulation.intrusions();
            inside += intrusions.len();
            edges += intrusions.iter().map(|i| i.edges.len()).sum::<usize>();
        }
        println!("{pieces} pieces: {inside} intrusions with {edges} edges");
        assert!(inside > 0 && edges == 0);
    }
}

#[test]
fn a_shift_by_kilometres_changes_nothing_before_the_edge() {
    let step_at = |x: f64| Terrain::Points {
        points: vec![[x - 5.0, 0.0], [x, 0.0], [x, 0.1], [x + 5.0, 0.1]],
        goal: x,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    for (name, scenario) in scenarios() {
        let path = |x: f64| {
            let mut scenario = scenario.clone();
            scenario.terrain = step_at(x);
            scenario.start.approach = 1.0;
            let mut simulation = Simulation::new(&checked(&scenario));
            let mut path = Vec::new();
            // At 0.2 m/s^2 up to 0.4 m/s, three seconds end 0.2 m before the edge.
            for _ in 0..3000 {
                advance(&mut simulation, 1e-3);
                let r = simulation.reading();
                path.push([r.position.x - x, r.position.y, 0.1825 * r.chassis_angle]);
            }
            path
        };
        let here = path(0.0);
        // Impacts pass differences of rounding on, and rounding is a hundred times as coarse at 10 km as at 100 m.
        for (x, after_impacts) in [(100.0, 1e-6), (1e4, 1e-5)] {
            let off = apart(&here, &path(x));
            println!("{name}, {x} m: off {off:.1e} m");
            assert!(off < if strikes(name) { after_impacts } else { 1e-9 });
        }
    }
}

/// Where grousers and shoes strike the ground, a start that is a nanometre off leads to another path within a
/// second: how the ground is cut, and where it lies, may lead no farther off than that.
#[test]
fn robots_that_strike_the_ground_find_no_more_in_it_than_in_a_nanometre() {
    let mut striking = articulated();
    striking.retain(|(name, _)| strikes(name));
    for (name, mut scenario) in striking {
        let seconds = few_or_many(1, 2);
        let driven = |scenario: &Scenario, ground| drive_for(seconds, scenario, ground);
        let level = |pieces| cut(pieces, 0.0, &mut Draw(0));
        let (whole, upward_on_whole) = driven(&scenario, level(1));
        let approach = scenario.start.approach;
        let (mut spread, mut fastest) = (0.0_f64, upward_on_whole);
        for nanometres in 1..=few_or_many(5, 12) {
            scenario.start.approach = approach + 1e-9 * f64::from(nanometres);
            let (twin, upward) = driven(&scenario, level(1));
            (spread, fastest) = (spread.max(apart(&whole, &twin)), fastest.max(upward));
        }
        scenario.start.approach = approach;
        for pieces in [1000, 101].into_iter().take(few_or_many(1, 2) as usize) {
            let (path, upward) = driven(&scenario, level(pieces));
            let off = apart(&whole, &path);
            println!(
                "{name}, {pieces} pieces: off {off:.1e} m, starts {spread:.1e} m; upwards {upward:.1e} m/s, \
                 starts {fastest:.1e} m/s"
            );
            // Paths part exponentially: starts know how far they lead to a power of ten. Of a dozen of a belt with grousers,
            // three led 7 to 250 times as far as the others.
            assert!(off < 1e-9 + 10.0 * spread && upward < 1e-6 + 1.5 * fastest);
        }
        let mut far = level(1);
        far.lanes[0] = Profile::new(
            "ground",
            &[[95.0, 0.0], [105.0, 0.0]],
            Surface::sharp(0.9),
            false,
        )
        .expect("a level profile");
        far.first_edge = 100.0;
        far.goal = 104.0;
        let (mut path, _) = driven(&scenario, far);
        for point in &mut path {
            point[0] -= 100.0;
        }
        let off = apart(&whole, &path);
        println!("{name}, 100 m on: off {off:.1e} m");
        assert!(off < 1e-9 + 10.0 * spread);
    }
}
