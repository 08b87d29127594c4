//! Diagnoses of synthetic stops of two wheels.
#![allow(clippy::float_cmp)] // lengths here are exact in binary

mod chains;

use super::*;
use crate::contact::{Contact, TrackEnvelope};
use crate::dynamics::Direction;
use crate::geometry::{Pose, Rotation, Vector};
use crate::observe::{Bearing, DriveMean};
use crate::robot::{BodyKind, Model, Mount, Part};
use crate::scenario::{
    GearWheel, LineOfWheels, Scenario, Surface, Terrain, TorqueSharing, Track, TrackOutline, Wheel,
    shared,
};
use crate::terrain::Ground;

/// [m] Half the distance between the end axles.
const HALF: f64 = 0.25;
/// [m] Radius at both ends.
const RADIUS: f64 = 0.0625;
/// [m] Height of two posts on the ground, and their depth inside the belt.
const POST: f64 = 0.02;
const DEPTH: f64 = 0.005;

/// The Engineer on two wheels, with end axles 0.5 m apart, on two posts.
struct Stage {
    scenario: Scenario,
    ground: Ground,
    model: Model,
    envelopes: Vec<TrackEnvelope>,
}

impl Stage {
    fn new() -> Self {
        Self::on(Track::Line(LineOfWheels {
            count: 2,
            wheel_radius: None,
            wheel: Wheel::Round,
            as_track: true,
        }))
    }

    fn on(track: Track) -> Self {
        let mut scenario = shared("engineer_belt_step");
        scenario.robot.track = track;
        scenario.robot.outline.discs = TrackOutline::two_discs(2.0 * HALF, [RADIUS, RADIUS]);
        let post = |x: f64| {
            let (from, to) = (x - 0.005, x + 0.005);
            [[from, 0.0], [from, POST], [to, POST], [to, 0.0]]
        };
        let posts = [post(-0.1), post(0.1)].concat();
        scenario.terrain = Terrain::Points {
            points: [vec![[-4.0, 0.0]], posts, vec![[4.0, 0.0]]].concat(),
            goal: 1.0,
            surface: Surface::sharp(0.9),
            segment_friction: None,
        };
        let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
        let model = Model::on(&scenario.robot, &ground).expect("it can be built");
        let margin = scenario.criteria.intrusion_depth;
        let envelope = TrackEnvelope::new(&model.parts, (0, Mount::Chassis), margin);
        Self {
            scenario,
            ground,
            model,
            envelopes: vec![envelope],
        }
    }

    /// [N]
    fn weight(&self) -> f64 {
        self.model.mass * self.scenario.gravity
    }

    /// At rest on the posts, with these shares of the weight on them.
    fn stance(&self, shares: [f64; 2]) -> Stance {
        let bearing = |(x, facet, share): (f64, usize, f64)| Bearing {
            contact: Contact {
                number: facet as u64,
                normal_force: share * self.weight(),
                ..Contact::new(0, (facet, -1), (Vector::new(x, POST), Vector::Y), 0.0)
            },
            duration: 1.0,
        };
        let places = [(-0.1, 2, shares[0]), (0.1, 6, shares[1])];
        Stance {
            position: Vector::new(0.0, POST + RADIUS - DEPTH),
            angle: 0.0,
            range: [0.0; 3],
            swing: [0.0; 3],
            bearings: places.map(bearing).to_vec(),
            drives: vec![DriveMean::default()],
        }
    }

    /// The same, half of the weight on each, with ground and robot turned [rad].
    fn on_slope(&self, angle: f64) -> Stance {
        let turn = Rotation::new(angle);
        let mut stance = self.stance([0.5, 0.5]);
        (stance.angle, stance.position) = (angle, turn * stance.position);
        for Bearing { contact, .. } in &mut stance.bearings {
            (contact.point, contact.normal) = (turn * contact.point, turn * contact.normal);
        }
        stance
    }

    fn scene(&self) -> Scene<'_> {
        Scene {
            model: &self.model,
            lanes: &self.ground.lanes,
            envelopes: &self.envelopes,
            criteria: &self.scenario.criteria,
            gravity: self.scenario.gravity,
            direction: self.scenario.drive.speed.signum(),
            set_point: self.scenario.drive.speed,
            half_length: HALF,
            running: self.model.running_at_start(0.0),
        }
    }

    fn examine(&self, stance: &Stance) -> Diagnosis {
        let seen = StopTimes {
            time: 3.0,
            since: 1.0,
            progress: 0.25,
        };
        examine(&self.scene(), stance, &seen)
    }
}

