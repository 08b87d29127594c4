//! Precedence of outcomes, the definition of ground inside the track, and invariants of every step.

use super::*;
use crate::contact::Contact;
use crate::dynamics::FlipperCommand;
use crate::geometry::direction;
use crate::observe::Outcome;
use crate::run::ByHand;
use crate::run::trials::tests::engineer;
use crate::scenario::{
    ChainMechanism, End, Ends, Engine, ForceSupport, ForceTrack, GearWheel, LineOfWheels,
    SegmentalTrack, ShoeShape, Surface, Terrain, TorqueSharing, Track, Wheel,
};

fn run_until(simulation: &mut Simulation, time: f64) {
    let left = time - simulation.time();
    simulation.advance(left).expect("the state stays finite");
}

/// The simulation, one second after the robot has stopped.
fn stopped(scenario: &Scenario) -> Simulation {
    let mut simulation =
        Simulation::new(&ValidScenario::new(scenario).expect("the scenario is valid"));
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
    let mut simulation =
        Simulation::new(&ValidScenario::new(&scenario).expect("the scenario is valid"));
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
        let mut simulation =
            Simulation::new(&ValidScenario::new(&scenario).expect("the scenario is valid"));
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

/// Everything that moves, and the contacts, in bits.
fn bits(simulation: &Simulation) -> Vec<u64> {
    let (now, contacts) = (simulation.reading(), simulation.contact_table());
    let pose = [now.position.x, now.position.y, now.chassis_angle];
    let speeds = [now.velocity.x, now.velocity.y, now.angular_velocity];
    let drives = [now.track_position, now.track_speed];
    let drives = drives.into_iter().chain(simulation.drive_forces());
    let forces = contacts
        .normal_force
        .into_iter()
        .chain(contacts.friction_force);
    let numbers = pose.into_iter().chain(speeds).chain(drives);
    numbers.chain(forces).map(f64::to_bits).collect()
}

/// Gear wheels strike the ground, and climb: a difference of rounding would grow.
#[test]
fn a_copy_in_the_middle_of_a_run_goes_on_with_the_same_bits_in_either_engine() {
    for engine in [Engine::Own, Engine::Rapier] {
        let mut scenario = gears(3, 0.06, 0.0);
        scenario.solver.engine = engine;
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(2.5e-4));
        let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
        let [mut whole, mut undisturbed] = [(); 2].map(|()| Simulation::new(&checked));
        for time in [0.3, 0.9, 1.6] {
            run_until(&mut whole, time);
            let mut copy = whole.copy();
            run_until(&mut undisturbed, time + 0.4);
            for simulation in [&mut copy, &mut whole] {
                run_until(simulation, time + 0.4);
                assert_eq!(
                    bits(simulation),
                    bits(&undisturbed),
                    "{engine:?} from {time} s"
                );
            }
        }
        assert!(
            undisturbed.reading().position.x > 0.0,
            "it has reached the step"
        );
    }
}

