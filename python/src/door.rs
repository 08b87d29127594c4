//! Scenarios that have been validated, on their way to a batch.

use crawler2d_core::Checked;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::PyList;

use crate::beside::built;
use crate::errors;

/// A valid scenario, with the robot and the ground that were built to check it.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct Passed {
    pub checked: Checked,
}

#[pymethods]
impl Passed {
    /// Validates a scenario; robot or ground equal to those of `like` are not built again.
    #[new]
    #[pyo3(signature = (text, like = None))]
    fn new(py: Python<'_>, text: PyBackedStr, like: Option<PyRef<'_, Self>>) -> PyResult<Self> {
        let like = like.map(|like| like.checked.clone());
        let checked = built(py, text, move |text| {
            Checked::from_json_like(text, like.as_ref())
        })?;
        Ok(Self { checked })
    }

    /// Scenarios that differ from this one in some numbers, one per row; or the error of what breaks a rule.
    ///
    /// `fields` are JSON pointers, each with whether it takes whole numbers; `rows` has shape (n, fields).
    fn varied<'py>(
        &self,
        py: Python<'py>,
        fields: Vec<(String, bool)>,
        rows: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyList>> {
        let numbers = rows.as_slice()?.to_vec();
        let (count, width) = (rows.shape()[0], rows.shape()[1]);
        let rows = (0..count).map(|row| &numbers[row * width..(row + 1) * width]);
        let found = errors::guarded(|| Ok(self.checked.varied(&fields, rows)))?;
        let list = PyList::empty(py);
        for each in found {
            match each {
                Ok(checked) => list.append(Bound::new(py, Self { checked })?)?,
                Err(error) => list.append(errors::to_python(error).into_value(py))?,
            }
        }
        Ok(list)
    }

    /// The canonical JSON.
    #[getter]
    fn text(&self) -> String {
        self.checked.scenario().to_json()
    }

    /// SHA-256 of the canonical JSON.
    #[getter]
    fn identity(&self) -> String {
        self.checked.scenario().identity()
    }
}
