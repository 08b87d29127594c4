//! A run ends early when its whole state stays the same.

use super::*;
use crate::scenario::{Ends, Flippers, Gait, GearWheel, Hold, LineOfWheels, Pi, Track, Wheel};

/// [s] Length of a stop window, and of three.
const WINDOW: f64 = 0.5;
const THREE: f64 = 1.5;
/// [m] Allowed change of a stationary pose.
const TOLERANCE: f64 = 0.0625;

fn robot(change: impl Fn(&mut Scenario)) -> Watched {
    Watched::with(|scenario| {
        scenario.criteria.stop_window = WINDOW;
        scenario.criteria.stationary_windows = 3;
        scenario.criteria.stationary_distance = TOLERANCE;
        change(scenario);
    })
}

/// The end of the run of a robot that stands still from the beginning, if it is within four windows: it stands for a
/// while, is changed, and stands still again.
fn over_at(mut robot: Watched, change: impl Fn(&mut Watched)) -> Option<f64> {
    for (time, changes) in [(0.7, true), (4.0 * WINDOW, false)] {
        while robot.now.time < time {
            robot.step();
            if robot.monitor.is_over() {
                return Some(robot.now.time);
            }
        }
        if changes {
            change(&mut robot);
        }
    }
    None
}

fn is_over_early(robot: Watched, change: impl Fn(&mut Watched)) -> bool {
    let Some(time) = over_at(robot, change) else {
        return false;
    };
    assert!((time - THREE).abs() < 0.012, "{time} s");
    true
}

#[test]
fn a_robot_that_stands_for_three_windows_stays() {
    assert!(is_over_early(robot(|_| {}), |_| {}));
}

#[test]
fn a_move_within_the_tolerance_is_none_and_one_beyond_it_begins_anew() {
    // The robot is on a slope, so that its angle is not 0 either.
    let turned = || {
        let mut robot = robot(|_| {});
        robot.now.chassis_angle = 0.5;
        robot
    };
    assert!(is_over_early(turned(), |_| {}));
    for side in [1.0, -1.0] {
        let moves = |share: f64| {
            let way = side * share * TOLERANCE;
            let x = is_over_early(turned(), |robot| robot.now.position.x += way);
            let y = is_over_early(turned(), |robot| robot.now.position.y += way);
            let turn = way / HALF;
            let angle = is_over_early(turned(), |robot| robot.now.chassis_angle += turn);
            [x, y, angle]
        };
        assert_eq!(moves(1.0), [true; 3], "to {side}");
        assert_eq!(moves(1.01), [false; 3], "to {side}");
    }
}

#[test]
fn a_contact_that_moves_to_another_place_begins_anew() {
    let edge = |edge: i32, facet: usize| {
        let mut contact = on_facet(facet, 10.0);
        contact.edge = edge;
        contact
    };
    let of_part = |part: usize| {
        let mut contact = on_facet(2, 10.0);
        contact.part = part;
        contact
    };
    let changes = |from: &[Contact], to: &[Contact]| {
        let mut standing = robot(|_| {});
        standing.loaded = from.to_vec();
        !is_over_early(standing, |robot| robot.loaded = to.to_vec())
    };
    let [a, b] = [on_facet(2, 10.0), on_facet(5, 20.0)];
    assert!(!changes(&[a, b], &[a, b]));
    assert!(!changes(&[a, b], &[b, a]), "their order does not matter");
    assert!(changes(&[a, b], &[a, on_facet(6, 20.0)]), "another facet");
    assert!(changes(&[a, b], &[a]), "one less");
    assert!(changes(&[a], &[a, b]), "one more");
    assert!(
        !changes(&[a, b], &[a, b, on_facet(6, 0.0)]),
        "one that does not bear"
    );
    assert!(
        changes(&[a, b], &[a, on_facet(5, 0.0)]),
        "one bears no more"
    );
    assert!(changes(&[of_part(0)], &[of_part(1)]), "another part");
    assert!(changes(&[edge(1, 2)], &[edge(2, 2)]), "another edge");
    assert!(
        !changes(&[edge(1, 2)], &[edge(1, 3)]),
        "either facet has the edge"
    );
    for place in [0, 2] {
        let from = on_facet(place, 10.0);
        assert!(
            changes(&[from], &[edge(place as i32, place)]),
            "from face to edge"
        );
    }
}

#[test]
fn what_may_still_change_by_itself_does_not_stay() {
    let ends = |change: &dyn Fn(&mut Scenario)| is_over_early(robot(change), |_| {});
    let gear = GearWheel {
        grouser_count: Some(12),
        grouser_height: None,
        tip_thickness: None,
        base_thickness: None,
        phase_fraction: 0.0,
    };
    let on_wheels = |wheel: Wheel| {
        Track::Line(LineOfWheels {
            count: 4,
            wheel_radius: None,
            wheel,
            as_track: true,
        })
    };
    assert!(ends(&|s| s.robot.track = on_wheels(Wheel::Round)));
    assert!(!ends(
        &|s| s.robot.track = on_wheels(Wheel::Gear(gear.clone()))
    ));
    assert!(!ends(&|s| s.drive.schedule = Some(vec![[60.0, 0.0]])));
    let gait = Gait::Hold(Hold {
        angle: 0.5,
        schedule: None,
        front: None,
        rear: None,
    });
    let with_gait = |s: &mut Scenario| s.drive.gait = Some(gait.clone());
    assert!(ends(&with_gait), "there are no flippers to move");
    let arms = Flippers {
        length: 0.34,
        root_radius: RADIUS,
        tip_radius: 0.037,
        mass: 0.775,
        ends: Ends::Front,
        angle: 0.5,
        rate_limit: 1.0,
        torque_limit: 30.0,
        rotor_inertia: 0.0,
        self_locking: false,
        track: None,
    };
    let with_arms = |s: &mut Scenario| s.robot.flippers = Some(arms.clone());
    assert!(ends(&with_arms));
    assert!(!ends(&|s| {
        with_arms(s);
        with_gait(s);
    }));
}

/// Its motor pushes harder and harder in the same pose.
#[test]
fn a_robot_whose_controller_adds_up_errors_may_leave_yet() {
    let with = |integral: f64| {
        robot(|scenario| {
            scenario.robot.drivetrain.controller = Some(Pi {
                gain: 1.0,
                integral,
            });
        })
    };
    assert!(is_over_early(with(0.0), |_| {}));
    assert_eq!(over_at(with(0.1), |_| {}), None);
}
