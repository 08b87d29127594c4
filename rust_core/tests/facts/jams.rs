//! All jams of a layout: those that are computed are equilibria, and all that are found by simulation are among them.

use crawler2d_core::{
    BodyKind, Cancel, FoundJam, JamContact, Scenario, Simulation, Surface, Terrain, Track,
    find_jams, jam_ranges,
};

use crate::common::*;

fn jams(scenario: &Scenario) -> Vec<FoundJam> {
    find_jams(&checked(scenario), &Cancel::default()).expect("its jams are known")
}

/// A robot without a belly on wheels that are strong enough, on a step.
fn strong(track: Track, height: f64, friction: f64) -> Scenario {
    let mut scenario = engineer_on(track);
    scenario.robot.belly = None;
    scenario.robot.drivetrain.max_torque = 500.0;
    scenario.terrain = step(height, friction);
    scenario
}

/// Wheels of any size anywhere between the ends of the track, or in a row or all round, on a ground of one of six kinds.
fn drawn(draw: &mut Draw) -> Scenario {
    let height = draw.between(0.02, 0.15);
    let count = draw.between(3.0, 9.99) as u32;
    let track = drawn_wheels(draw, count);
    let friction = draw.between(0.4, 1.2);
    let mut scenario = strong(track, height, friction);
    scenario.robot.center_of_mass = [draw.between(-0.06, 0.06), draw.between(0.0, 0.08)];
    let width = draw.between(0.03, 0.3);
    let points = match draw.between(0.0, 6.0) as u32 {
        0 => vec![[0.0, 0.0], [0.0, height]],
        1 => vec![[0.0, 0.0], [0.0, height], [width, height], [width, 0.0]],
        2 => vec![[0.0, 0.0], [width, height], [2.0 * width, 0.0]],
        3 => vec![[0.0, 0.0], [0.0, -0.3], [width, -0.3], [width, 0.0]],
        4 => {
            let corner = |i: u32| {
                let [run, rise] = [i / 2, i.div_ceil(2)].map(f64::from);
                [run * (width + 0.1), rise * 0.7 * height]
            };
            (0..6).map(corner).collect()
        }
        _ => {
            let mut x = 0.0;
            let mut corner = || {
                x += draw.between(0.06, 0.2);
                [x, draw.between(-0.08, 0.12)]
            };
            (0..6).map(|_| corner()).collect()
        }
    };
    let last = points[points.len() - 1][1];
    let mut whole = vec![[-3.0, 0.0]];
    whole.extend(points);
    whole.push([4.0, last]);
    let edge_radius = if draw.unit() < 0.5 { 0.0 } else { 0.005 };
    scenario.terrain = Terrain::Points {
        points: whole,
        goal: 2.0,
        surface: Surface::rounded(edge_radius, friction),
        segment_friction: None,
    };
    scenario.drive.speed = 0.2;
    scenario
}

/// Pose and greatest speed, with turns at a reach of 1 m.
fn pose(simulation: &Simulation) -> ([f64; 3], f64) {
    let now = simulation.reading();
    let speed = now.velocity.length().max(now.angular_velocity.abs());
    ([now.position.x, now.position.y, now.chassis_angle], speed)
}

/// Rounded edges are polygons in the simulation, 0.1 um off, and it lets bodies overlap by as much.
#[test]
fn every_stop_at_rest_is_one_of_the_jams_that_are_computed() {
    let mut draw = Draw(54);
    let (mut stops, mut most) = (0, 0.0_f64);
    for case in 0..few_or_many(75, 5_000) {
        let scenario = drawn(&mut draw);
        let mut simulation = Simulation::new(&checked(&scenario));
        advance(&mut simulation, 5.0);
        let (_, before) = pose(&simulation);
        advance(&mut simulation, 1.0);
        let (stop, after) = pose(&simulation);
        let contacts = simulation.contact_table();
        // A wheel that is wedged so that 500 N m do not turn it has no driven surface.
        let is_driven = contacts.surface_speed.iter().all(|v| v.abs() > 1e-3);
        if before.max(after) > 1e-6 || stop[2].abs() > 1.3 || !is_driven {
            continue;
        }
        stops += 1;
        let off = |found: &FoundJam| {
            let jam = &found.jam;
            let at = [jam.position.x, jam.position.y, jam.angle];
            let off = at.iter().zip(stop).map(|(a, b)| (a - b).abs());
            off.fold(0.0, f64::max)
        };
        let nearest = jams(&scenario).iter().map(off).fold(1.0, f64::min);
        most = most.max(nearest);
        assert!(nearest < 1e-4, "case {case}: {stop:?} is {nearest} off");
    }
    println!("{stops} stops, at most {most:e} m or rad off");
    // About three of ten robots come to rest.
    assert!(stops >= few_or_many(20, 1_300));
}

