//! Data of a run for the scripts of `pictures/page`: the same as `pictures/page/recording.py` writes into a page.

use std::collections::HashSet;

use crawler2d_core::{
    Body, BodyKind, Cancel, Error, Event, Poses, Profile, Robot, Run, ValidScenario, Vector, poses,
};
use serde_json::{Value, json};

use crate::carrier::{self, Carrier, Pose, relative};
use crate::columns::{Columns, Place, Varying};
use crate::extent;

/// [m] Resolution of positions on the chassis or a flipper.
const PLACE: f64 = 5e-5;
/// [m] Resolution of a rotation, as the movement of a body's farthest point.
const RIM: f64 = 1e-4;
/// [%] Percentile that sets the scale of arrows for a whole run.
const USUAL: f64 = 98.0;

/// The data of a run, whose history must have been recorded.
pub(crate) fn of(
    checked: &ValidScenario,
    run: &Run,
    columns: &mut Columns,
) -> Result<Value, Error> {
    let (model, ground, scenario) = (checked.model(), checked.ground(), checked.scenario());
    let found = poses(checked, &run.trace, &Cancel::default())?;
    let bodies = model.outlines();
    let carriers = carrier::all(
        (model, ground),
        &bodies,
        (&run.trace, &found),
        scenario.criteria.intrusion_depth,
    );
    let carrier_of = |body: usize| {
        let name = model.carrier(bodies[body].mount);
        carriers.iter().position(|each| each.name == name)
    };
    let goal = ground.goal_of(scenario);
    let lanes = &ground.lanes[..ground.tracks];
    Ok(json!({
        "extent": extent::of(&carriers, ground),
        "frames": frames(run, columns),
        "contacts": contacts(checked, run, columns),
        "events": run.events.iter().map(|each| event(each, &carrier_of)).collect::<Vec<_>>(),
        "ground": {
            "lanes": lanes.iter().map(|each| lane(each, columns)).collect::<Vec<_>>(),
            "goal": goal,
        },
        "ghosts": [],
        "robot": RobotDrawing {
            robot: &scenario.robot,
            bodies: &bodies,
            poses: &found,
            columns,
            varying: Varying::default(),
            outlines: Outlines::default(),
        }.all(&carriers),
    }))
}

fn frames(run: &Run, columns: &mut Columns) -> Value {
    let trace = &run.trace;
    let coordinate = |i: usize| trace.position.iter().skip(i).step_by(2).copied();
    json!({
        "count": trace.time.len(),
        "time": columns.add(trace.time.iter().copied()),
        "x": columns.add(coordinate(0)),
        "y": columns.add(coordinate(1)),
        "angle": columns.add(trace.chassis_angle.iter().copied()),
        "speed": columns.add(trace.track_speed.iter().copied()),
        "commanded": columns.add(trace.commanded_speed.iter().copied()),
    })
}

/// The contacts in the order of the frames; `counts` has their number in each frame.
fn contacts(checked: &ValidScenario, run: &Run, columns: &mut Columns) -> Value {
    let (table, scenario) = (&run.contacts, checked.scenario());
    let mut counts = vec![0.0; run.trace.time.len()];
    for time in &table.time {
        counts[run.trace.time.partition_point(|t| t < time)] += 1.0;
    }
    let forces = table.normal_force.iter().zip(&table.friction_force);
    let forces = forces.map(|(normal, friction)| normal.hypot(*friction));
    let speeds = table.surface_speed.iter().map(|speed| speed.abs());
    let weight = scenario.robot.mass * scenario.gravity;
    let normals = table.normal_x.iter().zip(&table.normal_y);
    json!({
        "usual_force": usual(forces.collect(), weight),
        "usual_speed": usual(speeds.collect(), scenario.drive.speed.abs()),
        "counts": columns.add(counts),
        "x": columns.add(table.x.iter().copied()),
        "y": columns.add(table.y.iter().copied()),
        "normal": columns.add(normals.map(|(x, y)| y.atan2(*x))),
        "normal_force": columns.add(table.normal_force.iter().copied()),
        "friction_force": columns.add(table.friction_force.iter().copied()),
        "surface_speed": columns.add(table.surface_speed.iter().copied()),
    })
}

/// The size that sets the scale of arrows: a percentile of their sizes, but at least a typical one.
fn usual(mut sizes: Vec<f64>, typical: f64) -> f64 {
    let Some(last) = sizes.len().checked_sub(1) else {
        return typical;
    };
    sizes.sort_by(f64::total_cmp);
    let place = USUAL / 100.0 * last as f64;
    let (below, above) = (sizes[place as usize], sizes[place.ceil() as usize]);
    typical.max(below + place.fract() * (above - below))
}

