//! The scenarios that tests of all parts share, `tests/scenarios` in the repository.

use super::Scenario;

/// The text of a shared scenario, by its name.
pub(crate) fn shared_text(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/scenarios");
    std::fs::read_to_string(format!("{folder}/{name}.json")).expect("it is there")
}

/// A shared scenario, by its name.
pub(crate) fn shared(name: &str) -> Scenario {
    Scenario::from_json(&shared_text(name)).expect("the shared scenario is valid")
}
