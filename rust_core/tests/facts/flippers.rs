//! Flippers on the ground: what their motors bear, and what they do to the robot.

use approx::assert_relative_eq;
use crawler2d_core::{
    Drive, End, Ends, Error, FlipperCommand, Gait, Hold, Outcome, Record, Scenario, Simulation,
    Track, ValidScenario, Wheel, simulate,
};

use crate::common::*;

/// Every model that has a form for arms.
fn models() -> Vec<(&'static str, Track)> {
    vec![
        ("belt", belt()),
        ("belt with grousers", grouser_belt()),
        ("line of 3", line(3)),
        ("line of 3 gear wheels", line_of(3, paper_gear())),
        ("24 all round", circumferential(24, Wheel::Round)),
        (
            "24 gear wheels all round",
            circumferential(24, paper_gear()),
        ),
        ("chain", segmental(None)),
        ("chain on a sprocket", sprocketed(None)),
        ("force on skids", force()),
        ("force on wheels", force_on_wheels()),
    ]
}

#[test]
fn an_arm_held_in_the_air_bears_its_weight() {
    for angle in [0.0, 0.5, 1.2, 2.0] {
        let mut scenario = with_flippers(Ends::Both, belt());
        scenario.terrain = slope(0.0, 0.9);
        scenario.drive = Drive {
            speed: 0.0,
            schedule: None,
            gait: Some(hold(angle)),
        };
        let torques: Vec<f64> = after(&scenario, 3.0).flipper_torques().collect();
        let weight = 2.0 * 0.775 * G * 0.17 * angle.cos();
        for torque in torques {
            assert_relative_eq!(torque, weight, epsilon = 1e-3);
        }
    }
}

/// A motor at its limit presses the tip down with its torque by the lever, whatever the angle it is to go to.
#[test]
fn an_arm_presses_down_with_the_limit_of_its_torque() {
    let mut scenario = with_flippers(Ends::Front, belt());
    scenario.terrain = slope(0.0, 0.0);
    flippers(&mut scenario).torque_limit = 5.0;
    scenario.drive = Drive {
        speed: 0.0,
        schedule: None,
        gait: Some(hold(-1.0)),
    };
    let simulation = after(&scenario, 3.0);
    let table = simulation.contact_table();
    let pivot = simulation.reading().position.x + 0.1825;
    let is_tip = |x: f64| x > pivot + 0.2;
    let (mut moment, mut weight) = (0.0, 0.0);
    for (x, force) in table.x.iter().zip(&table.normal_force) {
        weight += force;
        if is_tip(*x) {
            moment += (x - pivot) * force;
        }
    }
    let angle = simulation.flipper_angles().next().expect("it has one");
    let of_arm = 2.0 * 0.775 * G * 0.17 * angle.cos();
    println!("presses with {moment:.4} N m at {angle:.4} rad");
    assert!(angle > -0.2, "the robot is too heavy to be lifted: {angle}");
    assert_relative_eq!(moment, 10.0 + of_arm, max_relative = 1e-3);
    assert_relative_eq!(weight, scenario.robot.mass * G, max_relative = 1e-3);
}

#[test]
fn a_schedule_is_followed_at_the_limit_of_the_rate() {
    let mut scenario = with_flippers(Ends::Front, belt());
    scenario.terrain = slope(0.0, 0.9);
    scenario.drive = Drive {
        speed: 0.2,
        schedule: Some(vec![[1.0, -0.2], [2.0, 0.0]]),
        gait: Some(Gait::Hold(Hold {
            angle: 0.0,
            schedule: Some(vec![[0.5, 1.0], [2.5, 0.6]]),
            front: None,
            rear: None,
        })),
    };
    scenario.duration = 3.0;
    scenario.robot.drivetrain.max_acceleration = 4.0;
    let run = simulate(&checked(&scenario), Record::default()).expect("it runs");
    let at = |time: f64| (time / 0.01).round() as usize;
    for (time, angle) in [
        (0.5, 0.0),
        (1.0, 0.5),
        (1.5, 1.0),
        (2.5, 1.0),
        (2.7, 0.8),
        (2.9, 0.6),
    ] {
        assert_relative_eq!(run.trace.flipper_angles[at(time)], angle, epsilon = 5e-3);
    }
    for (time, speed) in [(0.9, 0.2), (1.9, -0.2), (2.9, 0.0)] {
        assert_relative_eq!(run.trace.track_speed[at(time)], speed, epsilon = 1e-3);
    }
}