#[test]
fn a_diagnosis_is_of_the_most_loaded_ground_and_of_equals_the_left() {
    let stage = Stage::new();
    for (shares, side) in [([0.7, 0.3], -1.0), ([0.3, 0.7], 1.0), ([0.5, 0.5], -1.0)] {
        let found = stage.examine(&stage.stance(shares)).intrusion;
        let found = found.expect("both posts are inside");
        assert_eq!(found.place.x.signum(), side, "{shares:?}");
        let most = shares[0].max(shares[1]) * stage.weight();
        assert!((found.force - most).abs() < 1e-9);
        assert!((found.place.depth - DEPTH).abs() < 1e-9);
    }
}

#[test]
fn a_stop_is_stationary_up_to_the_distance_and_cycles_there_and_back_beyond_its_own() {
    let mut stage = Stage::new();
    let criteria = &mut stage.scenario.criteria;
    (criteria.stationary_distance, criteria.cycling_distance) = (0.0625, 0.125);
    for (axis, lever) in [(0, 1.0), (1, 1.0), (2, HALF)] {
        let found = |range: f64, swing: f64| {
            let mut stance = stage.stance([0.5, 0.5]);
            (stance.range[axis], stance.swing[axis]) = (range / lever, swing / lever);
            let found = stage.examine(&stance);
            (found.stationary, found.outcome)
        };
        assert_eq!(found(0.0625, 0.0625), (true, Outcome::Slipping));
        assert_eq!(found(0.07, 0.07), (false, Outcome::Slipping));
        assert_eq!(found(0.125, 0.125), (false, Outcome::Slipping));
        assert_eq!(found(0.13, 0.13), (false, Outcome::Cycling));
        // Far one way, and back a little.
        assert_eq!(found(1.0, 0.125), (false, Outcome::Slipping));
    }
}

#[test]
fn forces_that_balance_are_certified_and_others_not() {
    let stage = Stage::new();
    let found = stage.examine(&stage.stance([0.5, 0.5]));
    assert!(found.certified && found.imbalance.is_some_and(|i| i < 1e-9));
    // Two posts that are both behind the centre of mass cannot hold the robot.
    let mut stance = stage.stance([0.5, 0.5]);
    stance.bearings[1].contact.point.x = -0.15;
    let found = stage.examine(&stance);
    assert!(!found.certified && found.imbalance.is_some_and(|i| i > 0.1));
}

/// Two posts behind the centre of mass, 0.15 and 0.1 m: the one in front pushes with three weights, the other has to
/// pull with two; friction of two places at one height has no lever.
#[test]
fn a_contact_that_would_have_to_pull_is_named_with_its_force() {
    let stage = Stage::new();
    let tolerance = 1e-3;
    let mut stance = stage.stance([0.5, 0.5]);
    let held = balance::balance(&stage.scene(), &stance, tolerance).expect("there is a weight");
    assert!(held.holds() && held.pulls.is_empty());
    let between = held.holds_between.expect("it holds as it is");
    assert!(between[0] < 1.0 && between[1] > 1.0);

    stance.bearings[0].contact.point.x = -0.15;
    stance.bearings[1].contact.point.x = -0.1;
    let found = balance::balance(&stage.scene(), &stance, tolerance).expect("there is a weight");
    assert!(!found.holds() && found.holds_between.is_none());
    let [pull] = found.pulls[..] else {
        panic!("one pulls: {:?}", found.pulls)
    };
    assert_eq!((pull.body, pull.point.x), (0, -0.15));
    // A residual within the tolerance reduces it, by the lever between the posts.
    let weights = pull.force / stage.weight();
    assert!((weights - 2.0).abs() < 0.05, "{weights}");
}

