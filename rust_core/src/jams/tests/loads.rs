//! Forces that carry the weight, checked by levers.

use super::*;
use crate::jams::forces::{Push, for_each_choice};

fn choices(wrenches: &[[f64; 3]]) -> Vec<Vec<(usize, f64)>> {
    let mut found = Vec::new();
    for_each_choice(wrenches, &mut |chosen| found.push(chosen.to_vec()));
    found
}

/// The part of the weight that a choice does not carry.
fn left(wrenches: &[[f64; 3]], choice: &[(usize, f64)]) -> f64 {
    let sum = |axis: usize| {
        choice
            .iter()
            .map(|(i, share)| share * wrenches[*i][axis])
            .sum::<f64>()
    };
    let off = [sum(0), sum(1) - 1.0, sum(2)];
    off.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// Two forces carry the weight if the three lines meet in a point.
#[test]
fn one_force_or_two_carry_only_what_they_balance() {
    assert_eq!(choices(&[[0.0, 2.0, 0.0]]), [[(0, 0.5)]]);
    for off in [
        [1e-6, 1.0, 0.0],
        [-1e-6, 1.0, 0.0],
        [0.0, 1.0, 1e-6],
        [0.0, 1.0, -1e-6],
    ] {
        assert!(choices(&[off]).is_empty(), "{off:?}");
    }
    // A force may be of any size.
    for size in [0.01, 1.0, 100.0] {
        for (off, carries) in [(0.5e-7, true), (2e-7, false)] {
            for one in [[off, 1.0, 0.0], [0.0, 1.0, off]] {
                let found = choices(&[one.map(|part| size * part)]);
                assert_eq!(!found.is_empty(), carries, "{size} {one:?}");
            }
        }
    }
    // Three quarters of the first and one of the second cancel along the ground, and leave half the weight.
    let both = |moment: f64| [[1.0, 0.5, 0.2], [-3.0, 2.5, moment]];
    let [choice] = &choices(&both(-0.6))[..] else {
        panic!("one choice carries it");
    };
    assert!((choice[0].1 - 0.75).abs() < 1e-15 && (choice[1].1 - 0.25).abs() < 1e-15);
    assert!(left(&both(-0.6), choice) < 1e-15);
    assert!(choices(&both(-0.61)).is_empty() && choices(&both(-0.59)).is_empty());
    // With a third that bears nothing, they are a choice of three, within rounding.
    let third = [1.0, 0.7, 3.0];
    let [a, b] = both(-0.6);
    let [choice] = &choices(&[a, b, third])[..] else {
        panic!("one choice carries it");
    };
    assert!((choice[0].1 - 0.75).abs() < 1e-12 && choice[2].1.abs() < 1e-12);
    // Neither may pull, nor both hang from above.
    assert!(choices(&[[1.0, 0.5, 0.2], [3.0, 2.5, 0.6]]).is_empty());
    assert!(choices(&[[1.0, -0.5, 0.2], [-3.0, -2.5, -0.6]]).is_empty());
}

/// By Carathéodory's theorem three of any number are enough.
#[test]
fn what_carries_the_weight_in_all_carries_it_by_three() {
    let mut draw = Draw(11);
    for case in 0..200 {
        let count = 3 + case % 3;
        let mut wrenches: Vec<[f64; 3]> = (0..count)
            .map(|_| std::array::from_fn(|_| draw.between(-1.0, 1.0)))
            .collect();
        let shares: Vec<f64> = (0..count).map(|_| draw.between(0.1, 1.0)).collect();
        // The last balances the others.
        let last: [f64; 3] = std::array::from_fn(|axis| {
            let weight = if axis == 1 { 1.0 } else { 0.0 };
            let others: f64 = (0..count - 1).map(|i| shares[i] * wrenches[i][axis]).sum();
            (weight - others) / shares[count - 1]
        });
        wrenches[count - 1] = last;
        let found = choices(&wrenches);
        assert!(!found.is_empty(), "case {case}");
        // Each three of them once.
        let mut sets: Vec<Vec<usize>> = found
            .iter()
            .map(|choice| choice.iter().map(|(i, _)| *i).collect())
            .collect();
        sets.sort();
        assert!(sets.windows(2).all(|pair| pair[0] != pair[1]), "{sets:?}");
        assert!(
            sets.iter()
                .all(|three| three[0] < three[1] && three[1] < three[2])
        );
        for choice in &found {
            assert_eq!(choice.len(), 3);
            assert!(choice.iter().all(|(_, share)| *share >= -1e-8));
            // Multiples grow as three wrenches approach one plane, and rounding errors with them.
            let most = choice
                .iter()
                .map(|(_, share)| share.abs())
                .fold(1.0, f64::max);
            assert!(left(&wrenches, choice) < 1e-11 * most * most, "case {case}");
        }
        if count == 3 {
            for (i, share) in &found[0] {
                assert!(
                    (share - shares[*i]).abs() < 1e-6 * share.max(1.0),
                    "case {case}"
                );
            }
        }
        // Reversed, none of these carries it, if none did in both directions.
        let over: Vec<[f64; 3]> = wrenches.iter().map(|w| w.map(|x| -x)).collect();
        assert!(count > 3 || choices(&over).is_empty(), "case {case}");
    }
}

/// Driven forwards, the ground pushes forwards; a free wheel is not pushed, and one that stands still in either
/// direction.
#[test]
fn friction_follows_the_grip_of_a_surface_and_the_smaller_of_two_coefficients() {
    let disc = Disc {
        center: Vector::new(0.1, 0.0),
        radius: 0.05,
    };
    let face = Facing::Face {
        ends: [-Vector::X, Vector::X],
        normal: Vector::Y,
    };
    for (grip, limit, expected) in [
        (Grip::Driven(1.0), 2.0, vec![0.6]),
        (Grip::Driven(-1.0), 0.4, vec![-0.4]),
        (Grip::Free, 2.0, vec![0.0]),
        (Grip::Still, 0.5, vec![0.5, -0.5]),
    ] {
        let mut on = surface(Outline::Round(disc), grip);
        on.friction_limit = limit;
        let center_of_mass = Vector::new(0.0, 0.2);
        let setting = setting(vec![on], vec![place(face, 0.6)], center_of_mass);
        let pushes: Vec<Push> = setting.pushes(0).collect();
        let slopes: Vec<f64> = pushes.iter().map(|push| push.slope).collect();
        assert_eq!(slopes, expected);
        for push in pushes {
            // Standing on the face, 0.1 m ahead of the centre of mass and 0.25 m below it.
            let found = setting.wrench(push, Vector::new(0.0, 0.05), Turn::by(0.0));
            let by_hand = [push.slope, 1.0, 0.1 + 0.25 * push.slope];
            assert!(
                found
                    .iter()
                    .zip(by_hand)
                    .all(|(a, b)| (a - b).abs() < 1e-15)
            );
        }
    }
}

/// A robot that stands on two feet has on each the weight times the other's lever, and no friction in all.
#[test]
fn two_feet_share_the_weight_by_their_levers() {
    let radius = 0.05;
    let foot = |x: f64| {
        let center = Vector::new(x, 0.0);
        surface(Outline::Round(Disc { center, radius }), Grip::Still)
    };
    let face = Facing::Face {
        ends: [-Vector::X, Vector::X],
        normal: Vector::Y,
    };
    let at = Posture {
        position: Vector::new(0.2, radius),
        angle: 0.0,
    };
    let on = |places: &[f64]| {
        let surfaces = places.iter().map(|x| foot(*x)).collect();
        let setting = setting(surfaces, vec![place(face, 0.6)], Vector::new(0.0, 0.1));
        let all: Vec<usize> = (0..places.len()).collect();
        setting.loads(&all, &at)
    };
    let two = on(&[-0.3, 0.1]).expect("it stands");
    assert!((two[0][0] - 0.25).abs() < 1e-12 && (two[1][0] - 0.75).abs() < 1e-12);
    assert!((two[0][1] + two[1][1]).abs() < 1e-12);
    assert!(on(&[-0.3, -0.1]).is_none() && on(&[0.3, 0.1]).is_none());
    assert!(on(&[0.0]).is_some() && on(&[0.01]).is_none());
}

/// Four wheels in a line on a slope, standing still: more than three forces can carry it, and none has more friction than its load
/// allows.
#[test]
fn loads_of_a_robot_on_more_supports_than_three_add_up_to_the_weight() {
    let (friction, radius) = (0.5, 0.05);
    let normal = Vector::from_angle(0.2).rotate(Vector::Y);
    let along = right_of(normal);
    let at = Posture {
        position: normal * radius,
        angle: 0.2,
    };
    let face = Facing::Face {
        ends: [along * -1.0, along],
        normal,
    };
    let disc = |x: f64| {
        let center = Vector::new(x, 0.0);
        surface(Outline::Round(Disc { center, radius }), Grip::Still)
    };
    let surfaces = [-0.3, -0.1, 0.1, 0.3].map(disc).to_vec();
    let setting = setting(surfaces, vec![place(face, friction)], Vector::ZERO);
    let loads = setting.loads(&[0, 1, 2, 3], &at).expect("they carry it");
    let sum = |k: usize| loads.iter().map(|load| load[k]).sum::<f64>();
    assert!((sum(0) - libm::cos(0.2)).abs() < 1e-12, "{loads:?}");
    assert!((sum(1).abs() - libm::sin(0.2)).abs() < 1e-12, "{loads:?}");
    let holds = |[load, pull]: &[f64; 2]| *load >= 0.0 && pull.abs() <= friction * load + 1e-12;
    assert!(loads.iter().all(holds), "{loads:?}");
}
