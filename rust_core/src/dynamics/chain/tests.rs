//! Pins, idler and rests of a chain, one at a time.

use approx::assert_relative_eq;

use super::rest::Bearing;
use super::*;
use crate::geometry::{Rotation, direction};
use crate::robot::Model;
use crate::scenario::shared;
use crate::solver::Damper;

/// [m] How far ahead rests are searched for.
const REACH: f64 = 1e-3;

/// The chain round sprocket, idler, road wheels and return rollers.
fn on_wheels() -> Chain {
    let scenario = shared("engineer_sprocket_step");
    let model = Model::new(&scenario.robot).expect("the robot can be built");
    Chain::new(model.chains[0].clone())
}

/// A chassis that stands askew, with its idler pressed in.
fn stand() -> ChainPose {
    ChainPose {
        chassis: Pose::from_parts(Vector::new(0.7, -0.2), Rotation::new(0.3)),
        travel: -2e-3,
        run: 0.0,
    }
}

/// The rests of pins on wheels, where the first two shoes are at these places on the chassis and all others far away.
fn rests_of_pin(chain: &mut Chain, places: [Pose; 2]) -> Vec<Rest> {
    let mut found = Vec::new();
    let on_chassis = |shoe: usize| {
        let away = Pose::from_parts(Vector::new(50.0 + shoe as f64, 0.0), Rotation::IDENTITY);
        stand().chassis * places.get(shoe).copied().unwrap_or(away)
    };
    let (faces, all) = (2 + chain.rule.between.len(), of_a_shoe(&chain.rule));
    chain.rests(stand(), on_chassis, REACH, |_, rest| {
        if (faces..all - 2).contains(&rest.index) {
            found.push(rest);
        }
    });
    found
}

/// Two shoes, bent outwards by twice an angle [rad], the inner edge between which is at a place.
fn bent(chain: &Chain, edge: Vector, angle: f64) -> [Pose; 2] {
    let (half, below) = (
        0.5 * chain.rule.path.pitch,
        0.5 * chain.rule.plate_thickness,
    );
    let [first, second] = [-angle, angle].map(Rotation::new);
    let center = edge - first * Vector::new(half, -below);
    let pin = center + first * Vector::new(half, 0.0);
    [
        Pose::from_parts(center, first),
        Pose::from_parts(pin + second * Vector::new(half, 0.0), second),
    ]
}

#[test]
fn the_edge_between_two_plates_rests_on_a_wheel_that_is_below_neither() {
    let mut chain = on_wheels();
    let [rear, front] = chain.rule.ends;
    let wheels = [vec![rear, front], chain.rule.between.clone()].concat();
    let pose = stand().chassis;
    let up = direction(1.5);
    for (k, wheel) in wheels.iter().enumerate() {
        let slides = if k == 1 { Vector::X } else { Vector::ZERO };
        let center = wheel.center + slides * stand().travel;
        let at = |gap: f64| center + up * (wheel.radius + gap);
        for gap in [-2e-4, 0.9 * REACH] {
            let shoes = bent(&chain, at(gap), 0.2);
            let found = rests_of_pin(&mut chain, shoes);
            let rest = found
                .iter()
                .find(|rest| rest.index == 2 + chain.rule.between.len() + k);
            let rest = rest.expect("it rests there");
            assert_eq!(rest.shoe, 0);
            assert_relative_eq!(rest.gap, gap, epsilon = 1e-15);
            assert_relative_eq!(rest.normal, pose.rotation * up, epsilon = 1e-12);
            assert_relative_eq!(rest.point, pose.transform_point(at(gap)), epsilon = 1e-15);
            let Bearing::Chassis(slid) = rest.on else {
                panic!("a wheel is no tooth")
            };
            assert_relative_eq!(slid, pose.rotation * slides, epsilon = 1e-15);
        }
        for (gap, angle) in [
            (1.1 * REACH, 0.2),
            (0.0, -0.2),
            (-2.0 * wheel.radius - 1e-4, 0.2),
        ] {
            let shoes = bent(&chain, at(gap), angle);
            let found = rests_of_pin(&mut chain, shoes);
            let index = 2 + chain.rule.between.len() + k;
            assert!(
                found.iter().all(|rest| rest.index != index),
                "{gap} {angle}"
            );
        }
    }
}

#[test]
fn a_chain_is_off_once_it_goes_round_one_of_its_ends_alone_or_none() {
    let mut chain = on_wheels();
    let at_rest = chain.rule.path.places(0.0);
    let [rear, front] = chain.rule.ends.map(|end| end.center.x);
    let beyond = front - rear + 2.0 * chain.rule.ends[0].radius;
    let aside = |x: f64, y: f64| Vector::new(x, y);
    for (way, is_off) in [
        (aside(0.0, 0.0), false),
        (aside(0.01, -0.01), false),
        (aside(beyond, 0.0), true),
        (aside(-beyond, 0.0), true),
        (aside(0.0, 1.0), true),
        (aside(0.5 * beyond, 0.0), true),
        (aside(-0.5 * beyond, 0.0), true),
    ] {
        let place = |shoe: usize| {
            let Pose {
                rotation,
                translation,
            } = at_rest[shoe];
            stand().chassis * Pose::from_parts(translation + way, rotation)
        };
        chain.rests(stand(), place, REACH, |_, _| {});
        assert_eq!(chain.is_off, is_off, "{way}");
    }
}

