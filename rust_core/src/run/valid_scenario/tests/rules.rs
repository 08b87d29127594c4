//! Every rule of a scenario refuses a value that breaks it, by path and rule, and accepts the last valid one.

use crate::scenario::shared_text;
use serde_json::{Value, json};

use super::super::{ValidScenario, place_of};

/// A scene; its first changes; a field; a valid value, if any; one that breaks a rule; the error. Values on bounds are
/// exact: sums of powers of two.
const RULES: &str = r#"
belt | /robot/mass=32; /robot/moment_of_inertia=100 | /robot/track_mass | 31.99968 | 31.9997 | robot.track_mass must leave a hundred-thousandth of robot.mass for the chassis: at most 31.99968 kg
belt | /robot/mass=32 | /robot/track_mass | 0.00032 | 0.000319 | robot.track_mass must be at least a hundred-thousandth of robot.mass, 0.00032 kg
belt | /robot/track_mass=2.5; /robot/outline/front_radius=0.0625; /robot/outline/rear_radius=0.0625 | /robot/moment_of_inertia | 0.00977 | 0.009765625 | robot.moment_of_inertia must exceed track_mass x radius^2 = 0.009765625 kg m^2, the inertia of the moving track
belt | | /robot/drivetrain/rotor_inertia | 44027 | 44029 | robot.drivetrain.rotor_inertia must be at most 100,000 times robot.moment_of_inertia, 44028
force | | /robot/drivetrain/self_locking | false | true | robot.drivetrain.self_locking must be false on a force track
belt | | /robot/drivetrain/torque_sharing | "track" | "wheel" | robot.drivetrain.torque_sharing must be "track" for a model without driven wheels
gear3 | | /robot/track | {"kind":"closed","of":{"kind":"belt"},"surface":"own"} | {"kind":"closed","of":{"kind":"closed","of":{"kind":"belt"},"surface":"own"},"surface":"own"} | robot.track.of must not be closed itself
hybrid | | /robot/track/placements | [[0,0,0.064]] | [] | robot.track.placements must place at least one wheel
chain | | /robot/track/road_wheel_count | null | 0 | robot.track.road_wheel_count must not be given for a guide, which has no wheels (mechanism "sprocket" has)
chain | | /robot/track/return_roller_count | null | 2 | robot.track.return_roller_count must not be given for a guide
sprocket | | /robot/track/mechanism | "guide" | "pulley" | robot.track.mechanism must be one of guide, sprocket
triangle | | /robot/track | {"kind":"belt"} | {"kind":"line","count":3,"wheel_radius":null,"wheel":{"kind":"round"},"as_track":true} | robot.track.kind must be another model round 3 discs
triangle | | /robot/track | {"kind":"force","support":"skids","skid_friction":0,"wheel_count":2} | {"kind":"force","support":"wheels","skid_friction":0,"wheel_count":2} | robot.track.support must be "skids" round 3 discs
triangle | /robot/track=CHAIN | /robot/track/mechanism | "guide" | "sprocket" | robot.track.mechanism must be "guide" round 3 discs
triangle | | /robot/track | {"kind":"closed","of":{"kind":"belt"},"surface":"own"} | {"kind":"closed","of":{"kind":"line","count":3,"wheel_radius":null,"wheel":{"kind":"round"},"as_track":true},"surface":"own"} | robot.track.of.kind must be another model round 3 discs
flippers | /criteria/intrusion_depth=0.00001 | /robot/flippers/tip_radius | 0.0121 | 0.012 | robot.flippers.tip_radius must exceed robot.outline.grouser_height = 0.012 m
flippers | /robot/mass=32 | /robot/flippers/mass | 0.00032 | 0.000319 | robot.flippers.mass must be at least a hundred-thousandth of robot.mass, 0.00032 kg
flippers | | /robot/flippers/rotor_inertia | 60212 | 60213 | robot.flippers.rotor_inertia must be at most 100,000 times robot.moment_of_inertia, 60212
flippers | /robot/mass=32; /robot/track_mass=2; /robot/moment_of_inertia=100 | /robot/flippers/mass | 14.9 | 15 | robot.flippers.mass must leave a hundred-thousandth of robot.mass for the chassis: arms (30 kg) and robot.track_mass together are more than 31.99968 kg
flippers | /robot/flippers/root_radius=0.1875; /robot/flippers/tip_radius=0.0625 | /robot/flippers/length | 0.126 | 0.125 | robot.flippers.tip_radius must differ from root_radius by less than the length
flippers | /robot/track={"kind":"hybrid","placements":[[0,0,0.064]],"wheel":{"kind":"round"}} | /robot/flippers/track | {"kind":"belt"} | null | robot.flippers.track must be given, because the robot's own track has wheels placed by hand
flippers | /robot/track={"kind":"circumferential","count":20,"wheel_radius":null,"wheel":{"kind":"gear","grouser_count":8,"grouser_height":null,"tip_thickness":0.001,"base_thickness":null,"phase_fraction":0}} | /robot/track/wheel/grouser_height | 0.004 | 0.02 | robot.flippers.track.wheel.grouser_height must be less than the radius of wheel 0, 0.01
flippers | | /robot/flippers/track | {"kind":"belt"} | CHAIN | robot.flippers.track must not be segmental
flippers | | /robot/flippers/track | null | {"kind":"closed","of":{"kind":"belt"},"surface":"own"} | robot.flippers.track must not be closed, because a closed robot.track closes the arms' too
flippers | | /robot/flippers/track | {"kind":"belt"} | {"kind":"force","support":"skids","skid_friction":0,"wheel_count":2} | robot.flippers.track must be a force track exactly when robot.track is one
flippers | /robot/track={"kind":"line","count":3,"wheel_radius":null,"wheel":{"kind":"round"},"as_track":true}; /robot/drivetrain/torque_sharing="wheel" | /robot/flippers/track | null | {"kind":"belt"} | robot.drivetrain.torque_sharing must be "track" for a model without driven wheels
flippers | | /robot/moment_of_inertia | 0.4 | 0.15 | robot.moment_of_inertia must exceed that of all moving parts; it leaves the chassis -
belt | | /robot/belly | [[-0.1,0],[0.1,0],[0,0.05]] | [[-0.1,0],[0.1,0]] | robot.belly must have at least 3 points
belt | | /robot/belly | null | [[-0.1,0],[0,0],[0.1,0],[0,0.05]] | robot.belly[1] must be a corner of a convex counter-clockwise polygon
belt | | /robot/belly | null | [[0,0.05],[0.1,0],[-0.1,0]] | robot.belly[1] must be a corner of a convex counter-clockwise polygon
belt | | /robot/belly | null | [[0,0.1],[-0.06,-0.08],[0.1,0.03],[-0.1,0.03],[0.06,-0.08]] | robot.belly must be a convex counter-clockwise polygon that goes round once
belt | | /robot/outline/grouser_height | 0.0639 | 0.064 | robot.outline.grouser_height must be less than the smaller radius, 0.064 m, to leave a belt
belt | | /robot/outline/grouser_thickness | 0.0479 | 0.048 | robot.outline.grouser_thickness must be less than the pitch, 0.048 m, or grousers would overlap
belt | | /robot/outline/discs | - | [[0,0,0.064],[0.1,0,0.064]] | robot.outline.axle_distance must not be given together with discs, which determine it
belt | /robot/outline/axle_distance=0.125; /robot/outline/rear_radius=0.0625 | /robot/outline/front_radius | 0.187 | 0.1875 | robot.outline.front_radius must differ from rear_radius by less than the axle distance
belt | /robot/outline/axle_distance=0.125; /robot/outline/front_radius=0.0625 | /robot/outline/rear_radius | 0.187 | 0.1875 | robot.outline.front_radius must differ from rear_radius by less than the axle distance
triangle | | /robot/outline/discs | [[-0.18,0,0.064],[0.18,0,0.064]] | [[-0.18,0,0.064]] | robot.outline.discs must have at least 2 discs, got 1 discs
triangle | | /robot/outline/discs | [[-0.0001,0,0.064],[0.0001,0.3,0.064]] | [[-0.00004,0,0.064],[0.00004,0.3,0.064]] | robot.outline.discs must have its rearmost and foremost discs at least 0.0001 m apart along x
triangle | | /robot/outline/discs | [[-0.001,0,0.064],[0.3,0,0.064]] | [[0,0,0.064],[0.3,0,0.064]] | robot.outline.discs must have the origin of the chassis frame between its end axles
triangle | | /robot/outline/discs | [[-0.3,0,0.064],[0.001,0,0.064]] | [[-0.3,0,0.064],[0,0,0.064]] | robot.outline.discs must have the origin of the chassis frame between its end axles
triangle | | /robot/outline/discs | [[-0.18,0,0.064],[0.18,0,0.064],[0.18,0.034,0.032]] | [[-0.18,0,0.064],[0.18,0,0.064],[0.18,0.032,0.032]] | robot.outline.discs[2] must not lie in another disc, discs[1]: no track would touch it, got [0.18, 0.032, 0.032]
triangle | | /robot/outline/discs | [[-0.18,0,0.064],[0.18,0,0.064],[0,0.001,0.064]] | [[-0.18,0,0.064],[0.18,0,0.064],[0,0,0.064]] | robot.outline.discs[2] must reach out of the hull of the others
grouser_belt | /robot/outline/grouser_thickness=0.001 | /robot/outline/grouser_pitch | 0.0053 | 0.0052 | robot.outline.grouser_pitch must be large enough for at most 200 grousers on a belt of
belt | | /drive/speed | -1.39 | -1.4 | drive.speed must not exceed robot.drivetrain.max_speed = 1.39 m/s
belt | | /drive/schedule | [[0,1],[1,-1.39],[2,1]] | [[0,1],[1,-1.4],[2,1]] | drive.schedule[1][1] must not exceed robot.drivetrain.max_speed = 1.39 m/s
belt | | /drive/schedule | [[1,0.1],[1.1,0.2]] | [[1,0.1],[1,0.2]] | drive.schedule[1][0] must be later than the previous entry, 1 s
flippers | | /drive/gait | {"kind":"hold","angle":1,"schedule":[[1,0],[2,0]]} | {"kind":"hold","angle":1,"schedule":[[1,0],[2,0],[1.5,0]]} | drive.gait.schedule[2][0] must be later than the previous entry, 2 s
belt | /robot/drivetrain/self_locking=true | /robot/drivetrain/controller | null | {"kind":"pi","gain":1,"integral":0} | robot.drivetrain.self_locking must be false with a controller
belt | /robot/drivetrain/torque_curve=[[0,6],[1,0]] | /robot/drivetrain/no_load_speed | null | 2 | robot.drivetrain.no_load_speed must not be given together with torque_curve
belt | | /robot/drivetrain/torque_curve | [[0,6]] | [] | robot.drivetrain.torque_curve must have at least one pair of a speed and a torque
belt | | /robot/drivetrain/torque_curve | null | [[0.1,6]] | robot.drivetrain.torque_curve[0][0] must be 0 m/s: the torque at rest
belt | | /robot/drivetrain/torque_curve | [[0,6.000000001]] | [[0,6.0000001]] | robot.drivetrain.torque_curve[0][1] must be max_torque = 6 N m, the torque at rest
belt | | /robot/drivetrain/torque_curve | [[0,6],[1,5],[1.1,4]] | [[0,6],[1,5],[1,4]] | robot.drivetrain.torque_curve[2][0] must exceed the speed of the pair before, 1 m/s
belt | | /robot/drivetrain/torque_curve | [[0,6],[1,5],[2,5]] | [[0,6],[1,5],[2,5.1]] | robot.drivetrain.torque_curve[2][1] must not exceed the torque of the pair before, 5 N m
belt | | /robot/drivetrain/controller | {"kind":"pi","gain":1,"integral":0} | {"kind":"pid","gain":1,"integral":0} | robot.drivetrain.controller.kind must be one of pi (did you mean pi?)
circumferential | | /robot/track/wheel_radius | 0.0639 | 0.064 | robot.track.wheel_radius must be less than the smaller radius of the outline, 0.064 m
circumferential | | /robot/track/count | 20 | 5 | robot.track.count must be larger: to touch each other, so few wheels would need a radius above 0.032 m, half the outline's
gear3 | /robot/track/wheel/tip_thickness=0.004 | /robot/outline/grouser_height | 0.001 | 0 | robot.track.wheel.grouser_height must be given and > 0 m, because the outline has no grousers
gear3 | | /robot/track/wheel/grouser_height | 0.03 | 0.064 | robot.track.wheel.grouser_height must be less than the radius of wheel 0, 0.064 m, to leave a root circle
gear3 | | /robot/outline/grouser_thickness | 0.001 | 0 | robot.track.wheel.tip_thickness must be given and > 0 m, because the outline's grousers have no thickness
gear3 | | /robot/track/wheel/base_thickness | 0.006 | 0.0059 | robot.track.wheel.base_thickness must be at least the thickness at the tip, 0.006 m
gear3 | | /robot/track/wheel/grouser_count | 54 | 55 | robot.track.wheel.tip_thickness must be less than 0.00593
gear3 | /robot/track/wheel/base_thickness=0.006 | /robot/track/wheel/grouser_count | 54 | 55 | robot.track.wheel.base_thickness must be less than 0.00593
gear3 | /robot/track/wheel/grouser_count=3 | /robot/track/wheel/base_thickness | 0.06 | 0.07 | robot.track.wheel.base_thickness must be at most 0.06
chain | | /robot/track/plate_thickness | 0.004 | 0.06 | robot.track.plate_thickness must leave room for a guide, whose smaller end would have a radius of -0.00
chain | | /robot/track/shoe_count | 40 | 3 | robot.track.shoe_count must be from 1
chain | | /robot/track_mass | 0.4 | 0.01 | robot.track_mass must be at least 0.
grouser_belt | | /robot/outline/grouser_height | 0.001 | 0 | robot.outline.grouser_height must be > 0 m for a belt with grousers
grouser_belt | | /robot/outline/grouser_thickness | 0.001 | 0 | robot.outline.grouser_thickness must be > 0 m for a belt with grousers
grouser_belt | | /robot/track/grouser_count | 170 | 190 | robot.track.grouser_count must be few enough to fit: the belt is 1.0
belt | /solver/accuracy=null | /solver/time_step | 0.0001 | null | solver.accuracy must be given if time_step is not
belt | | /solver/time_step | null | 0.0001 | solver.time_step must not be given together with accuracy
belt | /solver/accuracy=null; /robot/drivetrain/max_speed=5.12 | /solver/time_step | 0.00874 | 0.00876 | solver.time_step must be so short that no wheel or flipper turns by more than 0.7 rad (here 0.701 rad)
flippers | /solver/accuracy=null; /robot/flippers/rate_limit=100 | /solver/time_step | 0.0069 | 0.0071 | solver.time_step must be so short that no wheel or flipper turns by more than 0.7 rad (here 0.710 rad)
belt | | /criteria/intrusion_depth | 0.0639 | 0.064 | criteria.intrusion_depth must be less than the smallest radius of the track model, 0.064 m
chain | | /solver/restitution | 0 | 0.1 | solver.restitution must be 0 where robot.track.kind is segmental
points | | /terrain/points | [[-9,0],[9,0]] | [[-9,0],[-9,0]] | terrain.points must have at least 2 distinct points
points | | /terrain/points | [[-9,0],[0,0],[0,1],[9,1]] | [[-9,0],[0,0],[-0.1,1],[9,1]] | terrain.points[2] must not lie behind its neighbour at x = 0: overhangs are not allowed
points | | /terrain/points | [[-9,0],[0,0],[0,1],[0,2],[9,2]] | [[-9,0],[0,0],[0,1],[0,0.5],[9,1]] | terrain.points[2] must not be a spike, where segments 1 and 2 coincide
points | | /terrain/points | - | [[0,0],[0,1]] | terrain.points must extend along x, not be only a vertical wall
points | | /terrain/goal | 9 | 9.1 | terrain.goal must lie on the terrain, from -9 to 9 m
points | | /terrain/goal | -9 | -9.1 | terrain.goal must lie on the terrain, from -9 to 9 m
points | | /terrain/segment_friction | [0.9] | [0.9,0.8] | terrain.segment_friction must have one number for each of 1 segments between points, got 2 numbers
points | | /start/approach | 8 | 9 | terrain must reach under the whole robot at its start, from x = -9.
belt | | /terrain/edge_radius | 0.08 | 0.081 | terrain.edge_radius must fit the edge at (0, 0.08), whose arc needs 0.08
lanes | | /terrain/left | {"kind":"flat","length":1,"friction":0.9} | {"kind":"lanes","left":{"kind":"flat","length":1,"friction":0.9},"right":{"kind":"flat","length":1,"friction":0.9},"middle":null} | terrain.left must be a terrain with a single profile, got lanes
lanes | | /terrain/middle | null | {"kind":"diagonal_barrier","yaw":0.1,"height":0.1,"thickness":0.1,"edge_radius":0,"friction":0.9} | terrain.middle must be a terrain with a single profile, got diagonal_barrier
lanes | | /terrain/right | {"kind":"flat","length":1,"friction":0.9} | {"kind":"random_stepfield","seed":1,"pattern":"hill","posts":10,"post":0.1,"rise":0.1,"levels":1,"barrier_height":0,"barrier_thickness":0.1,"barrier_yaw":0,"edge_radius":0,"friction":0.9} | terrain.right must be a terrain with a single profile, got random_stepfield
lanes | | /terrain/left | {"kind":"points","points":[[-9,0],[2,0]],"goal":1,"edge_radius":0,"friction":0.9} | {"kind":"points","points":[[-9,0],[-8,0]],"goal":-8,"edge_radius":0,"friction":0.9} | terrain must have lanes
rapier | | /solver/contact | "own" | "reference" | solver.contact must be own where solver.engine is rapier, which has contacts of its own
rapier | | /solver/iterations | null | 4 | solver.iterations must be null where solver.engine is rapier, which has a number of its own
rapier | | /solver/contact_frequency | 1000 | 999 | solver.contact_frequency must be its default, 1000, where solver.engine is rapier, which has a value of its own
rapier | | /solver/restitution | 0 | 0.1 | solver.restitution must be its default, 0, where solver.engine is rapier
rapier | /solver/time_step=null | /solver/accuracy | - | 1e-6 | solver.accuracy must be null where solver.engine is rapier, which has a time_step instead
rapier | /terrain={"kind":"points","points":[[-9,0],[9,0]],"goal":8,"edge_radius":0,"friction":0.9} | /terrain/segment_friction | - | [0.8] | terrain.segment_friction must be null where solver.engine is rapier, whose lanes have one friction each
rapier | | /terrain | - | {"kind":"lanes","left":{"kind":"flat","length":1,"friction":0.9},"right":{"kind":"points","points":[[-9,0],[9,0]],"goal":8,"edge_radius":0,"friction":0.9,"segment_friction":[0.8]},"middle":null} | terrain.right.segment_friction must be null where solver.engine is rapier
rapier | | /robot/drivetrain/rotor_inertia | 0 | 0.1 | robot.drivetrain.rotor_inertia must be 0 where solver.engine is rapier: its motors hold their speed there
rapier | | /robot/drivetrain/no_load_speed | null | 2 | robot.drivetrain.no_load_speed must be null where solver.engine is rapier
rapier | | /robot/drivetrain/torque_curve | null | [[0,6]] | robot.drivetrain.torque_curve must be null where solver.engine is rapier
rapier | | /robot/drivetrain/controller | null | {"kind":"pi","gain":1,"integral":0} | robot.drivetrain.controller must be null where solver.engine is rapier
rapier | | /robot/drivetrain/self_locking | false | true | robot.drivetrain.self_locking must be false where solver.engine is rapier
rapier | | /robot/track | {"kind":"force","support":"skids","skid_friction":0,"wheel_count":2} | {"kind":"belt"} | robot.track.kind must be line, circumferential, hybrid or force where solver.engine is rapier, which has no surface that a motor with a limit moves, got belt
rapier | | /robot/track | - | {"kind":"grouser_belt","grouser_count":null} | robot.track.kind must be line, circumferential, hybrid or force where solver.engine is rapier, which has no surface that a motor with a limit moves, got grouser_belt
rapier | | /robot/track | - | {"kind":"closed","of":{"kind":"belt"},"surface":"own"} | which has no surface that a motor with a limit moves, got closed
rapier | | /robot/track | - | CHAIN | which would need a tensioner and shoes in contact with each other, which are not built there, got segmental
rapier | | /robot/flippers | null | ARMS | robot.flippers must be null where solver.engine is rapier: arms and their servos are not built there
belt | | /robot/name | "x" | 5 | robot.name must be a string, got 5
belt | | /robot/mass | 20 | "20" | robot.mass must be a number, got "20"
belt | | /robot/mass | 20 | "NaN" | robot.mass must be a finite number, got NaN
belt | | /robot/drivetrain/max_torque | 1e17 | 1.1e17 | robot.drivetrain.max_torque must be >= 0 N m and <= 1e17 N m, got 1.1e+17
belt | | /robot/gauge | 0.0001 | 0.000099 | robot.gauge must be >= 0.0001 m and <= 100 m, got 0.000099
belt | | /gravity | 0 | -0.1 | gravity must be >= 0 m/s^2 and <= 1000 m/s^2, got -0.1
belt | | /gravity | 0 | 1e-310 | gravity must be 0 or at least 2.2250738585072014e-308 in magnitude
belt | | /robot/drivetrain/max_speed | 100 | 0 | robot.drivetrain.max_speed must be > 0 m/s and <= 100 m/s, got 0
belt | | /criteria/stop_pitches | 0 | -1 | criteria.stop_pitches must be >= 0 and <= 1000, got -1
belt | | /criteria/stationary_windows | 1000 | 1001 | criteria.stationary_windows must be an integer from 1 to 1000, got 1001
belt | | /criteria/stationary_windows | 1 | 0 | criteria.stationary_windows must be an integer from 1 to 1000, got 0
belt | | /criteria/stationary_windows | 3 | 3.5 | criteria.stationary_windows must be an integer from 1 to 1000, got 3.5
belt | | /robot/drivetrain/self_locking | true | 1 | robot.drivetrain.self_locking must be true or false, got 1
belt | | /robot/center_of_mass | [0,0] | [0] | robot.center_of_mass must be [x, y], got [0]
belt | | /robot/center_of_mass | [0,0.01] | [0,101] | robot.center_of_mass[1] must be >= -100 m and <= 100 m, got 101
belt | | /robot/belly | null | 5 | robot.belly must be a list of [x, y], got 5
belt | | /robot/belly | null | [[0,0],[0.1]] | robot.belly[1] must be [x, y], got [0.1]
points | | /terrain/segment_friction | [0.9] | 0.9 | terrain.segment_friction must be a list of numbers, got 0.9
points | | /terrain/segment_friction | [0.9] | ["a"] | terrain.segment_friction[0] must be a number, got "a"
belt | | /robot/track/kind | "belt" | "bolt" | robot.track.kind must be one of line, circumferential, hybrid, belt, grouser_belt, segmental, force, closed (did you mean belt?), got bolt
belt | | /robot/track/kind | "belt" | "none of these" | robot.track.kind must be one of line, circumferential, hybrid, belt, grouser_belt, segmental, force, closed, got none of these
belt | | /robot/weight | - | 5 | robot.weight must be a known field:
belt | | /speed | - | 5 | speed must be a known field:
belt | | / | - | 5 | "" must be a known field:
belt | | /robot | - | 5 | robot must be an object, got 5
belt | | /schema | 2 | 1 | schema must be
belt | | /gravity | 9.81 | [1111111111,1111111111,1111111111,1111111111,1111111111,1111111111,1111111111,1111111111] | gravity must be a number, got [1111111111,1111111111,1111111111,1111111111,1111111111,1111111111,1111111111,11...
"#;

/// Texts that are not scenarios: a part of the belt's, its replacement, the error.
const TEXTS: [[&str; 3]; 9] = [
    [
        r#"{"schema""#,
        r#"{{"schema""#,
        "scenario must be JSON (key must be a string",
    ],
    [
        r#""gravity":9.81"#,
        r#""gravity":9.81,"gravity":9.81"#,
        "gravity must be given only once, got 9.81",
    ],
    [
        r#""mass":21.2"#,
        r#""mass":1e400"#,
        "robot.mass must be a number that fits in float64, got 1e400",
    ],
    [
        r#""mass":21.2"#,
        r#""mass":1e-400"#,
        "robot.mass must be a number that fits in float64, got 1e-400",
    ],
    [
        r#""center_of_mass":[0.0,0.02]"#,
        r#""center_of_mass":[0.0,1e400]"#,
        "robot.center_of_mass[1] must be a number that fits in float64",
    ],
    [
        r#""name":"engineer""#,
        r#""name":"\ud800""#,
        "robot.name must be valid Unicode",
    ],
    [
        r#""goal":null"#,
        r#""goal":[[[[[[[[[[[[1]]]]]]]]]]]]"#,
        "scenario must not be nested more than 12 levels deep",
    ],
    [r#""schema": 2,"#, "", "schema must be given, got nothing"],
    [
        r#""mass":21.2"#,
        r#""mas":21.2"#,
        "robot.mass must be given (is mas a misspelling of it?), got nothing",
    ],
];

/// The Engineer in front of a step.
fn engineer(on: &str) -> Value {
    let text = shared_text(&format!("engineer_{on}_step"));
    serde_json::from_str(&text).expect("it is JSON")
}

/// Such a scene, or one made of it.
pub(super) fn scene(name: &str) -> Value {
    let with = |name, field: &str, value| {
        let mut scene = engineer(name);
        put(&mut scene, field, value);
        scene
    };
    match name {
        "triangle" => {
            let mut outline = json!({"grouser_height": 0.012, "grouser_pitch": 0.048, "grouser_thickness": 0.006});
            outline["discs"] = json!([[-0.18, 0, 0.064], [0.18, 0, 0.064], [0, 0.1, 0.064]]);
            with("belt", "/robot/outline", outline)
        }
        "circumferential" => {
            let track = json!({"kind": name, "count": 20, "wheel_radius": null, "wheel": {"kind": "round"}});
            with("belt", "/robot/track", track)
        }
        "points" => {
            let ground = json!({"kind": name, "points": [[-9, 0], [9, 0]], "goal": 8, "edge_radius": 0, "friction": 0.9});
            with("belt", "/terrain", ground)
        }
        "lanes" => {
            let flat = |length| json!({"kind": "flat", "length": length, "friction": 0.9});
            let ground =
                json!({"kind": name, "left": flat(1.0), "right": flat(1.5), "middle": null});
            with("belt", "/terrain", ground)
        }
        "rapier" => {
            let mut scene = with("gear3", "/solver/engine", json!(name));
            put(&mut scene, "/solver/accuracy", Value::Null);
            put(&mut scene, "/solver/time_step", json!(0.000_125));
            scene
        }
        _ => engineer(name),
    }
}

/// A value of the table: JSON, or a name for a long one.
pub(super) fn value(text: &str) -> Value {
    match text {
        "CHAIN" => engineer("chain")["robot"]["track"].take(),
        "ARMS" => engineer("flippers")["robot"]["flippers"].take(),
        _ => serde_json::from_str(text).expect("it is JSON"),
    }
}

pub(super) fn put(scene: &mut Value, field: &str, value: Value) {
    *place_of(scene, field).expect("its object is there") = value;
}

/// The error of a text, or nothing.
fn refusal(text: &str) -> String {
    ValidScenario::from_json(text).map_or_else(|error| error.to_string(), |_| String::new())
}

#[test]
fn every_rule_refuses_what_breaks_it_and_nothing_before() {
    for row in RULES.trim().lines() {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [name, changes, field, legal, broken, error] = cells[..] else {
            panic!("{row}");
        };
        let mut scene = scene(name);
        for change in changes.split("; ").filter(|change| !change.is_empty()) {
            let (field, text) = change.split_once('=').expect("a field and a value");
            put(&mut scene, field, value(text));
        }
        if legal != "-" {
            put(&mut scene, field, value(legal));
            assert_eq!(refusal(&scene.to_string()), "", "{row}");
        }
        put(&mut scene, field, value(broken));
        let found = refusal(&scene.to_string());
        assert!(found.contains(error), "{row}\n{found}");
    }
}

#[test]
fn a_text_that_is_no_scenario_is_refused_by_its_place() {
    for [part, other, error] in TEXTS {
        let belt = shared_text("engineer_belt_step");
        assert!(belt.contains(part), "{part}");
        let found = refusal(&belt.replacen(part, other, 1));
        assert!(found.contains(error), "{other}\n{found}");
    }
}

#[test]
fn lists_and_texts_have_a_largest_length() {
    let long = |row: &str, count: usize| -> Value { vec![value(row); count].into() };
    let cases = [
        (
            "belt",
            "/robot/name",
            json!("x".repeat(1000)),
            json!("x".repeat(1001)),
            "characters",
        ),
        (
            "belt",
            "/robot/belly",
            Value::Null,
            long("[0, 0]", 65),
            "64 rows, got 65 rows",
        ),
        (
            "points",
            "/terrain/segment_friction",
            json!([0.9]),
            long("0.9", 200_001),
            "200000 numbers, got 200001 numbers",
        ),
    ];
    for (name, field, legal, broken, error) in cases {
        let mut scene = scene(name);
        put(&mut scene, field, legal);
        assert_eq!(refusal(&scene.to_string()), "", "{field}");
        put(&mut scene, field, broken);
        let found = refusal(&scene.to_string());
        assert!(found.contains("must have at most"), "{found}");
        assert!(found.contains(error), "{found}");
    }
    let found = refusal(&" ".repeat((64 << 20) + 1));
    assert_eq!(found, "scenario must be at most 64 MiB of JSON, got 64 MiB");
}
