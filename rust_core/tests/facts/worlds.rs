//! Many simulations side by side: each as if it were alone.

use crawler2d_core::{ByHand, Cancel, Error, Simulation, Worlds};

use crate::common::*;

fn at_speed(speed: f64) -> ByHand {
    ByHand {
        speed: Some(speed),
        flippers: [None; 2],
        push: None,
    }
}

#[test]
fn each_world_is_bit_by_bit_what_it_is_alone() {
    let of = |track| checked(&engineer_on(track));
    let scenarios = [belt(), line(4), line_of(3, paper_gear())].map(of);
    for threads in [1, 4] {
        let worlds = Worlds::new(scenarios.to_vec(), &Cancel::default());
        let mut worlds = worlds.expect("there is room");
        worlds.command(&[at_speed(0.3); 3]).expect("it is valid");
        for _ in 0..20 {
            let advanced = worlds.advance(&[0, 1, 2], 0.1, threads, &Cancel::default());
            advanced.expect("nobody interrupts it");
        }
        for (scenario, state) in scenarios.iter().zip(worlds.states()) {
            let mut alone = Simulation::new(scenario);
            alone.command_all(&at_speed(0.3)).expect("it is valid");
            for _ in 0..20 {
                advance(&mut alone, 0.1);
            }
            let own = alone.reading();
            assert_eq!(own.position, state.reading.position);
            let angles = [own.chassis_angle, state.reading.chassis_angle];
            assert_eq!(angles[0].to_bits(), angles[1].to_bits());
        }
    }
}

#[test]
fn an_interrupt_ends_all_threads() {
    let cancel = Cancel::default();
    cancel.ask();
    let worlds = Worlds::new(vec![checked(&engineer()); 8], &Cancel::default());
    let worlds = worlds.expect("there is room");
    let all: Vec<usize> = (0..8).collect();
    let ended = worlds.advance(&all, 1.0, 3, &cancel);
    assert!(matches!(ended, Err(Error::Interrupted)));
    assert!(worlds.states().iter().all(|state| state.reading.time < 1.0));
}
