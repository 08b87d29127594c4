//! Arrays of ground and robot for pictures.

use crawler2d_core::{Body, Ground, Model, Mount, Part, Poses, Shape, ValidScenario, Vector};
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::convert::{column, edges, rows};

/// Ground, bodies of the robot, and carriers of the track that is in front in a side view, the right one of two.
pub(crate) fn of<'py>(py: Python<'py>, checked: &ValidScenario) -> PyResult<Bound<'py, PyDict>> {
    let (model, ground) = (checked.model(), checked.ground());
    let lanes = PyList::empty(py);
    for lane in &ground.lanes {
        lanes.append((lane.side as i64, points(py, &lane.points)))?;
    }
    let carriers = PyList::empty(py);
    for mount in model.mounts() {
        carriers.append(carrier(py, model, (mount, ground.tracks - 1))?)?;
    }
    let frictions = ground
        .lanes
        .iter()
        .map(|lane| lane.friction.most().coefficient);
    let result = PyDict::new(py);
    result.set_item("lanes", lanes)?;
    result.set_item("frictions", frictions.collect::<Vec<f64>>())?;
    result.set_item("edges", edges(py, &ground.edges())?)?;
    result.set_item("goal", ground.goal_of(checked.scenario()))?;
    result.set_item("bodies", bodies(py, model, ground)?)?;
    result.set_item("carriers", carriers)?;
    result.set_item("drive_radius", model.drive_radius)?;
    Ok(result)
}

/// The bodies as columns; those that are not parts have the number -1.
#[allow(clippy::cast_possible_wrap)] // indices are small
fn bodies<'py>(py: Python<'py>, model: &Model, ground: &Ground) -> PyResult<Bound<'py, PyDict>> {
    let found = model.outlines();
    let number = |index: Option<usize>| index.map_or(-1, |index| index as i64);
    let carriers: Vec<&str> = found.iter().map(|body| model.carrier(body.mount)).collect();
    let columns = PyDict::new(py);
    columns.set_item("body", column(py, &found, |body| number(body.part)))?;
    columns.set_item("kind", column(py, &found, |body| body.kind as i64))?;
    let lane = |body: &Body| ground.lanes[body.lane].side as i64;
    columns.set_item("lane", column(py, &found, lane))?;
    columns.set_item("carrier", carriers)?;
    let shoe = |body: &Body| number(body.mount.shoe());
    columns.set_item("shoe", column(py, &found, shoe))?;
    let radius = |body: &Body| body.radius.unwrap_or(f64::NAN);
    columns.set_item("radius", column(py, &found, radius))?;
    let outlines = PyList::empty(py);
    for body in &found {
        outlines.append(points(py, &body.outline))?;
    }
    columns.set_item("outline", outlines)?;
    Ok(columns)
}

/// A carrier of a track on a lane: the taut belts round its bodies, and everything that moves along its own belt.
fn carrier<'py>(
    py: Python<'py>,
    model: &Model,
    (mount, lane): (Mount, usize),
) -> PyResult<Bound<'py, PyDict>> {
    /// [rad] Change of direction between two points on a belt.
    const BELT_TURN: f64 = 0.05;

    let mut circles: Vec<[f64; 3]> = Vec::new();
    let mut numbers: Vec<usize> = Vec::new();
    let mut closed = !model.has_track(mount);
    let circuit = PyDict::new(py);
    let (mut grousers, mut starts): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    let of_track = |part: &Part| part.lane == lane && part.mount == mount;
    for (number, part) in model.parts.iter().enumerate().filter(|(_, p)| of_track(p)) {
        match &part.shape {
            Shape::Disc { center, radius } => circles.push([center.x, center.y, *radius]),
            Shape::Gear { center, gear } => circles.push([center.x, center.y, gear.radius]),
            Shape::Hull { discs, .. } => {
                closed = true;
                circles.extend(discs.iter().map(|d| [d.center.x, d.center.y, d.radius]));
            }
            Shape::Grouser(grouser) => {
                grousers.push(number);
                starts.push(grouser.start());
            }
            Shape::Polygon { .. } => {}
        }
        numbers.resize(circles.len(), number);
        if let Some(found) = part.circuit() {
            circuit.set_item("belt", number)?;
            circuit.set_item("ways", found.ways.into_pyarray(py))?;
            circuit.set_item("poses", rows(py, &found.poses))?;
        }
    }
    circuit.set_item("grousers", grousers.into_pyarray(py))?;
    circuit.set_item("starts", starts.into_pyarray(py))?;
    let drawn = PyDict::new(py);
    drawn.set_item("name", model.carrier(mount))?;
    drawn.set_item("circles", rows(py, &circles))?;
    drawn.set_item("bodies", numbers.into_pyarray(py))?;
    drawn.set_item("closed", closed)?;
    drawn.set_item("circuit", circuit.contains("belt")?.then_some(circuit))?;
    let [envelope, root_envelope] = model.envelopes(mount, BELT_TURN);
    drawn.set_item("envelope", points(py, &envelope))?;
    drawn.set_item("root_envelope", points(py, &root_envelope))?;
    Ok(drawn)
}

/// The poses as arrays, whose first axis is the sample.
pub(crate) fn poses(py: Python<'_>, found: Poses) -> PyResult<Bound<'_, PyDict>> {
    let (n, bodies, arms) = (found.samples, found.count, found.flippers);
    let columns = PyDict::new(py);
    let poses = |values: Vec<f64>, count| values.into_pyarray(py).reshape([n, count, 3]);
    let rows = |values: Vec<f64>, width| values.into_pyarray(py).reshape([n, width]);
    columns.set_item("bodies", poses(found.bodies, bodies)?)?;
    columns.set_item("arms", poses(found.arms, arms)?)?;
    columns.set_item("travels", rows(found.travels, bodies)?)?;
    columns.set_item("center_of_mass", rows(found.centers_of_mass, 2)?)?;
    Ok(columns)
}

/// Points as rows.
fn points<'py>(py: Python<'py>, points: &[Vector]) -> Bound<'py, PyArray2<f64>> {
    let points: Vec<[f64; 2]> = points.iter().map(|p| [p.x, p.y]).collect();
    rows(py, &points)
}
