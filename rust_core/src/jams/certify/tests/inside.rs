//! Depth of the ground inside a track, in poses and over cells.

use super::*;
use crate::jams::contact::Turn;
use crate::jams::places::{Facing, Place};

/// [m] The depth of the deepest of points every half millimetre along the ground, with rounded corners by their
/// centres.
fn deepest(family: &Family, places: &[Place], at: &Posture) -> f64 {
    let back = Turn::by(-at.angle);
    let depth = |point: Vector| {
        let seen = back.apply(point - at.position);
        let depths = family.tracks.iter().map(|track| track.belt.depth(seen));
        depths.fold(0.0, f64::max)
    };
    let of_place = |place: &Place| match place.shape {
        Facing::Corner { center, radius, .. } => {
            let seen = back.apply(center - at.position);
            let depths = family
                .tracks
                .iter()
                .map(|track| track.belt.depth(seen) + radius);
            depths.fold(0.0, f64::max)
        }
        Facing::Face {
            ends: [from, to], ..
        } => {
            // No farther away than the robot reaches, twice.
            let length = (to - from).length();
            let along = (to - from) / length;
            let near = (at.position - from).dot(along);
            let [first, last] = [near - 1.0, near + 1.0].map(|s| s.clamp(0.0, length));
            let count = ((last - first) / 5e-4) as u32;
            let points = (0..=count).map(|k| from + along * (first + 5e-4 * f64::from(k)));
            points.map(depth).fold(0.0, f64::max)
        }
    };
    places.iter().map(of_place).fold(0.0, f64::max)
}

/// A pose in which no wheel overlaps with the ground: lowered onto it from above, near the step.
fn clear(draw: &mut Draw, family: &Family) -> (Cell, Setting) {
    let mut point = anywhere(draw, &family.root());
    point.low[0] = draw.between(-0.25, 0.25);
    point.low[2] = draw.between(-0.2, 0.9);
    let setting = family.setting(&point.shares(), &Cancel::default());
    let setting = setting.expect("there are few contacts");
    let (mut under, mut over) = (-0.5, 1.0);
    for _ in 0..30 {
        point.low[1] = 0.5 * (under + over);
        point.high = point.low;
        if setting.is_clear(&posture(&point)) {
            over = point.low[1];
        } else {
            under = point.low[1];
        }
    }
    point.low[1] = over + draw.between(0.0, 0.01);
    point.high = point.low;
    (point, setting)
}

/// Depth changes by no more than the distance along the ground, so steps of half a millimetre miss at most a quarter.
#[test]
fn ground_is_as_deep_inside_a_track_as_its_deepest_point() {
    let family = family_on_a_step();
    let mut draw = Draw(51);
    let mut inside = 0;
    for _ in 0..300 {
        let (point, setting) = clear(&mut draw, &family);
        let found = family.depth(&setting.places, &posture(&point));
        let expected = deepest(&family, &setting.places, &posture(&point));
        assert!(
            found > expected - 1e-9 && found < expected + 2.6e-4,
            "{found} {expected}"
        );
        inside += u32::from(expected > 1e-3);
    }
    assert!(inside > 30, "{inside}");
}

#[test]
fn where_a_cell_is_as_on_a_belt_no_clear_pose_of_it_has_deeper_ground() {
    let family = family_on_a_step();
    let mut draw = Draw(52);
    let (mut shown, mut deep, mut undecided) = (0, 0, 0);
    for case in 0..600 {
        let (point, setting) = clear(&mut draw, &family);
        let depth = family.depth(&setting.places, &posture(&point));
        let least = draw.between(1e-3, 0.02);
        let half = [0.0, 1e-3, 0.01][case % 3];
        let cell = cell_round(&mut draw, &point, half);
        if depth > 2e-3 {
            // A little less is not enough, however small the cell.
            assert!(!family.is_as_on_belt(&cell, depth - 1e-4), "{point:?}");
        }
        if family.is_as_on_belt(&cell, least) {
            shown += 1;
            assert!(depth < least + 1e-9, "{point:?}");
        } else if depth < least {
            undecided += u32::from(half == 0.0);
        } else {
            deep += 1;
        }
    }
    assert!(shown > 300 && deep > 10, "{shown} {deep}");
    // In a single pose hardly anything is left open.
    assert!(undecided < 10, "{undecided}");
}

/// The axles are as high as their radius, between the second and the third of which the wall of the step rises beyond
/// them: the edge is nearer to the upper run than the wall half way up is to either.
#[test]
fn a_wall_through_the_middle_of_a_track_is_deeper_than_its_edge() {
    let family = family_on_a_step();
    let radius = family.tracks[0].discs[0].radius;
    let at = Posture {
        position: Vector::new(0.0, radius),
        angle: 0.0,
    };
    // 90 mm high, and rounded by 4 mm.
    let shares = [1.0, 0.0, 0.0, 0.0];
    let setting = family.setting(&shares, &Cancel::default());
    let places = setting.expect("there are few contacts").places;
    assert!((family.depth(&places, &at) - radius).abs() < 1e-6);
    let edge = 2.0 * radius - 0.09;
    assert!(edge + 4e-3 < radius - 2e-3, "{edge} m");
    let point = cell_at(&at, &shares);
    assert!(!family.is_as_on_belt(&point, radius - 1e-3));
}

/// Of 4 m of ground only what is under the robot matters, wherever that is.
#[test]
fn level_ground_is_as_deep_inside_a_track_as_that_is_lowered_into_it() {
    let family = family_on_a_step();
    let radius = family.tracks[0].discs[0].radius;
    let setting = family.setting(&[0.0; 4], &Cancel::default());
    let places = setting.expect("there are few contacts").places;
    for x in [-2.0, -1.0, -0.5] {
        for lowered in [0.0, 0.01, 0.03] {
            let at = Posture {
                position: Vector::new(x, radius - lowered),
                angle: 0.0,
            };
            let found = family.depth(&places, &at);
            assert!((found - lowered).abs() < 1e-9, "{x} m: {found} m");
        }
    }
}
