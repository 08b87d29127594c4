//! Touches of a disc and of a straight run, one at a time, and points in the ground.

use super::*;
use crate::geometry::right_of;

/// A block of half a metre, whose top is a metre long.
const BLOCK: [[f64; 2]; 6] = [
    [-1.0, 0.0],
    [0.0, 0.0],
    [0.0, 0.5],
    [1.0, 0.5],
    [1.0, 0.0],
    [2.0, 0.0],
];

/// A valley whose faces slope by 45 degrees, each as far along x as given.
fn valley(left: f64, right: f64) -> Lane {
    let points = [
        [-3.0, left],
        [-left, left],
        [0.0, 0.0],
        [right, right],
        [3.0, right],
    ];
    rounded(&points, 0.0).1
}

/// Their faces are `left` and `right` times the root of 2 long.
#[test]
fn a_point_is_under_a_valley_in_the_cone_of_both_normals_and_as_deep_as_its_faces_are_long() {
    for (left, right, place, is_under) in [
        (1.0, 1.0, [0.0, -0.1], true),
        (1.0, 1.0, [0.05, -0.1], true),
        (1.0, 1.0, [-0.05, -0.1], true),
        (1.0, 1.0, [0.15, -0.1], false),
        (1.0, 1.0, [-0.15, -0.1], false),
        (1.0, 1.0, [0.0, 0.1], false),
        (1.0, 1.0, [0.0, -1.4], true),
        (1.0, 1.0, [0.0, -1.45], false),
        (0.5, 1.0, [0.0, -0.7], true),
        (0.5, 1.0, [0.0, -0.72], false),
        (1.0, 0.5, [0.0, -0.7], true),
        (1.0, 0.5, [0.0, -0.72], false),
    ] {
        let found = valley(left, right).is_under(2, place.into());
        assert_eq!(found, is_under, "{left} {right} {place:?}");
    }
    let lane = valley(1.0, 1.0);
    let below = |i: usize| lane.is_under(i, lane.corners[i].center - 0.1 * Vector::Y);
    // The ends, and the convex corners on top of the slopes.
    assert_eq!([0, 1, 3, 4].map(below), [false; 4]);
}

#[test]
fn a_tip_below_a_valley_is_in_both_of_its_faces() {
    let lane = valley(1.0, 1.0);
    let region = lane.region(-0.5, 0.5);
    for (x, faces) in [(0.0, &[1, 2][..]), (-7e-4, &[1]), (7e-4, &[2])] {
        let (mut found, tip) = (Vec::new(), Vector::new(x, -5e-4));
        let reach = (1e-4, SHALLOW.value());
        lane.touches_of_disc(&region, tip, 0.0, reach, |touch| found.push(touch));
        let on: Vec<On> = found.iter().map(|touch| touch.on).collect();
        let expected: Vec<On> = faces.iter().map(|face| On::Face(*face)).collect();
        assert_eq!(on, expected, "{x} m");
        for touch in found {
            let depth = 0.5_f64.sqrt() * (5e-4 + x.abs());
            assert!((touch.distance + depth).abs() < 1e-15, "{touch:?}");
        }
    }
}

#[test]
fn the_ground_holds_what_lies_below_its_faces_and_arcs() {
    let radius = 0.1;
    for (edge_radius, x, y, is_inside) in [
        (0.0, -0.5, -0.1, true),
        (0.0, -0.5, 0.1, false),
        (0.0, -1e-3, 0.25, false),
        (0.0, 1e-3, 0.25, true),
        (0.0, 0.5, 0.49, true),
        (0.0, 0.5, 0.51, false),
        (0.0, 0.999, 0.25, true),
        (0.0, 1.001, 0.25, false),
        (radius, 0.05, 0.3, true),
        // 0.071 m, 0.094 m and 0.127 m from the middle of the arc.
        (radius, 0.05, 0.45, true),
        (radius, 0.02, 0.45, true),
        (radius, 0.01, 0.49, false),
        (radius, 0.99, 0.49, false),
        (radius, 0.95, 0.45, true),
        (radius, 0.5, 0.49, true),
    ] {
        let (_, lane) = rounded(&BLOCK, edge_radius);
        let found = lane.contains(Vector::new(x, y));
        assert_eq!(found, is_inside, "{edge_radius} {x} {y}");
    }
}

