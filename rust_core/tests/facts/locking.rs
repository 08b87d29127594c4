//! Gears that lock themselves: the load turns no motor back, and holds none beyond its speed.

use approx::assert_relative_eq;
use crawler2d_core::{Error, Pi, Scenario, Simulation, TorqueSharing, Track, ValidScenario, Wheel};

use crate::basics::models;
use crate::common::*;
use crate::drawn::drawn;
use crate::energy::{follow, scale};

/// [rad] A slope on which every robot here sticks, with a friction of 0.9, ...
const SLOPE: f64 = 0.25;
/// ... and [N m] a torque of a sprocket that bears a third of its share of the weight there, and more than that on two.
const WEAK: f64 = 0.45;

/// Every model with a gear, on a slope that rises so much [rad] forwards.
fn on_slope(angle: f64) -> Vec<(&'static str, Scenario)> {
    let wheels = [
        ("line of 5 servos", line(5)),
        (
            "24 servos round the outline",
            circumferential(24, Wheel::Round),
        ),
    ];
    let servos = wheels.map(|(name, track)| {
        let mut scenario = engineer_on(track);
        scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
        (name, scenario)
    });
    let all = models().filter(|(name, _)| !name.starts_with("force"));
    all.chain(servos)
        .map(|(name, mut scenario)| {
            scenario.terrain = slope(angle, 0.9);
            scenario.start.angle = angle;
            scenario.robot.drivetrain.self_locking = true;
            (name, scenario)
        })
        .collect()
}

/// [m] How far a robot gets along x in 0.6 s, after it has settled for as long.
fn way(scenario: &Scenario) -> f64 {
    let mut simulation = after(scenario, 0.6);
    let start = simulation.reading().position.x;
    advance(&mut simulation, 0.6);
    simulation.reading().position.x - start
}

/// [m] How far a robot that stands may move: shoes settle on their guide for seconds, and shift where they are pushed.
fn still(scenario: &Scenario) -> f64 {
    if is_on_chain(scenario) { 1e-4 } else { 1e-6 }
}

/// Whether a robot may stand by the corners of what is round its arms.
fn stands_by_corners(name: &str) -> bool {
    strikes(name) && name.contains("on arms")
}

#[test]
fn a_robot_whose_motors_are_too_weak_stands_on_a_slope_by_its_gear_and_rolls_back_without() {
    for (name, mut scenario) in on_slope(SLOPE) {
        // Chains and gear wheels take seconds for each.
        let cases = if strikes(name) { few_or_many(1, 3) } else { 3 };
        for (torque, speed) in [(0.0, -0.4), (WEAK, 0.4), (WEAK, 0.0)]
            .into_iter()
            .take(cases as usize)
        {
            scenario.drive.speed = speed;
            scenario.robot.drivetrain.max_torque = torque;
            let held = way(&scenario);
            let mut without = scenario.clone();
            without.robot.drivetrain.self_locking = false;
            let rolled = way(&without);
            println!("{name}, {torque} N m, {speed} m/s: {held:+.1e} m, {rolled:+.2} m without");
            assert!(held.abs() < still(&scenario), "{name}");
            assert!(stands_by_corners(name) || rolled < -0.1, "{name}");
        }
    }
}

#[test]
fn uphill_a_gear_that_locks_changes_no_bit() {
    for (name, mut scenario) in on_slope(SLOPE) {
        // Impacts and wheels in gaps push drives ahead, which the gear does not let through.
        if strikes(name) || name.contains("round") || name.contains("arms") {
            continue;
        }
        for torque in [1.5, 20.0] {
            scenario.robot.drivetrain.max_torque = torque;
            let mut with = Simulation::new(&checked(&scenario));
            scenario.robot.drivetrain.self_locking = false;
            let mut without = Simulation::new(&checked(&scenario));
            scenario.robot.drivetrain.self_locking = true;
            let bits = |s: &Simulation| {
                let r = s.reading();
                [
                    r.position.x,
                    r.position.y,
                    r.chassis_angle,
                    s.drive_speed(0),
                ]
                .map(f64::to_bits)
            };
            while with.time() < 4.0 {
                with.step().expect("finite");
                without.step().expect("finite");
                assert_eq!(bits(&with), bits(&without), "{name} at {} s", with.time());
            }
            let found = with.drive_speed(0);
            println!("{name}, {torque} N m: the same bits, {found:.4} m/s");
            assert!(found > 0.39, "{name}");
        }
    }
}

