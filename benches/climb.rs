//! Times steps in the middle of a climb, and whole runs, beside the bare engine's loop on the same scene.

use std::hint::black_box;

use crawler2d_benches::{SCENES, Scene};
use crawler2d_core::{Record, Simulation, simulate};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

/// Steps per measurement; a single step is too short for the clock.
const STEPS: u64 = 200;

fn simulation(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(&scene.checked());
    while simulation.time() < scene.in_the_climb() {
        simulation.step().expect("a finite state");
    }
    simulation
}

fn steps(criterion: &mut Criterion) {
    for scene in &SCENES {
        let mut group = criterion.benchmark_group(format!("{}/steps", scene.name));
        group.throughput(Throughput::Elements(STEPS));
        group.bench_function("crawler2d", |bencher| {
            bencher.iter_batched_ref(
                || simulation(scene),
                |s| {
                    (0..STEPS)
                        .try_for_each(|_| s.step())
                        .expect("a finite state");
                },
                BatchSize::LargeInput,
            );
        });
        if scene.engine().is_some() {
            group.bench_function("bare engine", |bencher| {
                bencher.iter_batched_ref(
                    || {
                        let mut engine = scene.engine().expect("a scene of wheels");
                        let dt = scene.scenario().solver.time_step;
                        (0..(scene.in_the_climb() / dt) as u64).for_each(|_| engine.step());
                        engine
                    },
                    |engine| (0..STEPS).for_each(|_| engine.step()),
                    BatchSize::LargeInput,
                );
            });
        }
        group.finish();
    }
}

fn runs(criterion: &mut Criterion) {
    for scene in &SCENES {
        let scenario = scene.scenario();
        let run = simulate(&scene.checked(), Record::default()).expect("a valid scene");
        let steps = (run.metrics.time / scenario.solver.time_step).round() as u64;
        let mut group = criterion.benchmark_group(format!("{}/run", scene.name));
        group.sample_size(10);
        group.throughput(Throughput::Elements(steps));
        group.bench_function("crawler2d", |bencher| {
            bencher.iter(|| simulate(black_box(&scene.checked()), Record::default()));
        });
        group.bench_function("crawler2d, summary", |bencher| {
            bencher.iter(|| simulate(black_box(&scene.checked()), Record::summary()));
        });
        if scene.engine().is_some() {
            group.bench_function("bare engine", |bencher| {
                bencher.iter(|| {
                    let mut engine = scene.engine().expect("a scene of wheels");
                    (0..steps).for_each(|_| engine.step());
                    engine.pose()
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, steps, runs);
criterion_main!(benches);
