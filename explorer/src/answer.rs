//! Answers a request with outcome, diagnosis, metrics and drawing, or with an error.

use crawler2d_core::{
    Change, Error, Record, ScenarioError, ValidScenario, Wanted, Warning, simulate,
};
use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Map, Value, json};

use crate::columns::Columns;
use crate::{diagnosis, drawing};

/// The request of a page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request<'a> {
    /// The scenario, as `Scenario.to_json` writes it.
    #[serde(borrow)]
    scenario: &'a RawValue,
    /// Trials at a stop besides those that its outcome needs; null for none at all.
    trials: Option<Vec<String>>,
    /// [s] Time between two pictures; null for no pictures.
    sample_interval: Option<f64>,
}

/// Answers a request with JSON, and the columns to which it refers.
pub(crate) fn of(request: &[u8]) -> (String, Vec<f64>) {
    let mut columns = Columns::default();
    let answer = run(request, &mut columns).unwrap_or_else(|error| failure(&error));
    (answer.to_string(), columns.numbers)
}

fn run(request: &[u8], columns: &mut Columns) -> Result<Value, Error> {
    let request: Request = serde_json::from_slice(request)
        .map_err(|error| Error::Internal(format!("the request is not understood: {error}")))?;
    let checked = ValidScenario::from_json(request.scenario.get())?;
    let record = Record {
        sample_interval: request.sample_interval.unwrap_or(1.0),
        history: request.sample_interval.is_some(),
        trials: wanted(request.trials.as_deref())?,
    };
    let run = simulate(&checked, record)?;
    let why = run.diagnosis.as_ref();
    let mut answer = json!({
        "outcome": run.outcome.name(),
        "judged": request.trials.is_some() || why.is_none(),
        "diagnosis": why.map(diagnosis::of),
        "metrics": run.metrics.entries().into_iter().map(|(name, value)| (name.to_owned(), json!(value)))
            .collect::<Map<String, Value>>(),
        "warnings": checked.warnings().iter().chain(&run.warnings).map(warning).collect::<Vec<_>>(),
    });
    if request.sample_interval.is_some() {
        answer["drawing"] = drawing::of(&checked, &run, columns)?;
    }
    Ok(answer)
}

/// Returns the trials with these names.
fn wanted(names: Option<&[String]>) -> Result<Wanted, Error> {
    let Some(names) = names else {
        return Ok(Wanted::NOTHING);
    };
    let change = |name: &String| {
        let unknown = || Error::Internal(format!("there is no trial \"{name}\""));
        Change::of_name(name).ok_or_else(unknown)
    };
    Ok(Wanted::of(
        names.iter().map(change).collect::<Result<Vec<_>, _>>()?,
    ))
}

fn warning(warning: &Warning) -> Value {
    json!({ "path": warning.path, "value": warning.value, "reason": warning.reason })
}

/// An error as JSON; for a scenario with the path, the value and the broken rule.
fn failure(error: &Error) -> Value {
    let message = error.to_string();
    match error {
        Error::Scenario(ScenarioError { path, value, rule }) => {
            json!({ "error": { "message": message, "path": path, "value": value, "rule": rule } })
        }
        _ => json!({ "error": { "message": message } }),
    }
}
