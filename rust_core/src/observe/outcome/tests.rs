//! The order of the outcomes, and which of them are stops.

use super::*;

#[test]
fn outcomes_are_listed_in_their_order() {
    let places = Outcome::ALL.map(|outcome| outcome as usize);
    assert_eq!(places, std::array::from_fn(|place| place));
}

#[test]
fn a_stop_is_neither_an_end_of_its_own_nor_a_run_out_of_time() {
    for outcome in Outcome::ALL {
        let name = outcome.name();
        let stops = ["seized", "cycling", "hung_up", "stalled", "slipping"];
        assert_eq!(outcome.is_stop(), stops.contains(&name), "{name}");
    }
}
