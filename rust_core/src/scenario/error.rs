//! A field that breaks a rule.

use thiserror::Error;

/// A field of a scenario breaks a rule; nothing has been run.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{path} {rule}, got {value}")]
pub struct ScenarioError {
    /// Dotted path of the field, for example `robot.track.count`.
    pub path: String,
    /// The value found there, shortened for display.
    pub value: String,
    /// The rule it breaks, starting with "must".
    pub rule: String,
}

impl ScenarioError {
    #[allow(clippy::needless_pass_by_value)] // callers pass numbers and strings alike
    pub(crate) fn new(
        path: impl Into<String>,
        value: impl ToString,
        rule: impl Into<String>,
    ) -> Self {
        Self {
            path: path.into(),
            value: shorten(&value.to_string()),
            rule: rule.into(),
        }
    }
}

/// Shortens long values, such as lists of points, which would bury the message.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 80;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    let head: String = text.chars().take(LONGEST).collect();
    format!("{head}...")
}
