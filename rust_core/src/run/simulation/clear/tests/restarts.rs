//! Do trials come out alike when the robot is lifted off the ground at its stop and set down again nearby?
//!
//! The stops come from a file, a line each, which `tests/trials/test_restarts.py` writes and whose answers it reads.

use serde_json::{Value, json};

use super::super::*;
use crate::diagnosis::Change;
use crate::draw::Draw;
use crate::observe::Outcome;
use crate::run::{Checked, trials};

/// [m, rad] How far from the stop a robot is set down at most.
const AWAY: (f64, f64) = (1e-3, 1e-3);
/// [m] Between two heights at which it is tried, and the greatest.
const RISE: f64 = 5e-5;
const HIGHEST: f64 = 0.01;

/// At rest, displaced and lifted along its own normal until it is clear of the ground; `None` if it stays in it.
fn set_down(mut robot: Simulation, draw: &mut Draw) -> Option<Simulation> {
    robot.stand_still();
    let turn = draw.between(-AWAY.1, AWAY.1) * robot.half_length();
    let [x, y] = [0; 2].map(|_| draw.between(-AWAY.0, AWAY.0));
    robot.displace([x, y, turn]);
    let (sine, cosine) = libm::sincos(robot.state.angle);
    let mut rise = 0.0;
    while rise < HIGHEST {
        let up = [-sine * rise, cosine * rise, 0.0];
        if robot.contacts_at(up).iter().all(|c| c.distance > 0.0) {
            robot.displace(up);
            let mut contacts = robot.contacts_now();
            robot.dynamics.take_over(&mut contacts);
            robot.dents = Dents::default();
            return Some(robot);
        }
        rise += RISE;
    }
    None
}

/// Whether a robot gets ahead of where it had come [m], or clears, in the time of a trial.
fn gets_away(mut robot: Simulation, greatest: f64) -> bool {
    let end = robot.time() + trials::duration(&robot, Change::ClosedTrack);
    let (direction, far) = (robot.direction(), robot.scenario.criteria.escape_distance);
    while robot.time() < end && !robot.is_over() {
        robot.step_until(end).expect("the state stays finite");
        match robot.monitor.ended_as() {
            Some(outcome) => return outcome == Outcome::Cleared,
            None if direction * robot.reading().position.x - greatest > far => return true,
            None => {}
        }
    }
    false
}

#[test]
#[ignore = "takes its stops from a file that tests/trials writes"]
fn trials_from_other_starts() {
    let path = std::env::var("CRAWLER2D_STOPS").expect("a file of stops");
    let text = std::fs::read_to_string(&path).expect("it can be read");
    let mut draw = Draw(2026);
    let mut answers = Vec::new();
    for line in text.lines() {
        let stop: Value = serde_json::from_str(line).expect("a stop");
        let scenario = stop["scenario"].as_str().expect("a scenario");
        let at = stop["at"].as_f64().expect("a time");
        let checked = Checked::from_json(scenario).expect("a valid scenario");
        let mut robot = Simulation::new(&checked);
        let end = robot.scenario.duration;
        while robot.time() < at - crate::run::step_length::SAME_TIME.value() {
            robot.step_until(end).expect("the state stays finite");
        }
        let greatest = robot.monitor.best_advance();
        let mut again = serde_json::Map::new();
        for name in stop["trials"].as_array().expect("names") {
            let name = name.as_str().expect("a name");
            let change = Change::of_name(name).expect("a trial");
            let started = set_down(robot.copy(), &mut draw)
                .and_then(|down| trials::start(&down, change).expect("it can be built"));
            again.insert(
                name.to_owned(),
                started.map_or(Value::Null, |s| json!(gets_away(s, greatest))),
            );
        }
        answers.push(Value::Object(again).to_string());
    }
    std::fs::write(path + ".answers", answers.join("\n")).expect("it can be written");
}
