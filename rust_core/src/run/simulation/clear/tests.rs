//! The nearest clear pose against a search on a grid; and whether trials have the same results when the robot is lifted
//! off the ground at its stop and set down nearby. Those stops come from a file, one per line, which
//! `tests/trials/test_restarts.py` writes, and whose answers it reads.

use serde_json::{Value, json};

use super::*;
use crate::diagnosis::Change;
use crate::draw::Draw;
use crate::observe::Outcome;
use crate::run::{ValidScenario, trials};
use crate::scenario::{Surface, Terrain, shared};

/// A belt in front of a post whose top is at a height [m], moved onto it by `way` from its start.
fn on_a_post(height: f64, way: Displacement) -> Simulation {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.belly = None;
    scenario.terrain = Terrain::Barrier {
        height,
        thickness: 0.01,
        surface: Surface::sharp(0.9),
    };
    let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
    let mut simulation = Simulation::new(&checked);
    let onto = -simulation.reading().position.x + way[0];
    simulation.displace([onto, way[1], way[2]]);
    simulation
}

/// [m] Deepest overlap after a displacement.
fn overlap(simulation: &mut Simulation, way: Displacement) -> f64 {
    let found = simulation.contacts_at(way);
    found
        .iter()
        .map(|contact| -contact.distance)
        .fold(0.0, f64::max)
}

/// However long the directions of the walls are.
#[test]
fn the_nearest_point_beyond_walls_is_on_those_that_hold_it_back() {
    let wall = |along: [f64; 3], bound: f64| (along, bound);
    for (walls, expected) in [
        (vec![], [0.0; 3]),
        (vec![wall([0.0, 1.0, 0.0], -1.0)], [0.0; 3]),
        (vec![wall([0.0, 0.0, 2.0], 1.0)], [0.0, 0.0, 0.5]),
        (vec![wall([3.0, 4.0, 0.0], 10.0)], [1.2, 1.6, 0.0]),
        // Two at a right angle, and a third that is not reached, or reached alone.
        (
            vec![wall([1.0, 0.0, 0.0], 1.0), wall([0.0, 2.0, 0.0], 1.0)],
            [1.0, 0.5, 0.0],
        ),
        (
            vec![wall([1.0, 0.0, 0.0], 1.0), wall([1.0, 0.0, 1.0], 3.0)],
            [1.5, 0.0, 1.5],
        ),
        (
            vec![wall([1.0, 0.0, 1.0], 3.0), wall([1.0, 0.0, 0.0], 2.0)],
            [2.0, 0.0, 1.0],
        ),
    ] {
        let found = nearest_beyond(&walls);
        let off = [0, 1, 2].map(|i| (found[i] - expected[i]).abs());
        // Sweeps end once they move it by a hundredth of a nanometre.
        assert!(off.iter().all(|off| *off < 1e-9), "{walls:?}: {found:?}");
    }
}

#[test]
fn arms_are_moved_with_their_robot() {
    let scenario = shared("engineer_flippers_step");
    let mut robot = Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"));
    let (before, half) = (robot.reading(), robot.half_length());
    robot.displace([0.1, 0.2, 0.3 * half]);
    let turned = robot.reading().chassis_angle - before.chassis_angle;
    assert!((turned - 0.3).abs() < 1e-15);
    // Their angles over the chassis stay.
    assert!(
        robot
            .flipper_angles()
            .all(|angle| (angle - 0.8).abs() < 1e-15)
    );
}

#[test]
fn a_robot_is_raised_straight_up_from_its_own_floor() {
    for turn in [-0.4, 0.3] {
        let mut buried = on_a_post(0.05, [0.0, 0.0, 0.0]);
        let half = buried.half_length();
        buried.displace([0.0, 0.0, turn * half]);
        let [x, y, turned] = buried.raised_clear().expect("there is room above it");
        assert!(turned == 0.0 && y > 0.0);
        assert!((x / y + libm::tan(turn)).abs() < 1e-12, "{x} {y}");
    }
}

#[test]
fn no_pose_of_a_grid_is_nearer_and_clear() {
    let poses = [
        (0.03, [0.0, 0.01, 0.0]),
        (0.05, [0.05, 0.03, 0.0]),
        (0.08, [-0.1, 0.05, 0.02]),
        (0.06, [0.17, 0.03, 0.03]),
        (0.05, [-0.2, 0.01, 0.0]),
    ];
    for (height, way) in poses {
        let mut buried = on_a_post(height, way);
        assert!(overlap(&mut buried, [0.0; 3]) > 5e-3, "{height} {way:?}");
        let before = buried.state.clone();
        let clear = on_a_post(height, way).clear_of_the_ground();
        let mut clear = clear.expect("there is one");
        assert!(overlap(&mut clear, [0.0; 3]) < INSIDE.value());
        let moved = clear.state.center - before.center;
        let turned = (clear.state.angle - before.angle) * clear.half_length();
        let found = length([moved.x, moved.y, turned]);
        // Every pose of a grid that is nearer by a step of the grid has ground inside.
        let n = 12_i32;
        let step = found / f64::from(n);
        let mut nearer = 0;
        for i in -n..=n {
            for j in -n..=n {
                for k in -n..=n {
                    let there = [i, j, k].map(|cells| step * f64::from(cells));
                    if length(there) < found - step {
                        nearer += 1;
                        let inside = overlap(&mut buried, there);
                        assert!(
                            inside > INSIDE.value(),
                            "{height} {way:?}: {there:?}, {found} m"
                        );
                    }
                }
            }
        }
        assert!(nearer > 1000);
    }
}

#[test]
fn a_robot_that_is_clear_stays_where_it_is_and_rests() {
    let scenario = shared("engineer_belt_step");
    let mut moving =
        Simulation::new(&ValidScenario::new(&scenario).expect("the scenario is valid"));
    moving.advance(0.3).expect("the state stays finite");
    let (before, phase) = (moving.state.center, moving.reading().track_position);
    let clear = moving.clear_of_the_ground().expect("it is clear");
    let now = clear.reading();
    // Belts stand some micrometres in the ground.
    assert!((clear.state.center - before).length() < 2e-5);
    assert!(now.velocity.length() == 0.0 && now.track_speed == 0.0);
    assert!(now.track_position.to_bits() == phase.to_bits());
}

/// [m, rad] Largest distance from the stop at which a robot is set down.
const AWAY: (f64, f64) = (1e-3, 1e-3);
/// [m] Interval of the heights that are tried, and the largest one.
const RISE: f64 = 5e-5;
const HIGHEST: f64 = 0.01;

/// At rest, displaced and lifted along its own normal until it is clear of the ground; `None` if it never is.
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

/// Whether a robot gets farther than before [m], or clears, in the time of a trial.
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
        let checked = ValidScenario::from_json(scenario).expect("a valid scenario");
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