#[test]
fn downhill_a_gear_that_locks_keeps_the_speed_that_weak_motors_lose() {
    for rotor in [0.0, 0.02] {
        for (i, (name, mut scenario)) in on_slope(-SLOPE).into_iter().enumerate() {
            let is_chosen = is_soak() || (rotor > 0.0) == i.is_multiple_of(2);
            if !is_chosen || rotor > 0.0 && is_on_chain(&scenario) {
                continue;
            }
            scenario.robot.drivetrain.max_torque = WEAK;
            scenario.robot.drivetrain.rotor_inertia = rotor;
            scenario.robot.drivetrain.max_acceleration = 1.0;
            let speed = |scenario: &Scenario| {
                let simulation = after(scenario, 1.5);
                let drives = (0..simulation.drives()).map(|k| simulation.drive_speed(k));
                drives.fold(0.0, f64::max)
            };
            let held = speed(&scenario);
            scenario.robot.drivetrain.self_locking = false;
            let ran = speed(&scenario);
            println!("{name}, rotor {rotor} kg m2: {held:.6} m/s, {ran:.2} m/s without");
            // What comes down on corners, and a chain on its guide, pulls drives to and fro, back by more than this torque.
            if !strikes(name) {
                assert_relative_eq!(held, 0.4, max_relative = 1e-6);
            }
            assert!(held < 0.4 * (1.0 + 1e-6), "{name}");
            // Impacts slow gear wheels down.
            assert!(stands_by_corners(name) || ran > 0.42, "{name}");
        }
    }
}

#[test]
fn a_drive_behind_a_lock_turns_no_faster_than_its_motor_does_without_load() {
    let mut scenario = engineer_on(belt());
    scenario.robot.drivetrain.self_locking = true;
    (
        scenario.robot.drivetrain.max_acceleration,
        scenario.drive.speed,
    ) = (1.0, 0.4);
    for (angle, most) in [(-SLOPE, 0.3), (-SLOPE, 0.7)] {
        scenario.terrain = slope(angle, 0.9);
        scenario.start.angle = angle;
        scenario.robot.drivetrain.no_load_speed = Some(most);
        let found = after(&scenario, 3.0).drive_speed(0);
        println!("{most} m/s without load: {found:.6} m/s downhill");
        assert_relative_eq!(found, most.min(0.4), max_relative = 1e-6);
    }
    // Uphill the line decides, as without a lock.
    let held = scenario.robot.mass * G * libm::sin(SLOPE);
    let most = 2.0 * scenario.robot.drivetrain.max_torque / 0.052;
    scenario.terrain = slope(SLOPE, 0.9);
    scenario.start.angle = SLOPE;
    scenario.robot.drivetrain.no_load_speed = Some(0.3);
    let found = after(&scenario, 4.0).drive_speed(0);
    let expected = 0.3 * (1.0 - held / most);
    println!("{found:.6} m/s uphill, closed form {expected:.6}");
    assert_relative_eq!(found, expected, max_relative = 1e-5);
}

#[test]
fn a_stalled_robot_that_is_pushed_back_gives_way_by_its_grip_and_not_by_its_gear() {
    for (name, mut scenario) in on_slope(0.0) {
        scenario.robot.drivetrain.max_torque = WEAK;
        scenario.robot.belly = None;
        let grip = 0.9 * scenario.robot.mass * G;
        for (share, slips) in [(0.8, false), (1.1, true)] {
            let mut simulation = after(&scenario, 0.5);
            simulation.raise_push(-share * grip, 0.2).expect("a push");
            advance(&mut simulation, 1.0);
            let (mut back, start) = (0.0_f64, simulation.reading().position.x);
            while simulation.time() < 2.5 {
                simulation.step().expect("finite");
                let drives = (0..simulation.drives()).map(|k| simulation.drive_speed(k));
                back = drives.fold(back, f64::min);
            }
            let moved = simulation.reading().position.x - start;
            println!(
                "{name}: {share} of the grip moves it by {moved:+.1e} m, drives {back:+.1e} m/s"
            );
            assert!(back > -1e-6, "{name}: {back} m/s");
            assert_eq!(moved < -0.1, slips, "{name}");
            assert!(slips || moved.abs() < still(&scenario), "{name}: {moved} m");
        }
    }
}

#[test]
fn gears_that_lock_gain_no_energy() {
    let mut draw = Draw(17);
    for (name, mut scenario) in on_slope(0.0) {
        for _ in 0..few_or_many(1, 2) {
            let drivetrain = &mut scenario.robot.drivetrain;
            drivetrain.max_torque = draw.between(0.0, 3.0);
            drivetrain.rotor_inertia = libm::exp(draw.between(-8.0, -2.0));
            drivetrain.no_load_speed = (draw.unit() < 0.5).then(|| draw.between(0.1, 1.0));
            if let Some(flippers) = &mut scenario.robot.flippers {
                flippers.torque_limit = draw.between(0.0, 30.0);
                flippers.self_locking = true;
            }
            let angle = draw.between(-0.4, 0.4);
            scenario.terrain = slope(angle, draw.between(0.0, 1.2));
            scenario.start.angle = angle;
            let account = follow(&scenario, 2.0);
            let share = account.gained / scale(&scenario, &account);
            println!("{name}: {share:.1e}");
            assert!(share <= 1e-3, "{name} gained {} J", account.gained);
        }
    }
}