/// Braked on a slope, two sticking contacts need the tangent of its angle, and motors the sine of the weight.
#[test]
fn a_braked_robot_on_a_slope_holds_from_the_friction_of_the_angle_on() {
    let mut stage = Stage::new();
    let (friction, angle) = (0.9, 0.4);
    let stance = stage.on_slope(angle);
    let needed = libm::sin(angle) * stage.weight();
    for (share, holds) in [(1.01, true), (0.99, false)] {
        // Both tracks are one drive here.
        stage.model.motor.force = share * needed / stage.model.motors as f64;
        // The effect of a residual of a millionth is less than the error of the bisections.
        let found = balance::balance(&stage.scene(), &stance, 1e-6).expect("there is a weight");
        assert_eq!(found.holds(), holds);
        let Some([from, to]) = found.holds_between else {
            assert!(!holds, "with {share} of the force it holds");
            continue;
        };
        let expected = libm::tan(angle) / friction;
        assert!(
            holds && (from / expected - 1.0).abs() < 5e-4,
            "{from}, by hand {expected}"
        );
        assert!(to.is_infinite());
    }
}

#[test]
fn a_diagnosis_tells_when_the_stop_was_looked_at_and_where() {
    let stage = Stage::new();
    let mut stance = stage.stance([0.5, 0.5]);
    stance.angle = 0.001;
    let found = stage.examine(&stance);
    assert_eq!((found.time, found.since, found.progress), (3.0, 1.0, 0.25));
    let place = [stance.position.x, stance.position.y];
    assert_eq!((found.position, found.chassis_angle), (place, 0.001));
    assert!(found.trials.is_empty() && !found.is_transient());
}

#[test]
fn a_body_bears_on_ground_in_the_track_from_half_the_least_load_on() {
    let stage = Stage::new();
    let (criteria, weight) = (&stage.scenario.criteria, stage.weight());
    let mut facts = stage.scene().facts(&stage.stance([0.5, 0.5]), None);
    let least = criteria.intrusion_load * weight;
    for (kind, found) in [
        (BodyKind::Wheel, Mechanism::Straddled),
        (BodyKind::Roller, Mechanism::Fouled),
    ] {
        for (share, bears) in [(0.49, false), (0.51, true)] {
            for (body, contact) in facts.contacts.iter_mut().enumerate() {
                (contact.body, contact.in_pocket, contact.kind) = (body, true, BodyKind::Wheel);
            }
            facts.contacts[1].kind = kind;
            facts.contacts[1].normal_force = share * least;
            let mechanism = Mechanism::of(&facts, criteria, weight);
            assert_eq!(mechanism == Some(found), bears, "{share} of it, {kind:?}");
        }
    }
}

#[test]
fn the_moment_on_a_hinge_is_the_arms_weight_times_its_level_arm() {
    let mut stage = Stage::new();
    let scenario = shared("engineer_flippers_step");
    let model = Model::on(&scenario.robot, &stage.ground).expect("it can be built");
    stage.model = model.as_one_body(&model.running_at_start(0.0));
    let flippers = scenario.robot.flippers.expect("it has a pair");
    let turn = 0.3;
    let hinges = stage.scene().hinges(Pose::new(Vector::ZERO, turn));
    let level = 0.5 * flippers.length * libm::cos(flippers.angle + turn);
    let expected = 2.0 * flippers.mass * level / scenario.robot.mass;
    assert_eq!(hinges.len(), 1);
    assert!((hinges[0].weight / expected - 1.0).abs() < 1e-12);
    let most = stage.model.flippers[0].torque_limit / stage.weight();
    assert!((hinges[0].torque / most - 1.0).abs() < 1e-12);
}

/// A belt that runs round the pivot of an arm stands still with its sprocket while the arm turns: where it lies on the
/// sprocket the ground has no lever on the arm, and elsewhere that of its distance along the arm.
#[test]
fn ground_under_the_sprocket_of_an_arm_does_not_turn_it() {
    let mut stage = Stage::new();
    let scenario = shared("engineer_flippers_step");
    stage.model = Model::on(&scenario.robot, &stage.ground).expect("it can be built");
    let pivot = stage.model.flippers[0].pivot;
    let pose = Pose::new(Vector::new(0.2, 0.1), 0.3);
    let radius = stage.model.drive_radius;
    let along = |unit: Vector, spin_lever: f64| Direction {
        unit: pose.rotation * unit,
        spin_lever,
        ..Direction::default()
    };
    // A belt is pulled along itself, at the radius of its sprocket, and pressed square to that.
    let directions = [along(Vector::Y, 0.0), along(Vector::X, radius)];
    for ahead in [0.0, 0.1] {
        let point = pose.transform_point(pivot + Vector::new(ahead, -radius));
        let scene = stage.scene();
        let (hinge, hung) = scene.hung(Mount::Flipper(0), pose, point, directions);
        assert_eq!(hinge, Some(0));
        let levers = hung.map(|direction| direction.joint_lever);
        assert!((levers[0] - ahead).abs().max(levers[1].abs()) < 1e-15);
        let (hinge, hung) = scene.hung(Mount::Chassis, pose, point, directions);
        assert!(hinge.is_none() && hung.iter().all(|d| d.joint_lever == 0.0));
    }
}

