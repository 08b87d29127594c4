//! The walk along the belt round a few discs.

use super::*;
use crate::geometry::turned_by;

fn disc(x: f64, y: f64, radius: f64) -> Disc {
    Disc {
        center: Vector::new(x, y),
        radius,
    }
}

fn stadium() -> Envelope {
    Envelope::new(&[
        disc(-0.2, 0.0, 0.1),
        disc(0.0, 0.0, 0.1),
        disc(0.3, 0.0, 0.1),
    ])
}

#[test]
fn an_arc_is_cut_into_equal_pieces_and_a_run_is_one() {
    let pieces: Vec<f64> = stadium().positions(0.5).collect();
    // Half a turn takes seven pieces of at most 0.5 rad.
    let (arc, run) = (0.1 * std::f64::consts::PI, 0.5);
    assert_eq!(pieces.len(), 2 * (7 + 1));
    for (i, position) in pieces.iter().enumerate() {
        let (half, k) = (i / 8, i % 8);
        let expected = half as f64 * (arc + run) + arc * k as f64 / 7.0;
        assert!((position - expected).abs() < 1e-12, "{i}: {position}");
    }
    let points = stadium().polyline(0.5);
    assert!(points.iter().all(|p| stadium().depth(*p).abs() < 1e-12));
}

#[test]
fn a_hull_stands_on_the_run_below_its_centre_of_mass() {
    assert!(stadium().standing_angle(Vector::ZERO).abs() < 1e-15);
    // Its front is higher by as much as it is larger.
    let wedge = [disc(-0.2, 0.0, 0.1), disc(0.3, 0.0, 0.2)];
    let angle = Envelope::new(&wedge).standing_angle(Vector::ZERO);
    assert!(
        (angle - (0.1_f64 / 0.5).asin()).abs() < 1e-12,
        "{angle} rad"
    );
    // The middle run of a trapezoid with raised ends is level; the others count if the weight is beyond it.
    let raised = [(-0.5, 0.1), (-0.2, 0.0), (0.2, 0.0), (0.5, 0.1)];
    let raised = Envelope::new(&raised.map(|(x, y)| disc(x, y, 0.1)));
    let slope = (0.1_f64 / 0.3).atan();
    for (x, expected) in [(-0.35, slope), (0.0, 0.0), (0.35, -slope)] {
        let angle = raised.standing_angle(Vector::new(x, 0.1));
        assert!((angle - expected).abs() < 1e-12, "{angle} rad at {x} m");
    }
    let on_no_run = Envelope::new(&[disc(0.0, 0.0, 0.1)]);
    assert!(on_no_run.standing_angle(Vector::ZERO).abs() < 1e-15);
}

#[test]
fn length_and_area_are_those_of_a_stadium() {
    let belt = stadium();
    assert!((belt.length() - (1.0 + TAU * 0.1)).abs() < 1e-12);
    let area = -0.5 * belt.swept(0.0, belt.length());
    assert!((area - (0.1 + 0.5 * TAU * 0.01)).abs() < 1e-12, "{area}");
}

#[test]
fn walk_starts_at_the_rear_of_the_lower_run_and_follows_the_belt() {
    let belt = stadium();
    let arc = 0.05 * TAU;
    for (position, x, y) in [
        (0.0, -0.2, -0.1),
        (0.5 * arc, -0.3, 0.0),
        (arc, -0.2, 0.1),
        (arc + 0.5, 0.3, 0.1),
        (1.5 * arc + 0.5, 0.4, 0.0),
        (2.0 * arc + 0.6, 0.2, -0.1),
    ] {
        let point = belt.point_at(position);
        assert!(
            (point - Vector::new(x, y)).length() < 1e-12,
            "{position}: {point}"
        );
        assert!(
            (belt.position_of(point) - position).abs() < 1e-9,
            "{position}"
        );
    }
}

#[test]
fn one_disc_is_its_own_envelope() {
    let belt = Envelope::new(&[disc(1.0, 2.0, 0.5)]);
    assert!((belt.length() - 0.5 * TAU).abs() < 1e-12);
    assert!((belt.depth(Vector::new(1.0, 2.2)) - 0.3).abs() < 1e-12);
    assert!((-0.5 * belt.swept(0.0, belt.length()) - 0.125 * TAU).abs() < 1e-12);
}

