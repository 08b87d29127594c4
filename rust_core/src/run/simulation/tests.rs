//! Precedence of outcomes, and invariants of every step.

mod arms;
mod branches;
mod commands;
mod energy;

use super::*;
use crate::contact::Contact;
use crate::dynamics::FlipperCommand;
use crate::geometry::direction;
use crate::observe::Outcome;
use crate::run::ByHand;
use crate::run::trials::tests::engineer;
use crate::scenario::{
    ChainMechanism, End, Ends, Engine, ForceSupport, ForceTrack, GearWheel, LineOfWheels,
    SegmentalTrack, ShoeShape, Surface, Terrain, TorqueSharing, Track, Wheel, shared,
};

/// A simulation at its start.
fn started(scenario: &Scenario) -> Simulation {
    Simulation::new(&ValidScenario::new(scenario).expect("it is valid"))
}

fn run_until(simulation: &mut Simulation, time: f64) {
    let left = time - simulation.time();
    simulation.advance(left).expect("the state stays finite");
}

/// The simulation, one second after the robot has stopped.
fn stopped(scenario: &Scenario) -> Simulation {
    let mut simulation = started(scenario);
    while simulation.monitor.stop_since().is_none() {
        assert!(simulation.time() < scenario.duration, "it has not stopped");
        simulation.step().expect("the state stays finite");
    }
    let now = simulation.time();
    run_until(&mut simulation, now + 1.0);
    simulation
}

/// This many gear wheels against a step [m], with the centre of mass at x [m].
fn gears(count: u32, height: f64, center: f64) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel: Wheel::Gear(GearWheel {
            grouser_count: None,
            grouser_height: None,
            tip_thickness: None,
            base_thickness: None,
            phase_fraction: 1.0 / 3.0,
        }),
        as_track: true,
    });
    scenario.robot.belly = None;
    scenario.robot.center_of_mass[0] = center;
    scenario.robot.drivetrain.max_acceleration = 2.0;
    scenario.terrain = Terrain::Step {
        height,
        surface: Surface::sharp(0.9),
    };
    scenario
}

/// A track that is a force only, in front of a step.
fn pushed(support: ForceSupport) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = Track::Force(ForceTrack {
        support,
        skid_friction: 0.3,
        wheel_count: 5,
    });
    scenario
}

/// Skids without motor force, far before a step.
fn skids() -> Scenario {
    let mut scenario = pushed(ForceSupport::Skids);
    scenario.robot.drivetrain.max_torque = 0.0;
    scenario
}

#[test]
fn an_end_counts_before_a_stop() {
    let mut scenario = skids();
    scenario.goal = Some(-2.0);
    scenario.criteria.clear_time = 2.5;
    let mut simulation = started(&scenario);
    assert!(simulation.examine().is_none());
    run_until(&mut simulation, 2.0);
    let found = simulation.examine().expect("it stands");
    assert_eq!(found.symptom, Outcome::Stalled);
    assert!(!simulation.is_over(), "it could still be cleared");
    run_until(&mut simulation, 2.6);
    assert!(simulation.monitor.stop_since().is_some());
    assert_eq!(simulation.monitor.ended_as(), Some(Outcome::Cleared));
    assert!(simulation.examine().is_none());
}

#[test]
fn a_chain_that_comes_off_as_the_robot_tips_over_has_come_off() {
    let mut scenario = engineer();
    scenario.robot.track = Track::Segmental(SegmentalTrack {
        shoe_count: None,
        shoe_shape: ShoeShape::Rectangle,
        plate_thickness: None,
        pre_tension: None,
        mechanism: ChainMechanism::Guide,
        tensioner_stiffness: None,
        tensioner_damping: None,
        pin_stiffness: 0.0,
        pin_damping: 0.0,
        road_wheel_count: None,
        return_roller_count: None,
    });
    scenario.criteria.tip_over_angle = 1e-9;
    scenario.start.angle = 1e-3;
    let tips = |off: bool| {
        let mut simulation = started(&scenario);
        if off {
            // A shoe high above the robot.
            simulation.state.shoes[0].center.y += 0.5;
        }
        simulation.step().expect("the state stays finite");
        simulation.monitor.ended_as()
    };
    assert_eq!(tips(false), Some(Outcome::TippedOver));
    assert_eq!(tips(true), Some(Outcome::Detracked));
}

