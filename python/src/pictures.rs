//! Arrays of ground and robot that pictures need.

use crawler2d_core::{ChainOfShoes, Checked, Model, Mount, Part, Shape, Vector};
use numpy::{IntoPyArray, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::convert::{edges, rows};

/// Everything a picture needs; of two tracks, the right one, which is in front in a side view.
pub(crate) fn of<'py>(py: Python<'py>, checked: &Checked) -> PyResult<Bound<'py, PyDict>> {
    let (model, ground) = (checked.model(), checked.ground());
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
    let none = || points(py, &[]).into_any();
    result.set_item("belly", belly.get_item(0).unwrap_or_else(|_| none()))?;
    result.set_item("flippers", flippers)?;
    result.set_item("drive_radius", model.drive_radius)?;
    result.set_item("goal", ground.goal_of(checked.scenario()))?;
    Ok(result)
}

/// The track round the chassis or a flipper on a lane, in the frame of its carrier.
fn track<'py>(
    py: Python<'py>,
    model: &Model,
    (mount, lane): (Mount, usize),
) -> PyResult<Bound<'py, PyDict>> {
    /// Number of points of one root arc between two grousers.
    const ARC_POINTS: usize = 12;
    /// [rad] Turn between two points on a belt.
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
        // Parts without a drive are drawn with the first drive.
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

/// The sprocket of a chain, in the form of a gear wheel: its outline at the start.
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
