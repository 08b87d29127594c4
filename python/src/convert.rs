//! Converts the core's data to dictionaries of `NumPy` columns; unknown values are None.

use crawler2d_core::{
    Balance, BodyKind, Certificate, Change, ContactTable, Diagnosis, Edge, Event, ExcludedCell,
    FoundJam, Intrusion, JamContact, JamRange, LoadedIntrusion, Mechanism, Model, Outcome, Record,
    Region, RegionStatus, Run, Side, StopContact, TipOver, Trace, Trial, Vector, Wanted, WheelBody,
};
use numpy::ndarray::Array2;
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::calls;

/// Puts fields of a struct into a dictionary under their names; as arrays if an interpreter is given.
macro_rules! put {
    ($dict:ident, $of:ident: $($field:ident)+) => {
        $($dict.set_item(stringify!($field), $of.$field)?;)+
    };
    ($dict:ident, $of:ident, $py:ident: $($field:ident)+) => {
        $($dict.set_item(stringify!($field), $of.$field.into_pyarray($py))?;)+
    };
}
pub(crate) use put;

/// Returns what to record of a run; `trials` are names of trials at a stop.
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

/// Returns the trials with these names.
pub(crate) fn wanted(trials: &[String]) -> PyResult<Wanted> {
    let changes = trials.iter().map(|name| change(name));
    Ok(Wanted::of(changes.collect::<PyResult<Vec<_>>>()?))
}

/// Returns the change with this name.
pub(crate) fn change(name: &str) -> PyResult<Change> {
    Change::of_name(name).ok_or_else(|| {
        let names = Change::ALL.map(Change::name).join("\", \"");
        calls::argument("trials", name, &format!("must be one of \"{names}\""))
    })
}

/// The values of a finished run in the tables of sweeps.
pub(crate) fn row<'py>(py: Python<'py>, run: &Run) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let why = run.diagnosis.as_ref();
    result.set_item("outcome", run.outcome.name())?;
    result.set_item("diagnosis", why.map(|d| diagnosis(py, d)).transpose()?)?;
    result.set_item("metrics", run.metrics.entries().into_py_dict(py)?)?;
    result.set_item("wall_time", run.wall_time)?;
    Ok(result)
}

/// A finished run.
pub(crate) fn run(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyDict>> {
    let result = row(py, &run)?;
    let counts = (run.drives, run.shoes, run.flippers);
    result.set_item("trace", trace(py, run.trace, counts)?)?;
    result.set_item("contacts", contacts(py, run.contacts)?)?;
    result.set_item("edges", edges(py, &run.edges)?)?;
    result.set_item("events", events(py, &run.events)?)?;
    Ok(result)
}

/// A column of a table, with one value per row.
pub(crate) fn column<'py, R, T: Element>(
    py: Python<'py>,
    rows: &[R],
    value: impl Fn(&R) -> T,
) -> Bound<'py, PyArray1<T>> {
    rows.iter().map(value).collect::<Vec<T>>().into_pyarray(py)
}

fn events<'py>(py: Python<'py>, events: &[Event]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let kinds: Vec<&str> = events.iter().map(|e| e.kind.name()).collect();
    let pair = |e: &Event| {
        e.bodies
            .map_or(Ok(PyTuple::empty(py)), |pair| PyTuple::new(py, pair))
    };
    let bodies = events.iter().map(pair).collect::<PyResult<Vec<_>>>()?;
    columns.set_item("kind", kinds)?;
    columns.set_item("start", column(py, events, |e| e.start))?;
    columns.set_item("end", column(py, events, |e| e.end))?;
    columns.set_item("lane", column(py, events, |e| e.side as i64))?;
    columns.set_item("edge", column(py, events, |e| i64::from(e.edge)))?;
    columns.set_item("bodies", bodies)?;
    columns.set_item("depth", column(py, events, |e| e.depth))?;
    columns.set_item("root_depth", column(py, events, |e| e.root_depth))?;
    columns.set_item("force", column(py, events, |e| e.force))?;
    Ok(columns)
}

/// The ground inside the track.
pub(crate) fn intrusions<'py>(
    py: Python<'py>,
    found: &[Intrusion],
) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let edges = found.iter().map(|i| PyTuple::new(py, &i.edges));
    let bodies = found.iter().map(|i| PyTuple::new(py, i.bodies));
    columns.set_item("lane", column(py, found, |i| i.side as i64))?;
    columns.set_item("edge", column(py, found, |i| i64::from(i.edge)))?;
    columns.set_item("edges", edges.collect::<PyResult<Vec<_>>>()?)?;
    columns.set_item("bodies", bodies.collect::<PyResult<Vec<_>>>()?)?;
    columns.set_item("depth", column(py, found, |i| i.depth))?;
    columns.set_item("root_depth", column(py, found, |i| i.root_depth))?;
    columns.set_item("area", column(py, found, |i| i.area))?;
    columns.set_item("x", column(py, found, |i| i.x))?;
    columns.set_item("y", column(py, found, |i| i.y))?;
    Ok(columns)
}