/// An event; `carrier_of` finds the carrier of a body, of either track.
fn event(event: &Event, carrier_of: &impl Fn(usize) -> Option<usize>) -> Value {
    let bodies = event.bodies.map_or(Vec::new(), Vec::from);
    json!({
        "kind": event.kind.name(),
        "start": event.start,
        "end": event.end,
        "lane": event.side as i64,
        "edge": event.edge,
        "carrier": bodies.first().and_then(|body| carrier_of(*body)).unwrap_or(0),
        "bodies": bodies,
    })
}

fn lane(lane: &Profile, columns: &mut Columns) -> Value {
    // A rounded edge is marked on the ground, not where the sharp corner would be.
    let nearest = |x: f64, y: f64| {
        let distance = |i: &usize| (lane.points[*i] - Vector::new(x, y)).length();
        (0..lane.points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let edges = &lane.edges;
    json!({
        "lane": lane.side as i64,
        "profile": columns.add(flat(&lane.points)),
        "ids": edges.iter().map(|edge| edge.id).collect::<Vec<_>>(),
        "corners": edges.iter().map(|edge| nearest(edge.x, edge.y)).collect::<Vec<_>>(),
        "convex": edges.iter().map(|edge| edge.angle > 0.0).collect::<Vec<_>>(),
    })
}

/// Points as numbers, x before y.
fn flat(points: &[Vector]) -> impl Iterator<Item = f64> + '_ {
    points.iter().flat_map(|point| [point.x, point.y])
}

/// Outlines, each of which is written only once for all bodies that have it.
#[derive(Default)]
struct Outlines {
    points: Vec<Vec<Vector>>,
    places: Vec<Place>,
}

impl Outlines {
    fn index(&mut self, outline: &[Vector], columns: &mut Columns) -> usize {
        if let Some(index) = self.points.iter().position(|points| points == outline) {
            return index;
        }
        self.points.push(outline.to_vec());
        self.places.push(columns.add(flat(outline)));
        self.places.len() - 1
    }
}

/// A robot at all samples of a run.
struct RobotDrawing<'a> {
    robot: &'a Robot,
    bodies: &'a [Body],
    poses: &'a Poses,
    columns: &'a mut Columns,
    varying: Varying,
    outlines: Outlines,
}

