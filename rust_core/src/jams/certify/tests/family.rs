//! Contents of a family of robots and grounds, and the families that are refused.

#![allow(clippy::float_cmp)] // shares are halves of halves

use super::*;
use crate::jams::certify::found::{Region, SearchEffort};
use crate::jams::certify::regions::Pair;
use crate::jams::layout::Layout;
use crate::jams::places::{Facing, Place};
use crate::scenario::shared;

fn ends(place: &Place) -> [Vector; 2] {
    match place.shape {
        Facing::Face { ends, .. } => ends,
        Facing::Corner { center, .. } => [center; 2],
    }
}

#[test]
fn a_family_is_its_members_where_parameters_are_least_or_most() {
    let family = family_on_a_step();
    let shares = [[0.0; 2], [1.0, 0.0], [0.0, 1.0], [1.0; 2], [0.5; 2]];
    for (scenario, [height, friction]) in members().iter().zip(shares) {
        let (layout, places) = family.at(&[height, friction, 0.0, 0.0]);
        let (model, ground) = built(scenario);
        let own = Layout::new(&model, true).expect("it has round wheels");
        assert!((layout.center_of_mass - own.center_of_mass).length() < 1e-15);
        let expected = Place::of(&ground);
        assert_eq!(places.len(), expected.len());
        for (place, other) in places.iter().zip(&expected) {
            assert!((place.friction - other.friction).abs() < 1e-15);
            let off = ends(place).into_iter().zip(ends(other));
            assert!(off.map(|(a, b)| (a - b).length()).all(|off| off < 1e-15));
        }
    }
}

/// The whole robot is over the ground, within its reach, and no higher or lower than it can touch.
#[test]
fn poses_are_sought_over_all_of_the_ground() {
    let family = family_on_a_step();
    let root = family.root();
    let points: Vec<Vector> = [[0.0; MOST_PARAMETERS], [1.0; MOST_PARAMETERS]]
        .iter()
        .flat_map(|shares| family.at(shares).1)
        .flat_map(|place| ends(&place))
        .collect();
    let low = points.iter().copied().fold(points[0], Vector::min);
    let high = points.iter().copied().fold(points[0], Vector::max);
    let reach = family.reach;
    let expected = [
        [low.x + reach, high.x - reach],
        [low.y - reach, high.y + reach],
        [-MOST_ANGLE, MOST_ANGLE],
        [0.0, 1.0],
        [0.0, 1.0],
        [0.0; 2],
        [0.0; 2],
    ];
    for (number, [least, most]) in expected.into_iter().enumerate() {
        let off = (root.low[number] - least)
            .abs()
            .max((root.high[number] - most).abs());
        assert!(off < 1e-12, "{number}: {root:?}");
    }
    let far = |disc: &crate::geometry::Disc| disc.center.length() + disc.radius;
    let farthest = family.discs.iter().map(far).fold(0.0, f64::max);
    assert!(
        reach >= farthest && reach < 2.0 * farthest,
        "{reach} {farthest}"
    );
}

/// About the centre of mass of all it is that about the chassis frame, less the whole mass times the square of the
/// distance.
#[test]
fn arms_count_in_the_moment_of_inertia_where_they_are_held() {
    let mut scenario = shared("engineer_flippers_step");
    scenario.robot.track = super::scenario(0.07, 0.5).robot.track;
    let (model, ground) = built(&scenario);
    let found = Family::new(&[(&model, &ground)], &[], true, MOST_ANGLE).expect("it has wheels");
    let running = model.running_at_start(0.0);
    let (whole, center) = model.mass_center(&running);
    let chassis = model.locked_inertia() + model.mass * model.center_of_mass.length_squared();
    // Raised to the angle at which the run begins.
    let angle = scenario
        .robot
        .flippers
        .as_ref()
        .map_or(0.0, |pair| pair.angle);
    let arms = model.flippers.iter().map(|arm| {
        let at = arm.pivot + Vector::from_angle(angle).rotate(arm.arm);
        arm.moment_of_inertia + arm.mass * at.length_squared()
    });
    let about_frame = chassis + arms.sum::<f64>();
    let expected = about_frame / whole - center.length_squared();
    let Interval { low, high } = found.inertia;
    assert!((low / expected - 1.0).abs() < 1e-12 && (high / expected - 1.0).abs() < 1e-12);
    assert!(!model.flippers.is_empty() && angle > 0.5);
}

