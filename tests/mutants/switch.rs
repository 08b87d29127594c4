//! Which of the faults in this build is on: the one whose number is in the environment.

use std::fs::OpenOptions;
use std::io::Write;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

static ACTIVE: LazyLock<Option<usize>> =
    LazyLock::new(|| std::env::var("CRAWLER2D_FAULT").ok()?.parse().ok());
static TRACE: LazyLock<Option<String>> = LazyLock::new(|| std::env::var("CRAWLER2D_TRACE").ok());
static REACHED: [AtomicBool; 1 << 15] = [const { AtomicBool::new(false) }; 1 << 15];

pub(crate) fn on(fault: usize) -> bool {
    if let Some(file) = TRACE.as_ref() {
        reach(fault, file);
    }
    *ACTIVE == Some(fault)
}

/// Writes the number of a fault that is reached for the first time.
#[cold]
fn reach(fault: usize, file: &str) {
    if !REACHED[fault].swap(true, Relaxed) {
        let file = OpenOptions::new().append(true).create(true).open(file);
        file.unwrap().write_all(format!("{fault}\n").as_bytes()).unwrap();
    }
}
