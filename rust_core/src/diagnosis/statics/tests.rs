use super::*;
use crate::geometry::{Vector, right_of};

/// A support of a block whose normal force has the arm `lever` about the centre of mass, and its friction
/// `of_tangent`.
fn support(normal: Vector, [lever, of_tangent]: [f64; 2], friction: f64) -> Support {
    let direction = |unit, lever| Direction {
        unit,
        lever,
        drive_lever: 0.0,
        back: 0.0,
        flipper_lever: 0.0,
    };
    Support {
        normal: direction(normal, lever),
        tangent: direction(right_of(normal), of_tangent),
        drive: None,
        hinge: None,
        friction,
        slides: 0.0,
        role: Role::Track,
    }
}

fn block(supports: Vec<Support>) -> Statics {
    Statics {
        supports,
        closed: Vec::new(),
        motors: vec![0.0],
        stalled: vec![0.0],
        torque: 0.0,
        at_limit: 0.98,
        lever: 1.0,
        radius: 1.0,
        push: None,
        hinges: Vec::new(),
    }
}

/// A small block in a notch whose walls rise at `slope` [rad] on both sides.
fn notch(slope: f64, friction: f64) -> Statics {
    let (s, c) = libm::sincos(slope);
    let wall = |side: f64| support(Vector::new(side * s, c), [0.0, 0.0], friction);
    block(vec![wall(1.0), wall(-1.0)])
}

/// A block on a support on either side, the right one on a weightless arm, half a metre from its pivot.
fn on_an_arm(torque: f64) -> Statics {
    let on = |lever: f64| support(Vector::Y, [lever, 0.0], 0.0);
    let mut arm = on(1.0);
    arm.hinge = Some(0);
    arm.normal.flipper_lever = 0.5;
    let hinge = Hinge {
        weight: 0.0,
        torque,
    };
    Statics {
        hinges: vec![hinge],
        ..block(vec![on(-1.0), arm])
    }
}

#[test]
fn an_arm_bears_no_more_than_its_motor_holds() {
    // Half of the weight at half a metre needs a torque of a quarter of a metre times the weight.
    assert!(on_an_arm(0.26).imbalance().unwrap() < 1e-8);
    for torque in [0.0, 0.1, 0.2] {
        // With f on the arm and the residual s: the torque is 0.5 f - s, and 2 f + s is the weight minus s.
        let expected = (0.25 - torque) / 1.5;
        let imbalance = on_an_arm(torque).imbalance().unwrap();
        assert!((imbalance - expected).abs() < 1e-8, "{torque}: {imbalance}");
    }
}

#[test]
fn a_stalled_motor_holds_from_the_share_of_its_limit_that_the_criteria_say() {
    // On a slope that needs 0.9 of the motor's force, on supports before and behind the centre of mass.
    let (sine, cosine) = libm::sincos(0.5_f64);
    let on_slope = |lever: f64| {
        let mut on = support(Vector::new(-sine, cosine), [lever, 0.0], 1.0);
        (on.drive, on.tangent.drive_lever) = (Some(0), 1.0);
        on
    };
    for (at_limit, holds) in [(0.98, false), (0.91, false), (0.89, true)] {
        let stalled = Statics {
            motors: vec![1.0],
            stalled: vec![1.0],
            torque: sine / 0.9,
            at_limit,
            ..block(vec![on_slope(-1.0), on_slope(1.0)])
        };
        let imbalance = stalled.forces(Drives::Hold, &[]).imbalance().unwrap();
        assert_eq!(imbalance < 1e-6, holds, "{at_limit}: {imbalance}");
    }
}

#[test]
fn nothing_below_leaves_the_whole_weight_unbalanced() {
    let imbalance = block(Vec::new()).imbalance().unwrap();
    assert!((imbalance - 1.0).abs() < 1e-6);
}

#[test]
fn a_block_in_a_notch_gives_way_where_its_other_wall_is_unloaded() {
    for slope in [0.2, 0.5, 0.9] {
        for friction in [0.0_f64, 0.3, 0.4] {
            let block = notch(slope, friction);
            assert!(block.imbalance().unwrap() < 1e-8);
            let push = block.free_escape(1.0, 1e-3).unwrap().force;
            let expected = libm::tan(slope + friction.atan());
            assert!((push / expected - 1.0).abs() < 1e-5, "{push} {expected}");
        }
    }
}

#[test]
fn a_block_is_wedged_where_slope_and_friction_angle_make_a_right_angle() {
    let push = notch(0.9, 1.0).free_escape(1.0, 1e-3).unwrap().force;
    assert!(push.is_infinite());
}

#[test]
fn walls_that_slide_hold_with_their_friction_at_its_limit() {
    // The block is moving up the front wall, so friction points down the wall.
    let (slope, friction) = (0.5, 0.3_f64);
    let mut block = notch(slope, friction);
    for support in &mut block.supports {
        support.slides = 1.0;
    }
    let push = block.escape(1.0, 1e-3).unwrap().force;
    assert!((push / libm::tan(slope + friction.atan()) - 1.0).abs() < 1e-5);
    // When it slides down, friction helps against the push.
    for support in &mut block.supports {
        support.slides = -1.0;
    }
    let push = block.escape(1.0, 1e-3).unwrap().force;
    assert!((push / libm::tan(slope - friction.atan()) - 1.0).abs() < 1e-5);
}

#[test]
fn a_plank_tips_where_its_weight_leaves_the_base() {
    // Two supports to the left of the centre of mass cannot carry it, whatever their friction.
    let up = Vector::new(0.0, 1.0);
    let plank = |x: [f64; 2]| block(x.map(|x| support(up, [x, 0.0], 1.0)).to_vec());
    assert!(plank([-1.0, 0.5]).imbalance().unwrap() < 1e-8);
    assert!(plank([-1.0, -0.5]).imbalance().unwrap() > 0.1);
}

#[test]
fn the_belly_is_the_cause_if_nothing_else_bears() {
    let up = Vector::new(0.0, 1.0);
    let mut belly = support(up, [0.0, 0.0], 0.5);
    belly.role = Role::Belly;
    let hung = block(vec![belly]);
    let cause = hung.cause(1e-3, &Condition::ALL);
    assert_eq!(cause, [[Condition::Belly]]);
}

#[test]
fn a_block_that_nothing_given_would_free_has_no_cause() {
    let cause = notch(0.3, 0.5).cause(1e-3, &Condition::ALL);
    assert!(cause.is_empty());
}

#[test]
fn a_pocket_is_the_cause_if_what_would_bear_in_its_place_cannot_hold() {
    // In a pocket between two walls; if it were closed, its ground would bear from below and slide.
    let mut held = notch(0.7, 0.2);
    held.supports.iter_mut().for_each(|s| s.role = Role::Pocket);
    let mut below = support(Vector::new(0.0, 1.0), [0.0, 0.0], 0.2);
    below.slides = -1.0;
    held.closed = vec![below];
    assert_eq!(
        held.cause(1e-3, &[Condition::Pocket]),
        [[Condition::Pocket]]
    );
    // A wall in front of the robot would still hold it.
    held.supports
        .push(support(Vector::new(-1.0, 0.0), [0.0, 0.0], 0.2));
    assert!(held.cause(1e-3, &[Condition::Pocket]).is_empty());
}
