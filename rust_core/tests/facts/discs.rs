//! Tracks round more than two discs: trapezoids, whose ends are raised, and triangles.

use std::f64::consts::{PI, TAU};

use crawler2d_core::{
    Friction, Outcome, Record, Run, Scenario, Simulation, Terrain, Track, TrackOutline,
};

use crate::common::*;
use crate::drawn::drawn_on_discs;
use crate::energy::{follow, scale};

/// Friction that holds a track on an edge up to 45 degrees and more, as on two discs.
const AMPLE: f64 = 1.5;
/// [m] Place and radius of the lower discs of every trapezoid here.
const LOW: f64 = 0.17;
const RADIUS: f64 = 0.064;

/// Raised ends before and behind two equal discs on the ground.
fn trapezoid(rear: [f64; 3], front: [f64; 3]) -> Vec<[f64; 3]> {
    vec![rear, [-LOW, 0.0, RADIUS], [LOW, 0.0, RADIUS], front]
}

/// The sprocket raised at the rear, the idler in front.
fn raised() -> Vec<[f64; 3]> {
    trapezoid([-0.28, 0.09, 0.05], [0.29, 0.1, 0.045])
}

fn raised_high() -> Vec<[f64; 3]> {
    trapezoid([-0.26, 0.12, 0.05], [0.27, 0.1, 0.045])
}

fn triangle() -> Vec<[f64; 3]> {
    vec![[-0.2, 0.0, 0.06], [0.05, 0.2, 0.05], [0.2, 0.0, 0.06]]
}

fn level(length: f64) -> Terrain {
    Terrain::Flat {
        length,
        friction: Friction::dry(0.9),
    }
}

/// The Engineer's masses and motors on other discs.
fn on_discs(discs: Vec<[f64; 3]>, track: Track) -> Scenario {
    let mut scenario = engineer_on(track);
    scenario.robot.outline.discs = discs;
    scenario.robot.belly = None;
    scenario.robot.moment_of_inertia = 1.0;
    scenario
}

fn run_of(scenario: &Scenario) -> Run {
    crawler2d_core::simulate(&checked(scenario), Record::default()).expect("it stays finite")
}

/// All metrics, bit by bit.
fn bits(scenario: &Scenario) -> Vec<u64> {
    let run = run_of(scenario);
    let of_metrics = run.metrics.entries().into_iter().map(|(_, value)| value);
    let all = run.trace.position.iter().copied().chain(of_metrics);
    all.map(f64::to_bits).collect()
}

#[test]
fn two_discs_are_the_same_robot_in_either_form() {
    for (name, scenario) in crate::basics::models() {
        let text = scenario.to_json();
        let ends = r#""axle_distance":0.365,"front_radius":0.064,"rear_radius":0.064"#;
        assert!(text.contains(ends), "{name}");
        let long = text.replacen(
            ends,
            r#""discs":[[-0.1825,0.0,0.064],[0.1825,0.0,0.064]]"#,
            1,
        );
        let read = Scenario::from_json(&long).expect("it is the same robot");
        assert_eq!(read, scenario, "{name}");
        assert_eq!(read.to_json(), text, "{name}");
    }
}

#[test]
fn two_discs_in_the_other_order_give_the_same_bits() {
    for (name, mut scenario) in crate::basics::models() {
        scenario.duration = 1.0;
        let before = bits(&scenario);
        scenario.robot.outline.discs.reverse();
        assert_eq!(bits(&scenario), before, "{name}");
    }
}

#[test]
fn the_order_of_discs_changes_no_bit() {
    for track in [
        belt(),
        grouser_belt(),
        segmental(None),
        circumferential(40, paper_gear()),
    ] {
        let mut scenario = on_discs(raised(), track);
        scenario.duration = 1.0;
        let before = bits(&scenario);
        for order in [[3, 2, 1, 0], [1, 3, 0, 2]] {
            scenario.robot.outline.discs = order.map(|i| raised()[i]).to_vec();
            assert_eq!(bits(&scenario), before);
        }
    }
}