#[test]
fn an_arm_that_its_motor_cannot_hold_is_held_by_its_gear_and_sinks_without() {
    let models: Vec<(&str, Track)> = vec![
        ("belt", belt()),
        ("belt with grousers", grouser_belt()),
        ("line of 5", line(5)),
        ("chain", segmental(None)),
        ("force", force()),
    ];
    for (name, track) in models {
        for torque in [0.0, 1.0] {
            let mut scenario = on_arms(-0.4, track.clone());
            scenario.terrain = slope(0.0, 0.9);
            scenario.drive.speed = 0.0;
            scenario.drive.gait = Some(hold(-0.4));
            flippers(&mut scenario).torque_limit = torque;
            let sunk = |locks: bool| {
                let mut scenario = scenario.clone();
                flippers(&mut scenario).self_locking = locks;
                let simulation = after(&scenario, 3.0);
                let angles = simulation.flipper_angles();
                angles.map(|angle| (angle + 0.4).abs()).fold(0.0, f64::max)
            };
            let (held, sank) = (sunk(true), sunk(false));
            println!("{name}, {torque} N m: {held:.1e} rad, {sank:.2} rad without");
            assert!(held < 1e-9 && sank > 0.1, "{name}");
        }
    }
}

/// The next drawn scenario that can have gears that lock, with them.
fn drawn_with_locks(draw: &mut Draw) -> (Scenario, ValidScenario) {
    loop {
        let mut scenario = drawn(draw);
        let drivetrain = &mut scenario.robot.drivetrain;
        (drivetrain.self_locking, drivetrain.controller) = (true, None);
        if let Some(flippers) = &mut scenario.robot.flippers {
            flippers.self_locking = true;
        }
        if let Ok(checked) = ValidScenario::new(&scenario) {
            return (scenario, checked);
        }
    }
}

#[test]
fn drawn_robots_with_locks_gain_no_more_than_their_motors_give() {
    let (seed, mut most) = (41, 0.0_f64);
    let mut draw = Draw(seed);
    for case in 0..40 {
        let (scenario, _) = drawn_with_locks(&mut draw);
        let account = follow(&scenario, scenario.duration);
        let share = account.gained / scale(&scenario, &account);
        most = most.max(share);
        assert!(share < 1e-3, "seed {seed} case {case}: {share:.1e}");
    }
    println!("seed {seed}: 40 robots gained {most:.1e} at most");
}

#[test]
fn a_simulation_with_locks_goes_on_from_a_snapshot_with_the_same_bits() {
    let seed = 31;
    let mut draw = Draw(seed);
    for run in 0..60 {
        let (_, checked) = drawn_with_locks(&mut draw);
        let mut whole = Simulation::new(&checked);
        advance(&mut whole, draw.between(0.0, 1.0));
        let bytes = |simulation: &Simulation| simulation.snapshot().expect("our own dynamics");
        let mut copy = Simulation::from_snapshot(&bytes(&whole)).expect("it was just made");
        for simulation in [&mut whole, &mut copy] {
            advance(simulation, 0.3);
        }
        assert!(bytes(&whole) == bytes(&copy), "run {run}");
    }
    println!("seed {seed}: 60 runs went on with the same bits");
}

#[test]
fn a_lock_with_a_controller_or_a_force_track_is_refused() {
    let refused = |change: fn(&mut Scenario)| {
        let mut scenario = engineer();
        scenario.robot.drivetrain.self_locking = true;
        change(&mut scenario);
        match ValidScenario::new(&scenario).map(|_| ()) {
            Err(Error::Scenario(error)) => error.path,
            other => panic!("{other:?}"),
        }
    };
    let with_controller = refused(|s| {
        s.robot.drivetrain.controller = Some(Pi {
            gain: 1.0,
            integral: 0.0,
        });
    });
    assert_eq!(with_controller, "robot.drivetrain.self_locking");
    let with_force = refused(|s| s.robot.track = force());
    assert_eq!(with_force, "robot.drivetrain.self_locking");
    let in_an_engine = refused(|s| {
        s.robot.track = line(3);
        *s = in_rapier(s);
    });
    assert_eq!(in_an_engine, "robot.drivetrain.self_locking");
}
