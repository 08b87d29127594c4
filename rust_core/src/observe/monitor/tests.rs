//! A monitor with synthetic readings: its observations, and when it ends a run.
#![allow(clippy::float_cmp)] // lengths and times here are exact in binary, or repeated unchanged

mod ends;
mod fits;
mod stationary;
mod stops;

use approx::assert_relative_eq;

use super::*;
use crate::contact::Contact;
use crate::geometry::Vector;
use crate::scenario::{Surface, Terrain, TrackOutline, shared};
use crate::solver::Grip;

/// [s] Time between two readings, a tenth of that between two checks.
const STEP: f64 = 0.001;
/// [m] Half the distance between the end axles.
const HALF: f64 = 0.25;
/// [m] Radius at both ends.
const RADIUS: f64 = 0.0625;
/// [m] Distance at which the ground ends on either side.
const END: f64 = 4.0;

/// The Engineer on a belt, with end axles 0.5 m apart, on level ground.
fn scenario() -> Scenario {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.outline.discs = TrackOutline::two_discs(2.0 * HALF, [RADIUS, RADIUS]);
    scenario.terrain = ground(&[[-END, 0.0], [END, 0.0]]);
    scenario
}

/// Ground through these points, with its goal 1 m behind the origin.
fn ground(points: &[[f64; 2]]) -> Terrain {
    Terrain::Points {
        points: points.to_vec(),
        goal: 1.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    }
}

/// A contact of the first part of a robot with a facet of the ground.
fn on_facet(facet: usize, normal_force: f64) -> Contact {
    Contact {
        normal_force,
        grip: Grip::Open,
        ..Contact::new(0, (facet, -1), (Vector::ZERO, Vector::Y), 0.0)
    }
}

/// A robot placed by the tests, and its monitor.
struct Watched {
    monitor: Monitor,
    now: Reading,
    steps: u32,
    command: f64,
    loaded: Vec<Contact>,
    drives: Vec<(DriveState, f64)>,
    running: Running,
}

impl Watched {
    fn new(scenario: &Scenario) -> Self {
        let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
        let ground = Arc::new(ground);
        let model = Model::on(&scenario.robot, &ground).expect("it can be built");
        Self {
            monitor: Monitor::new(scenario, &ground, &model),
            now: Reading::at_rest(0.0, Vector::new(-1.0, RADIUS)),
            steps: 0,
            command: scenario.drive.speed,
            loaded: Vec::new(),
            drives: Vec::new(),
            running: model.running_at_start(0.0),
        }
    }

    fn with(change: impl Fn(&mut Scenario)) -> Self {
        let mut scenario = scenario();
        change(&mut scenario);
        Self::new(&scenario)
    }

    /// Takes one step without motion.
    fn step(&mut self) {
        self.steps += 1;
        self.now.time = f64::from(self.steps) * STEP;
        self.now.commanded_speed = self.command;
        let drives = self.drives.iter().copied();
        self.monitor.observe(
            (&self.now, self.now.forward_speed()),
            self.command,
            &self.loaded,
            drives,
            &self.running,
        );
    }

    /// Moves at a velocity [m/s] and an angular velocity [rad/s] until a time [s].
    fn goes_until(&mut self, time: f64, velocity: [f64; 2], rate: f64) {
        self.now.velocity = Vector::from(velocity);
        self.now.angular_velocity = rate;
        while self.now.time < time - 0.5 * STEP {
            self.now.position += self.now.velocity * STEP;
            self.now.chassis_angle += rate * STEP;
            self.step();
        }
    }

    fn stands_until(&mut self, time: f64) {
        self.goes_until(time, [0.0, 0.0], 0.0);
    }

    /// Takes one step in a pose; returns the outcome by then.
    fn put(&mut self, x: f64, y: f64, angle: f64) -> Option<Outcome> {
        self.now.position = Vector::new(x, y);
        self.now.chassis_angle = angle;
        self.step();
        self.monitor.ended_as()
    }

    fn observed(&self) -> &Observations {
        &self.monitor.observed
    }
}

#[test]
fn path_length_counts_backwards_when_the_robot_goes_backwards_along_its_axis() {
    let mut robot = Watched::with(|_| {});
    // Nose up by 60 degrees: motion along the axis is sin 60 of motion upwards and cos 60 of motion forwards.
    robot.now.chassis_angle = std::f64::consts::FRAC_PI_3;
    robot.goes_until(0.5, [0.4, 0.0], 0.0);
    assert_relative_eq!(robot.observed().path_length, 0.1, max_relative = 1e-12);
    robot.goes_until(1.0, [0.0, 0.4], 0.0);
    let up = 0.2 * 0.75_f64.sqrt();
    assert_relative_eq!(robot.observed().path_length, 0.1 + up, max_relative = 1e-12);
    robot.goes_until(3.0, [-0.4, 0.0], 0.0);
    assert_relative_eq!(robot.observed().path_length, up - 0.3, max_relative = 1e-12);
}

