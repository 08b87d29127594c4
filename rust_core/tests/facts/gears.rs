//! Gear wheels: odometry, phases, ghosts, impacts, and another engine.

use crawler2d_core::{
    Friction, GearWheel, Ground, HybridWheels, Model, Profile, Scenario, Shape, Simulation,
    Surface, Terrain, Track, Wheel,
};

use crate::common::*;

/// Slow, on level ground with friction to spare, without a belly.
pub(crate) fn rolling(track: Track) -> Scenario {
    let mut scenario = slow_and_strong();
    scenario.robot.track = track;
    scenario.terrain = Terrain::Flat {
        length: 5.0,
        friction: Friction::dry(1.5),
    };
    scenario
}

/// Distance of surface and of chassis while the wheels turn `turns` times.
pub(crate) fn travelled(scenario: &Scenario, radius: f64, turns: f64) -> (f64, f64) {
    let mut simulation = after(scenario, 1.0);
    let begin = simulation.reading();
    let way = turns * std::f64::consts::TAU * radius;
    let mut last = begin;
    // Between two steps the place is linear in the way of the surface.
    loop {
        simulation.step().expect("finite");
        let now = simulation.reading();
        let (a, b) = (
            last.track_position - begin.track_position,
            now.track_position - begin.track_position,
        );
        if b >= way {
            let share = (way - a) / (b - a);
            let x = last.position.x + share * (now.position.x - last.position.x);
            return (way, x - begin.position.x);
        }
        last = now;
    }
}

/// By what the odometry of the Engineer on gear wheels reads too much.
pub(crate) fn over_reading(grousers: u32, thickness: f64) -> f64 {
    let (radius, n) = (0.064, f64::from(grousers));
    let tip = 2.0 * (0.5 * thickness / radius).asin();
    let between = std::f64::consts::TAU / n - tip;
    let polygon = n * (thickness + 2.0 * radius * (0.5 * between).sin());
    std::f64::consts::TAU * radius / polygon
}

/// Oracle 9: a wheel with `n` grousers rolls from corner to corner of its outline, a polygon with two
/// corners a grouser; its circumference is less than that of the circumscribed circle.
#[test]
fn odometry_over_reads_by_the_polygon_of_the_tips() {
    for (count, grousers, thickness) in [(2, 7, 0.006), (2, 9, 0.010), (3, 12, 0.004)] {
        let wheel = Wheel::Gear(GearWheel {
            grouser_count: Some(grousers),
            grouser_height: None,
            tip_thickness: Some(thickness),
            base_thickness: None,
            phase_fraction: 0.0,
        });
        let expected = over_reading(grousers, thickness);
        let (surface, chassis) = travelled(&rolling(line_of(count, wheel)), 0.064, 2.0);
        let found = surface / chassis;
        println!(
            "{count} wheels, {grousers} grousers of {thickness} m: odometry reads {found:.5} times the way, \
             closed form {expected:.5}"
        );
        // The wheels start at any corner, and slip a little where the chassis speeds up.
        assert!((found / expected - 1.0).abs() < 1e-3);
    }
}

#[test]
fn round_wheels_do_not_over_read() {
    let (surface, chassis) = travelled(&rolling(line(3)), 0.064, 2.0);
    assert!((surface / chassis - 1.0).abs() < 1e-6);
}

#[test]
fn wheel_n_starts_n_phase_fractions_ahead() {
    let mut robot = engineer().robot;
    robot.track = line_of(5, paper_gear());
    let model = Model::new(&robot).expect("it can be built");
    let mut n = 0.0;
    for part in &model.parts {
        if let Shape::Gear { gear, .. } = &part.shape {
            n += 1.0;
            let expected = n * std::f64::consts::TAU / 7.0 / 3.0;
            assert!((gear.phase - expected).abs() < 1e-15);
        }
    }
    assert!((n - 5.0_f64).abs() < 1e-15);
}

