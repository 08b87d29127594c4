//! The index against visiting every piece.

#![allow(clippy::print_stdout)] // the printed counts say what was judged

mod touches;

use std::cell::Cell;

use super::*;
use crate::draw::Draw;
use crate::scenario::Surface;

/// Half a metre of ground: flat, or with upright faces and jitter of this size [m]; edges are rounded where
/// there is room.
pub(super) fn lane(
    points: usize,
    jitter: f64,
    edge_radius: f64,
    draw: &mut Draw,
) -> (Profile, Lane) {
    let pitch = 0.5 / points as f64;
    let mut x = 0.0;
    let points: Vec<[f64; 2]> = (0..points)
        .map(|i| {
            let upright = jitter > 1e-9 && i % 7 == 3;
            x += if upright { 0.0 } else { pitch };
            [x, draw.between(-jitter, jitter)]
        })
        .collect();
    let profile = Profile::new(
        "terrain",
        &points,
        Surface::rounded(edge_radius, 0.9),
        false,
    )
    .or_else(|_| Profile::new("terrain", &points, Surface::sharp(0.9), false))
    .unwrap();
    let lane = Lane::new(&profile);
    (profile, lane)
}

/// Ground along points whose edges are all round.
fn rounded(points: &[[f64; 2]], edge_radius: f64) -> (Profile, Lane) {
    let surface = Surface::rounded(edge_radius, 0.9);
    let profile = Profile::new("terrain", points, surface, false).unwrap();
    let lane = Lane::new(&profile);
    (profile, lane)
}

/// Ground as a saw, whose arcs take up all of its faces.
fn saw(points: usize) -> (Profile, Lane) {
    let pitch = 0.5 / points as f64;
    let points: Vec<[f64; 2]> = (0..points)
        .map(|i| [i as f64 * pitch, (i % 2) as f64 * pitch])
        .collect();
    // Its faces slope by 45 degrees.
    let edge_radius = pitch * 2.0_f64.sqrt();
    let (profile, lane) = rounded(&points, edge_radius);
    assert!(
        lane.faces[1..points.len() - 2]
            .iter()
            .all(|f| f.length <= 0.0)
    );
    (profile, lane)
}

/// A touch in a form that can be compared bit by bit.
fn key(touch: &Touch) -> (String, [u64; 5]) {
    let numbers = [
        touch.place.x,
        touch.place.y,
        touch.normal.x,
        touch.normal.y,
        touch.distance,
    ];
    (format!("{:?}", touch.on), numbers.map(f64::to_bits))
}

fn sorted(mut touches: Vec<Touch>) -> Vec<(String, [u64; 5])> {
    touches.sort_by_key(key);
    touches.iter().map(key).collect()
}

/// Whether a touch is not on a face farther away than this [m], which the disc did not sink into.
fn is_within(lane: &Lane, touch: &Touch, center: Vector, far: f64) -> bool {
    match touch.on {
        On::Corner(_) => true,
        On::Face(i) => {
            let face = &lane.faces[i];
            let along = (center - face.begin).dot(face.along);
            let nearest = face.begin + face.along * along.clamp(0.0, face.length);
            (nearest - center).length() < far
        }
    }
}

/// Everything that a disc bears on, found by visiting every piece.
fn touches_one_by_one(
    lane: &Lane,
    center: Vector,
    radius: f64,
    (prediction, depth): (f64, f64),
) -> Vec<Touch> {
    let is_near = |t: &Touch| t.distance < prediction && t.distance + radius > -depth;
    let faces = (0..lane.faces.len()).filter_map(|i| lane.face_under_disc(i, center, radius));
    let corners = (0..lane.corners.len()).filter_map(|i| lane.corner_under_disc(i, center, radius));
    let corners = corners.filter(|t| t.distance < prediction);
    faces.filter(is_near).chain(corners).collect()
}

