//! See rust_core/src/fuzz/snapshot.rs.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| crawler2d_core::fuzz::snapshot(data));
