//! From the core's plain data to dictionaries of `NumPy` arrays.

use crawler2d_core::{
    ChainOfShoes, ContactTable, Edge, Event, Ground, Intrusion, Model, Mount, Part, Record, Run,
    Scenario, Shape, SimulationError, Trace, Vector, WheelBody,
};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::{diagnosis, errors};

/// What to keep of a run, from its arguments.
pub(crate) fn record(sample_interval: f64, record: &str, counterfactual: bool) -> PyResult<Record> {
    if !(sample_interval > 0.0 && sample_interval <= 1e5) {
        let rule = "must be > 0 s and <= 100000 s";
        return Err(errors::argument(
            "sample_interval",
            &sample_interval.to_string(),
            rule,
        ));
    }
    match record {
        "full" => Ok(Record {
            sample_interval,
            history: true,
            counterfactual,
        }),
        "summary" => Ok(Record {
            sample_interval,
            history: false,
            counterfactual,
        }),
        other => Err(errors::argument(
            "record",
            other,
            "must be one of full, summary",
        )),
    }
}

/// Refuses a history that cannot fit in memory before anything is allocated.
pub(crate) fn check_size(scenario: &Scenario, record: Record) -> PyResult<()> {
    /// A sample holds about 20 numbers and a few contacts of 14 columns each.
    const BYTES_PER_SAMPLE: f64 = 800.0;
    const MOST: f64 = 8.0 * 1024.0 * 1024.0 * 1024.0;

    let every = (record.sample_interval / scenario.solver.time_step)
        .round()
        .max(1.0)
        * scenario.solver.time_step;
    let bytes = if record.history {
        scenario.duration / every * BYTES_PER_SAMPLE
    } else {
        0.0
    };
    if bytes > MOST {
        let message = format!(
            "a run of {} s sampled every {every} s needs about {:.0} GiB, more than 8 GiB; \
             use a longer sample_interval or record=\"summary\"",
            scenario.duration,
            bytes / (1024.0 * 1024.0 * 1024.0),
        );
        return Err(errors::limit(&message));
    }
    Ok(())
}

/// A finished run.
pub(crate) fn run(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    let metrics = PyDict::new(py);
    for (name, value) in run.metrics.entries() {
        metrics.set_item(name, value)?;
    }
    result.set_item("outcome", run.outcome.name())?;
    let why = run.diagnosis.as_ref();
    result.set_item("diagnosis", why.map(|d| diagnosis::of(py, d)).transpose()?)?;
    result.set_item("metrics", metrics)?;
    result.set_item(
        "trace",
        trace(py, run.trace, (run.drives, run.shoes, run.flippers))?,
    )?;
    result.set_item("contacts", contacts(py, run.contacts)?)?;
    result.set_item("edges", edges(py, &run.edges)?)?;
    result.set_item("events", events(py, &run.events)?)?;
    result.set_item("wall_time", run.wall_time)?;
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

/// What of the ground is inside the track.
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

/// A run of a batch that gave no result.
pub(crate) fn failure<'py>(
    py: Python<'py>,
    error: &SimulationError,
) -> PyResult<Bound<'py, PyDict>> {
    let details = PyDict::new(py);
    details.set_item("kind", "SimulationDiverged")?;
    details.set_item("message", error.to_string())?;
    details.set_item("step", error.step)?;
    details.set_item("body", &error.body)?;
    let result = PyDict::new(py);
    result.set_item("error", details)?;
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

pub(crate) fn contacts(py: Python<'_>, table: ContactTable) -> PyResult<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    columns.set_item("time", table.time.into_pyarray(py))?;
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

fn edges<'py>(py: Python<'py>, edges: &[Edge]) -> PyResult<Bound<'py, PyDict>> {
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

/// Everything a picture needs; of two tracks the right one, which is in front in a side view.
pub(crate) fn geometry<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    model: &Model,
    ground: &Ground,
) -> PyResult<Bound<'py, PyDict>> {
    let near = ground.tracks - 1;
    let result = track(py, model, (Mount::Chassis, near))?;
    let (shoes, belly) = (PyList::empty(py), PyList::empty(py));
    for part in &model.parts {
        let Shape::Polygon { corners } = &part.shape else {
            continue;
        };
        match part.mount {
            Mount::Shoe(shoe) if part.lane == near => shoes.append((shoe, points(py, corners)))?,
            Mount::Chassis => belly.append(points(py, corners))?,
            _ => {}
        }
    }
    let flippers = PyList::empty(py);
    for (k, flipper) in model.flippers.iter().enumerate() {
        let drawn = track(py, model, (Mount::Flipper(k), near))?;
        drawn.set_item("pivot", (flipper.pivot.x, flipper.pivot.y))?;
        drawn.set_item("arm", (flipper.arm.x, flipper.arm.y))?;
        drawn.set_item("sign", flipper.sign())?;
        flippers.append(drawn)?;
    }
    let lanes = PyList::empty(py);
    for lane in &ground.lanes {
        lanes.append((lane.side as i64, points(py, &lane.points)))?;
    }
    result.set_item("lanes", lanes)?;
    result.set_item("edges", edges(py, &ground.edges())?)?;
    result.set_item("shoes", shoes)?;
    let sprocket = model.chains.last().map(|chain| sprocket(py, chain));
    result.set_item("sprocket", sprocket.transpose()?.flatten())?;
    result.set_item("wheels", wheels(py, model)?)?;
    let none = || points(py, &[]).into_any();
    result.set_item("belly", belly.get_item(0).unwrap_or_else(|_| none()))?;
    result.set_item("flippers", flippers)?;
    result.set_item("drive_radius", model.drive_radius)?;
    result.set_item("goal", ground.goal_of(scenario))?;
    Ok(result)
}

