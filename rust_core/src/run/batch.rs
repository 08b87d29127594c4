//! Simulates many scenarios on several threads, with the results in the given order.

use std::mem;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::record::{STACK, batch_budget};
use super::recording::Run;
use super::simulate::simulate_within;
use super::{Record, ValidScenario};
use crate::error::{Error, LimitError, caught};
use crate::limits::Cancel;
use crate::limits::memory::Budget;

/// Whether a batch continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Continue.
    Continue,
    /// Finish no more runs.
    Stop,
}

/// A finished run: its index in the batch, and its result.
pub type Finished = (usize, Result<Run, Error>);

/// Data shared by the threads of a batch.
struct Work {
    scenarios: Arc<[ValidScenario]>,
    record: Record,
    budget: Budget,
    next: AtomicUsize,
    /// Number of threads that have ended.
    ended: AtomicUsize,
    cancel: Cancel,
    /// Runs that have not been handed over.
    finished: Mutex<Vec<Finished>>,
}

/// Simulates every scenario on `threads` threads.
///
/// About 50 times per second, the calling thread passes newly finished runs, often none, to `take`, which says
/// whether to continue. If not, it passes all others that are finished and returns at once; threads that are within a
/// step, or build something, end soon after. Errors in one run, including panics, do not affect the others. The results
/// do not depend on the number of threads, only their order does.
///
/// # Errors
/// The batch needs more memory than it may have; nothing has been run.
pub fn simulate_many(
    scenarios: impl Into<Arc<[ValidScenario]>>,
    threads: usize,
    record: Record,
    mut take: impl FnMut(Vec<Finished>) -> Progress,
) -> Result<(), LimitError> {
    const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

    let scenarios = scenarios.into();
    let threads = threads.clamp(1, scenarios.len().max(1));
    let budget = batch_budget(&scenarios, record, threads)?;
    let work = Arc::new(Work {
        next: AtomicUsize::new(0),
        ended: AtomicUsize::new(0),
        cancel: Cancel::default(),
        finished: Mutex::new(Vec::new()),
        scenarios,
        record,
        budget,
    });
    let started = start(&work, threads);
    if started == 0 {
        work.run_all();
    }
    while work.ended.load(Ordering::Acquire) < started {
        if take(work.hand_over()) == Progress::Stop {
            work.cancel.ask();
            break;
        }
        std::thread::park_timeout(BETWEEN_LOOKS);
    }
    take(work.hand_over());
    Ok(())
}

/// Starts as many threads as the system allows, and returns their number; it may be 0, because the calling thread can
/// work, too.
fn start(work: &Arc<Work>, threads: usize) -> usize {
    let caller = std::thread::current();
    let spawn = |_| {
        let (work, caller) = (Arc::clone(work), caller.clone());
        let thread = std::thread::Builder::new().stack_size(STACK);
        thread
            .spawn(move || {
                work.run_all();
                work.ended.fetch_add(1, Ordering::Release);
                caller.unpark();
            })
            .ok()
    };
    (0..threads).map_while(spawn).count()
}

impl Work {
    /// Simulates one scenario after another until none is left.
    fn run_all(&self) {
        while !self.cancel.is_asked() {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(scenario) = self.scenarios.get(i) else {
                break;
            };
            let result =
                caught(|| simulate_within(scenario, self.record, (&self.budget, &self.cancel)));
            if !matches!(result, Err(Error::Interrupted)) {
                // No thread panics while it holds the lock.
                if let Ok(mut finished) = self.finished.lock() {
                    finished.push((i, result));
                }
            }
        }
    }

    fn hand_over(&self) -> Vec<Finished> {
        let finished = self.finished.lock();
        finished.map_or_else(|_| Vec::new(), |mut finished| mem::take(&mut *finished))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::simulate;
    use crate::run::trials::tests::engineer;

    /// So many runs of this duration [s].
    fn runs(count: usize, duration: f64) -> Vec<ValidScenario> {
        let mut scenario = engineer();
        scenario.duration = duration;
        vec![ValidScenario::new(&scenario).expect("it is valid"); count]
    }

    #[test]
    fn each_run_of_a_batch_is_handed_over_once_however_many_threads_there_are() {
        let scenarios = runs(3, 0.01);
        let alone = simulate(&scenarios[0], Record::summary()).expect("it stays finite");
        for threads in [0, 1, 2, 9] {
            let mut all = Vec::new();
            let done = simulate_many(&scenarios[..], threads, Record::summary(), |finished| {
                all.extend(finished);
                Progress::Continue
            });
            done.expect("there is room");
            all.sort_by_key(|(place, _)| *place);
            assert_eq!(all.len(), 3, "{threads} threads");
            for (place, (number, run)) in all.iter().enumerate() {
                let run = run.as_ref().expect("it stays finite");
                assert!(run.trace.time.is_empty(), "a summary has no history");
                assert_eq!(place, *number);
                assert_eq!(
                    run.metrics.final_x.to_bits(),
                    alone.metrics.final_x.to_bits()
                );
            }
        }
        let done = simulate_many(&scenarios[..0], 2, Record::summary(), |finished| {
            assert!(finished.is_empty());
            Progress::Continue
        });
        assert!(done.is_ok());
    }

    /// Ten seconds take longer than the first look.
    #[test]
    fn a_batch_that_is_stopped_hands_over_only_what_is_finished() {
        let mut looks = 0;
        let done = simulate_many(runs(4, 10.0), 1, Record::summary(), |finished| {
            looks += 1;
            assert!(finished.is_empty());
            Progress::Stop
        });
        done.expect("there is room");
        // One that stops it, and a last one.
        assert_eq!(looks, 2);
    }
}