/// A micrometre is ten times as far as what counts as at an edge.
#[test]
fn a_disc_on_a_face_touches_the_edge_at_either_end_and_no_edge_between() {
    let (profile, lane) = rounded(&BLOCK, 0.0);
    let edges: Vec<i32> = profile.edges.iter().map(|edge| edge.id).collect();
    assert_eq!(edges, [0, 1, 2, 3]);
    for (x, edge) in [
        (5e-8, 1),
        (1e-6, -1),
        (0.3, -1),
        (1.0 - 1e-6, -1),
        (1.0 - 5e-8, 2),
    ] {
        let touch = lane.face_under_disc(2, Vector::new(x, 0.7), 0.125);
        let touch = touch.expect("it is above the top");
        assert_eq!((touch.edge, touch.facet), (edge, 2), "{x} m");
        assert!((touch.place - Vector::new(x, 0.5)).length() < 1e-15);
        assert!((touch.distance - 0.075).abs() < 1e-15 && touch.normal == Vector::Y);
        let contact = touch.contact(7);
        assert!((contact.point - Vector::new(x, 0.5375)).length() < 1e-15);
        assert_eq!((contact.part, contact.facet, contact.edge), (7, 2, edge));
    }
    for x in [-0.01, 1.01] {
        let touch = lane.face_under_disc(2, Vector::new(x, 0.7), 0.125);
        assert!(touch.is_none(), "{x} m");
    }
}

/// In numbers without rounding: they have no corner on which it could bear.
#[test]
fn a_disc_bears_right_above_either_end_of_the_ground() {
    let (_, lane) = rounded(&BLOCK, 0.0);
    for x in [-1.0, 2.0] {
        let center = Vector::new(x, 0.25);
        let mut distances = Vec::new();
        let region = lane.region(x - 0.25, x + 0.25);
        lane.touches_of_disc(&region, center, 0.125, (0.25, 0.0), |touch| {
            distances.push(touch.distance);
        });
        assert_eq!(distances, [0.125], "{x} m");
    }
}

#[test]
fn each_end_of_the_ground_has_the_normal_of_its_face() {
    let points = [[-1.0, 1.0], [0.0, 0.0], [1.0, 0.0], [3.0, 1.0]];
    let (_, lane) = rounded(&points, 0.0);
    let normal = |x: f64, y: f64| Vector::new(x, y).normalize();
    let faces = [normal(1.0, 1.0), Vector::Y, normal(-1.0, 2.0)];
    let expected = [
        [faces[0], faces[0]],
        [faces[0], faces[1]],
        [faces[1], faces[2]],
        [faces[2], faces[2]],
    ];
    for (corner, expected) in lane.corners.iter().zip(expected) {
        for (found, normal) in corner.normals.into_iter().zip(expected) {
            assert!((found - normal).length() < 1e-15, "{corner:?}");
        }
        assert!(!corner.is_convex);
    }
}

#[test]
fn an_arc_has_a_facet_for_each_of_its_normals() {
    let (profile, lane) = rounded(&BLOCK, 0.1);
    for corner in lane.corners.iter().filter(|corner| corner.radius > 0.0) {
        assert!(corner.facets > 50);
        for facet in corner.facet..corner.facet + corner.facets {
            let middle = 0.5 * (profile.points[facet] + profile.points[facet + 1]);
            let normal = (middle - corner.center).normalize();
            let touch = corner.touch(3, normal, 0.01);
            assert_eq!((touch.facet, touch.edge), (facet, corner.edge));
            assert_eq!(touch.on, On::Corner(3));
            // Facets are 0.04 mm below their arc.
            assert!((touch.place - middle).length() < 5e-5);
        }
        let [before, behind] = corner
            .normals
            .map(|normal| corner.touch(0, normal, 0.0).facet);
        assert_eq!(before, corner.facet);
        assert_eq!(behind, corner.facet + corner.facets - 1);
    }
}

