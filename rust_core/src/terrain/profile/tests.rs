//! Heights, edges and arcs of a lane.

use approx::assert_relative_eq;

use super::*;

fn profile(points: &[[f64; 2]], edge_radius: f64) -> Result<Profile, ScenarioError> {
    let surface = Surface {
        edge_radius,
        ..Surface::sharp(0.5)
    };
    Profile::new("terrain", points, surface, true)
}

/// A hill with sides of 45 degrees, and a block whose faces are 0.2 m high.
fn hill_and_block() -> Profile {
    let points = [
        [-2.0, 0.0],
        [1.0, 0.0],
        [1.5, 0.5],
        [2.0, 0.0],
        [4.0, 0.0],
        [4.0, 0.2],
        [4.5, 0.2],
        [4.5, 0.0],
        [6.0, 0.0],
    ];
    profile(&points, 0.0).expect("it is ground")
}

#[test]
fn ground_rises_above_a_segment_by_its_farthest_corner() {
    let ground = hill_and_block();
    for (a, b, rise) in [
        ([0.5, 0.0], [2.5, 0.0], 0.5),
        ([0.5, 0.1], [2.5, 0.5], 0.2),
        ([1.2, 0.0], [1.3, 0.0], 0.3),
        ([0.0, -0.5], [0.5, 1.0], 0.5),
        ([3.0, 0.5], [5.0, 1.0], -0.5),
    ] {
        let found = ground.rise_over_segment(a.into(), b.into());
        assert_relative_eq!(found, rise, epsilon = 1e-12);
    }
}

#[test]
fn a_disc_rests_on_faces_and_on_corners_to_either_side() {
    let ground = hill_and_block();
    let below = |x: f64| 0.2 + (0.09_f64 - (x - 4.0) * (x - 4.0)).sqrt();
    let slope = 0.3 * 2.0_f64.sqrt();
    for (x, height) in [
        (-1.0, 0.3),
        (3.75, below(3.75)),
        (4.2, 0.5),
        (4.75, below(3.75)),
        (1.25, 0.25 + slope),
        (1.75, 0.25 + slope),
        (1.5, 0.8),
    ] {
        let found = ground.height_under_disc(x, 0.3);
        assert_relative_eq!(found, height, epsilon = 1e-12);
    }
}

#[test]
fn the_angle_at_a_corner_is_that_of_the_facet_behind_it() {
    let ground = hill_and_block();
    let angle = 0.25 * std::f64::consts::PI;
    let places = [-9.0, 0.0, 1.0, 1.2, 1.5, 1.9, 2.0, 4.2, 5.0, 9.0];
    let found = places.map(|x| ground.angle_at(x));
    let expected = [0.0, 0.0, angle, angle, -angle, -angle, 0.0, 0.0, 0.0, 0.0];
    assert_relative_eq!(found.as_slice(), expected.as_slice(), epsilon = 1e-12);
    let slope = profile(&[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]], 0.0).expect("it is ground");
    assert_relative_eq!(slope.angle_at(5.0), angle);
}

#[test]
fn a_disc_is_clear_of_ground_that_ends_below_it() {
    let ground = hill_and_block();
    let is_clear = |x: f64, y: f64| ground.is_clear_of(Vector::new(x, y), 0.3);
    assert!(is_clear(0.0, 0.31) && !is_clear(0.0, 0.29));
    assert!(is_clear(1.5, 0.81) && !is_clear(1.5, 0.79));
    // The block is 0.25 m ahead of its centre.
    assert!(is_clear(3.75, 0.51) && !is_clear(3.75, 0.49));
}

#[test]
fn a_point_at_a_corner_touches_its_edge_and_one_beside_it_the_face() {
    let ground = hill_and_block();
    let facet = (ground.points.iter()).position(|p| (*p - Vector::new(4.0, 0.2)).length() < 1e-9);
    let facet = facet.expect("it has that corner");
    let edge = ground.edge_of_point[facet];
    assert!(edge >= 0);
    let at = |facet: usize, x: f64| ground.edge_at(facet, Vector::new(x, 0.2));
    assert_eq!([at(facet, 4.0 + 5e-8), at(facet, 4.0 + 2e-7)], [edge, -1]);
    assert_eq!(at(facet, 4.5 - 5e-8), ground.edge_of_point[facet + 1]);
    let on_face = ground.edge_at(facet - 1, Vector::new(4.0, 0.2 - 5e-8));
    assert_eq!(on_face, edge);
    let rounded = profile(&[[-1.0, 0.0], [0.0, 0.0], [0.0, 0.2], [1.0, 0.2]], 0.05);
    let rounded = rounded.expect("it is ground");
    let of_arc = rounded
        .edge_of_point
        .iter()
        .filter(|id| **id == rounded.edges.len() as i32 - 1);
    assert!(of_arc.count() > 10);
    for facet in 0..rounded.points.len() - 1 {
        let ids = [0, 1].map(|i| rounded.edge_of_point[facet + i]);
        if ids[0] == ids[1] && ids[0] >= 0 {
            let middle = (rounded.points[facet] + rounded.points[facet + 1]) * 0.5;
            assert_eq!(rounded.edge_at(facet, middle), ids[0]);
        }
    }
}