/// [m] Length of a belt round discs that it touches in this order, counter-clockwise.
fn length_round(discs: &[[f64; 3]]) -> f64 {
    let count = discs.len();
    let runs: Vec<(f64, f64)> = (0..count)
        .map(|i| {
            let ([ax, ay, a], [bx, by, b]) = (discs[i], discs[(i + 1) % count]);
            let (dx, dy) = (bx - ax, by - ay);
            let apart = dx.hypot(dy);
            // A belt that comes to a smaller disc turns inwards by this.
            let direction = dy.atan2(dx) + ((a - b) / apart).asin();
            ((apart * apart - (a - b) * (a - b)).sqrt(), direction)
        })
        .collect();
    let arc = |i: usize| {
        let before = runs[(i + count - 1) % count].1;
        discs[i][2] * (runs[i].1 - before).rem_euclid(TAU)
    };
    (0..count).map(|i| runs[i].0 + arc(i)).sum()
}

#[test]
fn the_belt_is_as_long_as_its_runs_and_arcs() {
    let [rear, low_rear, low_front, front] = raised().try_into().unwrap();
    let [left, top, right] = triangle().try_into().unwrap();
    for (discs, order) in [
        (raised(), vec![low_rear, low_front, front, rear]),
        (triangle(), vec![left, right, top]),
    ] {
        let checked = checked(&on_discs(discs, belt()));
        let circuit = checked.model().parts[0].circuit().expect("a belt");
        let (found, expected) = (circuit.ways[circuit.ways.len() - 1], length_round(&order));
        println!("{found:.6} m, closed form {expected:.6} m");
        assert!((found - expected).abs() < 1e-12);
    }
    // Equal discs: their polygon, and once round a disc.
    let square = [[-0.2, 0.0], [0.2, 0.0], [0.2, 0.3], [-0.2, 0.3]].map(|[x, y]| [x, y, 0.05]);
    assert!((length_round(&square) - (1.4 + 0.1 * PI)).abs() < 1e-12);
}

#[test]
fn it_drives_as_far_as_its_belt_runs_and_stands_on_its_lower_discs() {
    for discs in [raised(), triangle()] {
        let lowest = discs
            .iter()
            .map(|[_, y, radius]| radius - y)
            .fold(0.0, f64::max);
        let mut scenario = on_discs(discs, belt());
        scenario.terrain = level(3.0);
        scenario.duration = 4.0;
        let metrics = run_of(&scenario).metrics;
        // Contacts sink in by some tenths of a micrometre, and creep a little while they push.
        assert!((metrics.final_y - lowest).abs() < 1e-6);
        assert!((metrics.track_distance - metrics.distance).abs() < 1e-5);
        assert!(metrics.distance > 0.5);
    }
}

/// [m] Height of a step that a rigid track round discs just climbs, and the angle at which it then lies in balance on
/// the edge: its lower run on the edge right below the centre of mass, and on the ground the disc that is lowest.
fn highest_step(discs: &[[f64; 3]], [x, y]: [f64; 2]) -> (f64, f64) {
    let height = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let on_ground = |[x, y, radius]: &[f64; 3]| x * s + y * c - radius;
        let lowest = discs.iter().map(on_ground).fold(f64::INFINITY, f64::min);
        let on_edge = x - (y + RADIUS) * s / c;
        on_edge * s - RADIUS * c - lowest
    };
    let angles = (1..100_000).map(|i| 1.2e-5 * f64::from(i));
    let highest = angles.map(|angle| (height(angle), angle));
    highest.fold(
        (0.0, 0.0),
        |best, found| if found.0 > best.0 { found } else { best },
    )
}

fn rigid(discs: Vec<[f64; 3]>, center: [f64; 2]) -> Scenario {
    let mut scenario = slow_and_strong();
    let robot = &mut scenario.robot;
    robot.outline.discs = discs;
    robot.outline.grouser_height = 0.0;
    robot.center_of_mass = center;
    robot.moment_of_inertia = robot.mass * 0.05;
    robot.track_mass = 0.02 * robot.mass;
    robot.track = belt();
    scenario
}