/// A climb has the front arms level over ground while the chassis turns. Aimed at where the chassis was,
/// they would lag behind by what it turns in a step.
#[test]
fn arms_held_level_do_not_lag_behind_a_chassis_that_turns() {
    let mut scenario = with_flippers(Ends::Both, belt());
    scenario.terrain = step(0.3, 0.9);
    scenario.drive.gait = Some(climb());
    let mut simulation = Simulation::new(&checked(&scenario));
    let mut lags = Vec::new();
    while simulation.time() < 6.0 {
        simulation.step().expect("it runs");
        let now = simulation.reading();
        let over_chassis = simulation.flipper_angles().next().expect("it has one");
        let off = (over_chassis + now.chassis_angle).abs();
        let turns = now.angular_velocity.abs() * 1e-3;
        // Within reach of the level, above the tenth of a radian that starts it.
        if off < 5e-3 && now.chassis_angle > 0.1 && turns > 1e-4 {
            lags.push(off / turns);
        }
    }
    lags.sort_by(f64::total_cmp);
    let median = lags[lags.len() / 2];
    println!(
        "off by {median:.4} of what the chassis turns in a step, {} steps",
        lags.len()
    );
    assert!(lags.len() > 100, "it hardly turns: {} steps", lags.len());
    assert!(median < 0.05, "off by {median} of a step's turn");
}

/// Arms and chassis turn and stand on both; all contacts together bear weight and inertia.
#[test]
fn contact_forces_bear_weight_and_inertia_while_arms_move() {
    for (name, track) in models() {
        if name.starts_with("force") {
            continue; // its push is no contact force
        }
        let mut scenario = with_flippers(Ends::Both, track);
        scenario.terrain = slope(0.0, 0.9);
        flippers(&mut scenario).angle = 0.5;
        scenario.drive = Drive {
            speed: 0.3,
            schedule: None,
            gait: Some(Gait::Hold(Hold {
                angle: 0.5,
                schedule: Some(vec![[0.2, -0.6]]),
                front: None,
                rear: None,
            })),
        };
        let mut simulation = after(&scenario, 0.1);
        let (mut worst, mut hardest, weight) = (0.0_f64, 0.0_f64, scenario.robot.mass * G);
        let (mut raised, mut sum) = (0.0_f64, [0.0; 2]);
        let begin = simulation.momentum();
        while simulation.time() < 2.5 {
            let before = simulation.momentum();
            simulation.step().expect("finite");
            let dt = simulation.last_step();
            let gained = (simulation.momentum() - before) / dt;
            let (fx, fy, _) = contact_sums(&simulation, 0.0, 0.0);
            worst = worst.max((fx - gained.x).abs().max((fy - weight - gained.y).abs()));
            // An impact of 20 us is a large force.
            hardest = hardest.max(fx.hypot(fy));
            sum = [sum[0] + fx * dt, sum[1] + (fy - weight) * dt];
            raised = raised.max(simulation.reading().position.y);
        }
        let gained = simulation.momentum() - begin;
        let mean = (sum[0] - gained.x).abs().max((sum[1] - gained.y).abs()) / 2.4;
        println!(
            "{name}: {:.1e} of the weight at worst, {:.1e} in the mean, raised to {raised:.3} m",
            worst / weight,
            mean / weight
        );
        assert!(raised > 0.1, "{name} was raised to {raised} m");
        assert!(worst < 1e-10 * hardest, "{name}: {worst} N in a step");
        assert!(mean < 1e-11 * weight, "{name}: {mean} N in the mean");
    }
}

