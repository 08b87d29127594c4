//! Texts: each is a scenario that survives writing and reading, or is refused by the path of a field.

use crate::{Error, ValidScenario};

/// Reads bytes as the text of a scenario.
///
/// # Panics
/// If a rule is broken.
pub fn scenario(data: &[u8]) {
    accepted(data);
}

/// The scenario that bytes are, if they are one.
pub(super) fn accepted(data: &[u8]) -> Option<ValidScenario> {
    let text = std::str::from_utf8(data).ok()?;
    match ValidScenario::from_json(text) {
        Ok(read) => {
            survives(&read);
            Some(read)
        }
        Err(error) => {
            is_told(&error);
            None
        }
    }
}

/// Asserts that a refusal names a field and its rule, or memory.
pub(super) fn is_told(error: &Error) {
    match error {
        Error::Scenario(error) => {
            assert!(
                !error.path.is_empty() && error.rule.starts_with("must"),
                "{error}"
            );
        }
        Error::Limit(_) => {}
        other => panic!("{other}"),
    }
}

/// Asserts that a scenario is the same when it is written and read.
fn survives(read: &ValidScenario) {
    let text = read.scenario().to_json();
    let again = match ValidScenario::from_json(&text) {
        Ok(again) => again,
        Err(error) => panic!("accepted, and not again: {error}"),
    };
    assert_eq!(again.scenario(), read.scenario());
    assert_eq!(again.scenario().to_json(), text);
    assert_eq!(again.warnings(), read.warnings());
}
