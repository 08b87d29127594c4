//! Why a robot stops: hand-solved cases, and what a closed belt does in its place.

use crawler2d_core::{
    Cancel, Change, ClosedSurface, ClosedTrack, Mechanism, Outcome, Run, Scenario, Simulation,
    Surface, Terrain, Track, Wanted, Wheel, escape_force, make_trials, simulate,
};

use crate::common::*;

fn ends_in_a_stop(scenario: &Scenario) -> Simulation {
    let mut simulation = Simulation::new(&checked(scenario));
    while !simulation.is_over() && simulation.time() < scenario.duration {
        simulation
            .step_until(scenario.duration)
            .expect("the state stays finite");
    }
    simulation
}

/// Whether a change frees a robot from a stop.
fn is_freed(stopped: &Simulation, change: Change) -> bool {
    let at = stopped.time();
    let scenario = checked(stopped.scenario());
    let made = make_trials(&scenario, at, Wanted::of([change]), &Cancel::default());
    made.expect("the state stays finite")[0].freed
}

/// The robot in a closed belt, in the pose of a stop.
fn in_a_closed_belt(stopped: &Simulation, surface: ClosedSurface) -> Simulation {
    let mut scenario = stopped.scenario().clone();
    scenario.robot.track = Track::Closed(ClosedTrack {
        of: Box::new(scenario.robot.track),
        surface,
    });
    stopped.branch(&checked(&scenario))
}

/// [J] Kinetic and potential energy of robot and track.
fn energy(simulation: &Simulation) -> f64 {
    let (now, scenario) = (simulation.reading(), simulation.scenario());
    let robot = &scenario.robot;
    let (sine, cosine) = libm::sincos(now.chassis_angle);
    let [x, y] = robot.center_of_mass;
    let arm = [cosine * x - sine * y, sine * x + cosine * y];
    let (vx, vy) = (
        now.velocity.x - now.angular_velocity * arm[1],
        now.velocity.y + now.angular_velocity * arm[0],
    );
    let radius = robot.outline.rear_radius();
    let circulating = robot.track_mass * radius * radius;
    let spin = now.angular_velocity - now.track_speed / radius;
    0.5 * robot.mass * (vx * vx + vy * vy)
        + 0.5 * (robot.moment_of_inertia - circulating) * now.angular_velocity.powi(2)
        + 0.5 * circulating * spin * spin
        + robot.mass * scenario.gravity * (now.position.y + arm[1])
}

/// Robots that seize on steps and posts, with whatever depth the ground has inside them.
fn seized(draw: &mut Draw) -> Option<Simulation> {
    seized_on(draw, &Wheel::Round)
}

/// The same on wheels of a shape.
fn seized_on(draw: &mut Draw, wheel: &Wheel) -> Option<Simulation> {
    let mut scenario = engineer();
    let tracks = [
        line_of(3, wheel.clone()),
        line_of(4, wheel.clone()),
        line_of(5, wheel.clone()),
        line_of(6, wheel.clone()),
        circumferential(24, wheel.clone()),
        hybrid(wheel.clone()),
    ];
    let i = (draw.unit() * tracks.len() as f64) as usize;
    scenario.robot.track = tracks[i].clone();
    scenario.robot.center_of_mass[0] = draw.between(-0.05, 0.03);
    if draw.unit() < 0.5 {
        scenario.robot.belly = None;
    }
    let (height, friction) = (draw.between(0.04, 0.12), draw.between(0.5, 1.1));
    scenario.terrain = if draw.unit() < 0.5 {
        step(height, friction)
    } else {
        Terrain::Barrier {
            height,
            thickness: draw.between(0.01, 0.05),
            surface: Surface::sharp(friction),
        }
    };
    scenario.robot.drivetrain.max_deceleration = 1e3;
    scenario.duration = 10.0;
    let simulation = ends_in_a_stop(&scenario);
    (outcome_now(&simulation) == Outcome::Seized).then_some(simulation)
}