#[test]
fn two_equal_lanes_are_one() {
    for (name, track) in models() {
        let mut scenario = with_flippers(Ends::Both, track);
        scenario.drive.gait = Some(hold(0.4));
        let (off, _) = equal_lanes_off(&scenario);
        println!("{name}: lanes off {off:.1e}");
        // The pivot's disc lies on that of the end axle, and Coulomb leaves open which of both holds what.
        // Where grousers strike, that shows.
        let smooth = [
            "belt",
            "line of 3",
            "24 all round",
            "force on skids",
            "force on wheels",
        ];
        let limit = match name {
            "chain on a sprocket" => 1e-3, // as without arms
            _ if smooth.contains(&name) => 1e-5,
            _ => 2e-4,
        };
        assert!(off < limit, "{name}");
    }
}

/// What holds the weight over the edge is where it lies: arms at the front raise the nose and no more, those
/// at the rear lift it over.
#[test]
fn arms_at_the_rear_climb_what_those_at_the_front_cannot() {
    let outcome = |ends: Ends, height: f64| {
        let mut scenario = with_flippers(ends, belt());
        flippers(&mut scenario).angle = 0.8;
        scenario.terrain = step(height, 0.9);
        scenario.drive.gait = Some(climb());
        simulate(&checked(&scenario), Record::summary())
            .expect("it runs")
            .outcome
    };
    assert_eq!(outcome(Ends::Front, 0.08), Outcome::Cleared);
    assert_eq!(outcome(Ends::Front, 0.14), Outcome::TippedOver);
    assert_eq!(outcome(Ends::Rear, 0.14), Outcome::Cleared);
    assert_eq!(outcome(Ends::Both, 0.25), Outcome::Cleared);
}

/// In front of this step contacts of arms open by 0.1 um for an instant. A driver who took that for the loss of contact raised
/// the arms: at 1 um, two of these runs did not clear.
#[test]
fn a_climb_does_not_depend_on_contacts_that_open_for_an_instant() {
    let mut scenario = with_flippers(Ends::Front, line(5));
    scenario.robot.center_of_mass = [0.0276, 0.0297];
    scenario.robot.moment_of_inertia = 0.601;
    flippers(&mut scenario).angle = 0.8;
    scenario.terrain = step(0.1487, 0.91);
    (scenario.drive.speed, scenario.drive.gait) = (0.37, Some(climb()));
    for accuracy in [1e-6, 3e-7, 3e-8] {
        scenario.solver.accuracy = Some(accuracy);
        let mut clears = |k: u32| {
            scenario.start.approach = 0.05 + 0.01 * f64::from(k);
            run(&scenario).outcome == Outcome::Cleared
        };
        assert_eq!((0..10).filter(|k| clears(*k)).count(), 10, "{accuracy} m");
    }
}

