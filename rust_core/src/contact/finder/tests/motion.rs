//! Parts that move in small steps.

use super::scene::Scene;
use crate::draw::{Draw, cases};
use crate::geometry::Vector;

/// [m] The way out of a deeper overlap may change from step to step.
const SHALLOW: f64 = 5e-5;

#[test]
fn the_smallest_distance_follows_the_motion_without_a_jump() {
    const SEED: u64 = 20_270_117;
    const PREDICTION: f64 = 5e-3;
    const STEPS: usize = 10_000;
    let mut draw = Draw(SEED);
    let (mut judged, mut ended) = (0, 0);
    let count = cases(30, 1000);
    for number in 0..count {
        let mut scene = Scene::random(number, &mut draw);
        scene.approach(1e-3);
        let ahead = if draw.chance(0.5) { 1e-5 } else { -1e-5 };
        let spin = draw.between(-1e-4, 1e-4);
        // The first distance counts as no jump.
        let (mut before, mut bound) = (0.0, f64::INFINITY);
        for step in 0..STEPS {
            let contacts = scene.contacts(PREDICTION);
            let distances = contacts.iter().map(|c| c.distance);
            let now = distances.fold(PREDICTION, f64::min);
            let is_jump = (now - before).abs() > bound + 1e-9;
            assert!(
                !is_jump,
                "{before} to {now} {contacts:?} {}",
                scene.describe()
            );
            judged += 1;
            // Driven into an upright face.
            if now < -SHALLOW {
                ended += 1;
                break;
            }
            // Along the ground, alternating between a gap and an overlap.
            let height = 1e-4 * (0.01 * step as f64).sin() + 0.7e-4;
            let way = Vector::new(ahead, (height - now).clamp(-1e-5, 1e-5));
            scene.turn(spin);
            scene.push(way);
            before = now;
            bound = way.length() + spin.abs() * scene.outline.reach;
        }
    }
    println!("seed {SEED}: {judged} steps, {ended} of {count} ways ended in a wall");
    assert!(judged > count * STEPS / 4);
}
