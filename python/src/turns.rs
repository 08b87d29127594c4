//! A lock for values that Python's threads share. Waiting for it answers Ctrl-C, and a forked process does not wait for
//! threads that exist only in its parent.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{process, thread};

use crawler2d_core::Error;
use pyo3::prelude::*;

use crate::calls;

/// Time between two attempts to take the turn.
const BETWEEN_ATTEMPTS: Duration = Duration::from_micros(100);

/// A value that one thread at a time can use.
pub(crate) struct Turns<T> {
    /// Id of the process whose thread has the turn; 0 if none. A fork copies this number, but has another id.
    holder: AtomicU32,
    /// The number of that thread; 0 if none.
    thread: AtomicU64,
    /// Locked only by the holder.
    value: Mutex<T>,
}

/// Access to the value until this is dropped.
pub(crate) struct Turn<'a, T> {
    value: MutexGuard<'a, T>,
    /// Dropped after the value.
    _end: End<'a>,
}

impl<T> Deref for Turn<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Turn<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

struct End<'a>(&'a AtomicU32, &'a AtomicU64);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.1.store(0, Ordering::Relaxed);
        self.0.store(0, Ordering::Release);
    }
}

impl<T> Turns<T> {
    pub(crate) fn new(value: T) -> Self {
        Self {
            holder: AtomicU32::new(0),
            thread: AtomicU64::new(0),
            value: Mutex::new(value),
        }
    }

    /// Takes the turn, unless another thread has it.
    ///
    /// # Errors
    /// [`Error::Internal`] if it was held, when this process was forked, by a thread that exists only in the parent.
    fn attempt(&self) -> Result<Option<Turn<'_, T>>, Error> {
        let own = process::id();
        let (taken, failed) = (Ordering::Acquire, Ordering::Relaxed);
        match self.holder.compare_exchange(0, own, taken, failed) {
            Ok(_) => {
                self.thread.store(own_thread(), Ordering::Relaxed);
                let end = End(&self.holder, &self.thread);
                let value = self.value.lock().unwrap_or_else(PoisonError::into_inner);
                Ok(Some(Turn { value, _end: end }))
            }
            Err(holder) if holder == own => Ok(None),
            Err(_) => Err(Error::Internal(
                "a thread was using this simulation when this process was forked, so this copy may be incomplete: make a \
                 new one, or start from a snapshot"
                    .to_owned(),
            )),
        }
    }

    /// Waits for the turn on a thread that Python does not know.
    ///
    /// # Errors
    /// As [`attempt`](Self::attempt).
    pub(crate) fn wait(&self) -> Result<Turn<'_, T>, Error> {
        loop {
            if let Some(turn) = self.attempt()? {
                return Ok(turn);
            }
            thread::sleep(BETWEEN_ATTEMPTS);
        }
    }

    /// Waits for the turn; Ctrl-C is answered meanwhile. A signal handler on a thread that already has the turn is
    /// refused, as it would wait for ever.
    pub(crate) fn take(&self, py: Python<'_>) -> PyResult<Turn<'_, T>> {
        loop {
            if let Some(turn) = self.attempt().map_err(calls::to_python)? {
                return Ok(turn);
            }
            if self.thread.load(Ordering::Relaxed) == own_thread() {
                let rule = "must not be used by a signal handler that interrupts its own advance";
                return Err(calls::argument("simulation", "a signal handler", rule));
            }
            pause(py)?;
        }
    }

    /// Waits for the turn, during which Ctrl-C is answered; then calls the core with the value, detached from the
    /// interpreter.
    pub(crate) fn with<R: Send>(
        &self,
        py: Python<'_>,
        change: impl Send + FnOnce(&mut T) -> Result<R, Error>,
    ) -> PyResult<R>
    where
        T: Send,
    {
        let mut change = Some(change);
        loop {
            let attempt = || {
                let Some(mut turn) = self.attempt()? else {
                    return Ok(None);
                };
                change.take().map(|change| change(&mut turn)).transpose()
            };
            if let Some(result) = py.detach(|| calls::guarded(attempt))? {
                return Ok(result);
            }
            pause(py)?;
        }
    }
}

/// The number of this thread, above 0.
fn own_thread() -> u64 {
    static THREADS: AtomicU64 = AtomicU64::new(1);
    thread_local!(static NUMBER: u64 = THREADS.fetch_add(1, Ordering::Relaxed));
    NUMBER.with(|number| *number)
}

fn pause(py: Python<'_>) -> PyResult<()> {
    py.detach(|| thread::sleep(BETWEEN_ATTEMPTS));
    py.check_signals()
}
