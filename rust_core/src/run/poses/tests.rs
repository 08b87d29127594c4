//! Poses from a trace are those at which the contacts of that instant are found.

use super::*;
use crate::dynamics::FlipperCommand;
use crate::geometry::{Envelope, Rotation};
use crate::limits::memory::Budget;
use crate::robot::{BodyKind, Part, Shape};
use crate::run::record::Recorder;
use crate::run::{Record, Simulation, ValidScenario};
use crate::scenario::{
    End, Ends, Friction, Gait, GearWheel, Hold, LineOfWheels, Scenario, Terrain, TorqueSharing,
    Track, Wheel, shared,
};

/// Robots with all kinds of bodies, in front of a step, or of a step under one track only.
fn scenarios() -> Vec<(String, Scenario)> {
    let names = [
        "engineer_belt_step",
        "engineer_grouser_belt_step",
        "engineer_chain_step",
        "engineer_sprocket_step",
        "engineer_flippers_step",
    ];
    let mut found: Vec<Scenario> = names.map(shared).into();
    let mut gears = found[0].clone();
    gears.robot.track = Track::Line(LineOfWheels {
        count: 4,
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
    found.push(gears);
    // A gait that turns the arms from the first step on.
    if found[4].robot.flippers.is_some() {
        found[4].drive.gait = Some(Gait::Hold(Hold {
            angle: 0.7,
            schedule: None,
            front: None,
            rear: None,
        }));
    }
    let lanes = found.clone().into_iter().map(|mut scenario| {
        let left = Box::new(scenario.terrain.clone());
        let right = Box::new(Terrain::Flat {
            length: 3.0,
            friction: Friction::dry(0.9),
        });
        scenario.terrain = Terrain::Lanes {
            left,
            right,
            middle: None,
        };
        scenario
    });
    let lanes: Vec<Scenario> = lanes.collect();
    let named = |(i, scenario)| (format!("scenario {i}"), scenario);
    found
        .into_iter()
        .chain(lanes)
        .enumerate()
        .map(named)
        .collect()
}

/// A simulation after a number of steps, and the trace of that instant.
fn after(scenario: &Scenario, steps: usize) -> (Simulation, Trace) {
    let mut simulation = Simulation::new(&ValidScenario::new(scenario).expect("it is valid"));
    for _ in 0..steps {
        simulation.step().expect("the state stays finite");
    }
    let budget = Budget::new().expect("there is memory");
    let recorder = Recorder::new(&simulation, Record::default(), &budget);
    let (trace, _) = recorder
        .and_then(|recorder| recorder.finish(&simulation))
        .expect("one sample fits");
    (simulation, trace)
}

fn poses_of(scenario: &Scenario, trace: &Trace) -> Poses {
    let checked = ValidScenario::new(scenario).expect("the scenario is valid");
    poses(&checked, trace, &Cancel::default()).expect("the trace is the scenario's")
}

#[test]
fn bodies_are_where_the_contacts_have_their_parts() {
    for (name, scenario) in scenarios() {
        for steps in [0, 700] {
            let (simulation, trace) = after(&scenario, steps);
            let found = poses_of(&scenario, &trace);
            let (model, running, chassis) = simulation.placed();
            let bodies = model.outlines();
            for (i, part) in model.parts.iter().enumerate() {
                assert_eq!(bodies[i].part, Some(i), "{name}");
                let place = running.mounted(part.mount, chassis) * part.place(&running);
                let [x, y, angle] = found.bodies[3 * i..][..3] else {
                    unreachable!("three numbers a body");
                };
                if part.kind.is_in_chain() && part.kind != BodyKind::Guide {
                    // For contacts it is a disc in the frame of the chassis.
                    let Shape::Hull { discs, .. } = &part.shape else {
                        unreachable!("wheels in a chain are hulls");
                    };
                    let gap = place.transform_point(discs[0].center) - Vector::new(x, y);
                    assert!(gap.length() < 1e-12, "{name}, part {i}: {gap}");
                    continue;
                }
                let gap = place.translation - Vector::new(x, y);
                assert!(gap.length() < 1e-12, "{name}, part {i}: {gap}");
                if !matches!(part.shape, Shape::Disc { .. }) {
                    let off = (place.rotation.inverse() * Rotation::new(angle)).angle();
                    assert!(off.abs() < 1e-9, "{name}, part {i}: {off}");
                }
            }
        }
    }
}

#[test]
fn the_centre_of_mass_of_a_sample_is_that_of_the_whole_robot() {
    for (name, scenario) in scenarios() {
        let (simulation, trace) = after(&scenario, 700);
        let found = poses_of(&scenario, &trace);
        let (model, running, chassis) = simulation.placed();
        let whole = model.as_one_body(&running);
        let center = chassis.transform_point(whole.center_of_mass);
        let [x, y] = found.centers_of_mass[..] else {
            unreachable!("one sample");
        };
        assert!((center - Vector::new(x, y)).length() < 1e-12, "{name}");
    }
}

#[test]
fn a_waypoint_of_a_belt_is_where_a_grouser_would_be() {
    let scenario = shared("engineer_grouser_belt_step");
    let model = Model::new(&scenario.robot).expect("the robot is valid");
    let belt = model.parts.iter().find_map(Part::circuit);
    let belt = belt.expect("it has a belt");
    let grouser = model.parts.iter().find_map(|part| match &part.shape {
        Shape::Grouser(grouser) => Some(grouser),
        _ => None,
    });
    let grouser = grouser.expect("the belt has grousers");
    for (way, [x, y, angle]) in belt.ways.iter().zip(&belt.poses) {
        let place = grouser.place(way - grouser.start());
        assert!((place.translation - Vector::new(*x, *y)).length() < 1e-12);
        let off = (place.rotation.inverse() * Rotation::new(*angle)).angle();
        assert!(off.abs() < 1e-9, "at {way}: {off}");
    }
    let turns = belt.poses[belt.poses.len() - 1][2] - belt.poses[0][2];
    assert!((turns + std::f64::consts::TAU).abs() < 1e-12);
}

#[test]
fn tips_of_grousers_lie_on_the_envelope_of_the_tips() {
    let scenario = shared("engineer_grouser_belt_step");
    let model = Model::new(&scenario.robot).expect("the robot is valid");
    let tips: Vec<_> = model
        .discs_of_track(0, Mount::Chassis)
        .map(|d| d.0)
        .collect();
    let envelope = Envelope::new(&tips);
    let mut running = model.running_at_start(0.0);
    for step in 0..200 {
        running.drives[0] = 0.0131 * f64::from(step);
        for body in model.outlines() {
            if body.kind == BodyKind::Grouser {
                let (origin, angle) = body.place(&model, &running);
                let height = scenario.robot.outline.grouser_height;
                let tip = origin + Rotation::new(angle) * (Vector::Y * height);
                assert!(envelope.depth(tip).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn the_memory_for_poses_is_that_of_all_their_numbers() {
    for (name, scenario) in scenarios() {
        let (_, trace) = after(&scenario, 0);
        let found = poses_of(&scenario, &trace);
        let columns = [
            &found.bodies,
            &found.arms,
            &found.travels,
            &found.centers_of_mass,
        ];
        let numbers = columns.map(Vec::len).into_iter().sum::<usize>();
        let bytes = bytes_of([found.samples, found.count, found.flippers]);
        assert_eq!(bytes, 8 * numbers as u64, "{name}");
        // The long ones have no room to spare.
        for column in [&found.bodies, &found.travels] {
            assert_eq!(column.capacity(), column.len(), "{name}");
        }
    }
    // Per sample 5 poses of three numbers, 5 travels, 2 poses of arms and a point.
    assert_eq!(bytes_of([10, 5, 2]), 10 * (15 + 5 + 6 + 2) * 8);
}

/// Eleven samples of the next tenth of a second.
fn recorded(mut simulation: Simulation) -> Trace {
    let budget = Budget::new().expect("there is memory");
    let recorder = Recorder::new(&simulation, Record::default(), &budget);
    let mut recorder = recorder.expect("it fits");
    while simulation.time() < 0.1 {
        simulation.step_until(0.1).expect("the state stays finite");
        recorder.step(&simulation).expect("it fits");
    }
    let (trace, _) = recorder.finish(&simulation).expect("it fits");
    trace
}

/// Three of them, each with its own motor.
#[test]
fn wheels_of_each_sample_have_run_as_far_as_their_drives() {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.track = Track::Line(LineOfWheels {
        count: 3,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let trace = recorded(Simulation::new(&checked));
    let found = poses_of(&scenario, &trace);
    assert_eq!((found.samples, trace.drive_positions.len()), (11, 33));
    for (ways, drives) in (found.travels.chunks(found.count)).zip(trace.drive_positions.chunks(3)) {
        assert_eq!(&ways[..3], drives);
    }
    // Half of 0.2 m/s^2 times the square of 0.1 s.
    assert!((trace.drive_positions[32] - 1e-3).abs() < 2e-4);
}

/// Arms at both ends turn while it is recorded.
#[test]
fn arms_of_each_sample_are_at_their_angles_of_that_sample() {
    let mut scenario = shared("engineer_flippers_step");
    scenario.robot.flippers.as_mut().expect("it has some").ends = Ends::Both;
    scenario.robot.moment_of_inertia = 1.0;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    for (end, rate) in [(End::Front, 1.0), (End::Rear, -0.5)] {
        let turn = FlipperCommand::Rate(rate);
        simulation.command_flippers(end, turn).expect("it has arms");
    }
    let trace = recorded(simulation);
    let found = poses_of(&scenario, &trace);
    assert_eq!((found.samples, found.arms.len()), (11, 11 * 2 * 3));
    for (i, pair) in found.arms.chunks(6).enumerate() {
        let [front, rear] = [trace.flipper_angles[2 * i], trace.flipper_angles[2 * i + 1]];
        let chassis = trace.chassis_angle[i];
        assert!((pair[2] - chassis - front).abs() < 1e-12, "sample {i}");
        assert!((pair[5] - chassis + rear).abs() < 1e-12, "sample {i}");
    }
    let turned = [0, 1].map(|k| trace.flipper_angles[20 + k] - trace.flipper_angles[k]);
    assert!(turned[0] > 0.03 && turned[1] < -0.01, "{turned:?}");
}