/// What runs round the chassis or a flipper on a lane, in the frame of what carries it.
fn track<'py>(
    py: Python<'py>,
    model: &Model,
    (mount, lane): (Mount, usize),
) -> PyResult<Bound<'py, PyDict>> {
    /// Points of one root arc between two grousers.
    const ARC_POINTS: usize = 12;
    /// [rad] Turn between two points of a belt.
    const BELT_TURN: f64 = 0.05;

    let mut circles: Vec<[f64; 3]> = Vec::new();
    let mut drives: Vec<usize> = Vec::new();
    let mut bodies: Vec<usize> = Vec::new();
    let mut hull = false;
    let gears = PyList::empty(py);
    let grousers = PyList::empty(py);
    let shown = |part: &Part| part.lane == lane && part.mount == mount;
    for (body, part) in model.parts.iter().enumerate().filter(|(_, p)| shown(p)) {
        let before = circles.len();
        match &part.shape {
            Shape::Disc { center, radius } => circles.push([center.x, center.y, *radius]),
            Shape::Hull { discs, .. } => {
                hull = true;
                circles.extend(discs.iter().map(|d| [d.center.x, d.center.y, d.radius]));
            }
            Shape::Gear { center, gear } => {
                circles.push([center.x, center.y, gear.radius]);
                let drawn = PyDict::new(py);
                drawn.set_item("center", (center.x, center.y))?;
                drawn.set_item("radius", gear.radius)?;
                drawn.set_item("drive", part.drive)?;
                drawn.set_item("outline", points(py, &gear.outline(ARC_POINTS)))?;
                gears.append(drawn)?;
            }
            Shape::Grouser(grouser) => grousers.append(points(py, grouser.corners()))?,
            Shape::Polygon { .. } => {}
        }
        // What no drive moves follows the first.
        drives.resize(circles.len(), part.drive.unwrap_or(0));
        bodies.resize(bodies.len() + circles.len() - before, body);
    }
    let drawn = PyDict::new(py);
    drawn.set_item("circles", rows(py, &circles))?;
    drawn.set_item("drives", drives.into_pyarray(py))?;
    drawn.set_item("bodies", bodies.into_pyarray(py))?;
    drawn.set_item("hull", hull)?;
    drawn.set_item("gears", gears)?;
    drawn.set_item("grousers", grousers)?;
    let [envelope, root_envelope] = model.envelopes(mount, BELT_TURN);
    drawn.set_item("envelope", points(py, &envelope))?;
    drawn.set_item("root_envelope", points(py, &root_envelope))?;
    Ok(drawn)
}

/// Points as rows.
fn points<'py>(py: Python<'py>, points: &[Vector]) -> Bound<'py, PyArray2<f64>> {
    let points: Vec<[f64; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
    rows(py, &points)
}

/// The toothed wheel of a chain as a gear is given: its outline when its drive has not run.
fn sprocket<'py>(py: Python<'py>, chain: &ChainOfShoes) -> PyResult<Option<Bound<'py, PyDict>>> {
    let Some(sprocket) = &chain.sprocket else {
        return Ok(None);
    };
    let (sine, cosine) = sprocket.angle(0.0).sin_cos();
    let turned = |p: &Vector| Vector::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
    let outline = sprocket.teeth.outline(0.5 * chain.plate_thickness);
    let outline: Vec<Vector> = outline.iter().map(turned).collect();
    let center = chain.ends[0].center;
    let drawn = PyDict::new(py);
    drawn.set_item("center", (center.x, center.y))?;
    drawn.set_item("radius", sprocket.teeth.drive_radius())?;
    drawn.set_item("drive", chain.number)?;
    drawn.set_item("outline", points(py, &outline))?;
    Ok(Some(drawn))
}

/// Wheels of both sides together, as an engine of bodies and joints would hold them.
fn wheels<'py>(py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let (_, wheels) = model.bodies();
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
    columns.set_item("body", body.into_pyarray(py))?;
    columns.set_item("x", column(|w| w.center.x))?;
    columns.set_item("y", column(|w| w.center.y))?;
    columns.set_item("radius", column(|w| w.radius))?;
    columns.set_item("area", column(|w| w.area))?;
    columns.set_item("mass", column(|w| w.mass))?;
    columns.set_item("moment_of_inertia", column(|w| w.moment_of_inertia))?;
    Ok(columns)
}

fn rows<'py, const N: usize>(py: Python<'py>, rows: &[[f64; N]]) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((rows.len(), N), |(i, j)| rows[i][j]).into_pyarray(py)
}

/// A pair of coordinates.
pub(crate) fn pair(py: Python<'_>, x: f64, y: f64) -> Bound<'_, PyArray1<f64>> {
    vec![x, y].into_pyarray(py)
}

/// Version and build of the compiled core.
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