#[test]
fn the_track_of_an_arm_is_where_the_arm_is_held() {
    let mut scenario = shared("engineer_flippers_step");
    let wheels = super::scenario(0.07, 0.5).robot.track;
    let arms = scenario.robot.flippers.as_mut().expect("it has some");
    arms.track = Some(wheels.clone());
    let (angle, length) = (arms.angle, arms.length);
    scenario.robot.track = wheels;
    let (model, ground) = built(&scenario);
    let found = Family::new(&[(&model, &ground)], &[], true, MOST_ANGLE).expect("it has wheels");
    let pivot = model.flippers[0].pivot;
    let tip = pivot + Vector::from_angle(angle) * length;
    let ends = |center: Vector| {
        let near = |track: &crate::jams::certify::family::Track| {
            let of = |disc: &crate::geometry::Disc| (disc.center - center).length() < 1e-12;
            track.discs.iter().any(of)
        };
        found.tracks.iter().map(near).collect::<Vec<bool>>()
    };
    // Its root is on the front axle, which is the chassis's, too.
    assert_eq!(ends(tip), [false, true]);
    assert_eq!(ends(pivot), [true, true]);
}

#[test]
fn a_face_ends_at_the_corner_that_rounds_its_end() {
    let family = family_on_a_step();
    let is_corner = |spot: &&crate::jams::certify::family::Spot| {
        matches!(spot.place.shape, Facing::Corner { .. })
    };
    let corner = family
        .places
        .iter()
        .find(is_corner)
        .expect("a step has one");
    let found: Vec<bool> = family
        .places
        .iter()
        .map(|spot| spot.ends_at(corner))
        .collect();
    // The level face before the step, its wall, the level face on it, and the corner itself.
    assert_eq!(found, [false, true, true, false]);
}

#[test]
fn parameters_that_do_nothing_or_something_else_or_not_in_proportion_are_refused() {
    let refused = |change: fn(&mut [Scenario; 5])| {
        let mut all = members();
        change(&mut all);
        family(&all).err().map(|error| error.value)
    };
    assert_eq!(refused(|_| {}), None);
    let [height, friction] =
        ["terrain.height", "terrain.friction"].map(|name| Some(name.to_owned()));
    let both = Some("terrain.height, terrain.friction".to_owned());
    assert_eq!(refused(|all| all[1] = all[0].clone()), height);
    assert_eq!(refused(|all| all[2] = all[0].clone()), friction);
    assert_eq!(refused(|all| all[3] = all[1].clone()), both);
    assert_eq!(refused(|all| all[4] = all[0].clone()), both);
    // A sharp edge, another shape of the ground, another wheel, and no belly.
    assert_eq!(
        refused(|all| {
            all[1].terrain = Terrain::Step {
                height: 0.09,
                surface: Surface::sharp(0.5),
            };
        }),
        height
    );
    assert_eq!(
        refused(|all| {
            all[1].terrain = Terrain::Ramp {
                angle: 0.5,
                length: 1.0,
                surface: Surface::rounded(0.004, 0.5),
            };
        }),
        height
    );
    assert_eq!(
        refused(|all| {
            if let Track::Line(line) = &mut all[2].robot.track {
                line.wheel_radius = Some(0.04);
            }
        }),
        friction
    );
    assert_eq!(refused(|all| all[2].robot.belly = None), friction);
}

/// Here the first parameter raises the centre of mass, which lies over the middle of the robot.
#[test]
fn a_parameter_may_move_the_centre_of_mass_in_proportion_alone() {
    let moved = |heights: [f64; 5]| {
        let mut all = members();
        for (member, height) in all.iter_mut().zip(heights) {
            member.robot.center_of_mass = [0.0, height];
            if let Terrain::Step { height, .. } = &mut member.terrain {
                *height = HEIGHTS[0];
            }
        }
        family(&all).map(|family| family.center_of_mass)
    };
    let [low, high, middle] = [0.01, 0.05, 0.03];
    let found = moved([low, high, low, high, middle]).expect("it is in proportion");
    let at = |share: f64| found.at(&[share, 0.0, 0.0, 0.0]);
    assert!((at(1.0) - at(0.0) - Vector::new(0.0, high - low)).length() < 1e-12);
    assert!(moved([low, high, low, high, 0.04]).is_err());
    assert!(moved([low, high, low, middle, middle]).is_err());
    assert!(moved([low; 5]).is_err());
}

/// Wheels in a row jam at some heights and not at others, so the ranges are divided as far as allowed.
#[test]
fn no_region_is_smaller_than_asked_for_and_together_they_are_all() {
    let belt = belts_on_a_step();
    for smallest in [1.0, 0.5] {
        let pair = Pair {
            wheels: family_on_a_step(),
            belt: belt.clone(),
            effort: SearchEffort {
                depth: 1e-3,
                smallest,
                cells: 20,
                keeps_cells: false,
            },
        };
        let found = pair.certificate(&Cancel::default());
        let regions = found.expect("there is memory").regions;
        let widths = |region: &Region| [0, 1].map(|k| region.high[k] - region.low[k]);
        let all: f64 = regions.iter().map(|r| widths(r)[0] * widths(r)[1]).sum();
        let least = regions.iter().flat_map(widths).fold(1.0, f64::min);
        assert_eq!((all, least), (1.0, smallest));
    }
}