/// And nearly all on three contacts stay, none on one does.
#[test]
fn the_forces_of_every_jam_push_slide_and_balance_the_weight() {
    let mut draw = Draw(7);
    let (mut found, mut stable) = ([0; 4], [0; 4]);
    for _ in 0..few_or_many(30, 2_000) {
        let scenario = drawn(&mut draw);
        let friction = match &scenario.terrain {
            Terrain::Points { surface, .. } => surface.friction.coefficient,
            _ => unreachable!(),
        };
        let [along, up] = scenario.robot.center_of_mass;
        for FoundJam {
            jam, stable: stays, ..
        } in jams(&scenario)
        {
            let contacts = jam.contacts.len().min(3);
            found[contacts] += 1;
            stable[contacts] += u32::from(stays);
            let (sine, cosine) = libm::sincos(jam.angle);
            let x = jam.position.x + cosine * along - sine * up;
            let y = jam.position.y + sine * along + cosine * up;
            let (mut sum, mut moment) = ([0.0, -1.0], 0.0);
            for c in &jam.contacts {
                assert!(c.load >= -1e-8, "{jam:?}");
                // Driven forwards, the ground pushes along the normal turned by -90 degrees.
                assert!((c.friction - friction * c.load).abs() < 1e-12, "{jam:?}");
                let force = [
                    c.normal.x * c.load + c.normal.y * c.friction,
                    c.normal.y * c.load - c.normal.x * c.friction,
                ];
                sum = [sum[0] + force[0], sum[1] + force[1]];
                moment += (c.point.x - x) * force[1] - (c.point.y - y) * force[0];
            }
            assert!(
                sum.iter().all(|s| s.abs() < 1e-7) && moment.abs() < 1e-7,
                "{jam:?}"
            );
        }
    }
    println!("on none, one, two and more contacts {found:?}, of these stable {stable:?}");
    assert!(found.iter().sum::<u32>() > 100, "{found:?}");
    assert!(stable[1] == 0 && f64::from(stable[3]) > 0.8 * f64::from(found[3]));
}

#[test]
fn driving_backwards_from_the_other_side_mirrors_every_jam() {
    for (count, height) in [(4, 0.075), (5, 0.09), (6, 0.1)] {
        let forwards = strong(line(count), height, 0.9);
        let mut backwards = forwards.clone();
        backwards.robot.center_of_mass[0] = 0.03;
        backwards.drive.speed = -forwards.drive.speed;
        backwards.terrain = Terrain::Points {
            points: vec![[-3.0, height], [0.0, height], [0.0, 0.0], [3.0, 0.0]],
            goal: -2.0,
            surface: Surface::sharp(0.9),
            segment_friction: None,
        };
        let mut mirrored = forwards;
        mirrored.robot.center_of_mass[0] = -0.03;
        let (one, mut other) = (jams(&mirrored), jams(&backwards));
        other.reverse();
        assert_eq!(one.len(), other.len());
        assert!(one.len() > 1);
        for (a, b) in one.iter().zip(&other) {
            assert!((a.jam.position.x + b.jam.position.x).abs() < 1e-9);
            assert!((a.jam.position.y - b.jam.position.y).abs() < 1e-9);
            assert!((a.jam.angle + b.jam.angle).abs() < 1e-9);
        }
    }
}

/// On one corner the force, friction included, is vertical, and the centre of mass above the corner.
#[test]
fn a_robot_balances_on_one_corner_at_the_friction_angle() {
    for friction in [0.5, 0.9] {
        let found = jams(&strong(line(4), 0.075, friction));
        let mut on_one = found.iter().filter(|found| found.jam.contacts.len() == 1);
        let jam = &on_one.next_back().expect("it can").jam;
        let normal = jam.contacts[0].normal;
        assert!((normal.x + friction * normal.y).abs() < 1e-12);
        let (sine, cosine) = libm::sincos(jam.angle);
        let [along, up] = engineer().robot.center_of_mass;
        let x = jam.position.x + cosine * along - sine * up;
        assert!((x - jam.contacts[0].point.x).abs() < 1e-12);
        assert!(found.iter().all(|f| f.jam.contacts.len() != 1 || !f.stable));
    }
}