/// Edges that a straight run from `begin` to `end` meets within 10 mm and down to 20 mm, each with its gap [m].
fn met_by_run(lane: &Lane, begin: [f64; 2], end: [f64; 2]) -> Vec<(i32, f64)> {
    let (begin, end) = (Vector::from(begin), Vector::from(end));
    let outward = right_of((end - begin).normalize());
    let mut met = Vec::new();
    let x = [begin.x.min(end.x), begin.x.max(end.x)];
    let region = lane.region_of_runs(x, 0.01);
    lane.touches_of_run(&region, (begin, end), outward, (0.01, 0.02), |touch| {
        assert!((touch.normal + outward).length() < 1e-15);
        met.push((touch.edge, touch.distance));
    });
    met
}

#[test]
fn a_run_meets_the_edges_between_its_ends_that_are_neither_too_far_nor_too_deep() {
    for edge_radius in [0.0, 0.05] {
        let (_, lane) = rounded(&BLOCK, edge_radius);
        // An arc bears at its top, a radius beyond the face.
        let [rear, front] = [edge_radius, 1.0 - edge_radius];
        let level = |from: f64, to: f64, gap: f64| [[from, 0.5 + gap], [to, 0.5 + gap]];
        for ([begin, end], expected) in [
            (level(-0.5, 0.4, 9e-3), &[(1, 9e-3)][..]),
            (level(-0.5, 0.4, 0.011), &[]),
            (level(-0.5, 0.4, -0.019), &[(1, -0.019)]),
            (level(-0.5, 0.4, -0.021), &[]),
            (level(-0.5, rear + 1e-3, 0.0), &[(1, 0.0)]),
            (level(-0.5, rear - 1e-3, 0.0), &[]),
            (level(rear - 1e-3, 0.4, 0.0), &[(1, 0.0)]),
            (level(rear + 1e-3, 0.4, 0.0), &[]),
            (level(front - 1e-3, 1.5, 0.0), &[(2, 0.0)]),
            (level(-0.5, 1.5, 2e-3), &[(1, 2e-3), (2, 2e-3)]),
            // Upright, before the face, and upside down.
            ([[-5e-3, 0.3], [-5e-3, 0.6]], &[(1, 5e-3)]),
            ([[-5e-3, 0.3], [-5e-3, 0.44]], &[]),
            ([[1.005, 0.6], [1.005, 0.3]], &[(2, 5e-3)]),
            ([[0.4, 0.5], [-0.5, 0.5]], &[]),
        ] {
            let found = met_by_run(&lane, begin, end);
            assert_eq!(
                found.len(),
                expected.len(),
                "{edge_radius} {begin:?} {end:?}"
            );
            for (found, expected) in found.iter().zip(expected) {
                assert_eq!(found.0, expected.0);
                assert!((found.1 - expected.1).abs() < 1e-12, "{begin:?} {end:?}");
            }
        }
    }
}

/// Past the normal of the face beside it by the angle by which a side may turn in a step.
#[test]
fn a_run_that_is_turned_a_little_past_a_face_meets_its_edge() {
    let (_, lane) = rounded(&BLOCK, 0.0);
    for (turn, is_met) in [(0.5, true), (0.0, true), (-0.019, true), (-0.021, false)] {
        let (sine, cosine) = libm::sincos(turn);
        let at = |along: f64| [along * cosine, 0.5 + along * sine];
        let found = met_by_run(&lane, at(-0.3), at(0.3));
        let is_rear = found.iter().any(|(edge, _)| *edge == 1);
        assert_eq!(is_rear, is_met, "{turn} rad");
    }
}

#[test]
fn a_few_pieces_are_convex_where_one_of_their_corners_is() {
    let lane = valley(1.0, 1.0);
    let may_be = |first: usize, last: usize| lane.may_be_convex(&Region::between(first, last));
    assert!(may_be(0, 1) && may_be(1, 2) && may_be(2, 3) && may_be(3, 4));
    assert!(!lane.may_be_convex(&Region::between(2, 2)));
    let (_, flat) = rounded(&[[-1.0, 0.0], [1.0, 0.0]], 0.0);
    assert!(!flat.may_be_convex(&flat.region(-0.5, 0.5)));
}

