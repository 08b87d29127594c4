//! Scenarios that have been checked, for use in a batch.

use crawler2d_core::Checked;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::beside::built;

/// A valid scenario, with the robot and the ground that were built to check it.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct Passed {
    pub checked: Checked,
}

#[pymethods]
impl Passed {
    /// Checks a scenario; whatever equals that of `like` is not built again.
    #[new]
    #[pyo3(signature = (text, like = None))]
    fn new(py: Python<'_>, text: PyBackedStr, like: Option<PyRef<'_, Self>>) -> PyResult<Self> {
        let like = like.map(|like| like.checked.clone());
        let checked = built(py, text, move |text| {
            Checked::from_json_like(text, like.as_ref())
        })?;
        Ok(Self { checked })
    }

    /// SHA-256 of the canonical JSON.
    #[getter]
    fn identity(&self) -> String {
        self.checked.scenario().identity()
    }
}
