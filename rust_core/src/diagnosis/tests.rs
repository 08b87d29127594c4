//! Diagnoses of synthetic stops of two wheels.
#![allow(clippy::float_cmp)] // lengths here are exact in binary

use super::*;
use crate::contact::{Contact, TrackEnvelope};
use crate::geometry::{Pose, Rotation, Vector};
use crate::observe::{Bearing, DriveMean};
use crate::robot::{BodyKind, Model, Mount};
use crate::scenario::{LineOfWheels, Scenario, Surface, Terrain, Track, TrackOutline, Wheel};
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
        let text = include_str!("../../../tests/scenarios/engineer_belt_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        scenario.robot.track = Track::Line(LineOfWheels {
            count: 2,
            wheel_radius: None,
            wheel: Wheel::Round,
            as_track: true,
        });
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
            bearings: places.map(bearing).to_vec(),
            drives: vec![DriveMean::default()],
        }
    }

    fn scene(&self) -> Scene<'_> {
        Scene {
            model: &self.model,
            lanes: &self.ground.lanes,
            envelopes: &self.envelopes,
            criteria: &self.scenario.criteria,
            gravity: self.scenario.gravity,
            command: self.scenario.drive.speed,
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
fn a_stop_is_stationary_up_to_the_distance_and_cycles_beyond_its_own() {
    let mut stage = Stage::new();
    let criteria = &mut stage.scenario.criteria;
    (criteria.stationary_distance, criteria.cycling_distance) = (0.0625, 0.125);
    for (axis, lever) in [(0, 1.0), (1, 1.0), (2, HALF)] {
        let found = |range: f64| {
            let mut stance = stage.stance([0.5, 0.5]);
            stance.range[axis] = range / lever;
            let found = stage.examine(&stance);
            (found.stationary, found.outcome)
        };
        assert_eq!(found(0.0625), (true, Outcome::Slipping));
        assert_eq!(found(0.07), (false, Outcome::Slipping));
        assert_eq!(found(0.125), (false, Outcome::Slipping));
        assert_eq!(found(0.13), (false, Outcome::Cycling));
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

/// Two posts behind the centre of mass, 0.15 and 0.1 m: the one in front pushes with three weights, the other has to pull
/// with two; friction of two places at one height has no lever.
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
    // A residual within the tolerance spares some of it, by the lever between the posts.
    let weights = pull.force / stage.weight();
    assert!((weights - 2.0).abs() < 0.05, "{weights}");
}

/// Braked on a slope, two sticking contacts need the tangent of its angle, and motors the sine of the weight.
#[test]
fn a_braked_robot_on_a_slope_holds_from_the_friction_of_the_angle_on() {
    let mut stage = Stage::new();
    let (friction, angle) = (0.9, 0.4);
    let turn = Rotation::new(angle);
    let mut stance = stage.stance([0.5, 0.5]);
    (stance.angle, stance.position) = (angle, turn * stance.position);
    for bearing in &mut stance.bearings {
        let contact = &mut bearing.contact;
        (contact.point, contact.normal) = (turn * contact.point, turn * contact.normal);
    }
    let needed = libm::sin(angle) * stage.weight();
    for (share, holds) in [(1.01, true), (0.99, false)] {
        // Both tracks are one drive here.
        stage.model.motor.force = share * needed / stage.model.motors as f64;
        // What a residual of a millionth spares is less than what the halvings leave.
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
    assert!(found.trials.is_empty() && !found.is_passing());
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
    let text = include_str!("../../../tests/scenarios/engineer_flippers_step.json");
    let scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let model = Model::on(&scenario.robot, &stage.ground).expect("it can be built");
    stage.model = model.as_one_body(&model.running_at_start(0.0));
    let flippers = scenario.robot.flippers.expect("it has a pair");
    let turn = 0.3;
    let hinges = stage.scene().hinges(Pose::new(Vector::ZERO, turn));
    let level = 0.5 * flippers.length * libm::cos(flippers.angle + turn);
    let expected = 2.0 * flippers.mass * level / scenario.robot.mass;
    assert_eq!(hinges.len(), 1);
    assert!((hinges[0].weight / expected - 1.0).abs() < 1e-12);
}