#[test]
fn discs_inside_the_hull_leave_no_trace() {
    let belt = Envelope::new(&[
        disc(-0.2, 0.0, 0.1),
        disc(0.0, 0.02, 0.05),
        disc(0.3, 0.0, 0.1),
    ]);
    assert!((belt.length() - stadium().length()).abs() < 1e-12);
}

#[test]
fn the_hull_bends_once_round_and_only_round_discs_that_it_touches() {
    let discs = [
        disc(-0.2, 0.0, 0.1),
        disc(0.0, 0.02, 0.05),
        disc(0.3, 0.0, 0.1),
        disc(0.4, 0.2, 0.05),
    ];
    let belt = Envelope::new(&discs);
    let bends = belt.bends(discs.len());
    assert!((bends.iter().sum::<f64>() - TAU).abs() < 1e-12);
    assert!(bends[1].abs() < 1e-12 && [0, 2, 3].iter().all(|i| bends[*i] > 0.1));
    assert_eq!(belt.runs().count(), 3);
    for [from, to] in belt.runs() {
        let middle = (from + to) * 0.5;
        assert!(belt.depth(middle).abs() < 1e-12);
    }
}

#[test]
fn distances_along_the_belt_come_back_as_distances() {
    let belt = Envelope::new(&[disc(-0.2, 0.0, 0.1), disc(0.3, 0.05, 0.04)]);
    for i in 0..100 {
        let position = 0.017 * f64::from(i);
        for distance in [0.01, 0.05, 0.07] {
            let next = belt.position_at_distance(position, distance);
            let apart = (belt.point_at(next) - belt.point_at(position)).length();
            assert!(
                (apart - distance).abs() < 1e-9,
                "{position} {distance} {apart}"
            );
            // No arc within a half circle is longer than pi / 2 of its chord.
            assert!(next > position && next - position < 0.26 * TAU * distance);
        }
    }
}

/// In any orientation: rounding may move the position to just before the arc that begins there.
#[test]
fn a_stretch_begins_at_its_start() {
    for i in 0..2000 {
        let share = f64::from(i) / 2000.0;
        let turn = turned_by(TAU * share);
        let [rear, front] = [-0.2, 0.3].map(|x| turn(Vector::new(x, 0.0)));
        let belt = Envelope::new(&[
            disc(rear.x, rear.y, 0.1),
            disc(front.x, front.y, 0.05 + 0.1 * share),
        ]);
        for stretch in &belt.stretches {
            let position = belt.position_of(stretch.point_at(0.0));
            let off = (position - stretch.start).rem_euclid(belt.length());
            // The last one ends where the first one begins.
            assert!(off.min(belt.length() - off) < 1e-9, "{i}: {off} m");
        }
    }
}

#[test]
fn of_a_segment_the_part_inside_is_clipped() {
    for (a, b, inside) in [
        // From run to run, from arc to arc, and twice through one arc.
        ([0.0, -0.5], [0.0, 0.5], Some((0.4, 0.6))),
        ([-0.5, 0.0], [0.5, 0.0], Some((0.2, 0.9))),
        ([0.36, -0.16], [0.36, 0.16], Some((0.25, 0.75))),
        ([-0.26, 0.16], [-0.26, -0.16], Some((0.25, 0.75))),
        // From within, or to within.
        ([0.0, 0.0], [0.0, 0.4], Some((0.0, 0.25))),
        ([0.0, -0.4], [0.0, 0.0], Some((0.75, 1.0))),
        ([0.0, 0.0], [0.8, 0.0], Some((0.0, 0.5))),
        ([-0.6, 0.0], [0.0, 0.0], Some((0.5, 1.0))),
        ([-0.25, 0.0], [0.35, 0.05], Some((0.0, 1.0))),
        // Beside it, before it and behind it.
        ([-0.5, 0.11], [0.5, 0.11], None),
        ([0.0, -0.5], [0.0, -0.11], None),
        ([0.0, 0.11], [0.0, 0.5], None),
        ([0.36, -0.5], [0.36, -0.09], None),
        ([0.41, -0.5], [0.41, 0.5], None),
    ] {
        let ends = [a, b].map(Vector::from);
        let depths = ends.map(|end| stadium().depth(end));
        let found = stadium().clip(ends, depths);
        assert_eq!(found.is_some(), inside.is_some(), "{a:?} {b:?}");
        if let Some(((from, to), (low, high))) = found.zip(inside) {
            let off = (from - low).abs().max((to - high).abs());
            assert!(off < 1e-12, "{a:?} {b:?}: {from} to {to}");
        }
    }
}

