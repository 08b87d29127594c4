//! Two lanes under one chassis: each track meets its own ground, the belly the one between.

use crawler2d_core::{BodyKind, Model, Simulation, Surface, Terrain, Track, Wheel};

use crate::common::*;

fn models() -> Vec<(&'static str, Track)> {
    vec![
        ("belt", belt()),
        ("line of 3", line(3)),
        ("16 all round", circumferential(16, Wheel::Round)),
        ("hybrid", hybrid(Wheel::Round)),
        ("force on skids", force()),
        ("force on wheels", force_on_wheels()),
        ("line of 3 gear wheels", line_of(3, paper_gear())),
        ("belt with grousers", grouser_belt()),
        ("chain", segmental(None)),
        ("chain on a sprocket", sprocketed(None)),
    ]
}

fn lanes(left: Terrain, right: Terrain) -> Terrain {
    Terrain::Lanes {
        left: Box::new(left),
        right: Box::new(right),
        middle: None,
    }
}

/// Level ground at a height.
fn level(height: f64, friction: f64) -> Terrain {
    Terrain::Points {
        points: vec![[-5.0, height], [5.0, height]],
        goal: 4.0,
        surface: Surface::sharp(friction),
        segment_friction: None,
    }
}

/// Normal forces [N] on the left, the right and the belly, and friction on them along x.
fn shares(simulation: &Simulation) -> [[f64; 2]; 3] {
    let table = simulation.contact_table();
    let mut sums = [[0.0; 2]; 3];
    for (i, lane) in table.lane.iter().enumerate() {
        let sum = &mut sums[*lane as usize - 1];
        sum[0] += table.normal_force[i];
        sum[1] += table.friction_force[i] * table.normal_y[i];
    }
    sums
}

#[test]
fn equal_lanes_are_both_tracks_as_one() {
    for (name, track) in models() {
        let (pose, speed) = equal_lanes_off(&engineer_on(track));
        println!("{name}: off {pose:.1e}, speed {speed:.1e} m/s");
        // Coulomb friction leaves open who bears what; where grousers strike, that shows a little.
        let limit = match name {
            "line of 3 gear wheels" | "chain" => 1e-4,
            // Within the play of its teeth, 2 mm, a chain finds its own way from impact to impact.
            "chain on a sprocket" => 1e-3,
            _ => 1e-6,
        };
        assert!(pose < limit);
        // The motors bring a drive back from an impact by 60 m/s^2: if it comes 10 us sooner, that is 0.6 mm/s. The speed of
        // a chain is that of every impact of its shoes.
        let most = if name == "line of 3 gear wheels" {
            1e-3
        } else {
            limit
        };
        assert!(name.starts_with("chain") || speed < most);
    }
}

#[test]
fn two_tracks_have_the_mass_and_the_force_of_both() {
    for (name, track) in models() {
        let mut scenario = engineer();
        scenario.robot.track = track;
        let lumped = Model::new(&scenario.robot).expect("it can be built");
        let ground = equal_lanes(&scenario.terrain);
        let apart = Model::on(&scenario.robot, &ground).expect("it can be built");
        let force = |m: &Model| m.motors as f64 * m.motor.force;
        let mass = |m: &Model| m.total_mass() + m.drive_masses.iter().sum::<f64>();
        assert!((force(&apart) - force(&lumped)).abs() < 1e-9, "{name}");
        assert!((mass(&apart) - mass(&lumped)).abs() < 1e-9, "{name}");
        let belly = |m: &Model| m.parts.iter().filter(|p| p.kind == BodyKind::Belly).count();
        assert_eq!(apart.parts.len() - 1, 2 * (lumped.parts.len() - 1));
        assert_eq!(belly(&apart), 1);
    }
}

#[test]
fn the_higher_lane_bears_all_of_the_weight() {
    let mut scenario = engineer();
    scenario.terrain = lanes(level(0.0, 0.9), level(0.02, 0.9));
    scenario.drive.speed = 0.0;
    let mut simulation = Simulation::new(&checked(&scenario));
    advance(&mut simulation, 1.0);
    let [[left, _], [right, _], [belly, _]] = shares(&simulation);
    let weight = scenario.robot.mass * G;
    assert!(left == 0.0 && belly == 0.0);
    assert!(
        (right - weight).abs() < 1e-3 * weight,
        "{right} of {weight} N"
    );
}

/// On one slope, a lane of ice leaves the other what holds the robot.
#[test]
fn each_lane_has_its_own_friction() {
    let mut scenario = engineer();
    scenario.robot.track = line(3);
    let angle = 0.3_f64;
    scenario.terrain = lanes(slope(angle, 0.0), slope(angle, 0.9));
    scenario.drive.speed = 0.0;
    scenario.start.approach = 0.0;
    scenario.start.angle = angle;
    let mut simulation = Simulation::new(&checked(&scenario));
    advance(&mut simulation, 1.0);
    let table = simulation.contact_table();
    let weight = scenario.robot.mass * G;
    let sum = |lane: i64, column: &[f64]| -> f64 {
        let on_lane = table.lane.iter().zip(column).filter(|(l, _)| **l == lane);
        on_lane.map(|(_, force)| force).sum()
    };
    assert!(sum(1, &table.friction_force).abs() < 1e-9);
    let normal = sum(1, &table.normal_force) + sum(2, &table.normal_force);
    assert!((normal - weight * angle.cos()).abs() < 1e-3 * weight);
    assert!((sum(2, &table.friction_force) - weight * angle.sin()).abs() < 1e-3 * weight);
}

/// With one track on ice the other holds against a push with what its own motor has.
#[test]
fn each_track_has_half_of_the_force() {
    let mut scenario = engineer();
    scenario.robot.drivetrain.max_torque = 1.0;
    scenario.robot.drivetrain.max_acceleration = 1.0;
    let outline = &scenario.robot.outline;
    let force = 1.0 / (outline.rear_radius() - outline.grouser_height);
    for (friction, motors) in [(0.9, 2.0), (0.0, 1.0)] {
        scenario.terrain = lanes(level(0.0, 0.9), level(0.0, friction));
        for (share, forwards) in [(0.95, true), (1.05, false)] {
            let mut simulation = Simulation::new(&checked(&scenario));
            simulation
                .set_push(-share * motors * force)
                .expect("a push");
            advance(&mut simulation, 1.0);
            let speed = simulation.reading().velocity.x;
            assert_eq!(speed > 0.0, forwards, "{speed} m/s at {share} of the force");
        }
    }
}
