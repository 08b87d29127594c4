//! Arms: what they touch, and how their rates, torques and motion count.

use super::*;

/// Rods of 1.55 kg and 0.34 m at 0.8 rad, on a chassis at 1 m/s: turning at 2 rad/s their middle moves by 0.34 m/s, of
/// which 0.34 m/s sin 0.8 = 0.2439 m/s backwards.
#[test]
fn an_arm_that_turns_upwards_takes_speed_from_its_middle() {
    let scenario = shared("engineer_flippers_step");
    let mut simulation = started(&scenario);
    simulation.state.velocity = Vector::new(1.0, 0.0);
    let before = simulation.energy();
    simulation.state.flippers[0].rate = 2.0;
    // Half of 1.55 kg times 0.34^2 / 3 m^2 times the square of the rate, less 1.55 kg x 1 m/s x 0.2439 m/s.
    let expected = 0.119_453 - 0.378_047;
    let gained = simulation.energy() - before;
    assert!((gained - expected).abs() < 2e-6, "{gained} J");
}

/// Their roots are as large as the wheels, and bear on level ground while they are raised.
#[test]
fn arms_touch_the_ground_where_they_bear_beyond_their_roots() {
    let mut scenario = shared("engineer_flippers_step");
    let flippers = scenario.robot.flippers.as_mut().expect("it has some");
    flippers.ends = Ends::Both;
    scenario.robot.moment_of_inertia = 1.0;
    scenario.drive.gait = None;
    scenario.drive.speed = 0.0;
    scenario.start.approach = 1.0;
    let touches = |angles: [f64; 2]| {
        let mut simulation = started(&scenario);
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

/// The Engineer on level ground, at rest with arms at this end and angle [rad], after a millisecond.
fn on_arms(ends: Ends, angle: f64) -> Simulation {
    let mut scenario = shared("engineer_flippers_step");
    let flippers = scenario.robot.flippers.as_mut().expect("it has some");
    (flippers.ends, flippers.angle) = (ends, angle);
    scenario.drive.gait = None;
    scenario.drive.speed = 0.0;
    scenario.start.approach = 1.0;
    let mut simulation = started(&scenario);
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

/// Relative to a chassis that turns nose up by 0.3 rad/s; upwards is clockwise at the rear.
#[test]
fn rates_and_torques_of_arms_count_upwards_at_either_end() {
    let mut scenario = shared("engineer_flippers_step");
    scenario.robot.flippers.as_mut().expect("it has some").ends = Ends::Both;
    scenario.robot.moment_of_inertia = 1.0;
    let mut simulation = started(&scenario);
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