/// Nanometres beside the joints of arcs and runs, however large the hull is.
#[test]
fn no_line_slips_out_of_a_hull_between_two_of_its_stretches() {
    let hulls = [
        &[(0.0, 0.0, 0.2)][..],
        &[(-0.2, 0.0, 0.1), (0.3, 0.0, 0.1)],
        &[(-0.2, 0.0, 0.1), (0.3, 0.1, 0.25)],
        &[(-0.2, 0.0, 0.1), (0.3, 0.0, 0.05), (0.1, 0.3, 0.02)],
    ];
    for (discs, scale) in hulls
        .iter()
        .flat_map(|hull| [1.0, 100.0].map(|scale| (hull, scale)))
    {
        let discs = discs
            .iter()
            .map(|(x, y, r)| disc(x * scale, y * scale, r * scale));
        let hull = Envelope::new(&discs.collect::<Vec<_>>());
        for stretch in &hull.stretches {
            for off in [-5e-9, -1.5e-9, -0.5e-9, 0.0, 0.5e-9, 1.5e-9, 5e-9] {
                let (place, outward) = hull.place_at(stretch.start + off);
                let ends = [-0.01, 0.01].map(|way| place + outward * (way * scale));
                let found = hull.clip(ends, ends.map(|end| hull.depth(end)));
                let (from, to) = found.expect("it ends inside");
                assert!(
                    from <= 0.0 && (to - 0.5).abs() < 1e-9,
                    "{off} m: {from} to {to}"
                );
            }
        }
    }
}

#[test]
fn a_hull_reaches_as_far_as_its_farthest_disc_in_every_direction() {
    let mut draw = crate::draw::Draw(20_270_301);
    for number in 0..300 {
        let count = 1 + draw.below(6);
        // Of some hulls, several discs are equally low, alike, or in a row.
        let (flat, round) = (number % 3 == 0, number % 2 == 0);
        let discs: Vec<Disc> = (0..count)
            .map(|_| {
                let radius = if round { 0.1 } else { draw.between(0.0, 0.2) };
                let x = f64::from(draw.below(7) as u32) * 0.1;
                let y = if flat {
                    radius
                } else {
                    draw.between(-0.3, 0.3)
                };
                disc(x, y, radius)
            })
            .collect();
        let hull = Envelope::new(&discs);
        let turn = 0.01;
        let points = hull.polyline(turn);
        for i in 0..60 {
            let outward = crate::geometry::direction(0.1 + TAU * f64::from(i) / 60.0);
            let of_disc = |d: &Disc| d.center.dot(outward) + d.radius;
            let expected = discs.iter().map(of_disc).fold(f64::NEG_INFINITY, f64::max);
            let found = points
                .iter()
                .map(|p| p.dot(outward))
                .fold(f64::NEG_INFINITY, f64::max);
            // Between two points of an arc of 0.2 m it rises by less than half of this.
            let rise = 0.2 * 0.25 * turn * turn;
            assert!(
                (expected - rise..expected + 1e-12).contains(&found),
                "{discs:?}"
            );
        }
        let swept: f64 = hull.bends(count).iter().sum();
        assert!((swept - TAU).abs() < 1e-9, "{discs:?}: {swept} rad");
    }
}

