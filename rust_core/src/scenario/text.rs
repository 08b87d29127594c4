//! Parses JSON text strictly, so that nothing gets lost silently: every key once, every number exactly as written.

use serde::Deserializer;
use serde::de::{MapAccess, Visitor};
use serde_json::value::RawValue;
use serde_json::{Error, Map, Value, from_str};

use super::ScenarioError;
use super::fields::joined;

/// Deepest nesting of objects and lists; a scenario has six levels. Each level is parsed once more.
const DEEPEST: usize = 12;

/// Parses a text; an error has the path of the faulty value.
pub(crate) fn parse(text: &str) -> Result<Value, ScenarioError> {
    let whole: &RawValue = from_str(text)
        .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
    tree(&Place::Root, whole, 0)
}

/// Where a value is; turned into a path only for an error, because there may be hundreds of thousands.
enum Place<'a> {
    Root,
    Field(&'a Place<'a>, &'a str),
    Item(&'a Place<'a>, usize),
}

impl Place<'_> {
    fn path(&self) -> String {
        match self {
            Self::Root => String::new(),
            Self::Field(object, name) => joined(&object.path(), name),
            Self::Item(list, i) => format!("{}[{i}]", list.path()),
        }
    }

    fn error(&self, raw: &RawValue, rule: &str) -> ScenarioError {
        let path = match self {
            Self::Root => "scenario".to_owned(),
            _ => self.path(),
        };
        ScenarioError::new(path, raw.get(), rule)
    }
}

fn tree(place: &Place, raw: &RawValue, depth: usize) -> Result<Value, ScenarioError> {
    let text = raw.get();
    // The text is known to be JSON; only half of a surrogate pair can still be wrong.
    let not_unicode = |_: Error| place.error(raw, "must be valid Unicode");
    let first = text.as_bytes().first().copied().unwrap_or_default();
    if matches!(first, b'{' | b'[') && depth == DEEPEST {
        let rule = format!("must not be nested more than {DEEPEST} levels deep");
        return Err(Place::Root.error(raw, &rule));
    }
    match first {
        b'{' => {
            let mut map = Map::new();
            for (name, value) in entries(text).map_err(not_unicode)? {
                let inner = Place::Field(place, &name);
                if map.contains_key(&name) {
                    return Err(inner.error(value, "must be given only once"));
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
                .map(|(i, item)| tree(&Place::Item(place, i), item, depth + 1))
                .collect::<Result<_, _>>()
                .map(Value::Array)
        }
        b'-' | b'0'..=b'9' => {
            let read = from_str::<Value>(text).ok();
            read.filter(|number| number.as_f64() != Some(0.0) || is_zero(text))
                .ok_or_else(|| place.error(raw, "must be a number that fits in float64"))
        }
        _ => from_str(text).map_err(not_unicode),
    }
}

/// Whether a number is written as 0; another one may be read as 0 if it is too small for a float64.
fn is_zero(number: &str) -> bool {
    let digits = number.split(['e', 'E']).next().unwrap_or_default();
    !digits.contains(|c| matches!(c, '1'..='9'))
}

/// The fields of an object as written, including those that occur twice.
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