#[test]
fn phases_of_a_third_shake_less_than_wheels_in_step() {
    for count in [3, 4, 5] {
        let shaking = |phase_fraction| {
            let mut scenario = engineer();
            scenario.robot.track = line_of(count, gear(phase_fraction));
            scenario.terrain = Terrain::Flat {
                length: 20.0,
                friction: Friction::dry(0.9),
            };
            scenario.duration = 8.0;
            summary(&scenario).metrics.vertical_acceleration
        };
        let (together, apart) = (shaking(0.0), shaking(1.0 / 3.0));
        println!(
            "{count} gear wheels: {together:.2} m/s^2 in step, {apart:.2} with phases of a third"
        );
        assert!(apart < 0.7 * together);
    }
}

/// Each landing of a grouser passes a difference of rounding on, some ten times larger: in 3 s a tenth of
/// a millimetre after a hundred of them, a millimetre after a thousand. Round wheels keep a micrometre.
#[test]
fn pieces_of_flat_ground_leave_no_trace_under_grousers() {
    let cut = |pieces: usize| {
        let points: Vec<[f64; 2]> = (0..=pieces)
            .map(|i| [-5.0 + 10.0 * i as f64 / pieces as f64, 0.0])
            .collect();
        Ground {
            lanes: vec![
                Profile::new("ground", &points, Surface::sharp(0.9), false).expect("level"),
            ],
            tracks: 1,
            goal: 4.0,
            first_edge: 0.0,
        }
    };
    for (name, track, limit) in [
        ("3 gear", line_of(3, paper_gear()), 1e-4),
        (
            "24 gear round the outline",
            circumferential(24, paper_gear()),
            1e-3,
        ),
        ("belt with grousers", grouser_belt(), 1e-4),
    ] {
        let mut scenario = engineer();
        scenario.robot.track = track;
        let path = |pieces| {
            let mut simulation = Simulation::on_ground(&scenario, cut(pieces)).expect("it fits");
            let mut path = Vec::new();
            for _ in 0..3000 {
                advance(&mut simulation, 1e-3);
                let r = simulation.reading();
                path.push([r.position.x, r.position.y, 0.1825 * r.chassis_angle]);
            }
            path
        };
        let whole = path(1);
        for pieces in [10, 100, 1000] {
            let off = path(pieces)
                .iter()
                .zip(&whole)
                .flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()))
                .fold(0.0, f64::max);
            println!("{name}, {pieces} pieces: off {off:.1e} m");
            assert!(off < limit);
        }
    }
}

#[test]
fn explicit_line_equals_hybrid_wheels_at_the_same_places() {
    let mut scenario = engineer();
    scenario.robot.track = line_of(3, paper_gear());
    let line = summary(&scenario).metrics;
    let placements = vec![
        [-0.1825, 0.0, 0.064],
        [0.0, 0.0, 0.064],
        [0.1825, 0.0, 0.064],
    ];
    scenario.robot.track = Track::Hybrid(HybridWheels {
        placements,
        wheel: paper_gear(),
    });
    assert_eq!(summary(&scenario).metrics, line);
}

#[test]
fn ground_never_sinks_into_a_gear_wheel_by_a_millimetre() {
    let mut deepest: f64 = 0.0;
    for track in [
        line_of(3, paper_gear()),
        line_of(5, paper_gear()),
        hybrid(paper_gear()),
    ] {
        for i in 0..32 {
            let mut scenario = engineer();
            scenario.robot.track = track.clone();
            scenario.terrain = step(0.05 + 0.01 * f64::from(i % 8), 0.9);
            scenario.start.track_phase = 0.0015 * f64::from(i);
            scenario.duration = 6.0;
            deepest = deepest.max(summary(&scenario).metrics.max_penetration);
        }
    }
    println!("{:.3} mm", 1e3 * deepest);
    assert!(deepest < 1e-3);
}
