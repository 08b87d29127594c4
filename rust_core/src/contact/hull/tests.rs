//! Planks and capsules over ground that is known by hand.

use super::*;
use crate::draw::Draw;
use crate::geometry::Rotation;
use crate::robot::{BodyKind, Mount};
use crate::scenario::Surface;
use crate::terrain::Profile;

#[test]
fn a_sector_holds_what_lies_between_its_ends_however_wide_it_is() {
    for sweep in [0.1, 1.5, 3.0, 3.3, 5.0, 6.2] {
        for from in [-3.0, -0.4, 1.0, 2.9] {
            let sector = Sector::new(from, sweep);
            for i in 0..100 {
                let angle = TAU * (f64::from(i) + 0.37) / 100.0;
                let is_between = (angle - from).rem_euclid(TAU) < sweep;
                assert_eq!(sector.contains(direction(angle)), is_between);
            }
        }
    }
}

#[test]
fn a_whole_turn_holds_every_direction() {
    let sector = Sector::new(0.3, 7.0);
    assert!((0..100).all(|i| sector.contains(direction(0.0628 * f64::from(i)))));
}

fn part(shape: Shape) -> Part {
    Part {
        kind: BodyKind::Belly,
        shape,
        drive: None,
        friction_limit: f64::INFINITY,
        lane: 0,
        mount: Mount::Chassis,
    }
}

/// A metre long and 0.1 m high; its origin is the middle of its lower side.
fn plank() -> HullContact {
    let corners = [(-0.5, 0.0), (0.5, 0.0), (0.5, 0.1), (-0.5, 0.1)];
    let corners = corners.map(|(x, y)| Vector::new(x, y)).into();
    HullContact::new(0, &part(Shape::Polygon { corners }))
}

/// Two discs of 50 mm, 0.4 m apart.
fn capsule() -> HullContact {
    let disc = |x: f64| Disc {
        center: Vector::new(x, 0.0),
        radius: 0.05,
    };
    let discs = [-0.2, 0.2].map(disc).into();
    HullContact::new(
        0,
        &part(Shape::Hull {
            discs,
            grouser_height: 0.0,
        }),
    )
}

fn lane(points: &[[f64; 2]]) -> Lane {
    let profile = Profile::new("terrain", points, Surface::sharp(0.9), false);
    Lane::new(&profile.expect("it is ground"))
}

fn found(hull: &HullContact, lane: &Lane, pose: Pose, prediction: f64) -> Vec<Contact> {
    let mut contacts = Vec::new();
    hull.find(lane, pose, prediction, &mut contacts);
    contacts
}

/// Level ground in pieces of 5 mm, of which a tip 50 mm high stands in the middle.
#[test]
fn a_tip_between_many_pieces_bears_on_a_run_wherever_it_is_along_it() {
    let height = |i: i32| if i == 0 { 0.05 } else { 0.0 };
    let points: Vec<[f64; 2]> = (-300..=300)
        .map(|i| [5e-3 * f64::from(i), height(i)])
        .collect();
    let lane = lane(&points);
    let tip = Vector::new(0.0, 0.05);
    for (angle, along, gap) in [-0.05, 0.0, 0.05].into_iter().flat_map(|angle| {
        let places = [-0.45, -0.2, 0.0, 0.3].into_iter();
        places.flat_map(move |along| [5e-4, -2e-4].map(|gap| (angle, along, gap)))
    }) {
        for (hull, below) in [(plank(), 0.0), (capsule(), 0.05)] {
            let rotation = Rotation::new(angle);
            let normal = rotation * Vector::Y;
            // The tip is below that place of the lower run.
            let on_run = rotation * Vector::new(0.4 * along, -below);
            let pose = Pose::from_parts(tip + normal * gap - on_run, rotation);
            let found = found(&hull, &lane, pose, 1e-3);
            assert_eq!(found.len(), 1, "{angle} rad, {along} m, {gap} m: {found:?}");
            assert!((found[0].distance - gap).abs() < 1e-12);
            assert!((found[0].normal - normal).length() < 1e-12);
            assert!((found[0].point - tip - normal * (0.5 * gap)).length() < 1e-12);
        }
    }
}

/// A capsule that was found from 10 mm away, and is 5 mm deep.
#[test]
fn an_arc_in_a_wall_bears_on_it_unless_the_wall_ends_behind_it() {
    for (thickness, count) in [(3e-3, 0), (0.02, 1)] {
        let points = [
            [-2.0, 0.0],
            [0.0, 0.0],
            [0.0, 1.0],
            [thickness, 1.0],
            [thickness, 0.0],
            [2.0, 0.0],
        ];
        let pose = Pose::from_translation(Vector::new(5e-3 - 0.25, 0.5));
        let found = found(&capsule(), &lane(&points), pose, 0.01);
        assert_eq!(found.len(), count, "{thickness} m: {found:?}");
        for contact in found {
            assert!((contact.distance + 5e-3).abs() < 1e-12);
            assert!((contact.normal - Vector::NEG_X).length() < 1e-12);
        }
    }
}

