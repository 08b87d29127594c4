//! Runs the core beside the interpreter, which answers Ctrl-C in the meantime.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use crawler2d_core::{Cancel, Error};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::errors;

/// Runs the core in a thread of its own and checks for Ctrl-C until it has ended.
///
/// Ctrl-C is answered at once: the thread is asked to end, and does so at its next check. The data that it works
/// on must be its own, or locked.
pub(crate) fn beside<T: Send + 'static>(
    py: Python<'_>,
    cancel: &Cancel,
    call: impl Send + 'static + FnOnce() -> Result<T, Error>,
) -> PyResult<T> {
    /// Time between two checks.
    const PAUSE: Duration = Duration::from_millis(10);

    let (sender, receiver) = sync_channel(1);
    let work = move || {
        // After Ctrl-C, nobody receives the result.
        let _ = sender.send(errors::caught(call));
    };
    let thread = std::thread::Builder::new().spawn(work);
    if let Err(error) = thread {
        return Err(errors::limit(&format!(
            "a thread could not be started: {error}"
        )));
    }
    let result = py.detach(move || {
        loop {
            match receiver.recv_timeout(PAUSE) {
                Ok(result) => break Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    #[allow(clippy::redundant_closure_for_method_calls)]
                    // the closure's lifetime is not general enough
                    Python::attach(|py| py.check_signals()).inspect_err(|_| cancel.ask())?;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    break Err(errors::internal("a thread of the core failed"));
                }
            }
        }
    })?;
    result.map_err(errors::to_python)
}

/// Builds what a text describes, beside the interpreter if that may take long.
pub(crate) fn built<T: Send + 'static>(
    py: Python<'_>,
    text: PyBackedStr,
    call: impl Send + 'static + FnOnce(&str) -> Result<T, Error>,
) -> PyResult<T> {
    /// A text of this many bytes is built within some milliseconds.
    const SHORT: usize = 50_000;

    if text.len() <= SHORT {
        return errors::guarded(|| call(&text));
    }
    beside(py, &Cancel::default(), move || call(&text))
}
