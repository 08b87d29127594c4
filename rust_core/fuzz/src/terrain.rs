//! See rust_core/src/fuzz/terrain.rs.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crawler2d_core::fuzz::terrain(data));
