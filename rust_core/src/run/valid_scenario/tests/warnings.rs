//! Every warning begins at its limit, and says where the value is and what it should be.

use serde_json::{Value, json};

use super::super::ValidScenario;
use super::rules::{put, scene, value};

/// A scene; its first changes; a field; a value without a warning; one with a warning; the warning.
///
/// The Engineer is 0.365 m + 2 x 0.064 m = 0.493 m long, 0.128 m high and 0.2 m wide, and starts with its rear axle at
/// x = -0.529 m. It drives at 0.4 m/s.
const WARNINGS: &str = r#"
belt | | /robot/center_of_mass | [0.492,0.02] | [0.494,0.02] | robot.center_of_mass[0] = 0.494 is usually at most 0.493 m, the robot's length
belt | | /robot/center_of_mass | [0,-0.492] | [0,-0.494] | robot.center_of_mass[1] = -0.494 is usually at most 0.493 m, the robot's length
belt | | /robot/mass | 600.4 | 600.5 | robot.mass = 600.5 is usually at most 600.428 kg, the mass of gold of its length and height
belt | /robot/gauge=1 | /robot/mass | 1217 | 1218.5 | robot.mass = 1218.5 is usually at most 1217.907 kg, the mass of gold of its length and height
belt | /robot/track_mass=0.01 | /robot/mass | 0.0374 | 0.0373 | robot.mass = 0.0373 is usually at least 0.037 kg, the mass of air of its length and height
belt | | /robot/moment_of_inertia | 5.15 | 5.16 | robot.moment_of_inertia = 5.16 is usually at most 5.153 kg m^2, mass x the square of the robot's length
chain | | /robot/track/pin_stiffness | 6.65 | 6.66 | robot.track.pin_stiffness = 6.66 is usually at most 6.655 N m/rad, with which
chain | | /robot/track/pin_damping | 0.306 | 0.307 | robot.track.pin_damping = 0.307 is usually at most 0.306 N m s/rad, with which
belt | | /robot/track | {"kind":"line","count":3,"wheel_radius":0.182,"wheel":{"kind":"round"},"as_track":true} | {"kind":"line","count":3,"wheel_radius":0.183,"wheel":{"kind":"round"},"as_track":true} | robot.track.wheel_radius = 0.183 is usually at most 0.18
hybrid | | /robot/track/placements | [[0.49,0,0.064]] | [[-0.5,0,0.064]] | robot.track.placements[0][0] = -0.5 is usually at most 0.493 m, the length of the outline
hybrid | | /robot/track/placements | [[0,0.49,0.064]] | [[0,0,0.064],[0,0.5,0.064]] | robot.track.placements[1][1] = 0.5 is usually at most 0.493 m, the length of the outline
hybrid | | /robot/track/placements | [[0,0,0.182]] | [[0,0,0.183]] | robot.track.placements[0][2] = 0.183 is usually at most 0.18
flippers | | /robot/flippers/angle | 3.14 | 3.15 | robot.flippers.angle = 3.15 is usually between -3.14 and 3.14 rad, because angles are in radians
flippers | /robot/flippers/track={"kind":"line","count":3,"wheel_radius":0.04,"wheel":{"kind":"round"},"as_track":true} | /robot/flippers/tip_radius | 0.037 | 0.036 | robot.flippers.tip_radius = 0.036 has no effect, because robot.flippers.track.wheel_radius = 0.04 m sets the radius
flippers | | /drive/gait | {"kind":"hold","angle":3.14,"schedule":null} | {"kind":"hold","angle":-3.15,"schedule":null} | drive.gait.angle = -3.15 is usually between -3.14 and 3.14 rad, because angles are in radians
flippers | | /drive/gait | {"kind":"hold","angle":0,"front":-3.14,"schedule":null} | {"kind":"hold","angle":0,"front":3.15,"schedule":null} | drive.gait.front = 3.15 is usually between
flippers | | /drive/gait | {"kind":"hold","angle":0,"rear":-3.14,"schedule":null} | {"kind":"hold","angle":0,"rear":3.15,"schedule":null} | drive.gait.rear = 3.15 is usually between
flippers | | /drive/gait | {"kind":"hold","angle":0,"schedule":[[1,0],[2,3.14]]} | {"kind":"hold","angle":0,"schedule":[[1,0],[2,3.15]]} | drive.gait.schedule[1][1] = 3.15 is usually between
flippers | | /drive/gait/reach_angle | 3.14 | 3.15 | drive.gait.reach_angle = 3.15 is usually between
flippers | | /drive/gait/sweep_angle | 3.14 | 3.15 | drive.gait.sweep_angle = 3.15 is usually between
flippers | | /drive/gait/push_angle | 3.14 | 3.15 | drive.gait.push_angle = 3.15 is usually between
belt | /goal=2 | /duration | 3.69 | 3.7 | goal = 2 cannot be reached: it is 2.593 m away, and 0.4 m/s takes the robot 1.480 m in 3.7 s
belt | /duration=4 | /goal | 1 | 1.01 | goal = 1.01 cannot be reached: it is 1.603 m away, and 0.4 m/s takes the robot 1.600 m in 4 s
belt | /duration=4; /goal=2 | /drive/schedule | [[1,0.7]] | [[1,0.6],[2,0]] | goal = 2 cannot be reached: it is 2.593 m away, and 0.6 m/s takes the robot 2.400 m in 4 s
belt | /terrain={"kind":"flat","length":20,"friction":0.9} | /duration | 17.2 | 17.1 | duration = 17.1 is too short for the goal: it is 20.593 m away, and 0.4 m/s takes the robot 6.840 m in 17.1 s
points | /duration=100 | /goal | 8.57 | 8.58 | goal = 8.58 cannot be cleared: beyond 8.571 m the robot leaves the ground, which ends at 9.000 m
points | | /terrain/goal | 8.57 | 8.58 | terrain.goal = 8.58 cannot be cleared: beyond 8.571 m the robot leaves the ground, which ends at 9.000 m
points | | /goal | -0.592 | -0.594 | goal = -0.594 is behind the robot at its start, which clears where it stands
points | | /terrain/goal | -0.592 | -0.594 | terrain.goal = -0.594 is behind the robot at its start, which clears where it stands
belt | /duration=1 | /start/approach | 0.49 | 0.5 | start.approach = 0.5 is longer than the run: 0.4 m/s takes the robot 0.400 m in 1 s
belt | /duration=2 | /start/approach | 0.79 | 0.81 | start.approach = 0.81 is longer than the run: 0.4 m/s takes the robot 0.800 m in 2 s
belt | | /gravity | 30 | 30.1 | gravity = 30.1 is usually at most 30.000 m/s^2, more than on any planet
belt | | /solver/contact_frequency | 22.5 | 22.4 | solver.contact_frequency = 22.4 is so low that the robot sinks up to 4.95e-4 m into rigid ground
belt | | /terrain/height | 1.478 | 1.48 | terrain.height = 1.48 is usually at most 1.479 m, three times the robot's length
belt | | /terrain/friction | 3 | 3.01 | terrain.friction = 3.01 is usually at most 3, three times that of rubber on dry concrete
points | | /terrain/segment_friction | [3] | [3.01] | terrain.segment_friction[0] = 3.01 is usually at most 3, three times that of rubber
lanes | | /terrain/right | {"kind":"flat","length":1,"friction":3} | {"kind":"flat","length":1,"friction":3.01} | terrain.right.friction = 3.01 is usually at most 3, three times
"#;

