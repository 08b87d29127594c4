//! Changes for targets that read JSON: one of eight is libFuzzer's own, the others leave a text JSON.

use libfuzzer_sys::{fuzz_mutator, fuzzer_mutate};

fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    let changed = crawler2d_core::fuzz::mutated(&data[..size], seed);
    match changed.filter(|text| seed % 8 != 0 && text.len() <= most) {
        Some(text) => {
            data[..text.len()].copy_from_slice(&text);
            text.len()
        }
        None => fuzzer_mutate(data, size, most),
    }
});