/// A run of a batch without result, with its exception.
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
    let rows = |values: Vec<f64>, width: usize| values.into_pyarray(py).reshape([n, width]);
    put! { columns, trace, py: time }
    columns.set_item("position", rows(trace.position, 2)?)?;
    columns.set_item("velocity", rows(trace.velocity, 2)?)?;
    put! {
        columns, trace, py:
        chassis_angle angular_velocity commanded_speed track_speed track_position
        slip_ratio tractive_effort drive_force
    }
    columns.set_item("drive_speeds", rows(trace.drive_speeds, drives)?)?;
    columns.set_item("drive_positions", rows(trace.drive_positions, drives)?)?;
    columns.set_item("drive_forces", rows(trace.drive_forces, drives)?)?;
    put! { columns, trace, py: track_tension }
    let shoe_poses = trace.shoe_poses.into_pyarray(py);
    columns.set_item("shoe_poses", shoe_poses.reshape([n, shoes, 3])?)?;
    columns.set_item("flipper_angles", rows(trace.flipper_angles, flippers)?)?;
    columns.set_item("flipper_torques", rows(trace.flipper_torques, flippers)?)?;
    Ok(columns)
}

/// The columns of a trace that determine the poses.
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

/// Names used in tables; the index of a name is its code.
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
    put! {
        columns, table, py:
        time contact lane body body_kind segment edge x y normal_x normal_y
        normal_force friction_force surface_speed penetration
    }
    Ok(columns)
}

pub(crate) fn edges<'py>(py: Python<'py>, edges: &[Edge]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item("id", column(py, edges, |e| i64::from(e.id)))?;
    columns.set_item("lane", column(py, edges, |e| e.side as i64))?;
    columns.set_item("x", column(py, edges, |e| e.x))?;
    columns.set_item("y", column(py, edges, |e| e.y))?;
    columns.set_item("angle", column(py, edges, |e| e.angle))?;
    columns.set_item("radius", column(py, edges, |e| e.radius))?;
    Ok(columns)
}

/// The wheels of both sides, the left side first.
#[allow(clippy::cast_possible_wrap)] // indices are small
pub(crate) fn wheels<'py>(py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let of_side = || model.wheels().into_iter().map(WheelBody::of_one_side);
    let sides = ["left", "right"];
    let rows = sides
        .iter()
        .flat_map(|side| of_side().map(move |wheel| (*side, wheel)));
    let (side, wheels): (Vec<&str>, Vec<WheelBody>) = rows.unzip();
    let columns = PyDict::new(py);
    let carrier: Vec<&str> = wheels.iter().map(|w| model.carrier(w.mount)).collect();
    columns.set_item("side", side)?;
    columns.set_item("carrier", carrier)?;
    columns.set_item("body", column(py, &wheels, |w| w.part as i64))?;
    columns.set_item("x", column(py, &wheels, |w| w.center.x))?;
    columns.set_item("y", column(py, &wheels, |w| w.center.y))?;
    columns.set_item("radius", column(py, &wheels, |w| w.radius))?;
    columns.set_item("area", column(py, &wheels, |w| w.area))?;
    columns.set_item("mass", column(py, &wheels, |w| w.mass))?;
    let inertia = column(py, &wheels, |w| w.moment_of_inertia);
    columns.set_item("moment_of_inertia", inertia)?;
    Ok(columns)
}

pub(crate) fn rows<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((rows.len(), N), |(i, j)| rows[i][j]).into_pyarray(py)
}

/// A pair of coordinates.
pub(crate) fn pair(py: Python<'_>, of: Vector) -> Bound<'_, PyArray1<f64>> {
    vec![of.x, of.y].into_pyarray(py)
}

/// Version and build data of the compiled core.
pub(crate) fn build_info(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let info = PyDict::new(py);
    info.set_item("version", env!("CARGO_PKG_VERSION"))?;
    let is_debug = cfg!(debug_assertions);
    info.set_item("profile", if is_debug { "debug" } else { "release" })?;
    info.set_item("engine", crawler2d_core::ENGINE)?;
    let target = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS);
    info.set_item("target", target)?;
    info.set_item("schema", crawler2d_core::SCHEMA)?;
    info.set_item("build_id", crawler2d_core::BUILD_ID)?;
    Ok(info)
}

