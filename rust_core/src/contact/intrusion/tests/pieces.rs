//! The ground inside a track, for grounds whose pieces are known by hand.

use super::*;

fn envelope(margin: f64) -> TrackEnvelope {
    TrackEnvelope::new(&slotted().parts, (0, Mount::Chassis), margin)
}

fn ground(points: &[[f64; 2]]) -> Profile {
    Profile::new("terrain", points, Surface::sharp(0.9), true).expect("it is ground")
}

/// A track that is turned by an angle [rad], over two posts of 2 cm that rise to 3 cm inside it, 0.1 m before and
/// behind its middle, and the middles of their tops.
fn two_posts(angle: f64) -> (Pose, Profile, [Vector; 2]) {
    let pose = Pose::from_parts(Vector::new(0.1, 0.5), Rotation::new(angle));
    let tops = [-0.1, 0.1].map(|x| pose.transform_point(Vector::new(x, -0.05)));
    let post = |top: Vector| {
        let [left, right] = [-0.01, 0.01].map(|off| top.x + off);
        [[left, 0.0], [left, top.y], [right, top.y], [right, 0.0]]
    };
    let posts = tops.into_iter().flat_map(post);
    let ends = [[-2.0, 0.0], [2.0, 0.0]];
    let points: Vec<[f64; 2]> = std::iter::once(ends[0])
        .chain(posts)
        .chain([ends[1]])
        .collect();
    (pose, ground(&points), tops)
}

#[test]
fn a_point_of_a_post_is_in_its_own_piece_of_ground_only() {
    for angle in [-0.4, -0.1, 0.0, 0.1, 0.4] {
        let (envelope, (pose, profile, tops)) = (envelope(0.0), two_posts(angle));
        let under = envelope.points_under(&profile, pose);
        let place = |i: &u32| pose.inverse_transform_point(profile.points[*i as usize]);
        let polyline: Vec<Vector> = under.iter().map(place).collect();
        let chords = cut::chords(&envelope.tips.hull, &polyline);
        let pieces = cut::pieces(&envelope.tips.hull, &chords);
        assert_eq!(pieces.len(), 2);
        let holds = |point: Vector| {
            let point = pose.inverse_transform_point(point);
            let of_piece = |piece: &Piece| envelope.contains(&profile, pose, piece, point);
            pieces.iter().map(of_piece).collect::<Vec<_>>()
        };
        let below = 5e-3 * Vector::Y;
        assert_eq!(holds(tops[0] - below), [true, false], "{angle} rad");
        assert_eq!(holds(tops[1] - below), [false, true], "{angle} rad");
        assert_eq!(holds(0.5 * (tops[0] + tops[1])), [false, false]);
    }
}

#[test]
fn the_stretches_of_a_piece_begin_and_end_on_the_rim_of_the_track() {
    for angle in [-0.4, 0.0, 0.4] {
        let (envelope, (pose, profile, tops)) = (envelope(0.0), two_posts(angle));
        let found = envelope.intrusions(&profile, pose);
        assert_eq!(found.len(), 2);
        for ((intrusion, top), edges) in found.iter().zip(tops).zip([[1, 2], [5, 6]]) {
            assert_eq!(intrusion.edges, edges);
            let [(from, to)] = intrusion.stretches[..] else {
                panic!("a post has one: {intrusion:?}");
            };
            for (place, side) in [(from, -0.01), (to, 0.01)] {
                let point = profile.point_at(place);
                assert!((point.x - top.x - side).abs() < 1e-12, "{point}");
                let depth = envelope
                    .tips
                    .hull
                    .depth(pose.inverse_transform_point(point));
                assert!(depth.abs() < 1e-12, "{depth} m at {point}");
            }
            // Its deepest corner is on the side to which the track rises.
            let way = 0.01 * f64::from(i8::from(angle > 0.0) - i8::from(angle < 0.0));
            let expected = 0.03 * libm::cos(0.0) + way.abs() * libm::sin(angle.abs());
            assert!((intrusion.depth - expected).abs() < 1e-12, "{angle} rad");
        }
    }
}

#[test]
fn the_depth_of_a_piece_is_measured_without_the_margin_of_the_track() {
    let (pose, profile, _) = two_posts(0.0);
    for margin in [0.0, 2e-3] {
        let found = envelope(margin).intrusions(&profile, pose);
        for intrusion in found {
            let off = [intrusion.depth - 0.03, intrusion.root_depth - 0.03];
            assert!(off.iter().all(|off| off.abs() < 1e-12), "{margin} m");
            assert!((intrusion.area - 0.02 * (0.03 - margin)).abs() < 1e-12);
        }
    }
}

