//! Jams that exist at every value of the parameters, and the depth of ground inside the track.

use super::*;

/// At every value, the robot stands in a pose close to that, with its three surfaces touching.
#[test]
fn what_is_held_over_a_range_stands_at_every_value() {
    let family = family_on_a_step();
    let cancel = Cancel::default();
    let mut draw = Draw(41);
    let root = family.root();
    let (mut held, mut not) = (0, 0);
    for half in [0.0, 1e-3, 0.02, 0.5] {
        for _ in 0..12 {
            let mut range = root;
            for k in 0..2 {
                let middle = draw.between(half, 1.0 - half);
                (range.low[3 + k], range.high[3 + k]) = (middle - half, middle + half);
            }
            let middle = family
                .stands(&range.shares(), &cancel)
                .expect("nobody asks it to end");
            for stand in &middle {
                if !family.is_held(&range, &[*stand]) {
                    not += 1;
                    continue;
                }
                held += 1;
                let shares = anywhere(&mut draw, &range).shares();
                let there = family
                    .stands(&shares, &cancel)
                    .expect("nobody asks it to end");
                let is_it = |(_, three): &&crate::jams::certify::held::Stand| {
                    stand.1.iter().all(|pair| three.contains(pair))
                };
                assert!(there.iter().any(|stand| is_it(&stand)), "{half} {stand:?}");
            }
            assert!(
                half > 0.0
                    || middle.is_empty()
                    || middle.iter().any(|s| family.is_held(&range, &[*s]))
            );
        }
    }
    assert!(held > 20 && not > 8);
}

/// In one pose it is the gap, on a corner half the difference of the squares over the circle's radius, which begins
/// alike; over a cell it holds those of all its poses, and so do the slopes.
#[test]
fn a_gap_over_a_cell_holds_those_of_its_poses() {
    let family = family_on_a_step();
    let mut draw = Draw(42);
    for shares in [[0.2, 0.9, 0.0, 0.0], [0.8, 0.1, 0.0, 0.0]] {
        let (setting, all) = stands(&family, &shares);
        for (at, _) in &all {
            for contact in &setting.contacts {
                let pair = (contact.surface, contact.place);
                let touch = contact.touch(at);
                let (gap, row) = family.gap(&cell_at(at, &shares), pair);
                let expected = Contact::gradient(&touch, at.position);
                for (found, expected) in row.iter().zip(expected) {
                    // Of lengths up to 4 m, over circles of 4 cm.
                    assert!((found.middle() - expected).abs() < 1e-11 && found.half() < 1e-11);
                }
                if touch.gap.abs() < 1e-3 {
                    assert!((gap.middle() - touch.gap).abs() < 1e-4, "{contact:?}");
                    assert!(gap.half() < 1e-11);
                }
                let cell = cell_round(&mut draw, &cell_at(at, &shares), 0.05);
                let (over, slopes) = family.gap(&cell, pair);
                for _ in 0..4 {
                    let (gap, row) = family.gap(&anywhere(&mut draw, &cell), pair);
                    let holds = |all: &Interval, one: &Interval| {
                        all.low <= one.high + 1e-11 && one.low - 1e-11 <= all.high
                    };
                    assert!(holds(&over, &gap), "{contact:?}");
                    assert!(slopes.iter().zip(&row).all(|(all, one)| holds(all, one)));
                }
            }
        }
    }
}
