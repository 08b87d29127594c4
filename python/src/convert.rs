//! Converts the core's data to dictionaries of `NumPy` columns; values that are not known are None.

use crawler2d_core::{
    Balance, BodyKind, Change, ContactTable, Diagnosis, Edge, Event, Intrusion, LoadedIntrusion,
    Mechanism, Model, Outcome, Record, Run, Side, StopContact, TipOver, Trace, Trial, Wanted,
    WheelBody,
};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::calls;

/// What to record of a run, from the arguments; `trials` are names of what to try at a stop.
pub(crate) fn record(sample_interval: f64, record: &str, trials: &[String]) -> PyResult<Record> {
    if !(sample_interval > 0.0 && sample_interval <= 1e5) {
        let rule = "must be > 0 s and <= 100000 s";
        return Err(calls::argument(
            "sample_interval",
            &sample_interval.to_string(),
            rule,
        ));
    }
    let history = match record {
        "full" => true,
        "summary" => false,
        other => {
            let rule = "must be one of full, summary";
            return Err(calls::argument("record", other, rule));
        }
    };
    Ok(Record {
        sample_interval,
        history,
        trials: wanted(trials)?,
    })
}

/// The trials of these names.
pub(crate) fn wanted(trials: &[String]) -> PyResult<Wanted> {
    let changes = trials.iter().map(|name| change(name));
    Ok(Wanted::of(changes.collect::<PyResult<Vec<_>>>()?))
}

/// The change of a name.
pub(crate) fn change(name: &str) -> PyResult<Change> {
    Change::of_name(name).ok_or_else(|| {
        let names = Change::ALL.map(Change::name).join("\", \"");
        calls::argument("trials", name, &format!("must be one of \"{names}\""))
    })
}

/// What the tables of sweeps hold of a finished run.
pub(crate) fn row<'py>(py: Python<'py>, run: &Run) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let metrics = PyDict::new(py);
    for (name, value) in run.metrics.entries() {
        metrics.set_item(name, value)?;
    }
    result.set_item("outcome", run.outcome.name())?;
    let why = run.diagnosis.as_ref();
    result.set_item("diagnosis", why.map(|d| diagnosis(py, d)).transpose()?)?;
    result.set_item("metrics", metrics)?;
    result.set_item("wall_time", run.wall_time)?;
    Ok(result)
}

/// A finished run.
pub(crate) fn run(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyDict>> {
    let result = row(py, &run)?;
    result.set_item(
        "trace",
        trace(py, run.trace, (run.drives, run.shoes, run.flippers))?,
    )?;
    result.set_item("contacts", contacts(py, run.contacts)?)?;
    result.set_item("edges", edges(py, &run.edges)?)?;
    result.set_item("events", events(py, &run.events)?)?;
    Ok(result)
}

fn events<'py>(py: Python<'py>, events: &[Event]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let column = |value: fn(&Event) -> f64| {
        events
            .iter()
            .map(value)
            .collect::<Vec<_>>()
            .into_pyarray(py)
    };
    let whole = |value: fn(&Event) -> i64| {
        events
            .iter()
            .map(value)
            .collect::<Vec<_>>()
            .into_pyarray(py)
    };
    let kinds: Vec<&str> = events.iter().map(|e| e.kind.name()).collect();
    let bodies = events
        .iter()
        .map(|e| {
            e.bodies
                .map_or(Ok(PyTuple::empty(py)), |pair| PyTuple::new(py, pair))
        })
        .collect::<PyResult<Vec<_>>>()?;
    columns.set_item("kind", kinds)?;
    columns.set_item("start", column(|e| e.start))?;
    columns.set_item("end", column(|e| e.end))?;
    columns.set_item("lane", whole(|e| e.side as i64))?;
    columns.set_item("edge", whole(|e| i64::from(e.edge)))?;
    columns.set_item("bodies", bodies)?;
    columns.set_item("depth", column(|e| e.depth))?;
    columns.set_item("root_depth", column(|e| e.root_depth))?;
    columns.set_item("force", column(|e| e.force))?;
    Ok(columns)
}

/// The ground inside the track.
pub(crate) fn intrusions<'py>(
    py: Python<'py>,
    found: &[Intrusion],
) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let column =
        |value: fn(&Intrusion) -> f64| found.iter().map(value).collect::<Vec<_>>().into_pyarray(py);
    let lane: Vec<i64> = found.iter().map(|i| i.side as i64).collect();
    let edge: Vec<i64> = found.iter().map(|i| i64::from(i.edge)).collect();
    let edges = found
        .iter()
        .map(|i| PyTuple::new(py, &i.edges))
        .collect::<PyResult<Vec<_>>>()?;
    let bodies = found
        .iter()
        .map(|i| PyTuple::new(py, i.bodies))
        .collect::<PyResult<Vec<_>>>()?;
    columns.set_item("lane", lane.into_pyarray(py))?;
    columns.set_item("edge", edge.into_pyarray(py))?;
    columns.set_item("edges", edges)?;
    columns.set_item("bodies", bodies)?;
    columns.set_item("depth", column(|i| i.depth))?;
    columns.set_item("root_depth", column(|i| i.root_depth))?;
    columns.set_item("area", column(|i| i.area))?;
    columns.set_item("x", column(|i| i.x))?;
    columns.set_item("y", column(|i| i.y))?;
    Ok(columns)
}