#[test]
fn the_index_finds_what_looking_at_every_piece_finds() {
    const SEED: u64 = 20_270_119;
    let mut draw = Draw(SEED);
    let (mut poses, mut found) = (0, 0);
    for count in [10, 30, 100, 1000, 10_000, 100_000] {
        for kind in [
            Some((0.0, 0.0)),
            Some((1e-6, 0.0)),
            Some((1e-3, 0.0)),
            Some((1e-3, 1e-6)),
            Some((0.03, 1e-4)),
            None,
        ] {
            let (profile, lane) = match kind {
                Some((jitter, edge_radius)) => lane(count, jitter, edge_radius, &mut draw),
                None => saw(count.min(10_000)), // a lane has a million facets at most
            };
            for _ in 0..(1_000_000 / count).min(300) {
                let radius = draw.between(0.0, 0.1).max(0.02) - 0.02;
                let prediction = draw.between(1e-5, 0.01);
                let x = draw.between(-0.05, 0.55);
                let top = profile.height_under_disc(x, radius).max(-0.1);
                let center = Vector::new(x, top + draw.between(-1e-3, 1.2 * prediction));
                let depth = draw.between(0.0, prediction.max(SHALLOW.value()));
                let (reach, far) = ((prediction, depth), radius + prediction.max(depth));
                let mut touches = Vec::new();
                let ends = [-1.0, 1.0].map(|side| center.x + side * far);
                let region = lane.region(ends[0], ends[1]);
                lane.touches_of_disc(&region, center, radius, reach, |t| touches.push(t));
                let slow = touches_one_by_one(&lane, center, radius, reach);
                let reaches = |t: &Touch| is_within(&lane, t, center, far);
                touches.retain(reaches);
                let slow: Vec<Touch> = slow.into_iter().filter(reaches).collect();
                poses += 1;
                found += slow.len();
                assert_eq!(
                    sorted(touches),
                    sorted(slow),
                    "{count} {kind:?} {center} {radius} {reach:?}"
                );
            }
        }
    }
    println!("seed {SEED}: {poses} poses, {found} touches");
}

/// Bounds of several pieces must include the very end of each.
#[test]
fn the_index_finds_a_disc_with_its_centre_below_the_end_of_a_face() {
    let mut draw = Draw(20_270_124);
    let (radius, prediction) = (0.02, SHALLOW.value());
    let far = radius + prediction;
    for jitter in [1e-5, 1e-4, 1e-3] {
        let (_, lane) = lane(1000, jitter, 0.0, &mut draw);
        let mut found = 0;
        for face in &lane.faces {
            // A tenth of a nanometre inside is a tenth of what counts as rounding.
            for along in [1e-10, face.length - 1e-10] {
                let end = face.begin + face.along * along;
                let center = end - face.normal * draw.between(0.0, 0.99 * prediction);
                let reach = (prediction, prediction);
                let region = lane.region(center.x - far, center.x + far);
                let mut touches = Vec::new();
                lane.touches_of_disc(&region, center, radius, reach, |t| touches.push(t));
                touches.retain(|t| is_within(&lane, t, center, far));
                let mut slow = touches_one_by_one(&lane, center, radius, reach);
                slow.retain(|t| is_within(&lane, t, center, far));
                found += slow.len();
                assert_eq!(sorted(touches), sorted(slow), "{jitter} {center}");
            }
        }
        assert!(found >= 2 * lane.faces.len());
    }
}

/// It is searched for within the half chord of the disc at the height of the highest ground, of any disc.
#[test]
fn a_disc_bears_on_a_step_far_ahead_of_its_axle_however_large_it_is() {
    for radius in [0.3, 3.0, 30.0] {
        let (ahead, high) = (0.9 * radius, 0.56 * radius);
        let mut points: Vec<[f64; 2]> = (-100_i32..90)
            .map(|i| {
                let rough = 1e-3 * f64::from(i.rem_euclid(2));
                [0.01 * radius * f64::from(i), -radius * rough]
            })
            .collect();
        points.extend([[ahead, 0.0], [ahead, high], [2.0 * radius, 0.5 * high]]);
        let (_, lane) = rounded(&points, 0.0);
        let above = (radius * radius - ahead * ahead).sqrt();
        let center = Vector::new(0.0, high + above);
        let region = lane.region(-radius, radius);
        assert!(region.is_long());
        let mut on_step = Vec::new();
        let reach = (1e-3 * radius, 0.0);
        lane.touches_of_disc(&region, center, radius, reach, |touch| {
            if (touch.place - Vector::new(ahead, high)).length() < 1e-9 * radius {
                on_step.push(touch.distance);
            }
        });
        assert_eq!(on_step.len(), 1, "{radius} m");
        assert!(on_step[0].abs() < 1e-9 * radius, "{} m", on_step[0]);
    }
}