#[test]
fn letting_the_ground_out_of_a_closed_belt_gives_no_energy() {
    let seed = 3;
    let mut draw = Draw(seed);
    let (mut count, mut deepest, mut most, mut freed) = (0, 0.0_f64, f64::NEG_INFINITY, 0);
    while count < few_or_many(12, 30) {
        let Some(stopped) = seized(&mut draw) else {
            continue;
        };
        count += 1;
        let inside = stopped.intrusions().into_iter().map(|i| i.depth);
        deepest = deepest.max(inside.fold(0.0, f64::max));
        freed += u32::from(is_freed(&stopped, Change::ClosedTrack));
        let belt = in_a_closed_belt(&stopped, ClosedSurface::Smooth);
        most = most.max(gain_when_braked(belt));
    }
    println!(
        "seed {seed}: {count} seized robots, ground up to {:.0} mm inside; braked in a closed belt they gained \
         energy for at most {:.4} mm of height; driven, {freed} of them got away",
        1e3 * deepest,
        1e3 * most
    );
    assert!(deepest > 0.02);
    // A contact sinks in by up to 0.3 mm when a robot falls on it, and is pushed out again.
    assert!(most < 3e-4);
    assert!(6 * freed > 5 * count);
}

/// [m] Height that a belt could give with the most energy that it gains, braked at once so that its motor can
/// only take some.
fn gain_when_braked(mut belt: Simulation) -> f64 {
    belt.set_speed(0.0).unwrap();
    let (start, weight) = (energy(&belt), 21.2 * G);
    let mut most = f64::NEG_INFINITY;
    let end = belt.time() + 2.0;
    while belt.time() < end {
        belt.step().unwrap();
        most = most.max((energy(&belt) - start) / weight);
    }
    most
}

#[test]
fn letting_the_ground_out_of_a_belt_with_grousers_gives_little_energy() {
    let seed = 5;
    let mut draw = Draw(seed);
    let (mut count, mut most, mut smooth, mut freed) = (0, f64::NEG_INFINITY, 0, 0);
    while count < few_or_many(5, 15) {
        let Some(stopped) = seized_on(&mut draw, &paper_gear()) else {
            continue;
        };
        count += 1;
        smooth += u32::from(is_freed(&stopped, Change::ClosedSmoothTrack));
        freed += u32::from(is_freed(&stopped, Change::ClosedTrack));
        let belt = in_a_closed_belt(&stopped, ClosedSurface::Own);
        most = most.max(gain_when_braked(belt));
    }
    println!(
        "seed {seed}: {count} seized robots on gear wheels; braked in a belt with grousers they gained energy for \
         at most {:.4} mm of height; driven, {smooth} got away on a smooth belt, {freed} on one with grousers",
        1e3 * most
    );
    // Not none, as of a smooth belt: a grouser deep in the ground has several faces to be let out of. It is a
    // small share of the 50 mm that an escape takes.
    assert!(most < 2e-3);
    assert!(3 * freed > 2 * count);
}

#[test]
fn belts_and_skids_are_never_seized() {
    let mut draw = Draw(12);
    let mut stops = 0;
    for _ in 0..150 {
        let mut scenario = engineer();
        scenario.robot.track = if draw.unit() < 0.5 { belt() } else { force() };
        scenario.terrain = step(draw.between(0.05, 0.6), draw.between(0.2, 1.5));
        scenario.robot.drivetrain.max_torque = draw.between(0.5, 12.0);
        scenario.duration = 8.0;
        let run = summary(&scenario);
        stops += u32::from(run.outcome.is_stop());
        assert_ne!(run.outcome, Outcome::Seized, "{scenario:?}");
    }
    println!("{stops} stops");
    assert!(stops > 50);
}

/// Runs to a stop and says why.
fn why(scenario: &Scenario) -> (Run, crawler2d_core::Diagnosis) {
    let run = simulate(&checked(scenario), crawler2d_core::Record::summary()).unwrap();
    let diagnosis = run
        .diagnosis
        .clone()
        .unwrap_or_else(|| panic!("{}", run.outcome));
    (run, diagnosis)
}