/// A run of a batch without a result, with its exception.
pub(crate) fn failure(py: Python<'_>, error: PyErr) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("error", error.into_value(py))?;
    Ok(result)
}

fn trace(
    py: Python<'_>,
    trace: Trace,
    (drives, shoes, flippers): (usize, usize, usize),
) -> PyResult<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    let n = trace.time.len();
    if n == 0 {
        return Ok(columns);
    }
    columns.set_item("time", trace.time.into_pyarray(py))?;
    columns.set_item("position", trace.position.into_pyarray(py).reshape([n, 2])?)?;
    columns.set_item("velocity", trace.velocity.into_pyarray(py).reshape([n, 2])?)?;
    columns.set_item("chassis_angle", trace.chassis_angle.into_pyarray(py))?;
    columns.set_item("angular_velocity", trace.angular_velocity.into_pyarray(py))?;
    columns.set_item("commanded_speed", trace.commanded_speed.into_pyarray(py))?;
    columns.set_item("track_speed", trace.track_speed.into_pyarray(py))?;
    columns.set_item("track_position", trace.track_position.into_pyarray(py))?;
    columns.set_item("slip_ratio", trace.slip_ratio.into_pyarray(py))?;
    columns.set_item("tractive_effort", trace.tractive_effort.into_pyarray(py))?;
    columns.set_item("drive_force", trace.drive_force.into_pyarray(py))?;
    columns.set_item(
        "drive_speeds",
        trace.drive_speeds.into_pyarray(py).reshape([n, drives])?,
    )?;
    columns.set_item(
        "drive_positions",
        trace
            .drive_positions
            .into_pyarray(py)
            .reshape([n, drives])?,
    )?;
    columns.set_item(
        "drive_forces",
        trace.drive_forces.into_pyarray(py).reshape([n, drives])?,
    )?;
    columns.set_item("track_tension", trace.track_tension.into_pyarray(py))?;
    columns.set_item(
        "shoe_poses",
        trace.shoe_poses.into_pyarray(py).reshape([n, shoes, 3])?,
    )?;
    for (name, values) in [
        ("flipper_angles", trace.flipper_angles),
        ("flipper_torques", trace.flipper_torques),
    ] {
        columns.set_item(name, values.into_pyarray(py).reshape([n, flippers])?)?;
    }
    Ok(columns)
}

/// The columns of a trace from which poses follow.
pub(crate) fn moved(columns: &Bound<'_, PyDict>) -> PyResult<Trace> {
    let column = |name: &str| -> PyResult<Vec<f64>> {
        let column = columns.as_any().get_item(name)?;
        Ok(column
            .extract::<PyReadonlyArrayDyn<'_, f64>>()?
            .as_array()
            .iter()
            .copied()
            .collect())
    };
    Ok(Trace {
        position: column("position")?,
        chassis_angle: column("chassis_angle")?,
        drive_positions: column("drive_positions")?,
        shoe_poses: column("shoe_poses")?,
        flipper_angles: column("flipper_angles")?,
        ..Trace::default()
    })
}

/// Names used in tables; the position of a name is its code.
pub(crate) fn kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let names = PyDict::new(py);
    names.set_item("body_kind", BodyKind::ALL.map(BodyKind::name))?;
    names.set_item("lane", Side::ALL.map(Side::name))?;
    names.set_item("outcome", Outcome::ALL.map(Outcome::name))?;
    let stops = Outcome::ALL.iter().filter(|outcome| outcome.is_stop());
    names.set_item("stop", stops.map(|stop| stop.name()).collect::<Vec<_>>())?;
    names.set_item("mechanism", Mechanism::ALL.map(Mechanism::name))?;
    names.set_item("trial", Change::ALL.map(Change::name))?;
    Ok(names)
}

