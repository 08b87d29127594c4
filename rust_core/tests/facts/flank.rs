//! Flanks of grousers against rails: how hard a belt and a chain with the same grousers pull.

use crawler2d_core::{Scenario, Simulation, Surface, Terrain, Track};

use crate::common::*;

/// Rails of 10 mm, 30 mm long, 100 mm apart, on hardly any friction: friction alone would hold 10 N.
fn rails() -> Terrain {
    let mut points = vec![[-5.0, 0.0]];
    for rail in 0..150 {
        let x = -2.0 + 0.1 * f64::from(rail);
        points.extend([[x, 0.0], [x, 0.01], [x + 0.03, 0.01], [x + 0.03, 0.0]]);
    }
    points.push([20.0, 0.0]);
    Terrain::Points {
        points,
        goal: 19.0,
        surface: Surface::sharp(0.05),
        segment_friction: None,
    }
}

/// [N] The pull of a run: a push against the way grows by 15 N/s until the robot has lost 20 mm; the
/// pull is the push where it had come farthest.
fn pull(scenario: &Scenario) -> f64 {
    let mut simulation = Simulation::new(&checked(scenario));
    advance(&mut simulation, 2.0);
    let (mut farthest, mut at, mut push) = (f64::NEG_INFINITY, 0.0, 0.0);
    loop {
        simulation.set_push(-push).expect("a push");
        advance(&mut simulation, 0.02);
        let x = simulation.reading().position.x;
        if x > farthest {
            (farthest, at) = (x, push);
        }
        if x < farthest - 0.02 {
            return at;
        }
        push += 15.0 * 0.02;
        assert!(push < 900.0, "it never gives way");
    }
}

/// [N] Mean and its standard error over starts that differ in approach and phase, the same for all.
fn mean_pull(track: &Track, torque: f64, starts: u32) -> (f64, f64) {
    let mut draw = Draw(5);
    let pulls: Vec<f64> = (0..starts)
        .map(|_| {
            let mut scenario = engineer();
            scenario.robot.track = track.clone();
            scenario.robot.belly = None;
            scenario.robot.drivetrain.max_torque = torque;
            scenario.terrain = rails();
            scenario.drive.speed = 0.1;
            scenario.start.approach = draw.between(0.1, 0.2);
            scenario.start.track_phase = draw.between(0.0, 0.048);
            pull(&scenario)
        })
        .collect();
    let count = f64::from(starts);
    let mean = pulls.iter().sum::<f64>() / count;
    let variance = pulls.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// At 0.1 m/s, where a pull is one of statics. At 0.2 m/s a robot whose motors hold more than its weight
/// rears over the rails, and the belt gives way first: at 0.92 and 0.75 of the chain with 6 and 20 N m.
#[test]
fn on_rails_a_belt_with_grousers_pulls_like_the_chain() {
    let starts = few_or_many(2, 48);
    for torque in [2.0, 4.0, 6.0, 20.0] {
        if ![2.0, 6.0].contains(&torque) && !is_soak() {
            continue;
        }
        let (belt, of_belt) = mean_pull(&grouser_belt(), torque, starts);
        let (chain, of_chain) = mean_pull(&segmental(None), torque, starts);
        let ratio = belt / chain;
        println!(
            "motors {:.1} N: belt {belt:.1} +- {of_belt:.1} N, chain {chain:.1} +- {of_chain:.1} N, \
             ratio {ratio:.3}",
            2.0 * torque / 0.052
        );
        assert!((0.97..1.25).contains(&ratio));
    }
}