#[test]
fn a_wheel_against_a_face_at_the_friction_limit_slips() {
    // Belt against a wall, friction below that of oracle 2: both contacts slide.
    let mut scenario = engineer();
    scenario.terrain = step(0.3, 0.5);
    scenario.robot.track = line(5);
    let (_, d) = why(&scenario);
    assert_eq!(d.outcome, Outcome::Slipping);
    assert!(d.certified && d.imbalance.unwrap() < 1e-6);
    assert!((d.sliding_share - 1.0).abs() < 1e-9);
    // Pushed harder, it climbs: in the end rear wheel and wall alone bear, and both slide. Moments
    // about the rear contact and forces along x and y give the push.
    let (mu, g, weight) = (0.5, scenario.robot.center_of_mass[1], 21.2 * G);
    let (length, radius) = (0.365, 0.064);
    let behind = scenario.robot.center_of_mass[0] + 0.5 * length;
    let lift = (mu * (length + radius) + radius) / (1.0 + mu * mu);
    let push = weight * (behind - mu * lift) / (lift - (g + radius));
    let found = escape_force(&checked(&scenario), d.time, &Cancel::default()).unwrap();
    println!("escape force {found:?}, by hand {push} N");
    assert!(found.low < push && push < found.high);
}

#[test]
fn weak_motors_stall_until_they_have_more_torque() {
    let mut scenario = engineer();
    scenario.terrain = step(0.06, 0.9);
    scenario.robot.drivetrain.max_torque = 3.0;
    let (_, d) = why(&scenario);
    assert_eq!(d.outcome, Outcome::Stalled);
    let wanted = Wanted::of([Change::TwiceTheTorque, Change::TwiceTheFriction]);
    let made = make_trials(&checked(&scenario), d.time, wanted, &Cancel::default()).unwrap();
    let freed = made
        .iter()
        .filter(|trial| trial.freed)
        .map(|trial| trial.name);
    assert_eq!(freed.collect::<Vec<_>>(), ["torque x 2"]);
}

/// A slope of 17 degrees, on which it takes a friction of 0.31 and 2 N m for each track to stand.
#[test]
fn what_only_moves_downhill_slips_or_is_stalled_and_does_not_cycle() {
    for (friction, torque, outcome) in [
        (0.25, 30.0, Outcome::Slipping),
        (0.9, 1.5, Outcome::Stalled),
    ] {
        let mut scenario = engineer();
        scenario.terrain = slope(0.3, friction);
        scenario.start.angle = 0.3;
        scenario.robot.drivetrain.max_torque = torque;
        scenario.duration = 5.0;
        assert_eq!(why(&scenario).1.outcome, outcome, "friction {friction}");
    }
}

#[test]
fn worked_case_of_oracle_ten_is_seized_and_astride() {
    // A row of five, wheel 2 on the edge, wheel 3 on the top, three sliding contacts.
    let mut scenario = slow_and_strong();
    scenario.robot.track = line(5);
    scenario.robot.center_of_mass = [0.1 * 0.365, 0.0];
    scenario.terrain = step(0.100, 0.95);
    scenario.duration = 40.0;
    let (_, d) = why(&scenario);
    assert_eq!(d.outcome, Outcome::Seized);
    // Wheel 3 stands where the pocket ends, so that both its walls bear.
    assert_eq!(d.mechanism, Some(Mechanism::Straddled));
    assert_eq!(d.contacts.len(), 3);
    let shares = d.contacts.iter().map(|c| c.normal_force / (21.2 * G));
    for (share, statics) in shares.zip([0.184, 0.569, 0.069]) {
        assert!(
            (share - statics).abs() < 1e-3,
            "{share}, by statics {statics}"
        );
    }
    assert!(d.imbalance.unwrap() < 1e-6);
}

#[test]
fn a_belly_on_a_ridge_hangs_up() {
    let mut scenario = engineer();
    // The belly reaches below the track, and lies on the top.
    scenario.robot.belly = Some(vec![
        [-0.15, -0.075],
        [0.15, -0.075],
        [0.15, 0.05],
        [-0.15, 0.05],
    ]);
    scenario.robot.track = belt();
    scenario.terrain = Terrain::Ridge {
        height: 0.06,
        edge_angle: 1.5,
        surface: Surface::sharp(0.6),
    };
    let (_, d) = why(&scenario);
    assert_eq!(d.outcome, Outcome::HungUp);
    assert!(d.mechanism.is_none());
}