#[test]
fn drive_work_is_that_of_all_drives_and_less_for_one_that_brakes() {
    let mut robot = Watched::with(|_| {});
    let drive = |force: f64, speed: f64| {
        let state = DriveState {
            force,
            ..DriveState::default()
        };
        (state, speed)
    };
    robot.drives = vec![drive(10.0, 0.5), drive(-4.0, 0.5)];
    robot.stands_until(2.0);
    assert_relative_eq!(robot.observed().drive_work, 6.0, max_relative = 1e-12);
}

#[test]
fn angles_and_penetrations_are_remembered_at_their_extremes() {
    let mut robot = Watched::with(|_| {});
    let sunk = |distance: f64| {
        let mut contact = on_facet(0, 1.0);
        contact.distance = distance;
        contact
    };
    robot.loaded = vec![sunk(0.5), sunk(-0.002), sunk(-0.001)];
    for angle in [0.25, 0.5, -0.125, 0.0] {
        robot.put(-1.0, RADIUS, angle);
    }
    robot.loaded.clear();
    robot.step();
    let observed = robot.observed();
    assert_eq!((observed.max_angle, observed.min_angle), (0.5, -0.125));
    assert_eq!(observed.max_penetration, 0.002);
}

#[test]
fn the_extreme_angles_of_a_robot_that_never_lies_level_are_both_of_one_sign() {
    for side in [1.0, -1.0] {
        let mut robot = Watched::with(|_| {});
        robot.put(-1.0, RADIUS, side * 0.25);
        robot.put(-1.0, RADIUS, side * 0.5);
        let mut extremes = [robot.observed().min_angle, robot.observed().max_angle];
        extremes.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        assert_eq!(extremes, [side * 0.25, side * 0.5]);
    }
}

#[test]
fn chains_are_remembered_at_their_worst() {
    let mut robot = Watched::with(|_| {});
    let worst = ChainReading {
        tension: 200.0,
        pin_gap: 1e-4,
        guide_penetration: 2e-4,
        sprocket_slip: 3e-4,
        is_off: false,
    };
    robot.monitor.observe_chains(worst);
    robot.monitor.observe_chains(ChainReading::default());
    let observed = robot.observed();
    let remembered = (observed.max_track_tension, observed.max_pin_gap);
    assert_eq!(remembered, (worst.tension, worst.pin_gap));
    let remembered = (observed.max_guide_penetration, observed.max_sprocket_slip);
    assert_eq!(remembered, (worst.guide_penetration, worst.sprocket_slip));
}

#[test]
fn shaking_is_looked_at_every_ten_milliseconds() {
    let mut robot = Watched::with(|_| {});
    // Moving up and down between two checks leaves no acceleration from check to check.
    for i in 0..1000 {
        robot.now.velocity.y = if i % 2 == 0 { -0.1 } else { 0.1 };
        robot.now.velocity.y *= if i == 0 { -1.0 } else { 1.0 };
        robot.step();
    }
    assert_eq!(robot.observed().shaking.vertical_acceleration(), 0.0);
    robot.goes_until(2.0, [0.0, 0.0], 0.5);
    let mean = 0.5 * 0.5_f64.sqrt();
    let found = robot.observed().shaking.angular_velocity();
    assert_relative_eq!(found, mean, max_relative = 1e-3);
}

#[test]
fn a_monitor_that_begins_late_counts_from_there() {
    let mut robot = Watched::with(|_| {});
    robot.steps = 4_996;
    robot.now.time = f64::from(robot.steps) * STEP;
    robot.monitor.observed = Observations::from(robot.now.time);
    robot.goes_until(5.5, [0.25, 0.0], 0.0);
    assert_relative_eq!(robot.observed().path_length, 0.126, max_relative = 1e-12);
    let mut robot = Watched::with(|_| {});
    robot.steps = 4_996;
    robot.now.time = f64::from(robot.steps) * STEP;
    robot.monitor.observed = Observations::from(robot.now.time);
    robot.stands_until(5.995);
    assert_eq!(robot.monitor.stop_since(), None);
    robot.stands_until(6.0);
    let since = robot.monitor.stop_since().expect("a window is over");
    assert_relative_eq!(since, 5.0, max_relative = 1e-12);
}

#[test]
fn a_robot_has_an_envelope_for_each_track_and_flipper() {
    let robot = Watched::with(|_| {});
    let lanes: Vec<usize> = robot.monitor.envelopes().iter().map(|e| e.lane).collect();
    assert_eq!(lanes, [0]);
    let robot = Watched::with(|scenario| {
        let low = scenario.terrain.clone();
        let high = ground(&[[-END, 0.0], [0.0, 0.0], [0.0, 0.1], [END, 0.1]]);
        scenario.terrain = Terrain::Lanes {
            left: Box::new(low),
            right: Box::new(high),
            middle: None,
        };
    });
    let lanes: Vec<usize> = robot.monitor.envelopes().iter().map(|e| e.lane).collect();
    assert_eq!(lanes, [0, 1]);
}
