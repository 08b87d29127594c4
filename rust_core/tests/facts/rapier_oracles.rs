//! The closed forms in rapier's dynamics, beside how far our own are off.

use crawler2d_core::{GearWheel, Outcome, Scenario, Simulation, Surface, Terrain, Wheel};

use crate::candidates::Row;
use crate::climbing::{
    before_a_gap, climbs, friction_of_the_nose, highest_step, rigid_track, single_wheel,
};
use crate::common::*;
use crate::drive::{acceleration, braking_distance, racer};
use crate::gears::{over_reading, rolling, travelled};
use crate::seizure::{Stop, classify};
use crate::slopes;

/// Asserts that a figure is what is expected to a share, in our dynamics and in rapier's.
fn agree(
    what: &str,
    scenario: &Scenario,
    (expected, share): (f64, f64),
    found: impl Fn(&Scenario) -> f64,
) {
    let off = [scenario.clone(), in_rapier(scenario)].map(|each| found(&each) / expected - 1.0);
    println!(
        "{what}: closed form {expected:.5}, ours {:+.3} %, rapier {:+.3} %",
        100.0 * off[0],
        100.0 * off[1]
    );
    for off in off {
        assert!(off.abs() < share, "{what}: {off}");
    }
}

/// Asserts the same of the largest x for which something holds: it holds a share below what is expected, and not a share
/// above it. With `CRAWLER2D_SOAK` that x is looked for, to 1/16 of the share, and printed.
fn agree_up_to(
    what: &str,
    scenario: &Scenario,
    (expected, share): (f64, f64),
    holds: impl Fn(&Scenario, f64) -> bool,
) {
    let ends = [(1.0 - share) * expected, (1.0 + share) * expected];
    for each in [scenario.clone(), in_rapier(scenario)] {
        let engine = each.solver.engine;
        assert!(holds(&each, ends[0]), "{what}, {engine:?}: lower");
        assert!(!holds(&each, ends[1]), "{what}, {engine:?}: higher");
    }
    if is_soak() {
        agree(what, scenario, (expected, share), |scenario| {
            let [mut low, mut high] = ends;
            for _ in 0..4 {
                let middle = 0.5 * (low + high);
                if holds(scenario, middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            0.5 * (low + high)
        });
    }
}

fn with(scenario: &Scenario, change: impl FnOnce(&mut Scenario)) -> Scenario {
    let mut changed = scenario.clone();
    change(&mut changed);
    changed
}

/// Oracle 1, with wheels 18 mm apart, with pockets of 0.6 mm between them.
#[test]
#[ignore = "many wheels in rapier; run by make soak"]
fn a_close_row_of_wheels_climbs_as_high_as_a_rigid_track_in_rapier() {
    let (expected, _) = highest_step(0.064, 0.5 * 0.365, 0.03);
    let mut scenario = rigid_track(0.365, 0.064, 0.5, 0.03);
    scenario.robot.track = line(21);
    scenario.robot.track_mass = 1.4; // no lighter ones are held
    // At 0.05 m/s momentum carries a belt 2 % higher, and ours, which bumps over the edge wheel by wheel, 4 %.
    let clears = |scenario: &Scenario, height: f64| {
        let changed = with(scenario, |s| s.terrain = step(height, 1.5));
        summary(&changed).outcome == Outcome::Cleared
    };
    agree_up_to("step [m]", &scenario, (expected, 0.06), clears);
}

/// Oracle 2.
#[test]
#[ignore = "ten seconds of rapier; run by make soak"]
fn the_nose_climbs_a_face_from_the_friction_of_the_balance_on_in_rapier() {
    for share in [0.4, 0.5].into_iter().take(few_or_many(1, 2) as usize) {
        let expected = friction_of_the_nose(0.365, 0.064, share * 0.365);
        let mut scenario = rigid_track(0.365, 0.064, share, 0.0);
        scenario.robot.track = line(2);
        scenario.drive.speed = 0.01;
        scenario.duration = 25.0;
        let what = format!("b/L {share}: friction");
        agree_up_to(&what, &scenario, (expected, 0.01), |scenario, mu| {
            let changed = with(scenario, |s| s.terrain = step(0.2, mu));
            summary(&changed).metrics.max_angle < 0.1
        });
    }
}

/// Oracle 3.
#[test]
#[ignore = "half a minute of rapier; run by make soak"]
fn a_single_wheel_climbs_as_high_as_its_friction_allows_in_rapier() {
    for mu in [0.4, 0.7, 1.0_f64] {
        let expected = 0.064 * (1.0 - 1.0 / (1.0 + mu * mu).sqrt());
        let mut scenario = single_wheel(expected, mu);
        // A robot of 20 m.
        (scenario.robot.track_mass, scenario.robot.moment_of_inertia) = (0.42, 3000.0);
        // So that what is left of its motion does not tip it: the closed form is without the far wheel's push, 0.3 %.
        scenario.robot.center_of_mass = [9.97, 0.0];
        let what = format!("mu {mu}: step [m]");
        // Momentum carries both 1 to 2 % higher.
        agree_up_to(&what, &scenario, (expected, 0.03), |scenario, height| {
            climbs(&with(scenario, |s| s.terrain = step(height, mu)))
        });
    }
}

/// Oracle 5.
#[test]
fn robot_tips_backwards_at_the_angle_of_the_balance_in_rapier() {
    let centers = [(-0.10, 0.10), (-0.05, 0.15)].into_iter();
    for (x, y) in centers.take(few_or_many(1, 2) as usize) {
        let expected = libm::atan((0.1825 + x) / (0.064 + y));
        let mut scenario = slopes::braked(expected, 5.0);
        scenario.robot.track = line(3);
        scenario.robot.center_of_mass = [x, y];
        scenario.duration = 5.0;
        let what = format!("({x}, {y}): angle");
        agree_up_to(&what, &scenario, (expected, 0.01), |scenario, angle| {
            let changed = with(scenario, |s| {
                (s.terrain, s.start.angle) = (slope(angle, 5.0), angle);
                s.criteria.tip_over_angle = angle + 0.2;
            });
            summary(&changed).outcome != Outcome::TippedOver
        });
    }
}

/// Oracle 6: the shorter end of a row of wheels 18 mm apart reaches over a gap, and then up to a radius more.
#[test]
#[ignore = "many wheels in rapier; run by make soak"]
fn a_gap_is_bridged_up_to_the_shorter_end_in_rapier() {
    let shorter = 0.4 * 0.365;
    let mut scenario = rigid_track(0.365, 0.064, 0.4, 0.0);
    scenario.robot.track = line(21);
    scenario.robot.track_mass = 1.4;
    // Twice the usual step: 21 wheels cost a second a run, and the bounds are wide.
    let mut theirs = in_rapier(&scenario);
    fixed(&mut theirs, 2.5e-4);
    for scenario in [scenario, theirs] {
        let bridges = |width: f64| {
            let run = summary(&before_a_gap(&scenario, width));
            run.metrics.min_angle > -0.03 && run.metrics.max_angle < 0.03
        };
        assert!(bridges(shorter) && !bridges(shorter + 0.064));
    }
}

/// Oracle 7.
#[test]
fn starts_and_stops_are_limited_by_friction_and_torque_in_rapier() {
    let mut racer = racer();
    racer.robot.track = line(3);
    racer.robot.track_mass = 2.4;
    let begins = |scenario: &Scenario| acceleration(&mut after(scenario, 0.2), 0.4);
    let slips = with(&racer, |s| {
        s.robot.drivetrain.max_torque = 50.0;
        s.terrain = slope(0.0, 0.3);
    });
    let of_friction = (0.3 * G, 1e-3);
    agree("start by friction [m/s2]", &slips, of_friction, begins);
    let weak = with(&racer, |s| {
        s.robot.drivetrain.max_torque = 1.0;
    });
    let of_torque = (2.0 * 1.0 / 0.052 / (21.2 + 2.4), 1e-3);
    agree("start by torque [m/s2]", &weak, of_torque, begins);
    // It rolls on what is left of its radius, to 0.2 per mille.
    let way = (1.0 / (2.0 * 0.3 * G), 2e-3);
    agree("braking distance [m]", &slips, way, |s| {
        braking_distance(s, 1.0)
    });
    // The wheels, too, are set turning.
    let expected = G * (0.1825 - 0.12) / (0.064 + 0.10 + 2.4 / 21.2 * 0.064);
    let nose = with(&racer, |s| {
        s.robot.center_of_mass = [-0.12, 0.10];
        s.terrain = slope(0.0, 3.0);
    });
    agree_up_to("nose lifts at [m/s2]", &nose, (expected, 0.01), |s, a| {
        let torque = a * (21.2 + 2.4) * 0.052 / 2.0;
        let changed = with(s, |s| s.robot.drivetrain.max_torque = torque);
        after(&changed, 0.4).reading().chassis_angle < 0.01
    });
}

/// Oracle 9.
#[test]
fn odometry_over_reads_by_the_polygon_of_the_tips_in_rapier() {
    let wheel = Wheel::Gear(GearWheel {
        grouser_count: Some(7),
        grouser_height: None,
        tip_thickness: Some(0.006),
        base_thickness: None,
        phase_fraction: 0.0,
    });
    let scenario = rolling(line_of(2, wheel));
    // Tips that strike slip a little in softer contacts.
    let expected = (over_reading(7, 0.006), 3e-3);
    agree("odometry", &scenario, expected, |scenario| {
        let (surface, chassis) = travelled(scenario, 0.064, 2.0);
        surface / chassis
    });
}

/// Oracle 10: count, b/L, height [m], friction; the first is the worked case.
#[test]
#[ignore = "half a minute of rapier; run by make soak"]
fn a_row_of_wheels_stops_where_statics_says_in_rapier() {
    for (count, behind, height, friction) in [
        (5, 0.6, 0.100, 0.95),
        (5, 0.6, 0.075, 0.95),
        (7, 0.6, 0.100, 0.91),
        (7, 0.5, 0.100, 0.90),
    ] {
        let row = Row {
            count,
            spacing: 0.365 / f64::from(count - 1),
            radius: 0.064,
            behind: behind * 0.365,
            above: 0.0,
            height,
            friction,
        };
        let scenario = row.scenario();
        for (name, scenario) in [("ours", scenario.clone()), ("rapier", in_rapier(&scenario))] {
            let run = run(&scenario);
            assert!(run.outcome.is_stop(), "{row:?} {}", run.outcome);
            let stop = classify(&row, &run);
            println!("{count} wheels, b/L {behind}, {height} m, mu {friction}, {name}: {stop:?}");
            let Stop::Candidate {
                angle_off,
                share_off,
            } = stop
            else {
                panic!("{row:?} has three sliding contacts");
            };
            // The bounds of ours over 200 drawn rows.
            assert!(angle_off.to_degrees() < 0.3 && share_off < 0.05);
        }
    }
}

/// An impact takes from a robot the momentum of a plastic one: its front wheel comes down, the rear one may lift.
#[test]
fn an_impact_leaves_the_momentum_of_a_plastic_impact_in_rapier() {
    let (scenario, expected) = falling_on_its_front_wheel();
    // Within the millisecond after it gravity takes 2 % of what is left.
    agree("turn kept", &scenario, (expected, 0.03), |scenario| {
        let mut simulation = Simulation::new(&checked(scenario));
        let (mut last, mut turn) = (0.0, 0.0);
        while turn <= last {
            last = turn;
            advance(&mut simulation, 5e-4);
            turn = simulation.reading().angular_velocity;
        }
        advance(&mut simulation, 5e-4);
        simulation.reading().angular_velocity / last
    });
}

/// Oracle 8: what has rolled off a cliff falls freely.
#[test]
fn a_robot_in_the_air_falls_freely_in_rapier() {
    let mut scenario = slow_and_strong();
    scenario.robot.track = line(3);
    scenario.robot.drivetrain.max_torque = 0.0;
    let (s, c) = libm::sincos(-0.3);
    scenario.start.angle = -0.3;
    scenario.terrain = Terrain::Points {
        points: vec![
            [-3.0 * c, -3.0 * s],
            [0.0, 0.0],
            [0.0, -50.0],
            [60.0, -50.0],
        ],
        goal: 59.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    // The speed that is read is that of the chassis, which sways by three millionths of this as it turns with its wheels.
    agree("fall [m/s2]", &scenario, (G, 1e-5), |scenario| {
        let mut simulation = after(scenario, 1.0);
        assert!(simulation.contact_table().time.is_empty(), "it is off");
        let before = simulation.momentum();
        advance(&mut simulation, 0.5);
        (before - simulation.momentum()).y / scenario.robot.mass / 0.5
    });
}

/// Oracle 8: round wheels roll at the commanded speed.
#[test]
fn robots_run_at_the_commanded_speed_on_level_ground_in_rapier() {
    for track in [line(3), circumferential(24, Wheel::Round), line(9)]
        .into_iter()
        .take(few_or_many(1, 3) as usize)
    {
        let mut scenario = engineer_on(track);
        scenario.robot.belly = None;
        scenario.terrain = slope(0.0, 0.9);
        // Where the ground has let it in by 0.1 mm, its radius is 0.2 % less.
        agree("speed [m/s]", &scenario, (0.4, 2e-3), |scenario| {
            let mut simulation = after(scenario, 3.0);
            let before = simulation.reading().position.x;
            advance(&mut simulation, 2.0);
            (simulation.reading().position.x - before) / 2.0
        });
    }
}
