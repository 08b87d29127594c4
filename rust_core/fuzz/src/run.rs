//! See rust_core/src/fuzz/run.rs.

#![no_main]

mod texts;

libfuzzer_sys::fuzz_target!(|data: &[u8]| crawler2d_core::fuzz::run(data));
