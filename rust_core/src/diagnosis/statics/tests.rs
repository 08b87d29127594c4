use super::*;
use crate::geometry::{Vector, right_of};

/// A support of a block whose normal force has the arm `lever` about the centre of mass, and its friction
/// `of_tangent`.
fn support(normal: Vector, [lever, of_tangent]: [f64; 2], friction: f64) -> Support {
    let direction = |unit, lever| Direction {
        unit,
        lever,
        ..Direction::default()
    };
    Support {
        normal: direction(normal, lever),
        tangent: direction(right_of(normal), of_tangent),
        drive: None,
        hinge: None,
        friction,
        slides: 0.0,
    }
}

fn block(supports: Vec<Support>) -> Statics {
    Statics {
        supports,
        motors: vec![false],
        bounds: vec![[0.0, 0.0]],
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
    arm.normal.joint_lever = 0.5;
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
fn of_two_wheels_on_a_slope_one_may_stand_while_the_other_turns() {
    let (sine, cosine) = libm::sincos(0.3_f64);
    // A wheel on its own motor, whose torque acts back on the chassis.
    let wheel = |drive: usize, lever: f64, slides: f64| {
        let mut on = support(Vector::new(-sine, cosine), [lever, -1.0], 0.5);
        (on.drive, on.tangent.spin_lever, on.slides) = (Some(drive), 1.0, slides);
        on
    };
    let within = |slides: [f64; 2], bounds: [[f64; 2]; 2]| {
        let held = Statics {
            motors: vec![true; 2],
            bounds: bounds.to_vec(),
            ..block(vec![wheel(0, -1.0, slides[0]), wheel(1, 1.0, slides[1])])
        };
        held.imbalance().unwrap()
    };
    let imbalance = |slides: [f64; 2], torque: f64| within(slides, [[-torque, torque]; 2]);
    // The turning one pushes uphill with the friction of half the weight, which its motor balances.
    let needed = 0.5 * 0.5 * cosine;
    assert!(imbalance([0.0, -1.0], 1.01 * needed) < 1e-8);
    assert!(imbalance([0.0, -1.0], 0.8 * needed) > 0.01);
    // A self-locking gear holds the one that stands, but drives no other.
    let (weak, any) = (0.8 * needed, [f64::NEG_INFINITY, f64::INFINITY]);
    let turns = |most: f64| within([0.0, -1.0], [any, [f64::NEG_INFINITY, most]]);
    assert!(turns(1.01 * needed) < 1e-8);
    assert!(turns(weak) > 0.01);
    assert!(within([0.0, 0.0], [[-weak, weak]; 2]) < 1e-8);
    assert!(within([0.0, 0.0], [[-0.1 * needed, 0.1 * needed]; 2]) > 0.01);
    assert!(within([0.0, 0.0], [any; 2]) < 1e-8);
    // If both turned, they would push it up the slope.
    assert!(imbalance([-1.0, -1.0], 1.01 * needed) > 0.05);
}

#[test]
fn nothing_below_leaves_the_whole_weight_unbalanced() {
    let imbalance = block(Vec::new()).imbalance().unwrap();
    assert!((imbalance - 1.0).abs() < 1e-6);
}

#[test]
fn walls_that_slide_balance_a_block_where_they_are_steeper_than_the_friction_angle() {
    for slope in [0.2, 0.25, 0.35, 0.5] {
        let friction = libm::tan(0.3);
        let mut block = notch(slope, friction);
        assert!(block.imbalance().unwrap() < 1e-8);
        // It slips to the right, down one wall and up the other; the friction of both points to the left.
        for support in &mut block.supports {
            support.slides = 1.0;
        }
        let balances = block.imbalance().unwrap() < 1e-8;
        assert_eq!(balances, slope > 0.3, "{slope}");
    }
}

#[test]
fn a_plank_tips_where_its_weight_leaves_the_base() {
    // Two supports to the left of the centre of mass cannot carry it, whatever their friction.
    let up = Vector::new(0.0, 1.0);
    let plank = |x: [f64; 2]| block(x.map(|x| support(up, [x, 0.0], 1.0)).to_vec());
    assert!(plank([-1.0, 0.5]).imbalance().unwrap() < 1e-8);
    assert!(plank([-1.0, -0.5]).imbalance().unwrap() > 0.1);
}

/// On a slope as steep as the friction angle a block slides down at an even speed, whichever side the slope falls to. One that
/// slid up it would be pulled down by twice the weight's share along it.
#[test]
fn a_block_that_slides_down_at_the_friction_angle_is_balanced_on_either_side() {
    let friction: f64 = 0.5;
    let (sine, cosine) = libm::sincos(libm::atan(friction));
    for side in [1.0, -1.0] {
        let imbalance = |slides: f64| {
            let on = |lever: f64| Support {
                slides,
                ..support(Vector::new(-side * sine, cosine), [lever, 0.0], friction)
            };
            block(vec![on(1.0), on(-1.0)]).imbalance().unwrap()
        };
        // A tangent is its normal turned clockwise: uphill where the slope rises to the right.
        assert!(imbalance(-side) < 1e-8, "{side}");
        assert!(imbalance(side) > 0.1, "{side}");
    }
}