/// A diagnosis; unknown values are None.
pub(crate) fn diagnosis<'py>(py: Python<'py>, d: &Diagnosis) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let trials = d.trials.iter().map(|made| trial(py, made));
    let trials = trials.collect::<PyResult<Vec<_>>>()?;
    result.set_item("outcome", d.outcome.name())?;
    result.set_item("symptom", d.symptom.name())?;
    result.set_item("transient", d.is_transient())?;
    result.set_item("trials", PyTuple::new(py, trials)?)?;
    result.set_item("mechanism", d.mechanism.map(Mechanism::name))?;
    result.set_item("position", PyTuple::new(py, d.position)?)?;
    result.set_item("intrusion", loaded_intrusion(py, d.intrusion.as_ref())?)?;
    result.set_item("contacts", stop_contacts(py, &d.contacts)?)?;
    put! {
        result, d:
        jammed time since chassis_angle belly_share sliding_share stalled_share progress
        stationary imbalance certified
    }
    Ok(result)
}

/// The result of a change at a stop.
pub(crate) fn trial<'py>(py: Python<'py>, trial: &Trial) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let [x, y, angle] = trial.pose;
    let arms = trial.flipper_angles.iter().filter(|angle| !angle.is_nan());
    let arms = arms.collect::<Vec<_>>();
    put! { result, trial: name freed starts freeing distance time jammed duration }
    result.set_item("outcome", trial.outcome.name())?;
    result.set_item("intrusion", loaded_intrusion(py, trial.intrusion.as_ref())?)?;
    result.set_item("position", PyTuple::new(py, [x, y])?)?;
    result.set_item("chassis_angle", angle)?;
    result.set_item("flipper_angles", PyTuple::new(py, arms)?)?;
    Ok(result)
}

/// How a robot tipped over.
pub(crate) fn tip_over<'py>(py: Python<'py>, found: &TipOver) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    put! { result, found: backwards time end chassis_angle }
    result.set_item("center_of_mass", PyTuple::new(py, found.center_of_mass)?)?;
    result.set_item("pivot", PyTuple::new(py, found.pivot)?)?;
    Ok(result)
}

/// Whether forces could hold a stop.
pub(crate) fn balance<'py>(py: Python<'py>, found: &Balance) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("holds", found.holds())?;
    put! { result, found: imbalance tolerance holds_between }
    let pulls = found.pulls.iter();
    let pulls = pulls.map(|pull| (pull.body, (pull.point.x, pull.point.y), pull.force));
    result.set_item("pulls", PyTuple::new(py, pulls.collect::<Vec<_>>())?)?;
    Ok(result)
}

/// Poses of jams, the ground inside the track there, and whether they are stable; and contacts, each with the index of
/// its jam.
#[allow(clippy::cast_possible_wrap)] // indices are small
pub(crate) fn jams<'py>(py: Python<'py>, found: &[FoundJam]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let inside = |f: &FoundJam| f.intrusion.as_ref().map(|i| (i.depth, i.bodies));
    result.set_item("x", column(py, found, |f| f.jam.position.x))?;
    result.set_item("y", column(py, found, |f| f.jam.position.y))?;
    result.set_item("angle", column(py, found, |f| f.jam.angle))?;
    result.set_item("stable", column(py, found, |f| f.stable))?;
    let depth = column(py, found, |f| inside(f).map_or(0.0, |(depth, _)| depth));
    result.set_item("depth", depth)?;
    let bodies = found.iter().map(|f| inside(f).map(|(_, bodies)| bodies));
    result.set_item("between", bodies.collect::<Vec<_>>())?;
    let of = |(k, f): (usize, &FoundJam)| {
        let rows = f.jam.contacts.iter().map(move |contact| (k, *contact));
        rows.collect::<Vec<_>>()
    };
    let rows: Vec<(usize, JamContact)> = found.iter().enumerate().flat_map(of).collect();
    let number = |value: fn(&JamContact) -> f64| column(py, &rows, |(_, c)| value(c));
    let contacts = PyDict::new(py);
    contacts.set_item("jam", column(py, &rows, |(k, _)| *k as i64))?;
    contacts.set_item("body", column(py, &rows, |(_, c)| c.part as i64))?;
    contacts.set_item("body_kind", column(py, &rows, |(_, c)| c.kind as i64))?;
    contacts.set_item("edge", column(py, &rows, |(_, c)| c.edge.unwrap_or(-1)))?;
    contacts.set_item("x", number(|c| c.point.x))?;
    contacts.set_item("y", number(|c| c.point.y))?;
    contacts.set_item("normal_x", number(|c| c.normal.x))?;
    contacts.set_item("normal_y", number(|c| c.normal.y))?;
    contacts.set_item("normal_load", number(|c| c.load))?;
    contacts.set_item("friction", number(|c| c.friction))?;
    result.set_item("contacts", contacts)?;
    Ok(result)
}