#[test]
fn ground_between_the_grousers_of_one_wheel_is_no_jam() {
    let found = stopped(&gears(3, 0.1, 0.02)).examine();
    let found = found.expect("it has stopped");
    assert_eq!(found.symptom, Outcome::Stalled);
    assert!(found.intrusion.is_some() && !found.jammed);
}

#[test]
fn where_ground_is_jammed_that_counts_before_ground_with_more_load() {
    let found = stopped(&gears(4, 0.09, -0.05)).examine();
    let found = found.expect("it has stopped");
    assert!(found.jammed && found.certified);
    let inside = found.intrusion.expect("it is jammed");
    assert!(inside.place.bodies[0] != inside.place.bodies[1]);
}

/// Contacts and the push, which is no contact force, against weight and inertia: over a second against a step, as a
/// share of the weight and the forces in each step.
#[test]
fn a_robot_that_is_pushed_by_a_force_keeps_the_balance_in_every_step() {
    for support in [ForceSupport::Skids, ForceSupport::Wheels] {
        let scenario = pushed(support);
        let weight = scenario.robot.mass * scenario.gravity;
        let mut simulation = started(&scenario);
        let (mut worst, mut pushed) = (0.0_f64, 0.0_f64);
        while simulation.time() < 1.0 {
            let before = simulation.momentum();
            simulation.step().expect("the state stays finite");
            let loaded = simulation.dynamics.loaded().iter();
            let push = simulation.state.drives[0].traction;
            let along = direction(simulation.state.angle);
            let forces = loaded.map(Contact::force).sum::<Vector>() + along * push;
            let gained = (simulation.momentum() - before) / simulation.last_step();
            let off = forces - Vector::new(0.0, weight) - gained;
            worst = worst.max(off.length() / (weight + forces.length()));
            pushed = pushed.max(push);
        }
        assert!(worst < 1e-10, "{support:?}: {worst}");
        assert!(pushed > 0.1 * weight, "{support:?}: {pushed} N");
    }
}

#[test]
#[allow(clippy::float_cmp)] // times are handed on
fn what_rounding_leaves_of_a_step_is_no_step() {
    let mut simulation = started(&skids());
    simulation.step().expect("the state stays finite");
    let (steps, limit) = (simulation.steps(), simulation.time() + 4e-10);
    simulation
        .step_until(limit)
        .expect("there is nothing to do");
    assert_eq!((simulation.steps(), simulation.time()), (steps, limit));
}

/// It speeds up evenly on level ground, so a mean over a part of a step is the speed in its middle.
#[test]
fn a_robot_that_drives_straight_on_has_a_path_as_long_as_its_way() {
    let mut scenario = engineer();
    scenario.start.approach = 1.0;
    let mut simulation = started(&scenario);
    let begin = simulation.reading().position.x;
    run_until(&mut simulation, 1.0);
    let way = simulation.reading().position.x - begin;
    let path = simulation.monitor.observed.path_length;
    assert!(
        (path - way).abs() < 1e-4 * way && way > 0.05,
        "{path} {way}"
    );
}

/// Three wheels, each with its own motor.
#[test]
fn the_speed_and_way_of_a_track_are_means_over_its_motors() {
    let mut scenario = gears(3, 0.05, 0.0);
    scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    let mut simulation = started(&scenario);
    assert_eq!(simulation.drives(), 3);
    for (drive, (position, spin)) in
        (simulation.state.drives.iter_mut()).zip([(0.1, -1.0), (0.5, -3.0), (0.9, -8.0)])
    {
        (drive.position, drive.spin, drive.force) = (position, spin, 2.0 * position);
    }
    let now = simulation.reading();
    assert!((now.track_position - 0.5).abs() < 1e-15);
    let speeds = [0, 1, 2].map(|drive| simulation.drive_speed(drive));
    let mean = speeds.iter().sum::<f64>() / 3.0;
    assert!((now.track_speed - mean).abs() < 1e-15);
    // Wheels of 64 mm, with tips that reach no farther.
    assert!((mean - 4.0 * 0.064).abs() < 1e-12, "{mean} m/s");
    assert!((simulation.drive_force() - 3.0).abs() < 1e-15);
    assert!(simulation.drive_positions().eq([0.1, 0.5, 0.9]));
}

#[test]
fn the_size_of_a_simulation_is_that_of_its_ground_and_its_robot() {
    // A step has four points; a belt and a belly are two parts.
    assert_eq!(started(&engineer()).size(), (4, 2));
}