/// Both ends upwards, then the front ones on to the ground, which a motor too weak to lift the robot does not pass.
#[test]
fn arms_turn_at_a_commanded_rate_as_far_as_their_motors_can() {
    let mut scenario = with_flippers(Ends::Both, belt());
    scenario.terrain = slope(0.0, 0.9);
    scenario.drive.speed = 0.0;
    flippers(&mut scenario).torque_limit = 5.0;
    let mut simulation = Simulation::new(&checked(&scenario));
    let both = [End::Front, End::Rear];
    let turn = |simulation: &mut Simulation, rates: [f64; 2], duration: f64| {
        for (end, rate) in both.into_iter().zip(rates) {
            let command = FlipperCommand::Rate(rate);
            simulation.command_flippers(end, command).expect("it can");
        }
        advance(simulation, duration);
        simulation.flipper_angles().collect::<Vec<f64>>()
    };
    let up = turn(&mut simulation, [0.5, 0.2], 2.0);
    // Getting up to the rate takes the motor's torque over the inertia of the arms, some hundredths of a second.
    assert_relative_eq!(up[0], 1.0, epsilon = 0.02);
    assert_relative_eq!(up[1], 0.4, epsilon = 0.02);
    let held = turn(&mut simulation, [0.0, 0.0], 2.0);
    // They stop within as long, and then hold their weight.
    assert_relative_eq!(held[0], up[0], epsilon = 0.02);
    assert_relative_eq!(held[1], up[1], epsilon = 0.02);
    let later = turn(&mut simulation, [0.0, 0.0], 2.0);
    assert_relative_eq!(held[0], later[0], epsilon = 1e-6);
    let down = turn(&mut simulation, [-1.0, 0.0], 4.0);
    assert!((-0.2..0.0).contains(&down[0]), "{down:?}");
    let torque = simulation.flipper_torques().next().expect("it has two");
    assert_relative_eq!(torque, -10.0, max_relative = 1e-6);
    let refused = simulation.command_flippers(End::Front, FlipperCommand::Rate(1.5));
    let message = refused.expect_err("their limit is 1 rad/s").to_string();
    assert!(message.contains("flipper_rate"), "{message}");
}

#[test]
fn snapshots_go_on_with_the_same_bits() {
    for (name, track) in models() {
        let mut scenario = with_flippers(Ends::Both, track);
        scenario.drive.gait = Some(climb());
        let mut one = after(&scenario, 2.0);
        one.command_flippers(End::Rear, FlipperCommand::Angle(0.3))
            .expect("it has them");
        let mut other = Simulation::from_snapshot(&one.snapshot().expect("our own dynamics"))
            .expect("a snapshot");
        for _ in 0..1000 {
            one.step().expect("finite");
            other.step().expect("finite");
        }
        let bits = |s: &Simulation| {
            let r = s.reading();
            let arms: Vec<u64> = s.flipper_angles().map(f64::to_bits).collect();
            (r.position.x.to_bits(), r.chassis_angle.to_bits(), arms)
        };
        assert_eq!(bits(&one), bits(&other), "{name}");
    }
}

/// So that a study can leave the flippers of its robots off and keep how they are driven.
#[test]
fn a_gait_without_flippers_moves_nothing() {
    let mut without = engineer();
    let plain = run(&without);
    without.drive.gait = Some(hold(0.7));
    let driven = run(&without);
    assert_eq!(driven.trace.position, plain.trace.position);
    assert_eq!(driven.metrics, plain.metrics);
    assert_eq!(driven.outcome, plain.outcome);
}

#[test]
fn arms_and_shoes_that_leave_no_chassis_are_refused() {
    let mut scenario = with_flippers(Ends::Both, belt());
    let path = |scenario: &Scenario| match ValidScenario::new(scenario).map(|_| ()) {
        Err(Error::Scenario(error)) => error.path,
        other => panic!("{other:?}"),
    };
    flippers(&mut scenario).mass = 5.0;
    assert_eq!(path(&scenario), "robot.flippers.mass");
    flippers(&mut scenario).mass = 2.0;
    assert_eq!(path(&scenario), "robot.moment_of_inertia");
    flippers(&mut scenario).mass = 0.5;
    flippers(&mut scenario).track = Some(circumferential(4, Wheel::Round));
    assert_eq!(path(&scenario), "robot.flippers.track.count");
    let mut thin = engineer_on(segmental(None));
    // The track's mass at the ends of the outline alone would be 0.01.
    thin.robot.moment_of_inertia = 0.03;
    assert_eq!(path(&thin), "robot.moment_of_inertia");
    let by_hand = with_flippers(Ends::Rear, hybrid(Wheel::Round));
    assert_eq!(path(&by_hand), "robot.flippers.track");
}
