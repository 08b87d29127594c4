//! Times a fifth of a second in the middle of a climb next to rapier's dynamics on the same scene, if they can
//! represent the robot: `cargo bench --bench engine`.

use crawler2d_benches::{SCENES, milliseconds};
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};

/// [s] Simulated time of a measurement.
const PIECE: f64 = 0.2;

fn pieces(criterion: &mut Criterion) {
    for scene in &SCENES {
        let Some(in_rapier) = scene.in_rapier() else {
            continue;
        };
        let mut group = criterion.benchmark_group(scene.name);
        group
            .throughput(Throughput::Elements(milliseconds(PIECE)))
            .sample_size(10);
        for (name, checked) in [("crawler2d", scene.checked()), ("rapier", in_rapier)] {
            group.bench_function(name, |bencher| {
                bencher.iter_batched_ref(
                    || scene.climbing(&checked),
                    |simulation| simulation.advance(PIECE).expect("a finite state"),
                    BatchSize::PerIteration,
                );
            });
        }
        group.finish();
    }
}

criterion_group!(benches, pieces);
criterion_main!(benches);