#[test]
fn a_belt_climbs_as_high_as_a_rigid_trapezoid_can() {
    // With ends so high that they leave the ground alone, and with a rear end so low that it bears.
    let high = (raised_high(), [0.03, 0.06]);
    let low = (
        trapezoid([-0.27, 0.02, 0.05], [0.3, 0.05, 0.045]),
        [0.08, 0.1],
    );
    let mut rear_bears = 0;
    for (discs, above) in [high, low] {
        for center in above
            .into_iter()
            .flat_map(|y| [[-0.03, y], [0.0, y], [0.03, y]])
        {
            let (expected, angle) = highest_step(&discs, center);
            assert!(angle < 0.8, "steeper than its friction holds");
            let without_ends = highest_step(&discs[1..3], center).0;
            rear_bears += u32::from(expected > without_ends + 1e-3);
            let mut scenario = rigid(discs.clone(), center);
            let off = [0.05, 0.02].map(|speed| {
                scenario.drive.speed = speed;
                scenario.duration = 3.0 / speed;
                let found = bisect(0.97 * expected, 1.03 * expected, |height| {
                    let mut scenario = scenario.clone();
                    scenario.terrain = step(height, AMPLE);
                    summary(&scenario).outcome == Outcome::Cleared
                });
                found / expected - 1.0
            });
            println!(
                "{center:?}: closed form {expected:.5} m ({without_ends:.5} m without ends), {:+.2} % at 0.05 m/s, {:+.2} % at 0.02 m/s",
                100.0 * off[0],
                100.0 * off[1]
            );
            assert!(off[0].abs() < 0.02 && off[1].abs() < 0.01);
        }
    }
    assert_eq!(rear_bears, 6);
}

/// Friction from which on a step of that height lifts the nose, whose run rises to the front end.
///
/// The rear lower disc and the edge slide, and carry the weight together. The run has the angle of approach; from
/// the tangent of that angle on, the edge alone would lift it.
fn friction_of_the_approach(front: [f64; 3], height: f64, x: f64) -> f64 {
    let (dx, dy) = (front[0] - LOW, front[1]);
    let approach = dy.atan2(dx) + ((RADIUS - front[2]) / dx.hypot(dy)).asin();
    let (s, c) = approach.sin_cos();
    let along = (height - RADIUS + RADIUS * c) / s;
    let ahead = LOW + RADIUS * s + along * c;
    bisect(0.0, approach.tan(), |mu| {
        // From the balance of forces, in weights; then moments about the contact of the rear disc.
        let on_edge = mu / (s * (1.0 + mu * mu));
        let [right, up] = [on_edge * (mu * c - s), on_edge * (c + mu * s)];
        up * (ahead + LOW) - right * height < x + LOW
    })
}

/// Friction from which on the nose of a track with two equal ends climbs a face at least as high as its radius.
fn friction_of_the_nose(x: f64) -> f64 {
    let (length, behind) = (2.0 * LOW, x + LOW);
    bisect(0.0, 10.0, |mu| {
        behind * (1.0 + mu * mu) > mu * mu * (length + RADIUS) + mu * RADIUS
    })
}

#[test]
fn a_raised_nose_is_lifted_from_the_friction_of_its_approach_on() {
    for (front, height) in [
        ([0.29, 0.1, 0.045], 0.08),
        ([0.29, 0.1, 0.045], 0.06),
        ([0.32, 0.08, 0.05], 0.07),
    ] {
        let discs = trapezoid([-0.28, 0.09, 0.05], front);
        for x in [-0.03, 0.0] {
            let expected = friction_of_the_approach(front, height, x);
            let found = bisect(0.8 * expected, 1.2 * expected, |mu| {
                let mut scenario = rigid(discs.clone(), [x, 0.0]);
                scenario.terrain = step(height, mu);
                scenario.drive.speed = 0.01;
                scenario.duration = 20.0;
                summary(&scenario).metrics.max_angle < 0.005
            });
            let of_face = friction_of_the_nose(x);
            println!(
                "{front:?} at {height} m, x {x}: mu {found:.4}, closed form {expected:.4}, {:+.2} %; without raised ends {of_face:.3}",
                100.0 * (found / expected - 1.0)
            );
            assert!((found / expected - 1.0).abs() < 0.01);
            assert!(found < 0.8 * of_face);
        }
    }
}

#[test]
fn a_raised_nose_climbs_what_a_level_one_slips_at() {
    let friction = 0.6;
    let [raised, level] = [
        raised(),
        TrackOutline::two_discs(2.0 * LOW, [RADIUS, RADIUS]),
    ]
    .map(|discs| {
        let mut scenario = rigid(discs, [0.0, 0.0]);
        scenario.terrain = step(0.07, friction);
        summary(&scenario).outcome
    });
    assert_eq!((raised, level), (Outcome::Cleared, Outcome::Slipping));
}