#[test]
fn a_pebble_in_a_pocket_before_a_wall_is_not_the_cause() {
    // The front wheel is against a wall too high for anything; a pebble lies before wheel 2.
    let mut scenario = engineer();
    scenario.robot.track = line(4);
    scenario.robot.belly = None;
    let spacing = 0.365 / 3.0;
    // When the nose is at the wall, wheel 2 has begun to climb it.
    let (x, pebble) = (-0.064 - spacing + 0.025, 0.010);
    scenario.terrain = Terrain::Points {
        points: vec![
            [-4.0, 0.0],
            [x - pebble, 0.0],
            [x, pebble],
            [x + pebble, 0.0],
            [0.0, 0.0],
            [0.0, 0.5],
            [4.0, 0.5],
        ],
        goal: 1.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    let mut loaded = 0;
    for friction in [0.5, 0.6, 0.7] {
        if let Terrain::Points { surface, .. } = &mut scenario.terrain {
            surface.friction.coefficient = friction;
        }
        let (_, d) = why(&scenario);
        println!(
            "friction {friction}: {} {:?} {:?}",
            d.outcome,
            d.mechanism,
            d.intrusion.as_ref().map(|i| (i.place.depth, i.force))
        );
        loaded += u32::from(d.intrusion.is_some());
        assert_ne!(d.outcome, Outcome::Seized);
    }
    assert!(loaded > 0);
}

/// [m] How far the robot moves under a push that grows to `force` in 5 s and stays for three; all
/// at once it would carry the robot past where it could hold.
fn moves_under(stopped: &Simulation, force: f64) -> f64 {
    let mut pushed = stopped.branch(&checked(stopped.scenario()));
    let start = pushed.reading().position;
    let mut farthest: f64 = 0.0;
    for i in 0..8000 {
        pushed
            .set_push(force * f64::from(i).min(5000.0) / 5000.0)
            .unwrap();
        advance(&mut pushed, 1e-3);
        farthest = farthest.max((pushed.reading().position - start).length());
    }
    farthest
}

#[test]
fn a_seized_robot_holds_the_lower_escape_force_and_gives_way_to_the_upper() {
    let seed = 21;
    let mut draw = Draw(seed);
    let (mut count, mut held, mut moved, mut wedged) = (0, 0, 0, 0);
    while count < few_or_many(12, 200) {
        let Some(stopped) = seized(&mut draw) else {
            continue;
        };
        let scenario = checked(stopped.scenario());
        let found = escape_force(&scenario, stopped.time(), &Cancel::default()).unwrap();
        if found.high.is_infinite() {
            wedged += 1;
            continue;
        }
        count += 1;
        let [less, more] = [found.low, found.high].map(|force| moves_under(&stopped, force));
        held += u32::from(less <= 5e-3);
        moved += u32::from(more > 5e-3);
        if less > 5e-3 || more <= 5e-3 {
            println!(
                "{:?} {:?}: {found:?}, {:.2} and {:.2} mm",
                stopped.scenario().robot.track,
                stopped.scenario().terrain,
                1e3 * less,
                1e3 * more,
            );
        }
    }
    println!(
        "seed {seed}: of {count} seized robots {held} hold the lower force and {moved} give way to the upper one; \
         {wedged} more are wedged"
    );
    // Another course of the push may end the stop a little earlier or later than the levels of a tenth.
    assert!(10 * held.min(moved) >= 9 * count);
}

#[test]
fn a_stalled_chain_does_not_creep() {
    for time_step in [1e-3, 0.125e-3] {
        let mut scenario = engineer_on(segmental(Some(22)));
        scenario.terrain = step(0.2, 1.5);
        scenario.robot.drivetrain.max_torque = 2.0;
        scenario.robot.drivetrain.max_acceleration = 2.0;
        scenario.drive.speed = 0.1;
        scenario.start.approach = 0.02;
        scenario.start.track_phase = 0.02;
        fixed(&mut scenario, time_step);
        let mut simulation = after(&scenario, 1.0);
        // It swings on by some micrometres.
        let mut mean_of_two_seconds = || {
            let positions = (0..200).map(|_| {
                advance(&mut simulation, 0.01);
                simulation.reading().track_position
            });
            positions.sum::<f64>() / 200.0
        };
        let (before, after) = (mean_of_two_seconds(), mean_of_two_seconds());
        let crept = after - before;
        println!("{crept:.1e} m in 2 s, steps of {time_step} s");
        assert!(crept.abs() < 1e-6);
    }
}