#[test]
fn the_outward_normal_is_that_of_the_nearest_run_or_arc() {
    for (x, y, outward) in [
        (0.0, -0.05, Vector::NEG_Y),
        (0.0, 0.05, Vector::Y),
        (0.0, 0.3, Vector::Y),
        (-0.25, 0.0, Vector::NEG_X),
        (0.35, 0.0, Vector::X),
        (0.6, 0.4, Vector::new(0.6, 0.8)),
        (-0.23, -0.04, Vector::new(-0.6, -0.8)),
    ] {
        let found = stadium().outward_at(Vector::new(x, y));
        assert!((found - outward).length() < 1e-12, "{x} {y}: {found}");
    }
}

/// Forwards is to the right, and the belt runs rearwards below and forwards above.
#[test]
fn the_neighbours_of_a_point_are_the_discs_that_the_belt_passes_before_and_after_it() {
    let discs = [
        disc(-0.2, 0.0, 0.1),
        disc(0.0, 0.0, 0.05),
        disc(0.3, 0.0, 0.1),
    ];
    let belt = Envelope::new(&discs);
    for (x, y, expected) in [
        // Less deep than the small disc, 0.05 m from the belt, and deeper.
        (-0.1, -0.06, [2, 0]),
        (-0.1, -0.04, [1, 0]),
        (0.1, -0.04, [2, 1]),
        (0.1, 0.06, [0, 2]),
        (-0.1, 0.04, [0, 1]),
        (0.1, 0.04, [1, 2]),
        (-0.25, 0.01, [0, 0]),
        (0.35, 0.01, [2, 2]),
    ] {
        let point = Vector::new(x, y);
        let found = belt.neighbours(point, belt.nearest(point), &discs);
        assert_eq!(found, expected, "{x} {y}");
    }
}

#[test]
fn a_segment_is_no_deeper_below_the_runs_than_its_deeper_end() {
    let below = |a: [f64; 2], b: [f64; 2]| stadium().depth_below_runs([a, b].map(Vector::from));
    for (a, b, depth) in [
        ([0.0, -0.05], [0.1, -0.02], 0.08),
        ([0.0, -0.02], [0.1, -0.05], 0.08),
        ([0.0, 0.07], [0.1, 0.01], 0.09),
        ([0.0, -0.05], [0.1, 0.05], 0.15),
        ([0.0, 0.3], [0.1, 0.2], -0.1),
    ] {
        assert!((below(a, b) - depth).abs() < 1e-12, "{a:?} {b:?}");
    }
}

/// The area between the origin and the rim, twice and counted clockwise.
#[test]
fn what_a_stretch_of_the_rim_sweeps_is_the_area_of_its_fan() {
    let belt = Envelope::new(&[disc(0.1, 0.05, 0.1), disc(0.5, 0.1, 0.06)]);
    let length = belt.length();
    for (from, to) in [(0.0, 0.1), (0.05, 0.7), (0.3, 0.9), (1.0, 0.2), (0.9, 0.85)] {
        let way = if to < from {
            to + length - from
        } else {
            to - from
        };
        let count = 20_000;
        let point = |i: i32| belt.point_at(from + way * f64::from(i) / f64::from(count));
        let fan: f64 = (0..count)
            .map(|i| crate::geometry::cross(point(i), point(i + 1)))
            .sum();
        // Chords of 0.1 mm are a hundredth of a micrometre below an arc of 0.06 m.
        let off = belt.swept(from, to) - fan;
        assert!(off.abs() < 1e-7, "{from} to {to}: {off} m^2");
    }
}

#[test]
fn a_point_that_is_farther_than_the_whole_belt_is_a_round_ahead() {
    let belt = stadium();
    for position in [0.0, 0.3, 2.0] {
        let found = belt.position_at_distance(position, 5.0);
        assert!((found - position - belt.length()).abs() < 1e-12);
    }
}

#[test]
fn the_hull_of_points_is_a_polygon() {
    let corners = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.3), (0.1, 0.2)];
    let hull = Envelope::new(&corners.map(|(x, y)| disc(x, y, 0.0)));
    let points = hull.polyline(0.1);
    for (x, y) in corners {
        let off = points.iter().map(|p| (*p - Vector::new(x, y)).length());
        assert!(off.fold(f64::INFINITY, f64::min) < 1e-15, "{x} {y}");
    }
    for position in [0.0, 0.05, hull.length()] {
        assert!(hull.point_at(position).is_finite(), "{position} m");
    }
}
