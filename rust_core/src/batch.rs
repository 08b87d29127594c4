//! Many scenarios, one world a thread, results in the order given.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::cancel::Cancel;
use crate::error::{Error, LimitError};
use crate::memory::Budget;
use crate::needs::{self, STACK};
use crate::run::{Run, simulate_within};
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

/// What a run came to; `None` if it was not finished.
type Slot = Option<Result<Run, Error>>;

/// What the threads of a batch share.
struct Work {
    scenarios: Arc<[Scenario]>,
    record: Record,
    budget: Budget,
    next: AtomicUsize,
    done: AtomicUsize,
    cancel: Cancel,
    slots: Vec<Mutex<Slot>>,
}

/// Simulates every scenario on `threads` threads.
///
/// While they run, the calling thread asks `watch(done)` about 50 times a second whether to go on. If not, it
/// returns at once; threads that are within a step, or build something, end soon after. A run that was not
/// finished is `None`. Whatever one run does, a panic included, the others are not affected. The results do
/// not depend on the number of threads.
///
/// # Errors
/// The batch needs more memory than it may have; nothing has been run.
pub fn simulate_many(
    scenarios: impl Into<Arc<[Scenario]>>,
    threads: usize,
    record: Record,
    mut watch: impl FnMut(usize) -> Progress,
) -> Result<Vec<Slot>, LimitError> {
    const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

    let scenarios = scenarios.into();
    let threads = threads.clamp(1, scenarios.len().max(1));
    let budget = needs::of_batch(&scenarios, record, threads)?;
    let work = Arc::new(Work {
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
        cancel: Cancel::default(),
        slots: scenarios.iter().map(|_| Mutex::new(None)).collect(),
        scenarios,
        record,
        budget,
    });
    let workers = start(&work, threads);
    if workers.is_empty() {
        work.run_all();
    }
    while !workers.iter().all(JoinHandle::is_finished) {
        if watch(work.done.load(Ordering::Acquire)) == Progress::Stop {
            work.cancel.ask();
            break;
        }
        std::thread::park_timeout(BETWEEN_LOOKS);
    }
    watch(work.done.load(Ordering::Acquire));
    let taken = work.slots.iter().map(|slot| {
        let slot = slot.lock();
        slot.map_or(None, |mut slot| slot.take())
    });
    Ok(taken.collect())
}

/// As many threads as the system gives; none does no harm, for the calling thread can work, too.
fn start(work: &Arc<Work>, threads: usize) -> Vec<JoinHandle<()>> {
    let caller = std::thread::current();
    let spawn = |_| {
        let (work, caller) = (Arc::clone(work), caller.clone());
        let thread = std::thread::Builder::new().stack_size(STACK);
        thread
            .spawn(move || {
                work.run_all();
                caller.unpark();
            })
            .ok()
    };
    (0..threads).map_while(spawn).collect()
}

impl Work {
    /// Takes one scenario after the other, until none is left.
    fn run_all(&self) {
        while !self.cancel.is_asked() {
            let i = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(scenario) = self.scenarios.get(i) else {
                break;
            };
            let result =
                caught(|| simulate_within(scenario, self.record, (&self.budget, &self.cancel)));
            if !matches!(result, Err(Error::Interrupted)) {
                if let Ok(mut slot) = self.slots[i].lock() {
                    *slot = Some(result);
                }
                self.done.fetch_add(1, Ordering::Release);
            }
        }
    }
}

/// Turns a panic into an error: it is a fault of the program, and takes no more than its own run.
pub fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        let text = text.unwrap_or("unknown panic");
        Err(Error::Internal(format!(
            "the core failed: {text}; please report this with the scenario"
        )))
    })
}