/// Both tracks are one drive here. A motor is stalled if it stands at its limit, up to the creep of sticking contacts, or
/// is turned back.
#[test]
fn a_motor_that_stands_or_is_turned_back_at_its_limit_is_stalled() {
    let stage = Stage::new();
    let (criteria, motor) = (&stage.scenario.criteria, &stage.model.motor);
    let limit = criteria.torque_limit * motor.force;
    let creep = criteria.sliding_speed * stage.scenario.drive.speed;
    for (force, speed, stalled) in [
        (limit, 0.0, true),
        (-limit, creep, true),
        (0.99 * limit, 0.0, false),
        (limit, 1.01 * creep, false),
        (limit, -1.01 * creep, true),
        (-limit, 1.01 * creep, true),
        (-limit, -1.01 * creep, false),
        (0.99 * limit, -1.01 * creep, false),
    ] {
        let mut stance = stage.stance([0.5, 0.5]);
        stance.drives = vec![DriveMean { force, speed }];
        let found = stage.examine(&stance);
        assert_eq!(found.stalled_share, f64::from(u8::from(stalled)));
        assert_eq!(
            found.outcome == Outcome::Stalled,
            stalled,
            "{force} N, {speed} m/s"
        );
    }
}

/// A motor whose wheel is in the air does not count.
#[test]
fn of_two_motors_with_ground_one_that_stands_is_half() {
    let mut stage = Stage::new();
    stage.scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    stage.model = Model::on(&stage.scenario.robot, &stage.ground).expect("it can be built");
    let limit = stage.scenario.criteria.torque_limit * stage.model.motor.force;
    let on = |speed: f64| DriveMean {
        force: limit,
        speed,
    };
    let moving = stage.scenario.drive.speed;
    for (speeds, share) in [([0.0, moving], 0.5), ([0.0, 0.0], 1.0), ([moving; 2], 0.0)] {
        let mut stance = stage.stance([0.5, 0.5]);
        for (k, bearing) in stance.bearings.iter_mut().enumerate() {
            let is_of = |part: &Part| part.drive == Some(k);
            let part = stage.model.parts.iter().position(is_of);
            bearing.contact.part = part.expect("each wheel has a motor");
        }
        stance.drives = speeds.map(on).to_vec();
        assert_eq!(stage.examine(&stance).stalled_share, share, "{speeds:?}");
    }
}

/// Driving forwards, points on a wheel move rearwards under its axle, and dig into ground whose normal leans forwards.
#[test]
fn a_tooth_that_would_dig_into_ground_in_the_track_is_a_flank() {
    let stage = Stage::on(Track::Line(LineOfWheels {
        count: 2,
        wheel_radius: None,
        wheel: Wheel::Gear(GearWheel {
            grouser_count: Some(8),
            grouser_height: Some(0.1 * RADIUS),
            tip_thickness: Some(0.004),
            base_thickness: None,
            phase_fraction: 0.0,
        }),
        as_track: true,
    }));
    let is_rear = |part: &Part| part.discs().any(|(disc, _)| disc.center.x == -HALF);
    let rear = stage.model.parts.iter().position(is_rear);
    let radius = stage.model.drive_radius;
    for (direction, lean, interlocks) in [
        (1.0, 0.06, true),
        (1.0, 0.04, false),
        (1.0, -0.06, false),
        (-1.0, -0.06, true),
        (-1.0, -0.04, false),
    ] {
        let mut stance = stage.stance([0.5, 0.5]);
        for bearing in &mut stance.bearings {
            let axle = stance.position - Vector::new(HALF, 0.0);
            let spoke = axle - bearing.contact.point;
            // The fraction of the drive's speed at which it digs in.
            let sine = lean * radius / spoke.length();
            bearing.contact.part = rear.expect("it has a rear wheel");
            bearing.contact.normal = Rotation::new(-libm::asin(sine)) * spoke.normalize();
        }
        let force = stage.model.motor.force;
        stance.drives = vec![DriveMean { force, speed: 0.0 }];
        let seen = StopTimes {
            time: 3.0,
            since: 1.0,
            progress: 0.25,
        };
        let scene = Scene {
            direction,
            ..stage.scene()
        };
        let expected = if interlocks {
            Mechanism::Interlocked
        } else {
            Mechanism::Blocked
        };
        let found = examine(&scene, &stance, &seen).mechanism;
        assert_eq!(found, Some(expected), "{direction} {lean}");
    }
}

