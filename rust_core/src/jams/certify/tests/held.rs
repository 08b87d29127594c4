//! Jams that are there at every value of the parameters, and how deep the ground is inside the track.

use super::*;

/// At every value the robot stands in a pose next to that, where its three surfaces touch.
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