#[test]
fn an_idler_has_its_spring_and_damper_and_a_hundred_times_that_stiffness_beyond_its_stop() {
    let chain = on_wheels();
    let rule = chain.rule.tensioner;
    let (h, time) = (2e-3, 1e-3);
    let force = |travel: f64| chain.tensioner(travel, h, time);
    let within = -0.5 * rule.stop;
    let of_spring = |travel: f64| rule.pre_tension - rule.stiffness * travel;
    let expected = Damper::new(
        time * of_spring(within),
        time * (rule.damping + h * rule.stiffness),
    );
    assert_eq!(force(within), expected);
    let past = 1e-4;
    let hard = 100.0 * rule.stiffness;
    let expected = Damper::new(
        time * (of_spring(-rule.stop - past) + hard * past),
        time * (rule.damping + h * (rule.stiffness + hard)),
    );
    let found = force(-rule.stop - past);
    assert_relative_eq!(found.at(0.0), expected.at(0.0), max_relative = 1e-9);
    assert_relative_eq!(found.at(1.0), expected.at(1.0), max_relative = 1e-9);
}

#[test]
fn a_pull_lengthwise_turns_both_shoes_back_into_line() {
    let mut pin = Pin::default();
    let (pitch, along) = (0.04, direction(0.7));
    pin.turn([along, along], pitch);
    // The next shoe is ahead, and a chain under tension pulls it back.
    let tension = 30.0;
    pin.force = -along * tension;
    for moment in pin.straightens() {
        assert_relative_eq!(moment, tension * 0.5 * pitch, max_relative = 1e-12);
    }
    pin.force = along * tension;
    assert!(pin.straightens().iter().all(|moment| *moment < 0.0));
}

/// Puts the pin of a shoe somewhere in the chassis frame.
fn put_pin(chain: &mut Chain, shoe: usize, pin: Vector) {
    let back = Vector::new(-0.5 * chain.rule.path.pitch, 0.0);
    chain.places[shoe] = [Pose::from_parts(pin + back, Rotation::IDENTITY); 2];
}

/// The teeth are searched with the reach that all rests have, beyond their tips, too.
#[test]
fn a_pin_just_beyond_the_tips_of_the_teeth_is_near_them() {
    let mut chain = on_wheels();
    let at_rest = chain.rule.path.places(0.0);
    chain.rests(
        stand(),
        |shoe| stand().chassis * at_rest[shoe],
        REACH,
        |_, _| {},
    );
    let axle = chain.rule.ends[0].center;
    let teeth = chain
        .rule
        .sprocket
        .as_ref()
        .expect("it has one")
        .teeth
        .clone();
    for (gap, is_near) in [
        (-0.5 * REACH, true),
        (0.5 * REACH, true),
        (1.5 * REACH, false),
    ] {
        // A tooth is halfway between two seats.
        let up = direction(std::f64::consts::PI / teeth.count as f64);
        put_pin(&mut chain, 0, axle + up * (teeth.tip_radius + gap));
        let mut found = 0;
        chain.rest_on_teeth(0, stand(), REACH, &mut |_: &Chain, rest: Rest| {
            found += 1;
            assert!(rest.gap < REACH && matches!(rest.on, Bearing::Tooth(_)));
        });
        assert_eq!(found > 0, is_near, "{gap} m");
    }
}

/// Where a straight line between two pins passes the height of an axle, whatever side both pins are on.
#[test]
fn a_chain_goes_round_its_sprocket_if_it_passes_behind_the_axle() {
    let mut chain = on_wheels();
    let at_rest = chain.rule.path.places(0.0);
    let axle = chain.rule.ends[0].center;
    for (above, below, is_off) in [
        ([0.02, 0.05], [-0.05, -0.02], false),
        ([0.05, 0.02], [-0.02, -0.05], true),
    ] {
        chain.rests(
            stand(),
            |shoe| stand().chassis * at_rest[shoe],
            REACH,
            |_, _| {},
        );
        let count = chain.places.len();
        let side = |shoe: usize| chain.pin(shoe) - axle;
        let passes = |shoe: &usize| {
            let (here, next) = (side(*shoe), side((*shoe + 1) % count));
            here.x < 0.0 && (here.y > 0.0) != (next.y > 0.0)
        };
        let shoe = (0..count).find(passes).expect("it goes round");
        let [first, second] = if side(shoe).y > 0.0 {
            [above, below]
        } else {
            [below, above]
        };
        put_pin(&mut chain, shoe, axle + Vector::from(first));
        put_pin(&mut chain, (shoe + 1) % count, axle + Vector::from(second));
        assert_eq!(chain.is_off_wheels(stand()), is_off, "{above:?} {below:?}");
    }
}

/// By h^2/4 times the moment per radian with which the force of a pin turns it back; a push would turn it on, and does nothing.
#[test]
fn both_shoes_of_a_pin_under_tension_turn_as_if_they_had_more_inertia() {
    let mut chain = on_wheels();
    let (h, tension, along) = (2e-3, 30.0, direction(0.7));
    let (count, own, pitch) = (
        chain.pins.len(),
        chain.rule.shoe_inertia,
        chain.rule.path.pitch,
    );
    for pin in [0, 3, count - 1] {
        for (force, more) in [(-tension, tension * 0.5 * pitch), (tension, 0.0)] {
            for (i, each) in chain.pins.iter_mut().enumerate() {
                each.turn([along; 2], pitch);
                each.force = if i == pin {
                    along * force
                } else {
                    Vector::ZERO
                };
            }
            chain.stiffen(h);
            for (shoe, inertia) in chain.inertias.iter().enumerate() {
                let is_of_pin = shoe == pin || shoe == (pin + 1) % count;
                let expected = own + if is_of_pin { 0.25 * h * h * more } else { 0.0 };
                assert_relative_eq!(*inertia, expected, max_relative = 1e-14);
            }
        }
    }
}