/// Warnings about a scene, written as in the table.
fn warnings(scene: &Value) -> Vec<String> {
    let checked = ValidScenario::from_json(&scene.to_string()).expect("it is valid");
    let warnings = checked.warnings().iter();
    let written =
        warnings.map(|warning| format!("{} = {} {}", warning.path, warning.value, warning.reason));
    written.collect()
}

#[test]
fn every_warning_begins_at_its_limit() {
    for row in WARNINGS.trim().lines() {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [name, changes, field, likely, unlikely, warning] = cells[..] else {
            panic!("{row}");
        };
        let mut scene = scene(name);
        for change in changes.split("; ").filter(|change| !change.is_empty()) {
            let (field, text) = change.split_once('=').expect("a field and a value");
            put(&mut scene, field, value(text));
        }
        put(&mut scene, field, value(likely));
        let (path, _) = warning.split_once('=').expect("a field and a value");
        let found = warnings(&scene);
        let is_there = found.iter().any(|found| found.starts_with(path));
        assert!(!is_there, "{row}\n{found:?}");
        put(&mut scene, field, value(unlikely));
        let found = warnings(&scene);
        let is_there = found.iter().any(|found| found.starts_with(warning));
        assert!(is_there, "{row}\n{found:?}");
    }
}

#[test]
fn the_shared_scenes_have_no_warning() {
    for name in [
        "belt",
        "chain",
        "flippers",
        "force",
        "gear3",
        "grouser_belt",
        "hybrid",
        "sprocket",
    ] {
        assert!(warnings(&scene(name)).is_empty(), "{name}");
    }
}

/// The first warning about the robot is the likely reason why it does not fit at its start.
#[test]
fn an_error_at_the_start_has_the_first_warning_about_the_robot() {
    let mut scene = scene("points");
    put(&mut scene, "/robot/moment_of_inertia", json!(6.0));
    put(&mut scene, "/start/approach", json!(9.0));
    let error = ValidScenario::from_json(&scene.to_string()).expect_err("there is no ground");
    let why = " (robot.moment_of_inertia = 6 is usually at most 5.153 kg m^2, ";
    assert!(error.to_string().contains(why), "{error}");
}
