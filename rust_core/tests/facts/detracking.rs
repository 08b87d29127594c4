//! That no chain leaves its guide or its wheels, whatever ground it runs over.

use crawler2d_core::{ChainReading, Outcome, Scenario, Simulation, Surface, Terrain};

use crate::common::*;
use crate::segmental::{Build, COUNTS, chained, toothed};

/// Where a run takes place, and what a driver does meanwhile.
struct Trial {
    name: &'static str,
    terrain: Terrain,
    /// [m/s] Commands, a second each, again and again.
    commands: Vec<f64>,
}

/// Grounds that are long enough for a minute.
fn trials(seed: u64) -> Vec<Trial> {
    let mut draw = Draw(seed);
    let mut blocks = vec![[0.0, 0.0]];
    for block in 0..20 {
        let height = draw.between(0.0, 0.06);
        blocks.extend([block, block + 1].map(|end| [0.2 * f64::from(end), height]));
    }
    blocks.push([4.0, 0.0]);
    let rising = |height: f64| vec![[0.0, 0.0], [0.0, height]];
    let knife = vec![[0.0, 0.0], [0.0, 0.05], [0.01, 0.05], [0.01, 0.0]];
    let ramp = vec![[0.0, 0.0], [1.0, 35_f64.to_radians().tan()]];
    let trial = |name, corners: Vec<[f64; 2]>, commands: &[f64]| {
        let (first, last) = (corners[0], corners[corners.len() - 1]);
        let ends = [[-10.0, first[1]], [last[0] + 60.0, last[1]]];
        let points = [&ends[..1], &corners, &ends[1..]].concat();
        Trial {
            name,
            terrain: Terrain::Points {
                points,
                goal: last[0] + 59.0,
                surface: Surface::sharp(0.9),
                segment_friction: None,
            },
            commands: commands.to_vec(),
        }
    };
    vec![
        trial("flat", vec![[0.0, 0.0]], &[0.4]),
        trial("step of 50 mm", rising(0.05), &[0.4]),
        trial("step of 80 mm", rising(0.08), &[0.4]),
        trial("step of 100 mm", rising(0.10), &[0.4]),
        trial("knife edge", knife, &[0.4]),
        trial("blocks", blocks, &[0.4]),
        trial("ramp", ramp, &[0.4]),
        trial("drop", vec![[0.0, 0.2], [0.0, 0.0]], &[0.8]),
        trial("reversing", vec![[0.0, 0.0]], &[0.4, -0.4]),
        trial("stop and start", rising(0.05), &[0.4, 0.0]),
    ]
}

/// What a trial came to: the outcome, and the worst of all steps.
fn outcome_of(
    trial: &Trial,
    mut scenario: Scenario,
    draw: &mut Draw,
    duration: f64,
) -> (Outcome, ChainReading) {
    scenario.terrain = trial.terrain.clone();
    scenario.robot.drivetrain.max_torque = 20.0;
    scenario.robot.drivetrain.max_acceleration = 2.0;
    scenario.criteria.tip_over_angle = 3.1;
    scenario.start.approach = draw.between(0.05, 0.15);
    scenario.start.track_phase = draw.between(0.0, 0.05);
    scenario.drive.speed = trial.commands[0];
    scenario.duration = duration;
    let mut simulation = Simulation::new(&checked(&scenario));
    let mut worst = ChainReading::default();
    let mut seconds = 0;
    while simulation.time() < duration {
        if simulation.time() >= f64::from(seconds) {
            let command = trial.commands[seconds as usize % trial.commands.len()];
            simulation.set_speed(command).expect("a speed");
            seconds += 1;
        }
        let next = f64::from(seconds).min(duration);
        simulation.step_until(next).expect("the state stays finite");
        let now = simulation.chain();
        worst.pin_gap = worst.pin_gap.max(now.pin_gap);
        worst.guide_penetration = worst.guide_penetration.max(now.guide_penetration);
        worst.tension = worst.tension.max(now.tension);
        worst.sprocket_slip = worst.sprocket_slip.max(now.sprocket_slip);
        if simulation.is_over() {
            break; // on its back, where no robot drives on
        }
    }
    (outcome_now(&simulation), worst)
}

/// [m] Pins may be off by so much.
fn most_gap(trial: &str) -> f64 {
    match trial {
        "flat" | "reversing" => 2e-4,
        "drop" => 1.5e-3,
        _ => 6e-4,
    }
}

#[test]
fn no_chain_leaves_its_guide() {
    stays_on(chained, 0, 2e-3);
}

/// Nor its wheels; a sprocket's shoes begin up to 2 mm inside of the road wheels next to it.
#[test]
fn no_chain_leaves_its_wheels() {
    stays_on(toothed, 1, 5e-3);
}

/// Every trial with one of the counts in turn, beginning with the one of that place; with `CRAWLER2D_SOAK` with all of
/// them, a hundred starts of each, ten of them for a minute.
fn stays_on(build: Build, first: usize, deepest: f64) {
    let soak = is_soak();
    let starts = u64::from(few_or_many(1, 100));
    let (mut runs, mut draw) = (0, Draw(7));
    for (place, count) in COUNTS.into_iter().enumerate() {
        for seed in 0..trials(0).len() {
            if !soak && (first + seed) % COUNTS.len() != place {
                continue;
            }
            let mut worst = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
            let mut name = "";
            for start in 0..starts {
                let trial = &trials(start)[seed];
                let duration = match (soak, start % 10) {
                    (true, 0) => 60.0,
                    (true, _) => 8.0,
                    (false, _) => 1.2, // on the obstacle
                };
                let (outcome, seen) = outcome_of(trial, build(count), &mut draw, duration);
                name = trial.name;
                runs += 1;
                worst = (
                    worst.0.max(seen.pin_gap),
                    worst.1.max(seen.guide_penetration),
                    worst.2.max(seen.tension),
                    worst.3.max(seen.sprocket_slip),
                );
                assert_ne!(
                    outcome,
                    Outcome::Detracked,
                    "{count} shoes, {name}, start {start}"
                );
                assert!(seen.pin_gap < most_gap(name), "{count}, {name}: {seen:?}");
                assert!(
                    seen.guide_penetration < deepest,
                    "{count}, {name}: {seen:?}"
                );
            }
            println!(
                "{count} shoes, {name}: pins {:.4} mm, under shoes {:.3} mm, tension {:.0} N, slip {:.3} mm",
                1e3 * worst.0,
                1e3 * worst.1,
                worst.2,
                1e3 * worst.3
            );
        }
    }
    println!("{runs} runs, none off");
}