#[test]
fn ground_is_fine_where_its_pieces_are_many_and_shorter_than_a_millimetre() {
    for (pitch, count, is_fine) in [(9e-4, 60, true), (1.1e-3, 60, false), (9e-4, 15, false)] {
        let points = (0..=count).map(|i| [pitch * f64::from(i), 1e-4 * f64::from(i % 2)]);
        let (_, lane) = rounded(&points.collect::<Vec<_>>(), 0.0);
        let middle = 0.5 * pitch * f64::from(count);
        let found = lane.is_fine(Vector::new(middle, 0.3), middle);
        assert_eq!(found, is_fine, "{count} of {pitch} m");
        // Few of them are within five pitches.
        assert!(!lane.is_fine(Vector::new(middle, 0.3), 5.0 * pitch));
    }
}

/// The tip in the middle is 0.1 mm lower, below the line from the first to the last.
#[test]
fn a_run_over_a_few_teeth_meets_the_low_one_too() {
    let teeth = [
        [0.0, -0.1],
        [0.1, 0.0],
        [0.2, -0.1],
        [0.3, -1e-4],
        [0.4, -0.1],
        [0.5, 0.0],
        [0.6, -0.1],
    ];
    let (_, lane) = rounded(&teeth, 0.0);
    let met = met_by_run(&lane, [0.05, 1e-3], [0.55, 1e-3]);
    let gaps: Vec<f64> = met.iter().map(|(_, gap)| *gap).collect();
    assert_eq!(gaps.len(), 3, "{gaps:?}");
    for (found, gap) in gaps.iter().zip([1e-3, 1.1e-3, 1e-3]) {
        assert!((found - gap).abs() < 1e-15, "{gaps:?}");
    }
}

/// A parabola that is open at its top has no edges.
#[test]
fn where_all_corners_are_concave_a_run_looks_at_none() {
    let points = (-50..=50).map(|i| [0.01 * f64::from(i), 1e-4 * f64::from(i * i)]);
    let (_, lane) = rounded(&points.collect::<Vec<_>>(), 0.0);
    let mut met = 0;
    lane.visit_corners_below_run(
        &Region::between(20, 80),
        |_| true,
        |_| {
            met += 1;
            None
        },
    );
    assert_eq!(met, 0);
}

/// Of 2 mm each, so that a chord between the outermost teeth is tried.
#[test]
fn where_no_corner_matters_a_run_looks_at_none() {
    let points = (0..=200).map(|i| [2e-3 * f64::from(i), 1e-3 * f64::from(i % 2)]);
    let (_, lane) = rounded(&points.collect::<Vec<_>>(), 0.0);
    let met_if = |matters: bool| {
        let mut met = 0;
        let region = Region::between(20, 180);
        lane.visit_corners_below_run(
            &region,
            |_| matters,
            |_| {
                met += 1;
                None
            },
        );
        met
    };
    assert_eq!(met_if(false), 0);
    assert!(met_if(true) > 0);
}

/// Fine ground with one tooth, which is the last but one corner of a run.
#[test]
fn a_tooth_right_before_the_end_of_a_run_is_met() {
    let tooth = 59;
    let points = (0..=100).map(|i| {
        let high = if i == tooth {
            2e-4
        } else {
            1e-4 * f64::from(i % 2)
        };
        [5e-4 * f64::from(i), high]
    });
    let (_, lane) = rounded(&points.collect::<Vec<_>>(), 0.0);
    let mut met = Vec::new();
    let region = Region::between(11, 60);
    lane.visit_corners_below_run(
        &region,
        |_| true,
        |i| {
            met.push(i);
            let bears = [11, 59, 60].contains(&i);
            bears.then(|| lane.corners[i].touch(i, Vector::Y, 0.0))
        },
    );
    assert!(met.contains(&(tooth as usize)), "{met:?}");
    assert!(met.len() < 40, "the others are below the line: {met:?}");
}
