//! Many scenarios, one world a thread, results in the order given.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use crate::error::Error;
use crate::run::{Run, simulate_until};
use crate::scenario::Scenario;
use crate::trace::Record;

/// Whether a batch goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Go on.
    Continue,
    /// Finish no further run.
    Stop,
}

/// Simulates every scenario on `threads` threads.
///
/// While they run, the calling thread asks `watch(done)` about 50 times a second whether to go on.
/// A run that was not finished is `None`. The results do not depend on the number of threads.
pub fn simulate_many(
    scenarios: &[Scenario],
    threads: usize,
    record: Record,
    mut watch: impl FnMut(usize) -> Progress,
) -> Vec<Option<Result<Run, Error>>> {
    const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

    let (next, done, cancel) = (
        AtomicUsize::new(0),
        AtomicUsize::new(0),
        AtomicBool::new(false),
    );
    let results: Vec<Mutex<Option<Result<Run, Error>>>> =
        scenarios.iter().map(|_| Mutex::new(None)).collect();
    let caller = std::thread::current();
    let work = || {
        while !cancel.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(scenario) = scenarios.get(i) else {
                break;
            };
            let result = simulate_until(scenario, record, &cancel);
            if !matches!(result, Err(Error::Interrupted)) {
                if let Ok(mut slot) = results[i].lock() {
                    *slot = Some(result);
                }
                done.fetch_add(1, Ordering::Release);
            }
        }
        caller.unpark();
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, scenarios.len().max(1)))
            .map(|_| scope.spawn(work))
            .collect();
        while !workers
            .iter()
            .all(std::thread::ScopedJoinHandle::is_finished)
        {
            if watch(done.load(Ordering::Acquire)) == Progress::Stop {
                cancel.store(true, Ordering::Relaxed);
            }
            std::thread::park_timeout(BETWEEN_LOOKS);
        }
    });
    watch(done.load(Ordering::Acquire));
    results
        .into_iter()
        .map(|slot| slot.into_inner().unwrap_or_default())
        .collect()
}
