//! The core at work beside the interpreter, which answers Ctrl-C meanwhile.

use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use crawler2d_core::{Cancel, Error};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::errors;

/// Runs the core in a thread of its own and looks for Ctrl-C until it has ended.
///
/// Ctrl-C is answered at once: the thread is asked to end, and does so when it next looks. What it works on
/// must be its own, or locked.
pub(crate) fn beside<T: Send + 'static>(
    py: Python<'_>,
    cancel: &Cancel,
    call: impl Send + 'static + FnOnce() -> Result<T, Error>,
) -> PyResult<T> {
    /// Between two looks.
    const PAUSE: Duration = Duration::from_millis(10);

    let (sender, receiver) = sync_channel(1);
    let work = move || {
        // Nobody listens after Ctrl-C.
        let _ = sender.send(errors::caught(call));
    };
    let thread = std::thread::Builder::new().spawn(work);
    if let Err(error) = thread {
        return Err(errors::limit(&format!(
            "no thread could be started: {error}"
        )));
    }
    let result = py.detach(move || {
        loop {
            match receiver.recv_timeout(PAUSE) {
                Ok(result) => break Ok(result),
                Err(RecvTimeoutError::Timeout) => {
                    #[allow(clippy::redundant_closure_for_method_calls)]
                    // its lifetime is not general
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

/// Builds what a text describes: beside the interpreter if that may take long.
pub(crate) fn built<T: Send + 'static>(
    py: Python<'_>,
    text: PyBackedStr,
    call: impl Send + 'static + FnOnce(&str) -> Result<T, Error>,
) -> PyResult<T> {
    /// Bytes of a text that is built within some milliseconds.
    const SHORT: usize = 50_000;

    if text.len() <= SHORT {
        return errors::guarded(|| call(&text));
    }
    beside(py, &Cancel::default(), move || call(&text))
}
