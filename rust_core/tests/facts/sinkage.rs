//! How deep robots are in the ground, over terrains and models: no deeper than the softness of contacts explains.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use crawler2d_core::{
    FieldPattern, Friction, Run, Scenario, Stepfield, Surface, Terrain, ValidScenario,
};

use crate::common::*;
use crate::drawn::drawn;

const FRICTION: f64 = 0.9;

fn half_round(radius: f64, friction: f64) -> Terrain {
    let friction = Friction::dry(friction);
    Terrain::HalfRound { radius, friction }
}

fn points(points: &[[f64; 2]], edge_radius: f64) -> Terrain {
    Terrain::Points {
        points: points.to_vec(),
        goal: points[points.len() - 2][0],
        surface: Surface::rounded(edge_radius, FRICTION),
        segment_friction: None,
    }
}

fn barrier(height: f64, thickness: f64, edge_radius: f64) -> Terrain {
    Terrain::Barrier {
        height,
        thickness,
        surface: Surface::rounded(edge_radius, FRICTION),
    }
}

/// Terrains of every kind, of obstacles of a size [m], whose arcs leave a share of the face that they would take up.
fn rounded(size: f64, share: f64) -> Vec<(&'static str, Terrain)> {
    let radius = size * (1.0 - share);
    let kinds = [
        blocks(size, radius),
        slopes(size, radius),
        two_lanes(size, share),
    ];
    kinds.concat()
}

fn blocks(size: f64, radius: f64) -> Vec<(&'static str, Terrain)> {
    let friction = FRICTION;
    vec![
        ("step", step_of(size, radius)),
        (
            "step down",
            points(&[[-5.0, size], [0.0, size], [0.0, 0.0], [8.0, 0.0]], radius),
        ),
        ("barrier", barrier(size, 0.3, radius)),
        ("barrier of two arcs", barrier(size, 2.0 * size, radius)),
        ("bar", barrier(size, 0.5 * size, 0.25 * radius)),
        ("half round", half_round(radius, friction)),
        (
            "gap",
            Terrain::Gap {
                width: 0.15,
                depth: size,
                surface: Surface::rounded(radius, friction),
            },
        ),
        (
            "stairs without risers",
            Terrain::Stairs {
                count: 3,
                rise: size,
                run: 0.25,
                surface: Surface::rounded(radius, friction),
            },
        ),
        (
            "stairs without treads",
            Terrain::Stairs {
                count: 3,
                rise: size,
                run: 0.8 * size,
                surface: Surface::rounded(0.8 * radius, friction),
            },
        ),
    ]
}

fn slopes(size: f64, radius: f64) -> Vec<(&'static str, Terrain)> {
    let friction = FRICTION;
    // The arc of a corner that turns by 45 or 90 degrees takes up a slope of 45 degrees.
    let of_slope = |turn: f64| radius * 2.0_f64.sqrt() / (0.5 * turn).tan();
    let saw: Vec<[f64; 2]> = (0..300)
        .map(|i| [1e-3 * f64::from(i), 1e-3 * f64::from(i % 2)])
        .collect();
    let on_slopes = [
        [-5.0, -0.5],
        [0.0, 0.0],
        [0.0, size],
        [0.3, size],
        [0.3, 0.0],
        [5.0, -0.5],
    ];
    vec![
        (
            "ramp",
            Terrain::Ramp {
                angle: FRAC_PI_4,
                length: size,
                surface: Surface::rounded(of_slope(FRAC_PI_4), friction),
            },
        ),
        (
            "ridge",
            Terrain::Ridge {
                height: size,
                edge_angle: FRAC_PI_2,
                surface: Surface::rounded(of_slope(FRAC_PI_2), friction),
            },
        ),
        (
            "notch",
            points(
                &[
                    [-5.0, 0.0],
                    [0.0, 0.0],
                    [size, -size],
                    [2.0 * size, 0.0],
                    [5.0, 0.0],
                ],
                of_slope(FRAC_PI_4),
            ),
        ),
        ("block on slopes", points(&on_slopes, radius)),
        ("saw", {
            let run_out = [[[-5.0, 0.0]].to_vec(), saw, [[5.0, 0.0]].to_vec()].concat();
            points(&run_out, 1e-3 * 2.0_f64.sqrt() * radius / size)
        }),
    ]
}

fn two_lanes(size: f64, share: f64) -> Vec<(&'static str, Terrain)> {
    let (friction, radius) = (FRICTION, size * (1.0 - share));
    vec![
        (
            "field",
            Terrain::RandomStepfield(Stepfield {
                seed: 3,
                pattern: FieldPattern::Hill,
                posts: 6,
                post: 0.12,
                rise: 0.025,
                levels: 3,
                barrier_height: 0.0,
                barrier_thickness: 0.1,
                barrier_yaw: 0.0,
                surface: Surface::rounded(0.025 * (1.0 - share), friction),
            }),
        ),
        (
            "diagonal barrier",
            Terrain::DiagonalBarrier {
                yaw: 0.4,
                height: size,
                thickness: 0.2,
                surface: Surface::rounded(radius, friction),
            },
        ),
        (
            "lanes",
            Terrain::Lanes {
                left: Box::new(half_round(radius, friction)),
                right: Box::new(barrier(size, 0.2, radius)),
                middle: None,
            },
        ),
    ]
}

