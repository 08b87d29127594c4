//! A snapshot holds everything that the future depends on.

use crawler2d_core::{Error, Simulation, ValidScenario};

use crate::common::*;
use crate::drawn::drawn;

#[test]
fn simulation_goes_on_from_a_snapshot_with_the_same_bits() {
    let seed = 20_261_121;
    let mut draw = Draw(seed);
    let (mut runs, mut largest) = (0, 0);
    while runs < few_or_many(25, 1000) {
        let Ok(checked) = ValidScenario::new(&drawn(&mut draw)) else {
            continue;
        };
        let mut whole = Simulation::new(&checked);
        runs += 1;
        advance(&mut whole, draw.between(0.0, 1.0));
        if draw.unit() < 0.2 {
            whole.set_push(draw.between(-50.0, 50.0)).unwrap();
            whole.set_speed(0.0).unwrap();
        }
        let snapshot = whole.snapshot().expect("our own dynamics");
        largest = largest.max(snapshot.len());
        let mut copy = Simulation::from_snapshot(&snapshot).expect("it was just made");
        for simulation in [&mut whole, &mut copy] {
            advance(simulation, 0.3);
        }
        // The bytes hold pose, speeds, impulses of the solver and all that the monitor has seen.
        assert!(
            whole.snapshot().expect("our own dynamics")
                == copy.snapshot().expect("our own dynamics"),
            "run {runs}"
        );
        assert_eq!(outcome_now(&whole), outcome_now(&copy));
    }
    println!(
        "seed {seed}: {runs} runs went on with the same bits; largest snapshot {largest} bytes"
    );
}

#[test]
fn damaged_snapshot_is_refused_at_every_byte() {
    let snapshot = after(&engineer(), 0.5)
        .snapshot()
        .expect("our own dynamics");
    let is_refused = |bytes: &[u8]| match Simulation::from_snapshot(bytes) {
        Err(Error::Scenario(e)) => e.path == "snapshot",
        _ => false,
    };
    for length in 0..snapshot.len() {
        assert!(is_refused(&snapshot[..length]), "{length} bytes");
    }
    let mut draw = Draw(7);
    for _ in 0..2000 {
        let mut flipped = snapshot.clone();
        let place = (draw.unit() * flipped.len() as f64) as usize;
        flipped[place] ^= 1 << (draw.unit() * 8.0) as u32;
        assert!(is_refused(&flipped), "byte {place}");
    }
    assert!(is_refused(b"not a snapshot"));
}
