//! Ends that need no window: tipped over, left the terrain, cleared.

use super::*;

/// [m] An axle this much farther is beyond an end.
const BIT: f64 = 1e-4;

#[test]
fn a_robot_tips_over_beyond_the_angle_either_way() {
    let limit = scenario().criteria.tip_over_angle;
    for side in [1.0, -1.0] {
        let mut robot = Watched::with(|_| {});
        assert_eq!(robot.put(-1.0, RADIUS, side * limit), None);
        let ended = robot.put(-1.0, RADIUS, side * (limit + 1e-9));
        assert_eq!(ended, Some(Outcome::TippedOver));
    }
}

#[test]
fn an_axle_that_passes_an_end_has_left_the_terrain() {
    let upright = std::f64::consts::FRAC_PI_3; // cosine 1/2
    let backwards = 2.0 * upright; // cosine -1/2
    for (angle, reach) in [(0.0, HALF), (upright, 0.5 * HALF), (backwards, 0.5 * HALF)] {
        for side in [1.0, -1.0] {
            let mut robot = Watched::with(|s| s.criteria.tip_over_angle = 3.0);
            let last = END - reach;
            assert_eq!(robot.put(side * (last - BIT), RADIUS, angle), None);
            let ended = robot.put(side * (last + BIT), RADIUS, angle);
            assert_eq!(ended, Some(Outcome::LeftTerrain), "{angle} rad, {side}");
        }
    }
}

#[test]
fn an_axle_at_an_end_is_still_on_the_terrain() {
    let mut robot = Watched::with(|_| {});
    assert_eq!(robot.put(HALF - END, RADIUS, 0.0), None);
    assert_eq!(robot.put(END - HALF, RADIUS, 0.0), None);
}

#[test]
fn an_axle_a_metre_below_the_ground_has_left_the_terrain() {
    let (floor, tilted) = (-1.0, std::f64::consts::FRAC_PI_6);
    let mut robot = Watched::with(|_| {});
    assert_eq!(robot.put(-1.0, floor, 0.0), None);
    for side in [1.0, -1.0] {
        let mut robot = Watched::with(|_| {});
        let last = floor + 0.5 * HALF;
        assert_eq!(robot.put(-1.0, last + BIT, side * tilted), None);
        let ended = robot.put(-1.0, last - BIT, side * tilted);
        assert_eq!(ended, Some(Outcome::LeftTerrain));
    }
}

#[test]
fn a_run_is_cleared_when_the_goal_was_held_for_its_time() {
    let behind = 1.0 + HALF + RADIUS;
    let mut robot = Watched::with(|_| {});
    robot.put(behind, RADIUS, 0.0);
    robot.stands_until(0.7);
    assert_eq!(
        robot.monitor.ended_as(),
        None,
        "the rear axle is not beyond"
    );
    robot.now.position.x = behind + BIT;
    robot.stands_until(0.701 + 0.499);
    assert_eq!(
        robot.monitor.ended_as(),
        None,
        "it was not held long enough"
    );
    assert!(robot.observed().time_to_clear.is_infinite());
    robot.stands_until(0.701 + 0.501);
    assert_eq!(robot.monitor.ended_as(), Some(Outcome::Cleared));
    assert!(robot.monitor.is_over());
    // Until then it stood just before it.
    assert_relative_eq!(robot.observed().time_to_clear, 0.7);
}

#[test]
fn a_goal_that_is_lost_must_be_held_anew() {
    let behind = 1.0 + HALF + RADIUS + BIT;
    let mut robot = Watched::with(|_| {});
    robot.now.position.x = behind;
    robot.stands_until(0.4);
    robot.put(behind - 2.0 * BIT, RADIUS, 0.0);
    robot.now.position.x = behind;
    robot.stands_until(0.9);
    assert_eq!(robot.monitor.ended_as(), None);
    robot.stands_until(0.91);
    // In the step from 0.401 s on it passes the goal half-way.
    assert_relative_eq!(robot.observed().time_to_clear, 0.4015);
}

