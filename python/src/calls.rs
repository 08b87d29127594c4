//! Calls of the core: on a separate thread, so that the interpreter can answer Ctrl-C, and with errors, warnings and
//! panics of the core as the exceptions of `crawler2d.errors`.

use std::collections::HashSet;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use crawler2d_core::{
    Cancel, Error, FlipperCommand, LimitError, ValidScenario, Warning, check_rounding,
};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::PyDict;

/// Runs the core, turning errors and panics into Python exceptions.
pub(crate) fn guarded<T>(call: impl FnOnce() -> Result<T, Error>) -> PyResult<T> {
    caught(call).map_err(to_python)
}

/// The same, but returns an error of the core, which needs no interpreter.
pub(crate) fn caught<T>(call: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    check_rounding()?;
    crawler2d_core::caught(call)
}

/// Returns the Python exception for an error.
pub(crate) fn to_python(error: Error) -> PyErr {
    Python::attach(|py| exception(py, &error).unwrap_or_else(|failed| failed))
}

fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let details = PyDict::new(py);
    let class = match error {
        Error::Scenario(e) => {
            return Ok(raise(
                py,
                "ScenarioError",
                (&e.path, &e.value, &e.rule),
                None,
            ));
        }
        Error::Interrupted => return Ok(pyo3::exceptions::PyKeyboardInterrupt::new_err(())),
        Error::Simulation(e) => {
            details.set_item("step", e.step)?;
            details.set_item("body", &e.body)?;
            "SimulationDiverged"
        }
        Error::Limit(limit) => {
            if let LimitError::Memory {
                needed, available, ..
            } = limit
            {
                details.set_item("needed", needed)?;
                details.set_item("available", available)?;
            }
            "LimitError"
        }
        Error::Internal(_) => "InternalError",
    };
    Ok(raise(py, class, (error.to_string(),), Some(&details)))
}

/// Returns an exception that has only a message.
pub(crate) fn failure(class: &str, message: &str) -> PyErr {
    Python::attach(|py| raise(py, class, (message,), None))
}

/// Reads and validates scenarios.
pub(crate) fn read(texts: &[PyBackedStr]) -> Result<Vec<ValidScenario>, Error> {
    texts
        .iter()
        .map(|text| ValidScenario::from_json(text))
        .collect()
}

/// Returns the command of flippers for an angle or a rate; `None` leaves the command as it is.
pub(crate) fn flipper_command(angle: Option<f64>, rate: Option<f64>) -> Option<FlipperCommand> {
    let by_angle = angle.map(FlipperCommand::Angle);
    by_angle.or(rate.map(FlipperCommand::Rate))
}

/// Returns the exception for an invalid argument that is not a field of the scenario.
pub(crate) fn argument(path: &str, value: &str, rule: &str) -> PyErr {
    Python::attach(|py| raise(py, "ScenarioError", (path, value, rule), None))
}

/// Gives warnings at the line of the user's code, once for each field of a whole batch.
pub(crate) fn warn<'a>(
    py: Python<'_>,
    warnings: impl IntoIterator<Item = &'a Warning>,
) -> PyResult<()> {
    let mut seen = HashSet::new();
    for warning in warnings {
        if seen.insert(&warning.path) {
            let warn = py.import("crawler2d.errors")?.getattr("warn")?;
            warn.call1((&warning.path, warning.value, &warning.reason))?;
        }
    }
    Ok(())
}

/// The exceptions are defined in Python so that they can be pickled.
fn raise<'py>(
    py: Python<'py>,
    class: &str,
    args: impl pyo3::call::PyCallArgs<'py>,
    details: Option<&Bound<'py, PyDict>>,
) -> PyErr {
    let exception = py
        .import("crawler2d.errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call(args, details));
    match exception {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// Runs the core on a separate thread and checks for Ctrl-C until it has ended.
///
/// Ctrl-C is answered at once: the thread is asked to end, and does so at its next check. It must own or lock its
/// data.
pub(crate) fn run_interruptible<T: Send + 'static>(
    py: Python<'_>,
    call: impl Send + 'static + FnOnce(&Cancel) -> Result<T, Error>,
) -> PyResult<T> {
    /// Time between two checks.
    const PAUSE: Duration = Duration::from_millis(10);

    let cancel = Cancel::default();
    let asked = cancel.clone();
    let (sender, receiver) = sync_channel(1);
    let work = move || {
        // After Ctrl-C, nobody receives the result.
        let _ = sender.send(caught(|| call(&asked)));
    };
    let thread = std::thread::Builder::new().spawn(work);
    if let Err(error) = thread {
        let message = format!("a thread could not be started: {error}");
        return Err(failure("LimitError", &message));
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
                    break Err(failure("InternalError", "a thread of the core failed"));
                }
            }
        }
    })?;
    result.map_err(to_python)
}

/// Ends a call of the core on Python's own thread when it is time to check for Ctrl-C. Without a separate thread, short
/// calls take half the time.
pub(crate) fn until_a_look() -> Cancel {
    /// Time between two checks.
    const PAUSE: Duration = Duration::from_millis(20);

    Cancel::at(Instant::now() + PAUSE)
}

/// Whether a step may take long, judged by the numbers of points of the ground and parts of the robot. A robot of many
/// parts that is thrown against the ground has thousands of contacts.
pub(crate) fn may_be_slow((points, parts): (usize, usize)) -> bool {
    points > 10_000 || parts > 100
}

/// Builds what a text describes, on a separate thread if this may take long.
pub(crate) fn build_interruptible<T: Send + 'static>(
    py: Python<'_>,
    text: PyBackedStr,
    call: impl Send + 'static + FnOnce(&str) -> Result<T, Error>,
) -> PyResult<T> {
    /// A text of this many bytes is built within some milliseconds.
    const SHORT: usize = 50_000;

    if text.len() <= SHORT {
        return guarded(|| call(&text));
    }
    run_interruptible(py, move |_| call(&text))
}