/// Arcs of 90 degrees take their radius of each face.
#[test]
fn two_arcs_fit_on_a_face_of_twice_their_radius() {
    let block = |width: f64| {
        let points = [
            [-1.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.3],
            [width, 0.3],
            [width, 0.0],
            [2.0, 0.0],
        ];
        profile(&points, 0.1)
    };
    assert!(block(0.201).is_ok());
    let error = block(0.199).expect_err("the second arc has no room");
    assert_eq!(error.path, "terrain.edge_radius");
    assert!(error.rule.contains("(0.199, 0.3)"), "{}", error.rule);
}

#[test]
fn an_edge_with_a_radius_below_a_nanometre_is_sharp() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.2], [1.0, 0.2]];
    let [sharp, rounded] = [9e-10, 1e-4].map(|radius| profile(&points, radius).expect("ground"));
    assert_eq!(sharp.points.len(), 4);
    assert!(sharp.edges.iter().all(|edge| edge.radius <= 0.0));
    assert!(rounded.points.len() > 50);
}

#[test]
fn a_spike_is_refused_and_a_wall_in_two_pieces_is_not() {
    let with = |top: f64| {
        profile(
            &[[-1.0, 0.0], [0.0, 0.0], [0.0, 0.3], [0.0, top], [1.0, top]],
            0.0,
        )
    };
    assert!(with(0.5).is_ok());
    let error = with(0.1).expect_err("it goes up and down again");
    assert!(
        error.rule.starts_with("must not be a spike"),
        "{}",
        error.rule
    );
}

#[test]
fn a_place_along_a_straight_piece_is_on_the_facet_that_holds_it() {
    for ends in [
        &[0.0, 0.25, 0.5, 0.75, 1.0][..],
        &[0.0, 0.1, 0.2, 1.0],
        &[0.0, 0.8, 0.9, 1.0],
        &[0.0, 0.02, 0.5, 0.51, 0.98, 1.0],
    ] {
        let on_slope = |share: &f64| Vector::new(1.0 + 4.0 * share, 2.0 + 3.0 * share);
        let points: Vec<Vector> = ends.iter().map(on_slope).collect();
        let last = points.len() - 2;
        let found = |fraction: f64| facet_along(&points, 0..last + 1, fraction);
        for (facet, pair) in ends.windows(2).enumerate() {
            for share in [0.01, 0.5, 0.99] {
                let fraction = pair[0] + share * (pair[1] - pair[0]);
                assert_eq!(found(fraction), facet, "{fraction} of {ends:?}");
            }
        }
        assert_eq!([found(-0.1), found(1.1)], [0, last], "beyond {ends:?}");
    }
}

#[test]
fn of_equal_facets_the_likely_one_holds_the_place() {
    for (fraction, facet) in [
        (-0.1, 3),
        (0.0, 3),
        (0.24, 3),
        (0.26, 4),
        (0.6, 5),
        (0.99, 6),
        (1.0, 6),
        (1.7, 6),
    ] {
        assert_eq!(likely_facet(3..7, fraction), facet, "{fraction}");
    }
    assert_eq!(likely_facet(3..4, 0.5), 3);
}

#[test]
fn points_on_a_straight_line_are_no_edges() {
    let points = [
        [-1.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.5],
        [4.0, 1.5],
        [5.0, 1.5],
    ];
    let ground = Profile::new("terrain", &points, Surface::sharp(0.5), false).expect("ground");
    assert_eq!(ground.edge_of_point, [-1, -1, 0, -1, 1, -1]);
    assert_eq!(ground.edges.len(), 2);
}

/// A piece of five facets, between pieces of one.
#[test]
fn a_place_along_a_straight_piece_is_where_its_fraction_lies() {
    let on_slope = |share: f64| [1.0 + 4e-4 * share, 2.0 + 3e-4 * share];
    let shares = [0.0, 0.02, 0.5, 0.51, 0.98, 1.0];
    let mut points: Vec<[f64; 2]> = shares.map(on_slope).into();
    points.insert(0, [0.0, 2.0]);
    points.push([3.0, 2.0]);
    let ground = Profile::new("terrain", &points, Surface::sharp(0.5), false).expect("ground");
    assert_eq!(ground.bends(), [0, 1, 6, 7]);
    for fraction in [0.0, 0.01, 0.2, 0.505, 0.7, 0.99, 1.0] {
        let place = ground.place_along(1..6, fraction);
        let off = ground.point_at(place) - Vector::from(on_slope(fraction));
        assert!(off.length() < 1e-15, "{fraction}: {place}");
        let facet = 1 + shares[1..5].partition_point(|share| *share <= fraction);
        assert!((facet as f64..=facet as f64 + 1.0).contains(&place));
        assert_relative_eq!(ground.place_along(6..7, fraction), 6.0 + fraction);
        let on_piece = Vector::new(fraction, 2.0);
        assert!((ground.place_on(0, on_piece) - fraction).abs() < 1e-15);
    }
    // Beyond the ends of a facet.
    let beyond = [-1.0, 2.0].map(|x| ground.place_on(0, Vector::new(x, 2.0)));
    assert_relative_eq!(beyond.as_slice(), [0.0, 1.0].as_slice());
}

