//! From JSON text to its tree, without losing anything in silence: every key once, every number as it is written.

use serde::Deserializer;
use serde::de::{MapAccess, Visitor};
use serde_json::value::RawValue;
use serde_json::{Error, Map, Value, from_str};

use super::fields::{display, joined};
use crate::error::ScenarioError;

/// Objects and lists within each other at most; a scenario has six. Each level is read once more.
const DEEPEST: usize = 12;

/// Reads a text; an error has the path of what is wrong.
pub(crate) fn parse(text: &str) -> Result<Value, ScenarioError> {
    let whole: &RawValue = from_str(text)
        .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
    tree("", whole, 0)
}

fn tree(path: &str, raw: &RawValue, depth: usize) -> Result<Value, ScenarioError> {
    let text = raw.get();
    let error = |rule: &str| ScenarioError::new(display(path), text, rule);
    // What is read here has been found to be JSON before, but for the half of a character.
    let not_unicode = |_: Error| error("must be valid Unicode");
    let first = text.as_bytes().first().copied().unwrap_or_default();
    if matches!(first, b'{' | b'[') && depth == DEEPEST {
        let rule = format!("must not be nested more than {DEEPEST} levels deep");
        return Err(ScenarioError::new("scenario", text, rule));
    }
    match first {
        b'{' => {
            let entries = entries(text).map_err(not_unicode)?;
            let mut map = Map::new();
            for (name, value) in entries {
                let inner = joined(path, &name);
                if map.contains_key(&name) {
                    let rule = "must be given once";
                    return Err(ScenarioError::new(inner, value.get(), rule));
                }
                let value = tree(&inner, value, depth + 1)?;
                map.insert(name, value);
            }
            Ok(Value::Object(map))
        }
        b'[' => {
            let items: Vec<&RawValue> = from_str(text).map_err(not_unicode)?;
            let items = items.into_iter().enumerate();
            items
                .map(|(i, item)| tree(&format!("{path}[{i}]"), item, depth + 1))
                .collect::<Result<_, _>>()
                .map(Value::Array)
        }
        b'-' | b'0'..=b'9' => {
            let read = from_str::<Value>(text).ok();
            // What is written as more than 0 and read as 0 lies below every float64.
            let digits = text.split(['e', 'E']).next().unwrap_or_default();
            let is_zero = |number: &Value| number.as_f64() == Some(0.0);
            let vanishes =
                |number: &Value| is_zero(number) && digits.contains(|c| matches!(c, '1'..='9'));
            read.filter(|number| !vanishes(number))
                .ok_or_else(|| error("must be a number that fits in float64"))
        }
        _ => from_str(text).map_err(not_unicode),
    }
}

/// The fields of an object as they are written, also those that are written twice.
fn entries(text: &str) -> Result<Vec<(String, &RawValue)>, Error> {
    struct Entries;
    impl<'de> Visitor<'de> for Entries {
        type Value = Vec<(String, &'de RawValue)>;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut entries = Vec::new();
            while let Some(entry) = map.next_entry()? {
                entries.push(entry);
            }
            Ok(entries)
        }
    }
    serde_json::Deserializer::from_str(text).deserialize_map(Entries)
}