#[test]
fn a_hull_bears_on_level_ground_at_the_ends_of_its_lowest_run() {
    let level = lane(&[[-2.0, 0.0], [2.0, 0.0]]);
    for (hull, below, half) in [(plank(), 0.0, 0.5), (capsule(), 0.05, 0.2)] {
        for (gap, count) in [(9e-4, 2), (1.1e-3, 0), (-9e-4, 2)] {
            let pose = Pose::from_translation(Vector::new(0.3, below + gap));
            let found = found(&hull, &level, pose, 1e-3);
            assert_eq!(found.len(), count, "{gap} m: {found:?}");
            for contact in found {
                assert!(((contact.point.x - 0.3).abs() - half).abs() < 1e-12);
                assert!((contact.distance - gap).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_lowest_run_is_below_the_hull_however_that_lies() {
    for (angle, x) in [
        (0.0, [-0.5, 0.5]),
        (0.25 * TAU, [-0.1, 0.0]),
        (0.5 * TAU, [-0.5, 0.5]),
    ] {
        let pose = Pose::from_parts(Vector::new(3.0, 1.0), Rotation::new(angle));
        let found = plank().lowest_run(pose);
        for (found, expected) in found.into_iter().zip(x) {
            assert!(
                (found - 3.0 - expected).abs() < 1e-12,
                "{angle} rad: {found}"
            );
        }
    }
    let found = capsule().lowest_run(Pose::from_translation(Vector::X));
    assert!((found[0] - 0.8).abs() < 1e-12 && (found[1] - 1.2).abs() < 1e-12);
}

/// Saw teeth of 1 mm, each 5 mm long, from 1 m on.
fn saw(count: i32) -> Lane {
    let point = |i: i32| [1.0 + 5e-3 * f64::from(i), 1e-3 * f64::from(i % 2)];
    lane(&(0..=count).map(point).collect::<Vec<_>>())
}

/// Stretches of a ground of every length.
fn stretches(lane: &Lane) -> Vec<Stretch> {
    let found = std::cell::RefCell::new(Vec::new());
    let matters = |stretch: &Stretch| {
        found.borrow_mut().push(*stretch);
        true
    };
    lane.visit_corners(&lane.region(-9.0, 9.0), matters, |_| ());
    found.into_inner()
}

/// [m] Distance of a roof from a hull, of 200 of its points.
fn apart(hull: &HullContact, pose: Pose, [a, b]: [Vector; 2]) -> f64 {
    let place = |i: i32| a + (b - a) * (f64::from(i) / 200.0);
    let gap = |i: i32| -hull.hull.depth(pose.inverse_transform_point(place(i)));
    (0..=200).map(gap).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_room_above_a_roof_is_no_more_than_its_distance_and_all_of_it_over_a_level_side() {
    let roofs = stretches(&saw(64));
    assert!(roofs.len() > 8);
    let mut draw = Draw(20_270_501);
    for hull in [plank(), capsule()] {
        for _ in 0..200 {
            let place = Vector::new(draw.between(0.4, 2.0), draw.between(0.0, 0.4));
            let pose = Pose::from_parts(place, Rotation::new(draw.between(-0.7, 0.7)));
            for stretch in &roofs {
                let (room, apart) = (
                    hull.room_above(stretch, pose),
                    apart(&hull, pose, stretch.roof),
                );
                assert!(
                    room <= apart.max(0.0) + 1e-9,
                    "{room} m of {apart} m at {pose:?}"
                );
            }
        }
    }
    for stretch in &roofs {
        let level = |x: f64, y: f64| Pose::from_translation(Vector::new(x, y));
        // Above it, and before its beginning or behind its end.
        for (hull, pose) in [
            (plank(), level(1.16, 0.05)),
            (capsule(), level(1.16, 0.2)),
            (capsule(), level(0.6, 0.3)),
            (capsule(), level(1.8, 0.3)),
        ] {
            let (room, apart) = (
                hull.room_above(stretch, pose),
                apart(&hull, pose, stretch.roof),
            );
            // Of a roof that leans, its points are a sample.
            assert!(
                (room - apart).abs() < 1e-6,
                "{room} m of {apart} m at {pose:?}"
            );
        }
    }
}

/// Also if a side would bear on it only after a small turn.
#[test]
fn no_corner_that_bears_is_in_a_stretch_that_is_left_out() {
    let lane = saw(200);
    let mut draw = Draw(20_270_502);
    let mut found = 0;
    for hull in [plank(), capsule()] {
        for _ in 0..300 {
            let prediction = draw.size(1e-4, 0.05);
            let place = Vector::new(draw.between(0.9, 2.1), draw.between(0.0, 0.1));
            let pose = Pose::from_parts(place, Rotation::new(draw.between(-0.3, 0.3)));
            let bearing = |matters: &dyn Fn(&Stretch) -> bool| {
                let mut bearing = Vec::new();
                lane.visit_corners(&lane.region(-9.0, 9.0), matters, |i| {
                    if hull
                        .corner_in_hull(i, lane.corner(i), pose, prediction)
                        .is_some()
                    {
                        bearing.push(i);
                    }
                });
                bearing
            };
            let all = bearing(&|_| true);
            assert_eq!(
                bearing(&|stretch| hull.may_bear(stretch, pose, prediction)),
                all
            );
            found += all.len();
        }
    }
    assert!(found > 1000, "{found}");
}

/// Turned by more than the teeth lean, only its lower end can bear, and level it is too high for any.
#[test]
fn few_corners_are_looked_at_below_a_plank_that_few_can_bear() {
    let lane = saw(200);
    for (x, y, angle, most) in [
        (1.5, 0.2, 0.3, 40),
        (1.5, 0.2, -0.3, 40),
        (1.5, 0.3, 0.0, 0),
    ] {
        let pose = Pose::from_parts(Vector::new(x, y), Rotation::new(angle));
        let mut looked_at = 0;
        let may_bear = |stretch: &Stretch| plank().may_bear(stretch, pose, 0.2);
        lane.visit_corners(&lane.region(-9.0, 9.0), may_bear, |_| looked_at += 1);
        assert!(looked_at <= most, "{looked_at} at {angle} rad");
    }
}
