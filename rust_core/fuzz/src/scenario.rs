//! See rust_core/src/fuzz/scenario.rs.

#![no_main]

mod texts;

libfuzzer_sys::fuzz_target!(|data: &[u8]| crawler2d_core::fuzz::scenario(data));