#[test]
fn drawn_robots_on_discs_gain_no_more_than_their_motors_give() {
    let mut draw = Draw(53);
    let (mut most, mut chains) = (0.0_f64, 0);
    let robots = few_or_many(30, 60);
    for case in 0..robots {
        let scenario = drawn_on_discs(&mut draw);
        let account = follow(&scenario, scenario.duration);
        let share = account.gained / scale(&scenario, &account);
        most = most.max(share);
        chains += u32::from(is_on_chain(&scenario));
        assert!(
            share < 1e-3,
            "case {case}: {share:.1e}\n{}",
            scenario.to_json()
        );
    }
    println!("{robots} robots, {chains} on chains, gained {most:.1e} at most");
    assert!(chains > 2);
}

#[test]
fn the_ground_bears_the_weight_of_a_trapezoid() {
    for track in [
        belt(),
        grouser_belt(),
        segmental(None),
        circumferential(40, paper_gear()),
        force(),
    ] {
        let mut scenario = on_discs(raised(), track);
        scenario.terrain = level(3.0);
        scenario.drive.speed = 0.0;
        scenario.duration = 2.0;
        let run = run_of(&scenario);
        let last = run
            .contacts
            .time
            .last()
            .copied()
            .expect("it stands on the ground");
        let borne: f64 = (run.contacts.time.iter().zip(&run.contacts.normal_force))
            .filter(|(time, _)| **time == last)
            .map(|(_, force)| force)
            .sum();
        let weight = scenario.robot.mass * G;
        // The shoes of a chain that stands still swing on for a while.
        assert!(
            (borne / weight - 1.0).abs() < 1e-2,
            "{borne} N of {weight} N"
        );
    }
}

#[test]
fn a_chain_stays_linked_and_on_its_guide_round_any_discs() {
    for (discs, height) in [(raised(), 0.06), (triangle(), 0.03)] {
        let mut scenario = on_discs(discs, segmental(None));
        scenario.terrain = step(height, 0.9);
        let run = run_of(&scenario);
        let metrics = &run.metrics;
        println!(
            "pins {:.1e} m apart, {:.1e} m inside the guide, {:?}",
            metrics.max_pin_gap, metrics.max_guide_penetration, run.outcome
        );
        assert_eq!(run.outcome, Outcome::Cleared);
        // As for the Engineer's own chain.
        assert!(metrics.max_pin_gap < 1e-5 && metrics.max_guide_penetration < 5e-4);
    }
}

#[test]
fn a_chain_closes_round_drawn_discs_wherever_it_has_run_to() {
    let mut draw = Draw(9);
    let mut chains = 0;
    while chains < 20 {
        let scenario = drawn_on_discs(&mut draw);
        let checked = checked(&scenario);
        let Some(chain) = checked.model().chains.first() else {
            continue;
        };
        chains += 1;
        let mut simulation = Simulation::new(&checked);
        advance(&mut simulation, 1e-3);
        let gap = simulation.chain().pin_gap;
        assert!(
            gap < 1e-5 * chain.path.pitch.max(1e-2),
            "{gap} m\n{}",
            scenario.to_json()
        );
    }
}

#[test]
fn the_drive_of_a_chain_takes_it_round_a_raised_end() {
    let mut scenario = on_discs(raised(), segmental(None));
    scenario.terrain = level(4.0);
    scenario.duration = 5.0;
    let metrics = run_of(&scenario).metrics;
    let checked = checked(&scenario);
    let path = &checked.model().chains[0].path;
    let around = path.pitch * path.count as f64;
    assert!(metrics.track_distance > 0.8 * around);
    let slip = metrics.distance / metrics.track_distance - 1.0;
    println!("{:+.2} % beside the travel of the motor", 100.0 * slip);
    // A grouser moves faster than the pins where the chain bends, and not at all on the straight run.
    assert!(slip.abs() < 0.01);
}

#[test]
fn arms_pivot_on_the_end_axles() {
    let mut scenario = on_arms(0.6, belt());
    scenario.robot.outline.discs = raised();
    scenario.robot.moment_of_inertia = 2.0;
    let checked = checked(&scenario);
    let pivots: Vec<[f64; 2]> = (checked.model().flippers.iter())
        .map(|arm| arm.pivot.into())
        .collect();
    assert_eq!(pivots, [[0.29, 0.1], [-0.28, 0.09]]);
    assert_eq!(run_of(&scenario).outcome, Outcome::Cleared);
}