#[test]
fn a_tip_past_the_end_of_a_face_does_not_bear_on_it() {
    let (_, lane) = rounded(&[[-1.0, 0.0], [0.0, 0.0], [1.0, -1.0]], 0.0);
    // Less deep than SHALLOW below the top, a tenth of a millimetre behind the edge of it, and below the slope.
    let tip = Vector::new(1e-4, -5e-4);
    let mut touched = Vec::new();
    let reach = (2e-4, SHALLOW.value());
    lane.touches_of_disc(&lane.region(-0.1, 0.1), tip, 0.0, reach, |touch| {
        touched.push(touch.on);
    });
    assert_eq!(touched, [On::Face(1)]);
}

#[test]
fn the_ends_of_the_ground_are_no_edges() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
    for edge_radius in [0.0, 0.02] {
        let (_, lane) = rounded(&points, edge_radius);
        let edges: Vec<i32> = lane.corners.iter().map(|corner| corner.edge).collect();
        assert_eq!(edges, [-1, 0, 1, -1]);
    }
}

/// Its facets are chords, and turned from it by half a degree.
#[test]
fn an_arc_down_to_the_ground_meets_it_along_its_own_tangent() {
    let high = 0.06;
    let points = [
        [-2.0, 0.0],
        [-1.0, 0.0],
        [-1.0, high],
        [0.0, high],
        [0.0, 0.0],
        [1.0, 0.0],
    ];
    let (_, lane) = rounded(&points, high);
    let feet = [
        (-1.0, [Vector::Y, Vector::NEG_X]),
        (0.0, [Vector::X, Vector::Y]),
    ];
    for (x, normals) in feet {
        let at_foot =
            |c: &&Corner| c.radius <= 0.0 && (c.center - Vector::new(x, 0.0)).length() < 1e-9;
        let foot = lane.corners.iter().find(at_foot).expect("it has a foot");
        for (found, normal) in foot.normals.into_iter().zip(normals) {
            assert!((found - normal).length() < 1e-9, "{found} at {x} m");
        }
    }
}

#[test]
fn a_corner_that_is_pressed_into_a_wall_stays_found() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.07], [1.0, 0.07]];
    let (_, lane) = rounded(&points, 0.0);
    // Prediction distance for grousers of a chain at rest; 2 kN press one in by more.
    let prediction = 2e-4;
    for depth in [1e-5, 1.9e-4, 2.1e-4, 9e-4] {
        let corner = Vector::new(depth, 0.06);
        let mut depths = Vec::new();
        let reach = (prediction, SHALLOW.value());
        lane.touches_of_disc(&lane.region(-0.1, 0.1), corner, 0.0, reach, |touch| {
            depths.push(-touch.distance);
        });
        assert_eq!(depths, [depth]);
    }
}

#[test]
fn nothing_rises_above_the_top_of_a_region() {
    let mut draw = Draw(20_270_120);
    // The top of an arc need not be one of its points.
    for edge_radius in [0.0, 1e-3, 5e-3] {
        for _ in 0..1000 {
            let left = draw.between(0.05, 0.2);
            let points = [
                [-1.0, 0.0],
                [0.0, 0.0],
                [left, 0.1],
                [0.2 + left, 0.0],
                [2.0, 0.0],
            ];
            let (_, lane) = rounded(&points, edge_radius);
            let arc = &lane.corners[2];
            let top = lane.top(&lane.region(left - 0.1, left + 0.1));
            assert!(top >= arc.center.y + edge_radius, "{left} {edge_radius}");
        }
    }
}

#[test]
fn few_pieces_are_looked_at_however_finely_a_flat_is_cut() {
    let mut draw = Draw(20_270_121);
    for (count, jitter) in [(1000, 0.0), (100_000, 0.0), (100_000, 1e-9)] {
        let (_, lane) = lane(count, jitter, 0.0, &mut draw);
        let (center, radius) = (Vector::new(0.25, 0.1001), 0.1);
        let reach = radius + 1e-3;
        let region = lane.region(center.x - reach, center.x + reach);
        let visited = Cell::new(0);
        lane.index.visit(
            &region,
            |stretch| stretch.may_face(center, reach),
            |_, _| visited.set(visited.get() + 1),
        );
        println!(
            "{count} points, jitter {jitter}: {} pieces of {:?}",
            visited.get(),
            region
        );
        assert!(visited.get() <= 64);
    }
}

