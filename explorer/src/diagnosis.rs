//! A diagnosis as JSON, with the names that it has in Python.

use crawler2d_core::{Diagnosis, LoadedIntrusion, Mechanism, StopContact, Trial};
use serde_json::{Value, json};

/// The whole diagnosis, with contacts as columns.
pub(crate) fn of(d: &Diagnosis) -> Value {
    json!({
        "outcome": d.outcome.name(),
        "symptom": d.symptom.name(),
        "transient": d.is_transient(),
        "trials": d.trials.iter().map(trial).collect::<Vec<_>>(),
        "jammed": d.jammed,
        "mechanism": d.mechanism.map(Mechanism::name),
        "time": d.time,
        "since": d.since,
        "position": d.position,
        "chassis_angle": d.chassis_angle,
        "intrusion": d.intrusion.as_ref().map(intrusion),
        "contacts": contacts(&d.contacts),
        "belly_share": d.belly_share,
        "sliding_share": d.sliding_share,
        "stalled_share": d.stalled_share,
        "progress": d.progress,
        "stationary": d.stationary,
        "imbalance": d.imbalance,
        "certified": d.certified,
    })
}

/// The result of a trial; null stands for an infinite time.
fn trial(trial: &Trial) -> Value {
    let [x, y, angle] = trial.pose;
    let angles = trial.flipper_angles.iter().filter(|angle| !angle.is_nan());
    json!({
        "name": trial.name,
        "freed": trial.freed,
        "starts": trial.starts,
        "freeing": trial.freeing,
        "distance": trial.distance,
        "time": trial.time,
        "outcome": trial.outcome.name(),
        "jammed": trial.jammed,
        "intrusion": trial.intrusion.as_ref().map(intrusion),
        "duration": trial.duration,
        "position": [x, y],
        "chassis_angle": angle,
        "flipper_angles": angles.collect::<Vec<_>>(),
    })
}

fn intrusion(found: &LoadedIntrusion) -> Value {
    let place = &found.place;
    json!({
        "edge": place.edge,
        "edges": place.edges,
        "bodies": place.bodies,
        "body_kinds": found.kinds.map(|kind| kind as i64),
        "side": place.side.name(),
        "carrier": found.carrier,
        "depth": place.depth,
        "root_depth": place.root_depth,
        "x": place.x,
        "y": place.y,
        "force": found.force,
    })
}

fn contacts(found: &[StopContact]) -> Value {
    let whole = |value: fn(&StopContact) -> i64| found.iter().map(value).collect::<Vec<_>>();
    let number = |value: fn(&StopContact) -> f64| found.iter().map(value).collect::<Vec<_>>();
    let flag = |value: fn(&StopContact) -> bool| found.iter().map(value).collect::<Vec<_>>();
    json!({
        "body": whole(|c| c.body as i64),
        "body_kind": whole(|c| c.kind as i64),
        "x": number(|c| c.point.x),
        "y": number(|c| c.point.y),
        "normal_x": number(|c| c.normal.x),
        "normal_y": number(|c| c.normal.y),
        "normal_force": number(|c| c.normal_force),
        "friction_force": number(|c| c.friction_force),
        "surface_speed": number(|c| c.surface_speed),
        "slides": flag(|c| c.slides),
        "in_pocket": flag(|c| c.in_pocket),
    })
}
