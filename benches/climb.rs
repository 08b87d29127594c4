//! Times a fifth of a second in the middle of a climb, and whole runs, beside rapier's dynamics on the same
//! scene. The throughput is in simulated milliseconds per second, because steps differ in length.

use std::hint::black_box;

use crawler2d_benches::{SCENES, Scene};
use crawler2d_core::{Record, Simulation, ValidScenario, simulate};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

/// [s] Simulated time of a measurement.
const PIECE: f64 = 0.2;

/// A simulation in the middle of its climb.
fn simulation(scene: &Scene, checked: &ValidScenario) -> Simulation {
    let mut simulation = Simulation::new(checked);
    simulation
        .advance(scene.in_the_climb())
        .expect("a finite state");
    simulation
}

/// The scene by name of what moves the robot.
fn engines(scene: &Scene) -> impl Iterator<Item = (&'static str, ValidScenario)> {
    let rapier = scene.in_rapier().map(|checked| ("rapier", checked));
    std::iter::once(("crawler2d", scene.checked())).chain(rapier)
}

fn simulated(time: f64) -> Throughput {
    Throughput::Elements((1e3 * time).round() as u64)
}

fn pieces(criterion: &mut Criterion) {
    for scene in &SCENES {
        let mut group = criterion.benchmark_group(format!("{}/piece", scene.name));
        group.throughput(simulated(PIECE));
        for (name, checked) in engines(scene) {
            group.bench_function(name, |bencher| {
                bencher.iter_batched_ref(
                    || simulation(scene, &checked),
                    |s| s.advance(PIECE).expect("a finite state"),
                    BatchSize::LargeInput,
                );
            });
        }
        group.finish();
    }
}

fn runs(criterion: &mut Criterion) {
    for scene in &SCENES {
        let run = simulate(&scene.checked(), Record::default()).expect("a valid scene");
        let time = run.metrics.time;
        let mut group = criterion.benchmark_group(format!("{}/run", scene.name));
        group.sample_size(10);
        group.throughput(simulated(time));
        group.bench_function("crawler2d", |bencher| {
            bencher.iter(|| simulate(black_box(&scene.checked()), Record::default()));
        });
        group.bench_function("crawler2d, summary", |bencher| {
            bencher.iter(|| simulate(black_box(&scene.checked()), Record::summary()));
        });
        if let Some(checked) = scene.in_rapier() {
            group.bench_function("rapier", |bencher| {
                bencher.iter(|| simulate(black_box(&checked), Record::default()));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, pieces, runs);
criterion_main!(benches);
