//! Copies, branches, variants and replays of a simulation.

use super::*;

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
        let [mut whole, mut undisturbed] = [(); 2].map(|()| started(&scenario));
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

/// Its arms are on their way from 0.8 rad to 1.2 rad.
#[test]
fn a_branch_of_a_heavier_robot_goes_on_at_its_speed_and_with_its_arms_where_they_are() {
    let mut scenario = shared("engineer_flippers_step");
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

/// What does not change is shared, and what does is built.
#[test]
fn a_variant_of_a_stop_stands_on_its_own_ground_only_if_that_differs() {
    let simulation = started(&skids());
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

/// With another centre of mass, which moves otherwise, as the chassis turns.
#[test]
fn a_rebuilt_robot_moves_and_turns_as_it_did() {
    let scenario = engineer();
    let mut simulation = started(&scenario);
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
