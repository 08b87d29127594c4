//! How far a search goes.

use std::time::{Duration, Instant};

use super::*;
use crate::error::Error;
use crate::jams::certify::search::Found;

/// [m] Ground less deep inside a track is left to the belt.
const DEPTH: f64 = 1e-3;

#[test]
fn a_search_ends_once_it_has_more_cells_than_it_may() {
    let family = family_on_a_step();
    let (mut draw, cancel) = (Draw(61), Cancel::default());
    let root = family.root();
    let mut tried = 0;
    for case in 0..300 {
        let mut point = anywhere(&mut draw, &root);
        point.low[0] = draw.between(-0.4, 0.4);
        point.low[1] = draw.between(0.0, 0.3);
        point.high = point.low;
        let cell = cell_round(&mut draw, &point, [0.02, 0.05, 0.1][case % 3]);
        let search = |most| {
            family
                .search(cell, most, DEPTH, &cancel)
                .expect("it goes on")
        };
        let Found::Excluded(cells) = search(300) else {
            continue;
        };
        if cells.len() < 4 {
            continue;
        }
        tried += 1;
        assert!(matches!(search(cells.len()), Found::Excluded(_)));
        assert!(matches!(search(cells.len() / 2), Found::Left(_)));
    }
    assert!(tried > 8, "{tried}");
}

/// It is split a dozen times at most, which takes a moment: no limit of its number of cells ends it.
#[test]
fn a_search_ends_at_a_small_cell_in_which_the_robot_stands() {
    let family = family_on_a_step();
    let shares = [0.3, 0.6, 0.0, 0.0];
    let (setting, all) = stands(&family, &shares);
    let mut draw = Draw(62);
    let is_deep = |at: &&(Posture, Vec<usize>)| family.depth(&setting.places, &at.0) > 2.0 * DEPTH;
    let mut tried = 0;
    for (posture, contacts) in all.iter().filter(is_deep) {
        if setting.loads(contacts, posture).is_none() {
            continue;
        }
        tried += 1;
        let cell = cell_round(&mut draw, &cell_at(posture, &shares), 1e-4);
        let late = Cancel::at(Instant::now() + Duration::from_secs(5));
        let found = family.search(cell, usize::MAX, DEPTH, &late);
        let Ok(Found::Left(left)) = found else {
            panic!("it stands in {posture:?}");
        };
        for (k, share) in left.iter().enumerate() {
            assert!((cell.low[3 + k]..=cell.high[3 + k]).contains(share));
        }
    }
    assert!(tried > 0);
}

#[test]
fn a_search_that_is_asked_to_end_has_tried_no_cell() {
    let family = family_on_a_step();
    let mut above = cell_at(
        &Posture {
            position: Vector::new(0.0, 5.0),
            angle: 0.0,
        },
        &[0.0; 4],
    );
    above.high[1] += 0.1;
    let cancel = Cancel::default();
    let found = family.search(above, 10, DEPTH, &cancel);
    assert!(matches!(found, Ok(Found::Excluded(cells)) if cells.len() == 1));
    cancel.ask();
    let found = family.search(above, 10, DEPTH, &cancel);
    assert!(matches!(found, Err(Error::Interrupted)));
}
