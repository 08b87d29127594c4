//! The words of the outcomes, and their order, in both languages.

use super::*;

const IN_ORDER: [(Outcome, &str); 10] = [
    (Outcome::Detracked, "detracked"),
    (Outcome::TippedOver, "tipped_over"),
    (Outcome::LeftTerrain, "left_terrain"),
    (Outcome::Cleared, "cleared"),
    (Outcome::Cycling, "cycling"),
    (Outcome::Seized, "seized"),
    (Outcome::HungUp, "hung_up"),
    (Outcome::Stalled, "stalled"),
    (Outcome::Slipping, "slipping"),
    (Outcome::TimedOut, "timed_out"),
];

#[test]
fn python_lists_the_outcomes_in_the_order_of_the_core() {
    let python = include_str!("../../../../python/crawler2d/results/outcome.py");
    let members = python.lines().filter_map(|line| {
        let (_, value) = line.strip_prefix("    ")?.split_once(" = \"")?;
        value.strip_suffix('"')
    });
    let names = IN_ORDER.map(|(outcome, name)| {
        assert_eq!(outcome.name(), name);
        assert_eq!(outcome.to_string(), name);
        name
    });
    assert_eq!(members.collect::<Vec<_>>(), names);
    let places = IN_ORDER.map(|(outcome, _)| outcome as usize);
    assert_eq!(places, std::array::from_fn(|place| place));
}

#[test]
fn a_stop_is_neither_an_end_of_its_own_nor_a_run_out_of_time() {
    for (outcome, name) in IN_ORDER {
        let stops = ["cycling", "seized", "hung_up", "stalled", "slipping"];
        assert_eq!(outcome.is_stop(), stops.contains(&name), "{name}");
    }
}
