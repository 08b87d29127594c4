//! Times a fifth of a second in the middle of a climb, and whole runs, beside the bare engine's loop on the same
//! scene. The throughput is in simulated milliseconds per second, because steps differ in length.

use std::hint::black_box;

use crawler2d_benches::{ENGINE_STEP, SCENES, Scene};
use crawler2d_core::{Record, Simulation, simulate};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

/// [s] Simulated time of a measurement.
const PIECE: f64 = 0.2;

fn simulation(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(&scene.checked());
    simulation
        .advance(scene.in_the_climb())
        .expect("a finite state");
    simulation
}

/// Steps of the bare engine in a simulated time [s].
fn engine_steps(time: f64) -> u64 {
    (time / ENGINE_STEP).round() as u64
}

fn simulated(time: f64) -> Throughput {
    Throughput::Elements((1e3 * time).round() as u64)
}

fn pieces(criterion: &mut Criterion) {
    for scene in &SCENES {
        let mut group = criterion.benchmark_group(format!("{}/piece", scene.name));
        group.throughput(simulated(PIECE));
        group.bench_function("crawler2d", |bencher| {
            bencher.iter_batched_ref(
                || simulation(scene),
                |s| s.advance(PIECE).expect("a finite state"),
                BatchSize::LargeInput,
            );
        });
        if scene.engine().is_some() {
            group.bench_function("bare engine", |bencher| {
                bencher.iter_batched_ref(
                    || {
                        let mut engine = scene.engine().expect("a scene of wheels");
                        (0..engine_steps(scene.in_the_climb())).for_each(|_| engine.step());
                        engine
                    },
                    |engine| (0..engine_steps(PIECE)).for_each(|_| engine.step()),
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
        if scene.engine().is_some() {
            group.bench_function("bare engine", |bencher| {
                bencher.iter(|| {
                    let mut engine = scene.engine().expect("a scene of wheels");
                    (0..engine_steps(time)).for_each(|_| engine.step());
                    engine.pose()
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, pieces, runs);
criterion_main!(benches);