/// Poses on three contacts, the coefficients of friction at which these hold, and the ground inside the track there.
pub(crate) fn jam_ranges<'py>(
    py: Python<'py>,
    found: &[(JamRange, Option<Intrusion>)],
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("x", column(py, found, |(jam, _)| jam.position.x))?;
    result.set_item("y", column(py, found, |(jam, _)| jam.position.y))?;
    result.set_item("angle", column(py, found, |(jam, _)| jam.angle))?;
    result.set_item("low", column(py, found, |(jam, _)| jam.friction[0]))?;
    result.set_item("high", column(py, found, |(jam, _)| jam.friction[1]))?;
    let depth = column(py, found, |(_, inside)| {
        inside.as_ref().map_or(0.0, |i| i.depth)
    });
    result.set_item("depth", depth)?;
    let bodies = found
        .iter()
        .map(|(_, inside)| inside.as_ref().map(|i| i.bodies));
    result.set_item("between", bodies.collect::<Vec<_>>())?;
    Ok(result)
}

/// The status of each region: the number of cells that exclude jams, -1 with the pose of a jam, -2 if a belt jams, too,
/// -3 if unknown; and these cells.
#[allow(clippy::cast_possible_wrap)] // counts are small
pub(crate) fn certificate<'py>(
    py: Python<'py>,
    found: &Certificate,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let regions = &found.regions;
    let flat = |of: fn(&Region) -> &Vec<f64>| regions.iter().flat_map(of).copied().collect();
    let (low, high): (Vec<f64>, Vec<f64>) = (flat(|r| &r.low), flat(|r| &r.high));
    result.set_item("low", column(py, &low, |share| *share))?;
    result.set_item("high", column(py, &high, |share| *share))?;
    let count = column(py, regions, |region| match &region.status {
        RegionStatus::Certified(cells) => *cells as i64,
        RegionStatus::Jams(..) => -1,
        RegionStatus::AsBelt => -2,
        RegionStatus::Undecided => -3,
    });
    result.set_item("count", count)?;
    let witness = |region: &Region| match &region.status {
        RegionStatus::Jams(shares, jam) => {
            Some((shares.clone(), (jam.position.x, jam.position.y, jam.angle)))
        }
        _ => None,
    };
    let witnesses = regions.iter().map(witness);
    result.set_item("witnesses", witnesses.collect::<Vec<_>>())?;
    result.set_item("length", found.length)?;
    let cells = PyDict::new(py);
    let flat = |of: fn(&ExcludedCell) -> &[f64]| -> Vec<f64> {
        found.cells.iter().flat_map(of).copied().collect()
    };
    for (name, values) in [
        ("low", flat(|cell| &cell.low)),
        ("high", flat(|cell| &cell.high)),
        ("twist", flat(|cell| &cell.twist)),
    ] {
        cells.set_item(name, column(py, &values, |value| *value))?;
    }
    let exclusion = column(py, &found.cells, |cell| cell.exclusion as i64);
    cells.set_item("exclusion", exclusion)?;
    result.set_item("cells", cells)?;
    Ok(result)
}

/// Ground inside the track with the force on it, if any.
fn loaded_intrusion<'py>(
    py: Python<'py>,
    found: Option<&LoadedIntrusion>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(found) = found else { return Ok(None) };
    let (result, place) = (PyDict::new(py), &found.place);
    let kinds = found.kinds.map(|kind| kind as i64);
    put! { result, place: edge depth root_depth x y }
    put! { result, found: carrier force }
    result.set_item("edges", PyTuple::new(py, &place.edges)?)?;
    result.set_item("bodies", PyTuple::new(py, place.bodies)?)?;
    result.set_item("body_kinds", PyTuple::new(py, kinds)?)?;
    result.set_item("side", place.side.name())?;
    Ok(Some(result))
}

#[allow(clippy::cast_possible_wrap)] // indices are small
fn stop_contacts<'py>(py: Python<'py>, found: &[StopContact]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let whole = |value: fn(&StopContact) -> i64| column(py, found, value);
    let number = |value: fn(&StopContact) -> f64| column(py, found, value);
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
    columns.set_item("slides", column(py, found, |c| c.slides))?;
    columns.set_item("in_pocket", column(py, found, |c| c.in_pocket))?;
    Ok(columns)
}