#[test]
fn a_belt_has_no_stable_jam_where_wheels_that_touch_are_caught() {
    let wheels = jams(&strong(line(4), 0.075, 0.9));
    let caught = |found: &&FoundJam| found.stable && found.intrusion.is_some();
    assert_eq!(wheels.iter().filter(caught).count(), 1);
    let belt = jams(&strong(belt(), 0.075, 0.9));
    assert!(
        belt.iter()
            .all(|found| !found.stable && found.intrusion.is_none())
    );
}

/// A belly that rests on a barrier may have any friction: its jams are intervals, whose ends are computed, and a robot hung up
/// there is between two of them.
#[test]
fn a_robot_hung_up_on_its_belly_is_between_two_ends() {
    let mut scenario = engineer_on(line(2));
    scenario.robot.drivetrain.max_torque = 500.0;
    scenario.terrain = Terrain::Barrier {
        height: 0.08,
        thickness: 0.05,
        surface: Surface::sharp(0.9),
    };
    let mut simulation = Simulation::new(&checked(&scenario));
    advance(&mut simulation, 8.0);
    let ([x, ..], speed) = pose(&simulation);
    assert!(speed < 1e-6, "{speed}");
    let is_of_belly = |c: &JamContact| c.kind == BodyKind::Belly;
    let found = jams(&scenario);
    let on_belly = (found.iter()).filter(|f| f.jam.contacts.iter().any(is_of_belly));
    let ends: Vec<f64> = on_belly.map(|f| f.jam.position.x).collect();
    assert!(
        ends.iter().any(|end| *end <= x) && ends.iter().any(|end| *end >= x),
        "{x} {ends:?}"
    );
}

/// Just inside its frictions a pose on three contacts is a jam, just outside it is none.
#[test]
fn a_pose_is_a_jam_between_its_least_and_its_greatest_friction() {
    let mut ends = 0;
    for (count, height) in [(4, 0.075), (5, 0.11), (6, 0.108)] {
        let scenario = |friction| strong(line(count), height, friction);
        let ranges = jam_ranges(&[checked(&scenario(1.0))], 1.5, &Cancel::default());
        for (range, _) in ranges.expect("its jams are known").remove(0) {
            let is_jam = |friction: f64| {
                let is_it = |found: &FoundJam| {
                    (found.jam.position - range.position).length() < 1e-7
                        && (found.jam.angle - range.angle).abs() < 1e-7
                };
                jams(&scenario(friction)).iter().any(is_it)
            };
            let [low, high] = range.friction;
            for (end, inwards) in [(low, 1e-6), (high, -1e-6)] {
                if end > 0.01 && end < 1.5 {
                    assert!(is_jam(end + inwards) && !is_jam(end - inwards), "{range:?}");
                    ends += 1;
                }
            }
        }
    }
    assert!(ends > 6, "{ends}");
}

#[test]
fn what_has_no_jams_of_this_kind_is_refused_by_name() {
    let path = |scenario: &Scenario| match find_jams(&checked(scenario), &Cancel::default()) {
        Err(crawler2d_core::Error::Scenario(error)) => error.path,
        other => panic!("{other:?}"),
    };
    for track in [
        line_of(3, paper_gear()),
        grouser_belt(),
        segmental(Some(22)),
        force(),
    ] {
        assert_eq!(path(&strong(track, 0.05, 0.9)), "robot.track");
    }
    let mut still = strong(line(4), 0.05, 0.9);
    still.drive.speed = 0.0;
    assert_eq!(path(&still), "drive.speed");
    assert_eq!(path(&strong(line(4), 0.05, 0.0)), "terrain.friction");
    let mut lanes = strong(line(4), 0.05, 0.9);
    lanes.terrain = Terrain::Lanes {
        left: Box::new(step(0.05, 0.9)),
        right: Box::new(step(0.06, 0.9)),
        middle: None,
    };
    assert_eq!(path(&lanes), "terrain");
    let mut icy = strong(line(4), 0.05, 0.9);
    icy.terrain = Terrain::Points {
        points: vec![[-3.0, 0.0], [0.0, 0.0], [0.0, 0.05], [3.0, 0.05]],
        goal: 1.0,
        surface: Surface::sharp(0.9),
        segment_friction: Some(vec![0.9, 0.9, 0.1]),
    };
    assert_eq!(path(&icy), "terrain.segment_friction");
    let mut rough = strong(line(4), 0.05, 0.9);
    let point = |i: u32| [1e-3 * f64::from(i) - 3.0, 1e-4 * f64::from(i % 2)];
    rough.terrain = Terrain::Points {
        points: (0..10_000).map(point).collect(),
        goal: 5.0,
        surface: Surface::sharp(0.9),
        segment_friction: None,
    };
    assert_eq!(path(&rough), "terrain");
}
