//! Which outcome counts if several apply.

use super::*;
use crate::scenario::{
    ChainMechanism, ForceSupport, ForceTrack, GearWheel, LineOfWheels, SegmentalTrack,
    SeizureCriteria, ShoeShape, Terrain, Track, Wheel,
};

fn engineer() -> Scenario {
    let text = include_str!("../../../../tests/scenarios/engineer_belt_step.json");
    Scenario::from_json(text).expect("the shared scenario is valid")
}

fn run_until(simulation: &mut Simulation, time: f64) {
    let left = time - simulation.time();
    simulation.advance(left).expect("the state stays finite");
}

/// The simulation, one second after the robot has stopped.
fn stopped(scenario: &Scenario) -> Simulation {
    let mut simulation = Simulation::new(&Checked::new(scenario).expect("the scenario is valid"));
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
    });
    scenario.robot.belly = None;
    scenario.robot.center_of_mass[0] = center;
    scenario.robot.drivetrain.max_acceleration = 2.0;
    scenario.terrain = Terrain::Step {
        height,
        edge_radius: 0.0,
        friction: 0.9,
    };
    scenario
}

/// Skids without motor force, far before a step.
fn skids() -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = Track::Force(ForceTrack {
        support: ForceSupport::Skids,
        skid_friction: 0.3,
        wheel_count: 5,
    });
    scenario.robot.drivetrain.max_torque = 0.0;
    scenario
}

/// A change of the criteria after which an outcome no longer applies.
type NoMore = fn(&mut SeizureCriteria);

#[test]
fn of_the_outcomes_that_apply_to_a_stop_the_first_counts() {
    // An edge in a pocket has driven the motors to their limit: seized and stalled.
    let mut stop = stopped(&gears(4, 0.09, -0.05));
    let criteria = &mut stop.scenario.criteria;
    // With these criteria it also counts as moving to and fro and as lying on its belly.
    (criteria.cycling_distance, criteria.belly_load) = (-1.0, 0.0);
    let in_turn: [(Outcome, NoMore); 4] = [
        (Outcome::Cycling, |c| c.cycling_distance = 0.02),
        (Outcome::Seized, |c| {
            (c.imbalance, c.mean_imbalance) = (-1.0, -1.0);
        }),
        (Outcome::HungUp, |c| c.belly_load = 0.1),
        (Outcome::Stalled, |c| c.torque_limit = 2.0),
    ];
    let mut found = Vec::new();
    for (outcome, no_more) in in_turn {
        found.push(stop.outcome_now());
        assert_eq!(found.last(), Some(&outcome));
        no_more(&mut stop.scenario.criteria);
    }
    found.push(stop.outcome_now());
    assert_eq!(found.last(), Some(&Outcome::Slipping));
    assert!(
        found.is_sorted_by_key(|outcome| *outcome as usize),
        "{found:?}"
    );
}

#[test]
fn an_end_counts_before_a_stop() {
    let mut scenario = skids();
    scenario.goal = Some(-2.0);
    scenario.criteria.clear_time = 2.5;
    let mut simulation = Simulation::new(&Checked::new(&scenario).expect("the scenario is valid"));
    assert_eq!(simulation.outcome_now(), Outcome::TimedOut);
    run_until(&mut simulation, 2.0);
    assert_eq!(simulation.outcome_now(), Outcome::Stalled);
    assert_eq!(simulation.outcome(), None, "it could still be cleared");
    run_until(&mut simulation, 2.6);
    assert!(simulation.monitor.stop_since().is_some());
    assert_eq!(simulation.outcome(), Some(Outcome::Cleared));
    assert!(simulation.diagnosis().is_none());
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
        road_wheel_count: None,
        return_roller_count: None,
    });
    scenario.criteria.tip_over_angle = 1e-9;
    scenario.start.angle = 1e-3;
    let tips = |off: bool| {
        let mut simulation =
            Simulation::new(&Checked::new(&scenario).expect("the scenario is valid"));
        if off {
            // A shoe high above the robot.
            simulation.state.shoes[0].center.y += 0.5;
        }
        simulation.step().expect("the state stays finite");
        simulation.outcome()
    };
    assert_eq!(tips(false), Some(Outcome::TippedOver));
    assert_eq!(tips(true), Some(Outcome::Detracked));
}

#[test]
fn skids_that_nothing_pushes_hold_the_friction_of_their_weight() {
    let scenario = skids();
    let found = stopped(&scenario).diagnosis().expect("it stands");
    let hold = 0.3 * scenario.robot.mass * scenario.gravity;
    for force in [found.escape_force, found.free_escape_force] {
        let force = force.expect("it is at rest");
        assert!((force / hold - 1.0).abs() < 1e-6, "{force} N, {hold} N");
    }
}

#[test]
fn ground_between_the_grousers_of_a_wheel_seizes_at_the_tips_alone() {
    let found = stopped(&gears(3, 0.1, 0.02)).diagnosis();
    let found = found.expect("it has stopped");
    assert_eq!(found.outcome, Outcome::Stalled);
    assert!(found.intrusion.is_some() && found.seized_at_tips);
}

#[test]
fn ground_inside_the_track_that_is_no_cause_does_not_seize_at_the_tips() {
    let found = stopped(&gears(5, 0.108, -0.05)).diagnosis();
    let found = found.expect("it has stopped");
    assert_eq!(found.outcome, Outcome::Stalled);
    assert!(found.intrusion.is_some() && found.certified);
    assert!(!found.seized_at_tips);
}

#[test]
fn nothing_is_seized_without_a_certificate() {
    let mut stop = stopped(&gears(4, 0.09, -0.05));
    assert!(stop.diagnosis().is_some_and(|d| d.seized_at_tips));
    let criteria = &mut stop.scenario.criteria;
    (criteria.imbalance, criteria.mean_imbalance) = (-1.0, -1.0);
    let found = stop.diagnosis().expect("it has stopped");
    assert!(found.intrusion.is_some());
    assert!(!found.certified && !found.seized_at_tips);
    assert!(found.cause.is_empty() && found.escape_force.is_none());
    assert!(found.free_escape_force.is_none());
}