/// Their number grows by about two each time the ground is twice as long.
#[test]
fn few_stretches_are_looked_at_however_long_the_ground_is() {
    for count in [1000, 10_000, 100_000] {
        let pitch = 2e-3;
        let points: Vec<[f64; 2]> = (0..count).map(|i| [pitch * f64::from(i), 0.0]).collect();
        let (_, lane) = rounded(&points, 0.0);
        assert_eq!(lane.faces.len() + 1, points.len());
        let length = pitch * f64::from(count);
        let (center, reach) = (Vector::new(0.4 * length, 0.1001), 0.101);
        let (mut looked_at, mut faces) = (0, 0);
        lane.index.visit(
            &lane.region(0.0, length),
            |stretch| {
                looked_at += 1;
                stretch.may_face(center, reach)
            },
            |_, _| faces += 1,
        );
        assert!((1..=16).contains(&faces), "{faces} faces");
        assert!(looked_at <= 64, "{looked_at} stretches of {count} pieces");
    }
}

#[test]
fn a_corner_beyond_a_run_does_not_make_it_look_at_all_the_others() {
    let mut draw = Draw(20_270_123);
    for jitter in [3e-7, 1e-6, 1e-5] {
        let points = (0..100_000).map(|i| [5e-6 * f64::from(i), draw.between(-jitter, jitter)]);
        let profile = Profile::new(
            "terrain",
            &points.collect::<Vec<_>>(),
            Surface::sharp(0.9),
            false,
        );
        let rough = Lane::new(&profile.unwrap());
        let arc = Vector::new(1e-3, 1.0).normalize();
        let bears = |i: &usize| rough.corners[*i].is_convex && rough.corners[*i].has_normal(arc);
        let last = (0..rough.corners.len()).rev().find(bears).unwrap();
        let region = Region::between(100, last);
        let (mut visited, mut bearing) = (0, Vec::new());
        let meet = |i: usize| {
            visited += 1;
            let corner = &rough.corners[i];
            // The last one lies below the arc behind the run.
            let normal = if i == last { arc } else { Vector::Y };
            let bears = corner.is_convex && corner.has_normal(normal);
            if bears && i != last {
                bearing.push(corner.center);
            }
            bears.then(|| corner.touch(i, normal, 0.0))
        };
        rough.visit_corners_below_run(&region, |_| true, meet);
        println!(
            "jitter {jitter}: {visited} of {} corners",
            rough.corners.len()
        );
        assert!(visited <= 150);
        bearing.sort_by(|a, b| a.x.total_cmp(&b.x));
        for corner in &rough.corners[100..last] {
            let next = bearing.partition_point(|p| p.x <= corner.center.x);
            if next > 0 && next < bearing.len() {
                let [a, b] = [bearing[next - 1], bearing[next]];
                let chord = a.y + (b.y - a.y) * (corner.center.x - a.x) / (b.x - a.x);
                assert!(corner.center.y < chord + 1.001e-6);
            }
        }
        assert!(bearing[0].x < 0.012 && bearing[bearing.len() - 1].x > 0.488);
    }
}

#[test]
fn the_arc_of_a_corner_is_as_long_as_its_angle_on_its_radius() {
    let (_, lane) = rounded(
        &[[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 0.0]],
        0.05,
    );
    let lengths: Vec<f64> = (0..5)
        .map(|i| lane.corner(i))
        .filter(|corner| corner.is_convex && corner.radius > 0.0)
        .map(Corner::arc_length)
        .collect();
    let right = 0.5 * std::f64::consts::PI;
    assert!((lengths[0] - 0.05 * right).abs() < 1e-12);
    assert!((lengths[1] - 0.05 * 0.5 * right).abs() < 1e-12);
}

/// A disc that is 1 um deep, with its centre above the edge, along normals from those of one face to those of the
/// other.
#[test]
fn a_rounded_edge_bears_however_short_its_arc_is() {
    const RADIUS: f64 = 0.1;
    for (edge_radius, turn) in [
        (3e-9, 5e-4),
        (1.5e-9, 5e-4),
        (1e-6, 5e-7),
        (1e-4, 5e-9),
        (1e-4, 1e-6),
    ] {
        let (s, c) = libm::sincos(turn);
        let (_, lane) = rounded(&[[-1.0, 0.0], [0.0, 0.0], [c, -s]], edge_radius);
        for share in 0..9 {
            let normal = crate::geometry::direction(
                std::f64::consts::FRAC_PI_2 - turn * f64::from(share) / 8.0,
            );
            let (center, mut found) = (normal * (RADIUS - 1e-6), 0);
            let region = lane.region(-RADIUS, RADIUS);
            lane.touches_of_disc(&region, center, RADIUS, (1e-4, 1e-3), |_| found += 1);
            assert!(found > 0, "{edge_radius} m, {turn} rad: {share}");
        }
    }
}