#[test]
fn a_contact_slides_that_moves_with_nearly_all_of_its_friction() {
    let stage = Stage::new();
    let creep = stage.scenario.criteria.sliding_speed * stage.scenario.drive.speed;
    for (share, speed, slides) in [
        (0.96, 1.01 * creep, true),
        (-0.96, -1.01 * creep, true),
        (0.94, 1.01 * creep, false),
        (0.96, creep, false),
    ] {
        let mut stance = stage.stance([0.25, 0.75]);
        let contact = &mut stance.bearings[1].contact;
        contact.friction_force = share * 0.9 * contact.normal_force;
        contact.surface_speed = speed;
        let found = stage.examine(&stance);
        assert_eq!(found.contacts[1].slides, slides, "{share}, {speed} m/s");
        assert!((found.sliding_share - if slides { 0.75 } else { 0.0 }).abs() < 1e-12);
    }
}

/// Ground between two wheels jams if it is deeper inside the track than the least depth.
#[test]
fn ground_between_wheels_jams_from_the_least_depth_on() {
    let mut stage = Stage::new();
    for (least, jams) in [(0.9 * DEPTH, true), (1.1 * DEPTH, false)] {
        stage.scenario.criteria.intrusion_depth = least;
        let found = stage.examine(&stage.stance([0.5, 0.5]));
        assert_eq!(found.jammed, jams, "{least} m");
        assert!(found.intrusion.is_some());
    }
}

/// The same posts dent the belt that the shared scenario has.
#[test]
fn ground_within_a_single_smooth_surface_is_not_inside_the_track() {
    let scenario = shared("engineer_belt_step");
    let stage = Stage::on(scenario.robot.track);
    let found = stage.examine(&stage.stance([0.5, 0.5]));
    assert!(found.intrusion.is_none() && !found.jammed);
    assert!(found.contacts.iter().all(|contact| !contact.in_pocket));
}

/// A contact counts by the part of the weight that it lifts, by its normal force and by its friction.
#[test]
fn the_belly_bears_its_share_of_what_is_lifted() {
    let stage = Stage::new();
    let parts = &stage.model.parts;
    let belly = parts.iter().position(|part| part.kind == BodyKind::Belly);
    let mut stance = stage.stance([0.5, 0.25]);
    let contact = &mut stance.bearings[1].contact;
    contact.part = belly.expect("it has a belly");
    // Friction acts along the normal turned by -90 degrees, here down.
    contact.normal = Vector::new(0.6, 0.8);
    contact.friction_force = 0.5 * contact.normal_force;
    let lifted = 0.25 * (0.8 - 0.5 * 0.6);
    let found = stage.examine(&stance);
    assert!((found.belly_share - lifted / (0.5 + lifted)).abs() < 1e-12);
    let least = stage.scenario.criteria.belly_load;
    assert_eq!(found.outcome == Outcome::HungUp, found.belly_share >= least);
}

/// Behind a self-locking gear, a motor without force holds what stands; it brakes what moves, and does not push it.
#[test]
fn a_lock_holds_what_stands_and_holds_back_what_moves() {
    let mut stage = Stage::new();
    (stage.model.motor.self_locking, stage.model.motor.force) = (true, 0.0);
    let speed = stage.scenario.drive.speed;
    for (angle, speed, holds) in [
        (0.3, 0.0, true),
        (-0.3, 0.0, true),
        (0.3, speed, false),
        (-0.3, speed, true),
        (0.3, -speed, true),
        (-0.3, -speed, false),
    ] {
        let mut stance = stage.on_slope(angle);
        stance.drives = vec![DriveMean { force: 0.0, speed }];
        let found = balance::balance(&stage.scene(), &stance, 1e-6).expect("there is a weight");
        assert_eq!(found.holds(), holds, "{angle} rad, {speed} m/s");
    }
}