#[test]
fn a_goal_is_held_along_the_ground_that_is_there() {
    let (slope, limit) = (0.5_f64.atan(), scenario().criteria.clear_angle);
    let clears = |angle: f64| {
        let mut robot = Watched::with(|s| {
            let top = 0.5 * (END - 1.0);
            s.terrain = ground(&[[-END, 0.0], [1.0, 0.0], [END, top]]);
        });
        robot.now.position = Vector::new(2.0, 1.0);
        robot.now.chassis_angle = angle;
        robot.stands_until(0.6);
        robot.monitor.ended_as() == Some(Outcome::Cleared)
    };
    assert!(clears(slope) && clears(slope + 0.9 * limit) && clears(slope - 0.9 * limit));
    assert!(!clears(slope + 1.1 * limit) && !clears(slope - 1.1 * limit));
    assert!(!clears(0.0));
}

/// A track with a larger front stands with its nose up.
#[test]
fn a_goal_is_held_at_the_angle_at_which_the_robot_stands() {
    let clears = |angle: f64| {
        let mut robot = Watched::with(|s| {
            s.robot.outline.discs = TrackOutline::two_discs(2.0 * HALF, [RADIUS, 2.5 * RADIUS]);
        });
        robot.now.position.x = 3.0;
        robot.now.chassis_angle = angle;
        robot.stands_until(0.6);
        robot.monitor.ended_as() == Some(Outcome::Cleared)
    };
    let (stands, limit) = (
        (0.75 * RADIUS / HALF).asin(),
        scenario().criteria.clear_angle,
    );
    assert!(stands > limit);
    assert!(clears(stands) && clears(stands + 0.9 * limit) && clears(stands - 0.9 * limit));
    assert!(!clears(0.0) && !clears(stands + 1.1 * limit));
}

#[test]
fn a_chassis_at_the_very_angle_of_clearing_is_not_level() {
    let mut robot = Watched::with(|_| {});
    robot.now.position.x = 2.0;
    robot.now.chassis_angle = scenario().criteria.clear_angle;
    robot.stands_until(1.0);
    assert_eq!(robot.monitor.ended_as(), None);
}

#[test]
fn a_robot_that_tips_over_where_it_leaves_the_terrain_has_tipped_over() {
    let mut robot = Watched::with(|_| {});
    assert_eq!(robot.put(END, -3.0, 2.0), Some(Outcome::TippedOver));
}

#[test]
fn a_robot_that_leaves_the_terrain_as_it_would_have_cleared_has_left_it() {
    let mut robot = Watched::with(|s| s.criteria.clear_time = 0.0);
    // Level and beyond the goal, but past the end of the ground.
    assert_eq!(robot.put(END, RADIUS, 0.0), Some(Outcome::LeftTerrain));
}

#[test]
fn what_a_run_ended_with_stays() {
    let mut robot = Watched::with(|_| {});
    robot.put(END, RADIUS, 0.0);
    assert!(robot.monitor.is_over());
    assert_eq!(robot.put(-1.0, RADIUS, 2.0), Some(Outcome::LeftTerrain));
}

#[test]
fn a_chain_that_is_off_ends_a_run_as_long_as_nothing_else_has() {
    let off = ChainReading {
        is_off: true,
        ..ChainReading::default()
    };
    let mut robot = Watched::with(|_| {});
    robot.step();
    assert!(!robot.monitor.is_over());
    robot.monitor.observe_chains(ChainReading::default());
    assert!(!robot.monitor.is_over());
    robot.monitor.observe_chains(off);
    assert_eq!(robot.monitor.ended_as(), Some(Outcome::Detracked));
    assert!(robot.monitor.is_over());
    let ended = robot.put(-1.0, RADIUS, 2.0);
    assert_eq!(ended, Some(Outcome::Detracked));

    let mut robot = Watched::with(|_| {});
    robot.put(-1.0, RADIUS, 2.0);
    robot.monitor.observe_chains(off);
    assert_eq!(robot.monitor.ended_as(), Some(Outcome::TippedOver));
}

/// Its rear wheel has to be past it as a whole.
#[test]
fn the_way_to_the_goal_is_that_of_the_rear_end_of_the_track() {
    let robot = Watched::with(|_| {});
    for (x, angle) in [(-1.0, 0.0), (0.5, std::f64::consts::FRAC_PI_3), (2.0, 0.0)] {
        let mut now = robot.now;
        (now.position.x, now.chassis_angle) = (x, angle);
        let rear_end = x - HALF * libm::cos(angle) - RADIUS;
        let expected = 1.0 - rear_end;
        assert_relative_eq!(robot.monitor.to_goal(&now), expected, max_relative = 1e-12);
    }
}