/// Contacts and the push, which is no contact force, against weight and inertia: over a second against a step, as a
/// share of the weight and the forces in each step.
#[test]
fn a_robot_that_is_pushed_by_a_force_keeps_the_balance_in_every_step() {
    for support in [ForceSupport::Skids, ForceSupport::Wheels] {
        let scenario = pushed(support);
        let weight = scenario.robot.mass * scenario.gravity;
        let checked = ValidScenario::new(&scenario).expect("the scenario is valid");
        let mut simulation = Simulation::new(&checked);
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

/// Without torque there is no motor; with torque there is one, whatever was there before.
#[test]
fn a_branch_has_the_motors_of_its_own_torque() {
    let mut weak = engineer();
    weak.robot.drivetrain.max_torque = 0.0;
    let mut strong = weak.clone();
    strong.robot.drivetrain.max_torque = 6.0;
    let [weak, strong] = [weak, strong].map(|s| ValidScenario::new(&s).expect("it is valid"));
    let mut stands = Simulation::new(&weak);
    run_until(&mut stands, 0.3);
    let mut drives = stands.branch(&strong);
    run_until(&mut drives, 0.8);
    assert!(drives.reading().velocity.x > 0.05);
    let mut rolls = drives.branch(&weak);
    run_until(&mut rolls, 0.9);
    assert!(rolls.drive_force().abs() < 1e-12);
    // A snapshot has no motor that the robot does not have.
    let [without, with] = [&stands, &drives].map(|robot| robot.dynamics.impulses());
    let lanes = &drives.ground.lanes;
    assert!(drives.dynamics.fits(&with, lanes) && stands.dynamics.fits(&without, lanes));
    assert!(!drives.dynamics.fits(&without, lanes) && !stands.dynamics.fits(&with, lanes));
}

/// Half of the stiffness times the square of the travel, minus the pre-tension times the travel, for both tracks.
#[test]
fn a_tensioner_gives_its_pre_tension_and_takes_its_stiffness() {
    let text = include_str!("../../../../tests/scenarios/engineer_chain_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let Track::Segmental(chain) = &mut scenario.robot.track else {
        panic!("it is a chain")
    };
    chain.pre_tension = Some(100.0);
    chain.tensioner_stiffness = Some(50_000.0);
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let energy = |simulation: &mut Simulation, travel: f64| {
        simulation.state.idlers[0].travel = travel;
        simulation.energy()
    };
    let before = energy(&mut simulation, 0.0);
    for (travel, stored) in [(1e-3, -0.15), (-1e-3, 0.25)] {
        let gained = energy(&mut simulation, travel) - before;
        // Rounding of an energy of some joules.
        assert!((gained - stored).abs() < 1e-12, "{gained} J");
    }
}

#[test]
#[allow(clippy::float_cmp)] // a sign is exact
fn the_direction_is_that_of_the_command() {
    for (speed, direction) in [(0.4, 1.0), (-0.4, -1.0)] {
        let mut scenario = skids();
        scenario.drive.speed = speed;
        let checked = ValidScenario::new(&scenario).expect("it is valid");
        assert_eq!(Simulation::new(&checked).direction(), direction);
    }
}

#[test]
fn a_robot_that_stays_is_over_unless_a_push_has_just_risen() {
    let scenario = skids();
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    while !simulation.is_over() {
        assert!(simulation.time() < scenario.duration, "it stands");
        simulation.step().expect("the state stays finite");
    }
    assert!(simulation.ended_as().is_none());
    simulation.raise_push(1.0, 0.1).expect("it is a force");
    assert!(!simulation.is_over(), "it may leave");
}

/// Without friction, 42.4 N give it 42.4 N s in a second, and half as much while they rise. Its track of 2.4 kg moves
/// with its 21.2 kg, but not in the other engine, where the track is only a force.
#[test]
fn a_push_moves_a_robot_in_either_engine() {
    for (engine, mass) in [(Engine::Own, 21.2 + 2.4), (Engine::Rapier, 21.2)] {
        let mut scenario = skids();
        scenario.solver.engine = engine;
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(1e-3));
        if let Track::Force(track) = &mut scenario.robot.track {
            track.skid_friction = 0.0;
        }
        scenario.start.approach = 1.0;
        let checked = ValidScenario::new(&scenario).expect("it is valid");
        let mut simulation = Simulation::new(&checked);
        run_until(&mut simulation, 0.1);
        simulation.raise_push(42.4, 0.2).expect("it is a force");
        for (time, impulse) in [(0.3, 4.24), (0.5, 12.72)] {
            run_until(&mut simulation, time);
            let found = mass * simulation.reading().velocity.x;
            assert!(
                (found - impulse).abs() < 0.005 * impulse,
                "{engine:?}: {found} N s at {time} s"
            );
        }
    }
}

#[test]
#[allow(clippy::float_cmp)] // times are handed on
fn what_rounding_leaves_of_a_step_is_no_step() {
    let checked = ValidScenario::new(&skids()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    simulation.step().expect("the state stays finite");
    let (steps, limit) = (simulation.steps(), simulation.time() + 4e-10);
    simulation
        .step_until(limit)
        .expect("there is nothing to do");
    assert_eq!((simulation.steps(), simulation.time()), (steps, limit));
}

/// Its arms are on their way from 0.8 rad to 1.2 rad.
#[test]
fn a_branch_of_a_heavier_robot_goes_on_at_its_speed_and_with_its_arms_where_they_are() {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let gait = r#"{"kind":"hold","angle":1.2,"schedule":null,"front":null,"rear":null}"#;
    let mut value = serde_json::to_value(&scenario).expect("it is JSON");
    value["drive"]["gait"] = serde_json::from_str(gait).expect("it is JSON");
    scenario = Scenario::from_json(&value.to_string()).expect("it is valid");
    let mut heavier = scenario.clone();
    heavier.robot.mass += 1.0;
    let mut armless = heavier.clone();
    armless.robot.flippers = None;
    armless.drive.gait = None;
    let [own, heavier, armless] =
        [scenario, heavier, armless].map(|s| ValidScenario::new(&s).expect("it is valid"));
    let mut simulation = Simulation::new(&own);
    run_until(&mut simulation, 0.2);
    simulation.raise_push(3.0, 0.1).expect("it is a force");
    let angles = |simulation: &Simulation| simulation.now().flipper_angles().collect::<Vec<_>>();
    let before = (simulation.reading(), angles(&simulation));
    assert!(before.1[0] > 0.9, "{:?}", before.1);
    for (variant, arms) in [(&heavier, before.1.clone()), (&armless, vec![])] {
        let branch = simulation.branch(variant);
        let now = branch.reading();
        assert!((now.position - before.0.position).length() < 1e-12);
        assert_eq!(branch.commands.push, simulation.commands.push);
        assert!((now.track_speed - before.0.track_speed).abs() < 1e-12);
        assert!((now.track_position - before.0.track_position).abs() < 1e-12);
        assert_eq!(angles(&branch).len(), arms.len());
        for (found, angle) in angles(&branch).iter().zip(&arms) {
            assert!((found - angle).abs() < 1e-12, "{found} rad, {angle} rad");
        }
    }
    // A robot that gets arms has them at their initial angle in the scenario.
    let mut bare = Simulation::new(&armless);
    run_until(&mut bare, 0.1);
    let arms = angles(&bare.branch(&own));
    assert!((arms[0] - 0.8).abs() < 1e-12, "{arms:?}");
}

/// With its arms at an angle of 0, at which the scenario has its mass and moment of inertia.
#[test]
fn bodies_of_a_simulation_add_up_to_the_robot() {
    let texts = [
        include_str!("../../../../tests/scenarios/engineer_sprocket_step.json"),
        include_str!("../../../../tests/scenarios/engineer_flippers_step.json"),
    ];
    for text in texts {
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        if let Some(flippers) = &mut scenario.robot.flippers {
            flippers.angle = 0.0;
        }
        let robot = scenario.robot.clone();
        let checked = ValidScenario::new(&scenario).expect("it is valid");
        let simulation = Simulation::new(&checked);
        let center = simulation.center_of_mass() - simulation.reading().position;
        assert!((center - Vector::from(robot.center_of_mass)).length() < 1e-12);
        let share = simulation.moment_of_inertia() / robot.moment_of_inertia;
        assert!((share - 1.0).abs() < 1e-12, "{share}");
        assert!((simulation.weight() / robot.mass - 9.81).abs() < 1e-12);
        assert!((simulation.half_length() - 0.1825).abs() < 1e-15);
    }
}

/// Rods of 1.55 kg and 0.34 m at 0.8 rad, on a chassis at 1 m/s: turning at 2 rad/s their middle moves by 0.34 m/s, of
/// which 0.34 m/s sin 0.8 = 0.2439 m/s backwards.
#[test]
fn an_arm_that_turns_upwards_takes_speed_from_its_middle() {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    simulation.state.velocity = Vector::new(1.0, 0.0);
    let before = simulation.energy();
    simulation.state.flippers[0].rate = 2.0;
    // Half of 1.55 kg times 0.34^2 / 3 m^2 times the square of the rate, less 1.55 kg x 1 m/s x 0.2439 m/s.
    let expected = 0.119_453 - 0.378_047;
    let gained = simulation.energy() - before;
    assert!((gained - expected).abs() < 2e-6, "{gained} J");
}

/// Pins of both tracks with 2 x 4 N m/rad: a shoe of a straight run that turns by 0.01 rad bends two of them.
#[test]
fn a_bent_pin_stores_half_of_its_stiffness_times_the_square_of_its_angle() {
    let text = include_str!("../../../../tests/scenarios/engineer_chain_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    if let Track::Segmental(chain) = &mut scenario.robot.track {
        chain.pin_stiffness = 4.0;
    }
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let before = simulation.energy();
    let is_straight = |pair: &[Shoe]| pair[0].bend(&pair[1]).abs() < 1e-9;
    let mut runs = simulation.state.shoes.windows(3);
    let straight = runs.position(|run| run.windows(2).all(is_straight));
    let middle = straight.expect("it has a straight run") + 1;
    simulation.state.shoes[middle].angle += 0.01;
    let gained = simulation.energy() - before;
    assert!((gained - 8e-4).abs() < 1e-10, "{gained} J");
}

/// Their roots are as large as the wheels, and bear on level ground while they are raised.
#[test]
fn arms_touch_the_ground_where_they_bear_beyond_their_roots() {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let flippers = scenario.robot.flippers.as_mut().expect("it has some");
    flippers.ends = Ends::Both;
    scenario.robot.moment_of_inertia = 1.0;
    scenario.drive.gait = None;
    scenario.drive.speed = 0.0;
    scenario.start.approach = 1.0;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let touches = |angles: [f64; 2]| {
        let mut simulation = Simulation::new(&checked);
        let commands = ByHand {
            speed: None,
            flippers: angles.map(|angle| Some(FlipperCommand::Angle(angle))),
            push: None,
        };
        simulation
            .command_all(&commands)
            .expect("they are within limits");
        run_until(&mut simulation, 1.5);
        [End::Front, End::Rear].map(|end| simulation.flipper_touches(end))
    };
    assert_eq!(touches([0.8, 0.8]), [false, false]);
    assert_eq!(touches([-0.2, 0.8]), [true, false]);
    assert_eq!(touches([0.8, -0.2]), [false, true]);
    assert_eq!(touches([-0.2, -0.2]), [true, true]);
}

/// It speeds up evenly on level ground, so a mean over a part of a step is the speed in its middle.
#[test]
fn a_robot_that_drives_straight_on_has_a_path_as_long_as_its_way() {
    let mut scenario = engineer();
    scenario.start.approach = 1.0;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let begin = simulation.reading().position.x;
    run_until(&mut simulation, 1.0);
    let way = simulation.reading().position.x - begin;
    let path = simulation.monitor.observed.path_length;
    assert!(
        (path - way).abs() < 1e-4 * way && way > 0.05,
        "{path} {way}"
    );
}

/// The Engineer on level ground, at rest with arms at this end and angle [rad], after a millisecond.
fn on_arms(ends: Ends, angle: f64) -> Simulation {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    let flippers = scenario.robot.flippers.as_mut().expect("it has some");
    (flippers.ends, flippers.angle) = (ends, angle);
    scenario.drive.gait = None;
    scenario.drive.speed = 0.0;
    scenario.start.approach = 1.0;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    run_until(&mut simulation, 1e-3);
    simulation
}

/// The track of the chassis bears, as far along them as they are long.
#[test]
fn arms_that_are_folded_over_the_chassis_touch_nothing() {
    for end in [End::Front, End::Rear] {
        let ends = if end == End::Front {
            Ends::Front
        } else {
            Ends::Rear
        };
        let simulation = on_arms(ends, 3.0);
        let pivot = simulation.reading().position + simulation.model().flippers[0].pivot;
        let bears = simulation.loaded().iter().any(|contact| {
            let behind = end.sign() * (pivot - contact.point).x;
            behind > 0.3 && contact.normal_force > 1.0
        });
        assert!(bears && !simulation.flipper_touches(end), "{end:?}");
    }
}

/// Their tips of 37 mm are 10 um over the ground on which their roots of 64 mm stand, 0.34 m away.
#[test]
fn an_arm_that_hovers_over_the_ground_does_not_touch_it() {
    let angle = -libm::asin((0.064 - 0.037 - 1e-5) / 0.34);
    let simulation = on_arms(Ends::Front, angle);
    let ahead = simulation.reading().position.x + 0.4;
    let mut of_tip = simulation.loaded().iter().filter(|l| l.point.x > ahead);
    assert!(of_tip.all(|contact| contact.normal_force.to_bits() == 0));
    assert!(
        simulation.loaded().iter().any(|l| l.point.x > ahead),
        "it is near"
    );
    assert!(!simulation.flipper_touches(End::Front));
}

/// An arm touches with what is on it, bears, and lies farther along it than its root reaches, however far beside it.
#[test]
fn of_the_contacts_of_an_arm_those_beyond_its_root_touch() {
    for (end, ends, angle) in [
        (End::Front, Ends::Front, 0.8),
        (End::Front, Ends::Front, -0.3),
        (End::Rear, Ends::Rear, 0.8),
        (End::Rear, Ends::Rear, 2.5),
    ] {
        let mut simulation = on_arms(ends, angle);
        let model = simulation.model().clone();
        let pose = simulation.state.pose(&model);
        let pivot = pose.transform_point(model.flippers[0].pivot);
        let along = pose.rotation * (direction(end.sign() * angle) * end.sign());
        let of_arm = |part: &crate::robot::Part| part.mount == Mount::Flipper(0);
        let arm = model.parts.iter().position(of_arm).expect("it has one");
        let chassis = model.parts.iter().position(|part| !of_arm(part));
        let mut touches = |part: usize, far: f64, aside: f64, force: f64| {
            let point = pivot + along * far + crate::geometry::left_of(along) * aside;
            let contact = Contact {
                normal_force: force,
                ..Contact::new(part, (0, -1), (point, Vector::Y), 0.0)
            };
            simulation.dynamics.take_contacts(vec![contact], 0.0, 1e-3);
            simulation.flipper_touches(end)
        };
        for aside in [-0.06, 0.06] {
            assert!(touches(arm, 0.066, aside, 1.0) && touches(arm, 0.3, aside, 1.0));
            assert!(!touches(arm, 0.062, aside, 1.0) && !touches(arm, -0.3, aside, 1.0));
            assert!(!touches(arm, 0.3, aside, 0.0));
            assert!(!touches(chassis.expect("it has a track"), 0.3, aside, 1.0));
        }
    }
}

/// What does not change is shared, and what does is built.
#[test]
fn a_variant_of_a_stop_stands_on_its_own_ground_only_if_that_differs() {
    let checked = ValidScenario::new(&skids()).expect("it is valid");
    let simulation = Simulation::new(&checked);
    let mut variant = skids();
    variant.robot.drivetrain.max_torque = 1.0;
    let same = simulation.varied(&variant, true).expect("it can be built");
    assert!(Arc::ptr_eq(&same.ground, &simulation.ground));
    variant.terrain.scale_friction(0.5);
    let other = simulation.varied(&variant, true).expect("it can be built");
    let friction = |simulation: &Simulation| simulation.ground.lanes[0].friction.most().coefficient;
    let share = friction(&other) / friction(&simulation);
    assert!((share - 0.5).abs() < 1e-12, "{share}");
}

/// Speeds change at 1 s and 2 s, angles of arms at 1.5 s, and a push has risen at 1.2 s.
#[test]
fn a_command_changes_next_at_an_entry_of_a_schedule_or_when_it_is_reached() {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let mut value: serde_json::Value = serde_json::from_str(text).expect("it is JSON");
    value["drive"]["schedule"] = serde_json::json!([[1.0, 0.2], [2.0, 0.1]]);
    value["drive"]["gait"] = serde_json::json!({
        "kind": "hold", "angle": 0.8, "schedule": [[1.5, 0.7]], "front": null, "rear": null,
    });
    let checked = ValidScenario::from_json(&value.to_string()).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    let command = checked.scenario().drive.speed;
    let rate = checked.scenario().robot.drivetrain.max_acceleration;
    let next = |simulation: &mut Simulation, time: f64| {
        simulation.time = time;
        simulation.next_change()
    };
    // At rest it takes its ramp; here that is longer than a second.
    simulation.commands.speed = 1.3 * rate;
    for (time, change) in [(0.0, 1.0), (1.0, 1.5), (1.5, 2.0), (2.0, 3.3)] {
        let found = next(&mut simulation, time);
        assert!((found - change).abs() < 1e-12, "{found} s, {change} s");
    }
    simulation.commands.speed = command;
    simulation.set_point = command;
    assert!(next(&mut simulation, 2.5).is_infinite());
    simulation.time = 0.7;
    simulation.raise_push(1.0, 0.5).expect("it is a force");
    for (time, change) in [(0.8, 1.0), (1.1, 1.2), (1.2, 1.5)] {
        let found = next(&mut simulation, time);
        assert!((found - change).abs() < 1e-12, "{found} s, {change} s");
    }
}

/// A stop counts from as many windows on as the criteria say, after the push has risen.
#[test]
fn a_push_leaves_a_robot_its_windows_to_get_away() {
    let scenario = skids();
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    while !simulation.is_over() {
        simulation.step().expect("the state stays finite");
    }
    let now = simulation.time();
    simulation.raise_push(1.0, 0.5).expect("it is a force");
    let windows = f64::from(scenario.criteria.stationary_windows);
    let end = now + 0.5 + windows * simulation.stop_window();
    for (time, is_over) in [(now, false), (end - 1e-6, false), (end + 1e-6, true)] {
        simulation.time = time;
        assert_eq!(simulation.is_over(), is_over, "{time} s");
    }
}

/// Relative to a chassis that turns nose up by 0.3 rad/s; upwards is clockwise at the rear.
#[test]
fn rates_and_torques_of_arms_count_upwards_at_either_end() {
    let text = include_str!("../../../../tests/scenarios/engineer_flippers_step.json");
    let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
    scenario.robot.flippers.as_mut().expect("it has some").ends = Ends::Both;
    scenario.robot.moment_of_inertia = 1.0;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    simulation.state.angular_velocity = 0.3;
    for (arm, (rate, torque)) in simulation
        .state
        .flippers
        .iter_mut()
        .zip([(1.0, 5.0), (-1.0, -7.0)])
    {
        (arm.rate, arm.torque) = (rate, torque);
    }
    let close = |found: Vec<f64>, expected: [f64; 2]| {
        assert_eq!(found.len(), 2);
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{found:?}");
    };
    close(simulation.flipper_rates().collect(), [0.7, 1.3]);
    close(simulation.flipper_torques().collect(), [5.0, 7.0]);
    // Raised to 0.8 rad at either end.
    close(simulation.flipper_angles().collect(), [0.8, 0.8]);
}

/// 21.2 kg of the robot move, its track and two rotors turn; the rotors turn over the chassis.
#[test]
fn energy_is_that_of_motion_of_turning_parts_and_of_height() {
    let mut scenario = engineer();
    scenario.robot.drivetrain.rotor_inertia = 0.02;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let gained = |change: fn(&mut State)| {
        let mut simulation = Simulation::new(&checked);
        let before = simulation.energy();
        change(&mut simulation.state);
        simulation.energy() - before
    };
    let robot = &scenario.robot;
    let model = checked.model();
    let (track, rotors) = (model.drive_inertia(0), model.rotor_inertia(0));
    assert!(track > 1e-3 && rotors > 1e-3);
    let mass = robot.mass;
    let chassis = robot.moment_of_inertia - track;
    for (found, expected) in [
        (gained(|s| s.velocity = Vector::new(3.0, 4.0)), 12.5 * mass),
        (gained(|s| s.center.y += 2.0), 2.0 * 9.81 * mass),
        (gained(|s| s.drives[0].spin = 3.0), 4.5 * (track + rotors)),
        (
            gained(|s| s.angular_velocity = 2.0),
            2.0 * (chassis + rotors),
        ),
        // All of it turns, except the rotors.
        (
            gained(|s| (s.angular_velocity, s.drives[0].spin) = (2.0, 2.0)),
            2.0 * robot.moment_of_inertia,
        ),
    ] {
        // Rounding of some hundreds of joules.
        assert!((found - expected).abs() < 1e-11, "{found} J, {expected} J");
    }
}

/// With another centre of mass, which moves otherwise, as the chassis turns.
#[test]
fn a_rebuilt_robot_moves_and_turns_as_it_did() {
    let scenario = engineer();
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    run_until(&mut simulation, 0.05);
    simulation.state.velocity = Vector::new(0.3, 0.1);
    simulation.state.angular_velocity = 0.7;
    simulation.state.drives[0].spin = -4.0;
    let before = simulation.reading();
    let mut variant = scenario;
    variant.robot.center_of_mass = [0.04, 0.05];
    variant.robot.mass += 1.0;
    let branch = simulation.branch(&ValidScenario::new(&variant).expect("it is valid"));
    let now = branch.reading();
    assert!((now.position - before.position).length() < 1e-12);
    assert!((now.velocity - before.velocity).length() < 1e-12);
    assert!((now.angular_velocity - 0.7).abs() < 1e-15);
    assert!((now.track_speed - before.track_speed).abs() < 1e-12);
    assert!((now.track_position - before.track_position).abs() < 1e-15);
    assert!((now.time - 0.05).abs() < 1e-12);
    let center = branch.center_of_mass() - now.position;
    let expected = crate::geometry::turned_by(now.chassis_angle)(Vector::new(0.04, 0.05));
    assert!((center - expected).length() < 1e-12);
}

/// Its own end does not matter, and a time that it misses by rounding is reached.
#[test]
fn a_run_is_replayed_up_to_the_first_step_that_reaches_a_time() {
    let mut scenario = engineer();
    scenario.duration = 0.02;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut undisturbed = Simulation::new(&checked);
    for _ in 0..3 {
        undisturbed
            .step_until(0.02)
            .expect("the state stays finite");
    }
    let at = undisturbed.time();
    assert!(at < 0.02, "{at} s");
    for time in [at, at - 1e-6, at + 0.9e-9] {
        let found = Simulation::replayed(&checked, time, &Cancel::default());
        let found = found.expect("nobody asks it to end");
        assert_eq!(found.steps(), 3, "{time} s");
        assert_eq!(bits(&found), bits(&undisturbed));
    }
    let found = Simulation::replayed(&checked, 0.03, &Cancel::default());
    let end = found.expect("nobody asks it to end").time();
    assert!((end - 0.03).abs() < 1e-9, "{end} s");
    let cancel = Cancel::default();
    cancel.ask();
    assert!(Simulation::replayed(&checked, at, &cancel).is_err());
}

/// Three wheels, each with its own motor.
#[test]
fn the_speed_and_way_of_a_track_are_means_over_its_motors() {
    let mut scenario = gears(3, 0.05, 0.0);
    scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
    let checked = ValidScenario::new(&scenario).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
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
    let checked = ValidScenario::new(&engineer()).expect("it is valid");
    // A step has four points; a belt and a belly are two parts.
    assert_eq!(Simulation::new(&checked).size(), (4, 2));
}
