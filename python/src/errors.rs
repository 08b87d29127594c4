//! Errors and doubts of the core as the Python exceptions of `crawler2d.errors`; no panic leaves this file.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crawler2d_core::{Doubt, Error};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Runs the core, turning errors and panics into Python exceptions.
pub(crate) fn guarded<T>(call: impl FnOnce() -> Result<T, Error>) -> PyResult<T> {
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(to_python(error)),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("unknown panic");
            Err(internal(&format!(
                "the core failed: {text}; please report this with the scenario"
            )))
        }
    }
}

/// The Python exception of an error.
pub(crate) fn to_python(error: Error) -> PyErr {
    Python::attach(|py| match error {
        Error::Scenario(e) => raise(py, "ScenarioError", (e.path, e.value, e.rule), None),
        Error::Simulation(e) => {
            let details = PyDict::new(py);
            let filled = details
                .set_item("step", e.step)
                .and_then(|()| details.set_item("body", &e.body));
            filled.map_or_else(
                |err| err,
                |()| raise(py, "SimulationDiverged", (e.to_string(),), Some(&details)),
            )
        }
        Error::Interrupted => pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
    })
}

/// A fault of the program itself.
pub(crate) fn internal(message: &str) -> PyErr {
    Python::attach(|py| raise(py, "InternalError", (message,), None))
}

/// A request beyond what the machine can hold.
pub(crate) fn limit(message: &str) -> PyErr {
    Python::attach(|py| raise(py, "LimitError", (message,), None))
}

/// A wrong argument that is no field of the scenario.
pub(crate) fn argument(path: &str, value: &str, rule: &str) -> PyErr {
    Python::attach(|py| raise(py, "ScenarioError", (path, value, rule), None))
}

/// Warns of doubts at the line of the caller's own code; of each field once, whatever a batch has there.
pub(crate) fn warn(py: Python<'_>, doubts: impl IntoIterator<Item = Doubt>) -> PyResult<()> {
    let mut seen = HashSet::new();
    for doubt in doubts {
        if seen.insert(doubt.path.clone()) {
            let warn = py.import("crawler2d._doubts")?.getattr("warn")?;
            warn.call1((doubt.path, doubt.value, doubt.reason))?;
        }
    }
    Ok(())
}

/// The exceptions are defined in Python so that they pickle.
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