/// Half discs of 0.08 m, 0.372 m apart, less the margin.
#[test]
fn a_track_that_is_buried_is_all_in_one_piece_and_one_above_the_ground_in_none() {
    let flat = ground(&[[-5.0, 0.0], [5.0, 0.0]]);
    for margin in [0.0, 2e-3] {
        let radius = 0.08 - margin;
        let at = |y: f64| {
            envelope(margin).intrusions(&flat, Pose::from_translation(Vector::new(1.0, y)))
        };
        assert!(at(0.5).is_empty());
        let [found] = &at(-0.5)[..] else {
            panic!("it is one piece");
        };
        let area = 0.372 * 2.0 * radius + std::f64::consts::PI * radius * radius;
        assert!((found.area - area).abs() < 1e-12, "{} m^2", found.area);
        // The search for the deepest point ends within a nanometre.
        assert!((found.depth - 0.08).abs() < 1e-9 && (found.root_depth - 0.08).abs() < 1e-9);
        assert!((found.y + 0.5).abs() < 1e-9 && (found.x - 1.0).abs() < 0.19);
        assert!(found.edges.is_empty() && found.edge == -1 && found.stretches.is_empty());
    }
}

/// Its lower side is 0.08 m below its axles, and its ends 0.266 m before and behind its middle.
#[test]
fn a_track_holds_an_edge_that_is_convex_and_inside() {
    let ridge = ground(&[[-2.0, -1.0], [0.0, 0.0], [2.0, -1.0]]);
    let valley = ground(&[[-2.0, 1.0], [0.0, 0.0], [2.0, 1.0]]);
    let flat = ground(&[[-2.0, 0.0], [2.0, 0.0]]);
    for (profile, x, y, holds) in [
        (&ridge, 0.0, 0.07, true),
        (&ridge, 0.0, 0.09, false),
        (&ridge, 0.1, -0.07, true),
        (&ridge, 0.0, -0.09, false),
        (&ridge, 0.25, 0.04, true),
        (&ridge, 0.25, 0.06, false),
        (&ridge, -0.25, 0.04, true),
        (&ridge, 0.3, 0.01, false),
        (&ridge, -0.3, 0.01, false),
        (&valley, 0.0, 0.07, false),
        (&flat, 0.0, 0.0, false),
    ] {
        let pose = Pose::from_translation(Vector::new(x, y));
        assert_eq!(envelope(0.0).holds_edge(profile, pose), holds, "{x} {y}");
    }
}

#[test]
fn the_points_under_a_track_are_those_within_its_ends_and_one_on_either_side() {
    let height = |i: i32| 1e-3 * f64::from(i.rem_euclid(3));
    let points: Vec<[f64; 2]> = (-100..=100)
        .map(|i| [0.01 * f64::from(i), height(i)])
        .collect();
    let profile = ground(&points);
    let place = |i: u32| profile.points[i as usize].x;
    for x in [-0.7, -0.333, 0.0, 0.123, 0.7, -2.0, 2.0] {
        let pose = Pose::from_translation(Vector::new(x, 0.1));
        let under = envelope(0.0).points_under(&profile, pose);
        let (low, high) = (x - 0.266, x + 0.266);
        let before = profile.bends().iter().rfind(|i| place(**i) < low);
        let behind = profile.bends().iter().find(|i| place(**i) > high);
        let (first, last) = (
            profile.bends()[0],
            profile.bends()[profile.bends().len() - 1],
        );
        assert_eq!(under.first(), Some(before.unwrap_or(&first)), "{x} m");
        assert_eq!(under.last(), Some(behind.unwrap_or(&last)), "{x} m");
    }
}

#[test]
fn ground_without_a_convex_edge_in_a_track_has_no_deepest_one() {
    let valley = ground(&[[-2.0, 1.0], [0.0, 0.0], [2.0, 1.0]]);
    let pose = Pose::from_translation(Vector::new(0.0, 0.07));
    let [found] = &envelope(0.0).intrusions(&valley, pose)[..] else {
        panic!("it is one piece");
    };
    assert_eq!((found.edges.as_slice(), found.edge), (&[0][..], -1));
}