pub(crate) fn contacts(py: Python<'_>, table: ContactTable) -> PyResult<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item("time", table.time.into_pyarray(py))?;
    columns.set_item("contact", table.contact.into_pyarray(py))?;
    columns.set_item("lane", table.lane.into_pyarray(py))?;
    columns.set_item("body", table.body.into_pyarray(py))?;
    columns.set_item("body_kind", table.body_kind.into_pyarray(py))?;
    columns.set_item("segment", table.segment.into_pyarray(py))?;
    columns.set_item("edge", table.edge.into_pyarray(py))?;
    columns.set_item("x", table.x.into_pyarray(py))?;
    columns.set_item("y", table.y.into_pyarray(py))?;
    columns.set_item("normal_x", table.normal_x.into_pyarray(py))?;
    columns.set_item("normal_y", table.normal_y.into_pyarray(py))?;
    columns.set_item("normal_force", table.normal_force.into_pyarray(py))?;
    columns.set_item("friction_force", table.friction_force.into_pyarray(py))?;
    columns.set_item("surface_speed", table.surface_speed.into_pyarray(py))?;
    columns.set_item("penetration", table.penetration.into_pyarray(py))?;
    Ok(columns)
}

pub(crate) fn edges<'py>(py: Python<'py>, edges: &[Edge]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let column =
        |value: fn(&Edge) -> f64| edges.iter().map(value).collect::<Vec<_>>().into_pyarray(py);
    let ids: Vec<i64> = edges.iter().map(|e| i64::from(e.id)).collect();
    let lanes: Vec<i64> = edges.iter().map(|e| e.side as i64).collect();
    columns.set_item("id", ids.into_pyarray(py))?;
    columns.set_item("lane", lanes.into_pyarray(py))?;
    columns.set_item("x", column(|e| e.x))?;
    columns.set_item("y", column(|e| e.y))?;
    columns.set_item("angle", column(|e| e.angle))?;
    columns.set_item("radius", column(|e| e.radius))?;
    Ok(columns)
}

/// The wheels of both sides, the left side first.
pub(crate) fn wheels<'py>(py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let of_side = || model.wheels().into_iter().map(WheelBody::of_one_side);
    let sides = ["left", "right"];
    let rows = sides
        .iter()
        .flat_map(|side| of_side().map(move |wheel| (*side, wheel)));
    let (side, wheels): (Vec<&str>, Vec<WheelBody>) = rows.unzip();
    let columns = PyDict::new(py);
    let column = |value: fn(&WheelBody) -> f64| {
        wheels
            .iter()
            .map(value)
            .collect::<Vec<_>>()
            .into_pyarray(py)
    };
    let body: Vec<i64> = wheels
        .iter()
        .filter_map(|w| i64::try_from(w.part).ok())
        .collect();
    let carrier: Vec<&str> = wheels.iter().map(|w| model.carrier(w.mount)).collect();
    columns.set_item("side", side)?;
    columns.set_item("carrier", carrier)?;
    columns.set_item("body", body.into_pyarray(py))?;
    columns.set_item("x", column(|w| w.center.x))?;
    columns.set_item("y", column(|w| w.center.y))?;
    columns.set_item("radius", column(|w| w.radius))?;
    columns.set_item("area", column(|w| w.area))?;
    columns.set_item("mass", column(|w| w.mass))?;
    columns.set_item("moment_of_inertia", column(|w| w.moment_of_inertia))?;
    Ok(columns)
}

pub(crate) fn rows<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((rows.len(), N), |(i, j)| rows[i][j]).into_pyarray(py)
}

/// A pair of coordinates.
pub(crate) fn pair(py: Python<'_>, x: f64, y: f64) -> Bound<'_, PyArray1<f64>> {
    vec![x, y].into_pyarray(py)
}

/// Version and build data of the compiled core.
pub(crate) fn build_info(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let info = PyDict::new(py);
    info.set_item("version", env!("CARGO_PKG_VERSION"))?;
    info.set_item(
        "profile",
        if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        },
    )?;
    info.set_item("engine", crawler2d_core::ENGINE)?;
    info.set_item(
        "target",
        format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
    )?;
    info.set_item("schema", crawler2d_core::SCHEMA)?;
    info.set_item("build_id", crawler2d_core::BUILD_ID)?;
    Ok(info)
}

/// A diagnosis; values that are not known are None.
pub(crate) fn diagnosis<'py>(py: Python<'py>, d: &Diagnosis) -> PyResult<Bound<'py, PyDict>> {
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
    result.set_item(
        "intrusion",
        place.map(|i| loaded_intrusion(py, i)).transpose()?,
    )?;
    result.set_item("contacts", stop_contacts(py, &d.contacts)?)?;
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
    result.set_item(
        "intrusion",
        place.map(|i| loaded_intrusion(py, i)).transpose()?,
    )?;
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

fn loaded_intrusion<'py>(py: Python<'py>, i: &LoadedIntrusion) -> PyResult<Bound<'py, PyDict>> {
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
fn stop_contacts<'py>(py: Python<'py>, found: &[StopContact]) -> PyResult<Bound<'py, PyDict>> {
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
