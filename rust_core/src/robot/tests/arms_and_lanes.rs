//! Arms computed by hand, tracks on separate lanes, and tips of grousers.

use super::*;
use crate::scenario::shared;

#[test]
fn each_closed_track_is_over_the_lane_of_its_own_drive() {
    for robot in on_all_tracks() {
        let closed = closed(&robot, ClosedSurface::Own);
        let lanes = |model: &Model| {
            let driven = model
                .parts
                .iter()
                .filter_map(|part| Some((part.lane, part.drive?)));
            let mut lanes: Vec<(usize, usize)> = driven.collect();
            lanes.sort_unstable();
            lanes.dedup();
            lanes
        };
        assert_eq!(lanes(&model(&closed)), [(0, 0)]);
        assert_eq!(lanes(&on_two_lanes(&closed)), [(0, 0), (1, 1)]);
    }
}

/// Both arms at an end are one body: a rod of twice the mass, which turns about its root.
#[test]
fn arms_at_an_end_are_one_rod_about_the_axle_there() {
    for robot in on_arms(0.4) {
        let given = robot.flippers.as_ref().expect("it has arms");
        let model = model(&robot);
        assert_eq!(model.flippers.len(), 2);
        for arm in &model.flippers {
            let sign = arm.end.sign();
            let axle = robot.outline.end_discs()[usize::from(sign > 0.0)];
            assert!((arm.pivot - Vector::new(axle[0], axle[1])).length() < 1e-12);
            assert_relative_eq!(arm.mass, 2.0 * given.mass);
            assert_relative_eq!(arm.arm.x, 0.5 * sign * given.length);
            let inertia = 2.0 * given.mass * given.length.powi(2) / 12.0;
            assert_relative_eq!(arm.moment_of_inertia, inertia);
            assert_relative_eq!(arm.torque_limit, 2.0 * given.torque_limit);
            assert_relative_eq!(arm.rotor_inertia, 2.0 * given.rotor_inertia);
            assert!(arm.reach >= given.length + given.tip_radius);
            assert_relative_eq!(arm.start_angle, 0.4);
        }
    }
}

/// Round a wheel the tip of a grouser is faster than the belt that carries it, as it is farther from the axle; along itself a
/// surface has no tips.
#[test]
fn tips_of_grousers_are_faster_than_their_belt_by_the_ratio_of_their_radii() {
    let mut fastest = Vec::new();
    for robot in on_all_tracks() {
        let closed = model(&closed(&robot, ClosedSurface::Own));
        let driven = closed.parts.iter().filter(|part| part.drive.is_some());
        let ratios =
            driven.flat_map(|part| part.discs().map(|(tip, root)| tip.radius / root.radius));
        let ratio = ratios.fold(0.0, f64::max);
        let expected = if ratio > 1.0 { ratio } else { 0.0 };
        assert_relative_eq!(closed.tip_speed(), expected);
        fastest.push(expected);
    }
    assert!(fastest.contains(&0.0) && fastest.iter().any(|speed| *speed > 1.1));
    let gears = shared("engineer_gear3_step");
    // Its surface is where its tips are.
    assert_relative_eq!(model(&gears.robot).tip_speed(), 1.0);
}
