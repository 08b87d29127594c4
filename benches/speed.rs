//! Times a fifth of a second in the middle of a climb for every track model, and a whole run of a belt. The throughput
//! is in simulated milliseconds per second, because steps differ in length.

use std::hint::black_box;
use std::time::Duration;

use crawler2d_benches::{SCENES, milliseconds};
use crawler2d_core::{Record, simulate};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

/// [s] Simulated time of a measurement.
const PIECE: f64 = 0.2;

fn pieces(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("climb");
    group.throughput(Throughput::Elements(milliseconds(PIECE)));
    for scene in &SCENES {
        let checked = scene.checked();
        let climbing = scene.climbing(&checked);
        group.bench_function(scene.name, |bencher| {
            bencher.iter_batched_ref(
                || climbing.branch(&checked),
                |simulation| simulation.advance(PIECE).expect("a finite state"),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

fn runs(criterion: &mut Criterion) {
    let belt = SCENES
        .iter()
        .find(|scene| scene.name == "engineer_belt_step");
    let checked = belt.expect("it is one of them").checked();
    let run = simulate(&checked, Record::default()).expect("a valid scene");
    let mut group = criterion.benchmark_group("run");
    group.throughput(Throughput::Elements(milliseconds(run.metrics.time)));
    for (name, record) in [
        ("recorded", Record::default()),
        ("summary", Record::summary()),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| simulate(black_box(&checked), record));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .sample_size(30);
    targets = pieces, runs
}
criterion_main!(benches);