impl RobotDrawing<'_> {
    fn all(mut self, carriers: &[Carrier]) -> Value {
        let all: Vec<Value> = carriers
            .iter()
            .map(|each| self.carrier(each, &carriers[0]))
            .collect();
        let (centers, _) = self.poses.centers_of_mass.as_chunks::<2>();
        let centers: Vec<Pose> = centers.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
        let [x, y, _] = self.pose(&centers, &carriers[0], 0.0);
        json!({
            "carriers": all,
            "mass_center": [x, y],
            "columns": self.varying.places,
            "outlines": self.outlines.places,
            "length": length(self.robot),
        })
    }

    fn carrier(&mut self, carrier: &Carrier, chassis: &Carrier) -> Value {
        let axles = match &self.robot.flippers {
            Some(flippers) if carrier.name != chassis.name => {
                let half = 0.5 * flippers.length;
                [[-half, 0.0], [half, 0.0]]
            }
            _ => self.robot.outline.end_discs().map(|[x, y, _]| [x, y]),
        };
        let [envelope, root] = &carrier.envelopes;
        let [x, y, angle] = self.pose(&carrier.poses, chassis, reach(envelope));
        let mut drawn = json!({
            "x": x,
            "y": y,
            "angle": angle,
            "axles": axles,
            "bodies": self.seen(carrier),
            "circuit": self.circuit(carrier),
            "envelope": null,
            "inner": null,
            "root": null,
        });
        if !carrier.closed {
            drawn["envelope"] = json!(self.columns.add(flat(envelope)));
            drawn["inner"] = json!(self.columns.add(flat(&carrier.inner)));
            if root != envelope {
                drawn["root"] = json!(self.columns.add(flat(root)));
            }
        }
        drawn
    }

    /// All bodies except the grousers of a belt; the pieces of a shoe are one body.
    fn seen(&mut self, carrier: &Carrier) -> Vec<Value> {
        let riders: HashSet<usize> = match carrier.circuit {
            Some(_) => carrier.grousers.iter().map(|each| each.0).collect(),
            None => HashSet::new(),
        };
        let mut drawn: Vec<Value> = Vec::new();
        let mut shoes: Vec<(usize, usize)> = Vec::new();
        for row in carrier
            .bodies
            .iter()
            .copied()
            .filter(|row| !riders.contains(row))
        {
            let body = &self.bodies[row];
            let outline = self.outlines.index(&body.outline, self.columns);
            let of_shoe = body.mount.shoe();
            if let Some((_, index)) = shoes.iter().find(|each| Some(each.0) == of_shoe) {
                if let Some(outlines) = drawn[*index]["outlines"].as_array_mut() {
                    outlines.push(json!(outline));
                }
                continue;
            }
            let [x, y, angle] = self.pose(&self.moving(row), carrier, reach(&body.outline));
            let mut new = json!({
                "x": x,
                "y": y,
                "angle": angle,
                "body": body.part.map_or(-1, |part| part as i64),
                "look": look(body),
                "outlines": [outline],
            });
            if let (Some(shoe), BodyKind::Shoe) = (of_shoe, body.kind) {
                shoes.push((shoe, drawn.len()));
                // A plate reaches from pin to pin, and is equally thick on both sides of the pins.
                let least = |value: fn(&Vector) -> f64| {
                    body.outline.iter().map(value).fold(f64::INFINITY, f64::min)
                };
                new["pin"] = json!(least(|p| p.x));
                new["pin_radius"] = json!(-0.5 * least(|p| p.y));
            }
            drawn.push(new);
        }
        drawn
    }

    fn circuit(&mut self, carrier: &Carrier) -> Option<Value> {
        let (belt, circuit) = carrier.circuit.as_ref()?;
        let samples = self.poses.travels.iter().skip(*belt);
        let travel: Vec<f64> = samples.step_by(self.poses.count).copied().collect();
        let column = |i: usize| circuit.poses.iter().map(move |pose| pose[i]);
        let outline = |(row, _): &(usize, f64)| {
            let points = &self.bodies[*row].outline;
            self.outlines.index(points, self.columns)
        };
        let grousers: Vec<usize> = carrier.grousers.iter().map(outline).collect();
        Some(json!({
            "travel": self.varying.add(self.columns, &travel, RIM),
            "length": circuit.ways.last(),
            "ways": self.columns.add(circuit.ways.iter().copied()),
            "x": self.columns.add(column(0)),
            "y": self.columns.add(column(1)),
            "angle": self.columns.add(column(2)),
            "grousers": grousers,
            "starts": carrier.grousers.iter().map(|each| each.1).collect::<Vec<_>>(),
            "pitch": self.robot.outline.grouser_pitch,
        }))
    }

    /// The poses of a body at all samples.
    fn moving(&self, row: usize) -> Vec<Pose> {
        let number = |sample: usize| sample * self.poses.count + row;
        let poses = 0..self.poses.samples;
        poses
            .map(|i| carrier::pose(&self.poses.bodies, number(i)))
            .collect()
    }

    /// Poses of a body with this reach [m], relative to its carrier.
    fn pose(&mut self, poses: &[Pose], carrier: &Carrier, reach: f64) -> [Value; 3] {
        let frames = poses.iter().zip(&carrier.poses);
        let moved: Vec<Pose> = frames
            .map(|(pose, frame)| relative(*pose, *frame))
            .collect();
        let turn = if reach > 0.0 {
            RIM / reach
        } else {
            f64::INFINITY
        };
        [0, 1, 2].map(|i| {
            let values: Vec<f64> = moved.iter().map(|pose| pose[i]).collect();
            let resolution = if i == 2 { turn } else { PLACE };
            self.varying.add(self.columns, &values, resolution)
        })
    }
}

/// How a body is drawn, as a name that the scripts know.
fn look(body: &Body) -> &'static str {
    match body.kind {
        BodyKind::Belly => "belly",
        _ if body.mount.shoe().is_some() => "shoe",
        BodyKind::Guide => "guide",
        _ if body.part.is_none() => "inside",
        BodyKind::Wheel | BodyKind::Sprocket => "wheel",
        BodyKind::Idler | BodyKind::RoadWheel | BodyKind::Roller => "chain wheel",
        BodyKind::Belt | BodyKind::Skid | BodyKind::Grouser | BodyKind::Shoe => "hull",
    }
}

/// [m] Distance of the farthest of the points from the origin.
fn reach(points: &[Vector]) -> f64 {
    points
        .iter()
        .map(|point| point.length())
        .fold(0.0, f64::max)
}

/// [m] Length of the robot that has to fit into the view: the track with one flipper stretched out.
fn length(robot: &Robot) -> f64 {
    let outline = &robot.outline;
    let (rear, front) = (outline.rear_radius(), outline.front_radius());
    let track = outline.axle_distance() + front + rear;
    let beyond = robot
        .flippers
        .as_ref()
        .map_or(0.0, |f| f.length + f.tip_radius);
    track + (beyond - rear.max(front)).max(0.0)
}