fn step_of(height: f64, edge_radius: f64) -> Terrain {
    Terrain::Step {
        height,
        surface: Surface::rounded(edge_radius, FRICTION),
    }
}

/// A robot for every model, the same on arms, and one that turns back on the way.
fn models() -> Vec<(&'static str, Scenario)> {
    let mut turning = engineer_on(line_of(3, paper_gear()));
    turning.drive.schedule = Some(vec![[1.2, -0.4], [2.4, 0.4]]);
    let one_body = [
        ("belt", belt()),
        ("line of 3", line(3)),
        ("line of 3 gear wheels", line_of(3, paper_gear())),
        ("line of 5 gear wheels", line_of(5, paper_gear())),
        (
            "24 gear wheels all round",
            circumferential(24, paper_gear()),
        ),
        ("hybrid gear wheels", hybrid(paper_gear())),
        ("force", force()),
        ("force on wheels", force_on_wheels()),
    ];
    let one_body = one_body.map(|(name, track)| (name, engineer_on(track)));
    let turning = [("line of 3 gear wheels, there and back", turning)];
    one_body
        .into_iter()
        .chain(turning)
        .chain(articulated())
        .collect()
}

/// [m] How deep a run was, which nothing warnings.
fn depth(run: &Run, told: &str) -> f64 {
    assert!(run.warnings.is_empty(), "{told}: {:?}", run.warnings);
    run.metrics.max_penetration.max(run.depth)
}

/// The deepest of all; of a chain, whose light shoes give way more, apart.
#[derive(Default)]
struct Deepest([(f64, String); 2]);

impl Deepest {
    fn take(&mut self, scenario: &Scenario, depth: f64, told: String) {
        let deepest = &mut self.0[usize::from(is_on_chain(scenario))];
        if depth > deepest.0 {
            *deepest = (depth, told);
        }
    }

    fn check(&self, runs: usize, most: [f64; 2]) {
        for ((depth, told), most) in self.0.iter().zip(most) {
            println!("of {runs} runs, {told}: {:.4} mm deep", 1e3 * depth);
            assert!(*depth < most, "{told}: {depth}");
        }
    }
}

/// Of every terrain all models, or every twenty-fourth of them.
#[test]
fn no_robot_sinks_in_behind_an_arc_that_takes_up_a_whole_face() {
    let (mut runs, mut deepest) = (0, Deepest::default());
    let sizes: &[f64] = if is_soak() {
        &[0.02, 0.04, 0.06]
    } else {
        &[0.04]
    };
    for size in sizes {
        for (k, share) in [0.0, 1e-13, 1e-9, 1e-6, 1e-3].into_iter().enumerate() {
            for (i, (ground, terrain)) in rounded(*size, share).into_iter().enumerate() {
                for (j, (model, mut scenario)) in models().into_iter().enumerate() {
                    let is_chosen = (i + j).is_multiple_of(24) && k == [0, 0, 3, 0, 2, 4][i % 6];
                    if !is_soak() && !is_chosen {
                        continue;
                    }
                    scenario.terrain = terrain.clone();
                    scenario.drive.speed = 0.4;
                    scenario.duration = 4.0;
                    let told = format!("{model} over {ground} of {size} m less {share:e}");
                    let depth = depth(&summary(&scenario), &told);
                    runs += 1;
                    deepest.take(&scenario, depth, told);
                }
            }
        }
    }
    // At rest the Engineer is 0.3 um deep, on shoes some 0.1 mm.
    deepest.check(runs, [1e-4, 1e-3]);
}

/// Robots from a hand to a metre and a half, of any mass and grousers.
#[test]
fn no_drawn_robot_sinks_in_behind_an_arc_that_takes_up_a_whole_face() {
    const SEED: u64 = 41;
    let mut draw = Draw(SEED);
    let (mut runs, mut deepest) = (0, 0.0_f64);
    for case in 0..few_or_many(15, 2000) {
        let mut scenario = drawn(&mut draw);
        let radius = scenario.robot.outline.rear_radius();
        let share = [0.0, 0.0, 1e-11, 1e-7, 1e-4][(draw.unit() * 5.0) as usize];
        let terrains = rounded(radius * draw.between(0.2, 0.9), share);
        let pick = (draw.unit() * terrains.len() as f64) as usize;
        scenario.terrain = terrains[pick].1.clone();
        scenario.drive.speed = scenario.drive.speed.abs().max(0.2);
        scenario.duration = 4.0;
        // Posts of some centimetres have no room for every radius.
        if ValidScenario::new(&scenario).is_err() {
            continue;
        }
        let told = format!("seed {SEED} case {case}, over {}", terrains[pick].0);
        let depth = depth(&summary(&scenario), &told) / radius;
        runs += 1;
        if depth > deepest {
            deepest = depth;
            println!("{told}: {depth:.4} of a radius");
        }
    }
    println!("of {runs} runs {deepest:.4} of a radius");
    assert!(runs > few_or_many(5, 600), "{runs}");
    assert!(deepest < 0.03);
}