/// The rest of the face is half a nanometre, which has no direction.
#[test]
fn an_arc_that_takes_up_its_face_ends_at_the_next_corner() {
    let width = 0.1 + 5e-10;
    let up = [
        [-1.0, 0.0],
        [0.0, 0.0],
        [0.0, 0.3],
        [width, 0.3],
        [width, 0.4],
        [2.0, 0.4],
    ];
    let ground = profile(&up, 0.05 + 0.05).expect("it is ground");
    let corner = Vector::new(width, 0.3);
    assert_eq!(
        ground
            .points
            .iter()
            .filter(|point| **point == corner)
            .count(),
        1
    );
    for pair in ground.points.windows(2) {
        assert!((pair[1] - pair[0]).length() > COLLINEAR.value(), "{pair:?}");
    }
    let [arc, inner] = [1, 2].map(|id| ground.edges[id].span);
    assert_eq!([arc[1]; 2], inner);
}

/// A turn of 0.1 mrad beside a piece of a micrometre is off it by a tenth of a nanometre.
#[test]
fn a_turn_that_moves_the_shorter_of_two_pieces_by_less_than_a_nanometre_is_no_edge() {
    for (length, count) in [(1e-6, 0), (1e-4, 1)] {
        let bend = [[0.0, 2.0], [5.0, 2.0], [5.0 + length, 2.0 + 1e-4 * length]];
        let mirrored = bend.map(|[x, y]| [-x, y]);
        for points in [bend, mirrored] {
            let ground = Profile::new("terrain", &points, Surface::sharp(0.5), false);
            let edges = ground.expect("it is ground").edges;
            assert_eq!(edges.len(), count, "{points:?}");
        }
    }
}

#[test]
fn a_sharp_step_of_nearly_a_nanometre_has_both_of_its_corners() {
    let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 9e-10], [1.0, 9e-10]];
    let ground = Profile::new("terrain", &points, Surface::sharp(0.5), false).expect("ground");
    assert_eq!(ground.points.len(), 4);
    let spans: Vec<[u32; 2]> = ground.edges.iter().map(|edge| edge.span).collect();
    assert_eq!(spans, [[1, 1], [2, 2]]);
}

/// Each of its blocks has two edges that would take 90 facets.
#[test]
fn ground_may_have_so_many_edges_that_only_sharp_ones_have_room() {
    let block = |i: u32| {
        let x = f64::from(i);
        [[x, 0.0], [x, 0.2], [x + 0.5, 0.2], [x + 0.5, 0.0]]
    };
    let points: Vec<[f64; 2]> = (0..5_700).flat_map(block).collect();
    assert!(profile(&points, 0.0).is_ok());
    let error = profile(&points, 0.01).expect_err("they are too many");
    assert!(
        error.rule.contains("would take 1026000 facets"),
        "{}",
        error.rule
    );
    assert!(profile(&points[..22_000], 0.01).is_ok());
}

#[test]
fn a_range_touches_the_facets_that_reach_into_it() {
    let ground = hill_and_block();
    for (low, high, facets) in [
        (-1.0, 0.5, 0..1),
        (-1.0, 1.2, 0..2),
        (1.2, 1.3, 1..2),
        (1.2, 1.7, 1..3),
        (1.5, 1.5, 1..3),
        // Both faces of the block, and its top.
        (3.9, 4.6, 3..8),
        (4.2, 4.3, 5..6),
        (-9.0, 9.0, 0..8),
        (7.0, 8.0, 8..8),
    ] {
        assert_eq!(ground.facets(low, high), facets, "{low} to {high}");
    }
    assert_eq!(ground.extent(), (-2.0, 6.0));
    assert_relative_eq!(ground.lowest(), 0.0);
}

/// Between two arcs that leave a nanometre of their face, or half of one, which is none.
#[test]
fn two_arcs_that_take_up_a_face_share_its_end() {
    for (left, is_shared) in [(2e-9, false), (5e-10, true)] {
        let width = 0.2 + left;
        let points = [
            [-1.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.3],
            [width, 0.3],
            [width, 0.0],
            [2.0, 0.0],
        ];
        let ground = profile(&points, 0.1).expect("it is ground");
        let [rear, front] = [1, 2].map(|id| ground.edges[id].span);
        assert_eq!(rear[1] == front[0], is_shared, "{left} m");
        // Neither takes anything of the faces beside them.
        let [foot, end] = [0, 3].map(|id| ground.edges[id].span);
        assert!(foot[1] < rear[0] && front[1] < end[0]);
        for edge in &ground.edges[1..3] {
            assert!((edge.angle - 0.5 * std::f64::consts::PI).abs() < 1e-12);
            for i in edge.span[0]..=edge.span[1] {
                let off = (ground.points[i as usize] - edge.center).length() - 0.1;
                assert!(off.abs() < 1e-9, "{off} m");
            }
            assert_eq!(edge.span[1] - edge.span[0], 90);
        }
    }
}
