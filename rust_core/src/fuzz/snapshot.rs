//! Damaged snapshots with a right digest: each is refused, or goes on.

use std::sync::OnceLock;

use sha2::{Digest, Sha256};

use super::TEXTS;
use crate::draw::{Draw, Source};
use crate::{Error, Simulation, ValidScenario};

/// Bytes of a digest.
const DIGEST: usize = 32;
/// What a number becomes.
const NUMBERS: [f64; 12] = [
    0.0,
    -0.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e308,
    -1e308,
    5e-324,
    -1.0,
    1e-9,
    1e6,
    1e9,
];

/// What a snapshot holds, apart from its digest: first bytes, build, text of the scenario and state.
struct Parts {
    magic: Vec<u8>,
    build: String,
    text: Vec<u8>,
    state: Vec<u8>,
}

/// Snapshots of the shared scenarios after a few steps.
fn originals() -> &'static [Parts] {
    static ORIGINALS: OnceLock<Vec<Parts>> = OnceLock::new();
    ORIGINALS.get_or_init(|| TEXTS.iter().map(|text| Parts::of(text)).collect())
}

impl Parts {
    fn of(text: &str) -> Self {
        let scenario = ValidScenario::from_json(text).expect("it is shared");
        let mut simulation = Simulation::new(&scenario);
        for _ in 0..40 {
            simulation.step().expect("the state stays finite");
        }
        let snapshot = simulation.snapshot().expect("our own dynamics");
        let head = 1 + snapshot
            .iter()
            .position(|byte| *byte == b'\n')
            .expect("a line");
        let body = &snapshot[head..snapshot.len() - DIGEST];
        let (build, rest): (String, Vec<u8>) = postcard::from_bytes(body).expect("a payload");
        let (_, state) = postcard::take_from_bytes::<String>(&rest).expect("it begins with a text");
        let (text, state) = rest.split_at(rest.len() - state.len());
        Self {
            magic: snapshot[..head].to_vec(),
            build,
            text: text.to_vec(),
            state: state.to_vec(),
        }
    }

    /// A whole snapshot with another state.
    fn with(&self, state: &[u8]) -> Vec<u8> {
        let rest = [&self.text, state].concat();
        let payload = postcard::to_stdvec(&(&self.build, rest)).expect("plain data");
        let mut snapshot = [&self.magic[..], &payload].concat();
        let digest = Sha256::digest(&snapshot);
        snapshot.extend_from_slice(&digest);
        snapshot
    }
}

/// Damages one of the snapshots as bytes say, and goes on from it.
///
/// # Panics
/// If a rule is broken.
pub fn snapshot(data: &[u8]) {
    let mut draw = Draw(data);
    let original = &originals()[draw.below(TEXTS.len())];
    let mut state = original.state.clone();
    for _ in 0..draw.below(6) {
        damage(&mut state, &mut draw);
    }
    let mut simulation = match Simulation::from_snapshot(&original.with(&state)) {
        Ok(simulation) => simulation,
        Err(Error::Scenario(error)) => {
            assert_eq!(error.path, "snapshot");
            return;
        }
        Err(other) => panic!("{other}"),
    };
    let again = simulation.snapshot().expect("our own dynamics");
    let copy = Simulation::from_snapshot(&again).expect("it was just made");
    assert!(copy.snapshot().expect("our own dynamics") == again);
    for _ in 0..8 {
        match simulation.step() {
            Ok(()) => assert!(simulation.reading().position.is_finite()),
            Err(Error::Simulation(_)) => return,
            Err(other) => panic!("{other}"),
        }
    }
}

/// Changes a byte, a number or a length.
fn damage<S: Source>(state: &mut Vec<u8>, draw: &mut Draw<S>) {
    let at = draw.below(state.len().max(1));
    let byte = draw.below(256) as u8;
    match draw.below(8) {
        0 if at < state.len() => state[at] = byte,
        1 => state.insert(at, byte),
        2 if at < state.len() => drop(state.remove(at)),
        3 => state.truncate(at),
        4 => {
            let end = state.len().min(at + usize::from(byte));
            state.extend_from_within(at..end);
        }
        _ => {
            let number = if byte < 128 {
                NUMBERS[usize::from(byte) % NUMBERS.len()]
            } else {
                draw.between(-2.0, 2.0)
            };
            if let Some(place) = state.get_mut(at..at + 8) {
                place.copy_from_slice(&number.to_le_bytes());
            }
        }
    }
}
