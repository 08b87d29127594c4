//! The diagnosis of a stop as dictionaries and `NumPy` columns.

use crawler2d_core::{Balance, Diagnosis, LoadedIntrusion, Mechanism, StopContact, TipOver, Trial};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// A diagnosis; values that are not known are None.
pub(crate) fn of<'py>(py: Python<'py>, d: &Diagnosis) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let trials = d.trials.iter().map(|made| trial(py, made));
    let place = d.intrusion.as_ref();
    result.set_item("outcome", d.outcome.name())?;
    result.set_item("symptom", d.symptom.name())?;
    result.set_item("passing", d.is_passing())?;
    result.set_item(
        "trials",
        PyTuple::new(py, trials.collect::<PyResult<Vec<_>>>()?)?,
    )?;
    result.set_item("jammed", d.jammed)?;
    result.set_item("mechanism", d.mechanism.map(Mechanism::name))?;
    result.set_item("time", d.time)?;
    result.set_item("since", d.since)?;
    result.set_item("position", PyTuple::new(py, d.position)?)?;
    result.set_item("chassis_angle", d.chassis_angle)?;
    result.set_item("intrusion", place.map(|i| intrusion(py, i)).transpose()?)?;
    result.set_item("contacts", contacts(py, &d.contacts)?)?;
    result.set_item("belly_share", d.belly_share)?;
    result.set_item("sliding_share", d.sliding_share)?;
    result.set_item("stalled_share", d.stalled_share)?;
    result.set_item("progress", d.progress)?;
    result.set_item("stationary", d.stationary)?;
    result.set_item("imbalance", d.imbalance)?;
    result.set_item("certified", d.certified)?;
    Ok(result)
}

/// What came of a change at a stop.
pub(crate) fn trial<'py>(py: Python<'py>, trial: &Trial) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("name", trial.name)?;
    result.set_item("freed", trial.freed)?;
    result.set_item("starts", trial.starts)?;
    result.set_item("freeing", trial.freeing)?;
    result.set_item("distance", trial.distance)?;
    result.set_item("time", trial.time)?;
    result.set_item("outcome", trial.outcome.name())?;
    result.set_item("jammed", trial.jammed)?;
    let place = trial.intrusion.as_ref();
    result.set_item("intrusion", place.map(|i| intrusion(py, i)).transpose()?)?;
    result.set_item("duration", trial.duration)?;
    let [x, y, angle] = trial.pose;
    result.set_item("position", PyTuple::new(py, [x, y])?)?;
    result.set_item("chassis_angle", angle)?;
    let arms = trial.flipper_angles.iter().filter(|angle| !angle.is_nan());
    result.set_item(
        "flipper_angles",
        PyTuple::new(py, arms.collect::<Vec<_>>())?,
    )?;
    Ok(result)
}

/// How a robot tipped over.
pub(crate) fn tip_over<'py>(py: Python<'py>, found: &TipOver) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("backwards", found.backwards)?;
    result.set_item("time", found.time)?;
    result.set_item("end", found.end)?;
    result.set_item("chassis_angle", found.chassis_angle)?;
    result.set_item("center_of_mass", PyTuple::new(py, found.center_of_mass)?)?;
    result.set_item("pivot", PyTuple::new(py, found.pivot)?)?;
    Ok(result)
}

/// Whether forces could hold a stop.
pub(crate) fn balance<'py>(py: Python<'py>, found: &Balance) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("holds", found.holds())?;
    result.set_item("imbalance", found.imbalance)?;
    result.set_item("tolerance", found.tolerance)?;
    result.set_item("holds_between", found.holds_between)?;
    let pulls = found.pulls.iter();
    let pulls = pulls.map(|pull| (pull.body, (pull.point.x, pull.point.y), pull.force));
    result.set_item("pulls", PyTuple::new(py, pulls.collect::<Vec<_>>())?)?;
    Ok(result)
}

fn intrusion<'py>(py: Python<'py>, i: &LoadedIntrusion) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("edge", i.place.edge)?;
    result.set_item("edges", PyTuple::new(py, &i.place.edges)?)?;
    result.set_item("bodies", PyTuple::new(py, i.place.bodies)?)?;
    let kinds = i.kinds.map(|kind| kind as i64);
    result.set_item("body_kinds", PyTuple::new(py, kinds)?)?;
    result.set_item("side", i.place.side.name())?;
    result.set_item("carrier", i.carrier)?;
    result.set_item("depth", i.place.depth)?;
    result.set_item("root_depth", i.place.root_depth)?;
    result.set_item("x", i.place.x)?;
    result.set_item("y", i.place.y)?;
    result.set_item("force", i.force)?;
    Ok(result)
}

#[allow(clippy::cast_possible_wrap)] // indices are small
fn contacts<'py>(py: Python<'py>, found: &[StopContact]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let whole = |value: fn(&StopContact) -> i64| {
        let column: Vec<i64> = found.iter().map(value).collect();
        column.into_pyarray(py)
    };
    let number = |value: fn(&StopContact) -> f64| {
        let column: Vec<f64> = found.iter().map(value).collect();
        column.into_pyarray(py)
    };
    let is = |value: fn(&StopContact) -> bool| {
        let column: Vec<bool> = found.iter().map(value).collect();
        column.into_pyarray(py)
    };
    columns.set_item("contact", whole(|c| c.number as i64))?;
    columns.set_item("lane", whole(|c| c.side as i64))?;
    columns.set_item("body", whole(|c| c.body as i64))?;
    columns.set_item("body_kind", whole(|c| c.kind as i64))?;
    columns.set_item("segment", whole(|c| c.segment as i64))?;
    columns.set_item("edge", whole(|c| i64::from(c.edge)))?;
    columns.set_item("x", number(|c| c.point.x))?;
    columns.set_item("y", number(|c| c.point.y))?;
    columns.set_item("normal_x", number(|c| c.normal.x))?;
    columns.set_item("normal_y", number(|c| c.normal.y))?;
    columns.set_item("normal_force", number(|c| c.normal_force))?;
    columns.set_item("friction_force", number(|c| c.friction_force))?;
    columns.set_item("surface_speed", number(|c| c.surface_speed))?;
    columns.set_item("slides", is(|c| c.slides))?;
    columns.set_item("in_pocket", is(|c| c.in_pocket))?;
    Ok(columns)
}
