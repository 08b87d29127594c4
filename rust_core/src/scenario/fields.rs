//! Reads one JSON object field by field; an error names path, value and rule.

use serde_json::{Map, Value};
use thiserror::Error;

/// An interval that a number must lie in, with its unit for the message.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    low: f64,
    low_included: bool,
    high: f64,
    unit: &'static str,
}

impl Range {
    /// Above `low`, up to and including `high`.
    pub(crate) const fn above(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low_included: false,
            ..Self::between(low, high, unit)
        }
    }

    /// From `low` to `high`, both included.
    pub(crate) const fn between(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low,
            low_included: true,
            high,
            unit,
        }
    }

    fn contains(self, x: f64) -> bool {
        (self.low..=self.high).contains(&x) && (self.low_included || x > self.low)
    }

    /// The nearest number in it, if the interval is closed.
    pub(super) fn cut(self, x: f64) -> f64 {
        debug_assert!(self.low_included);
        x.clamp(self.low, self.high)
    }

    fn rule(self) -> String {
        let sign = if self.low_included { ">=" } else { ">" };
        let unit = if self.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", self.unit)
        };
        let [low, high] = [self.low, self.high].map(shown);
        format!("must be {sign} {low}{unit} and <= {high}{unit}")
    }
}

/// [kg] Lightest and heaviest mass.
///
/// The equations of motion have no scale of mass: robots whose masses, forces and torques all differ by the same power
/// of two move alike to the last bit, until a number leaves the range of float64. The largest number with a mass in it
/// is a stiffness, 1e22; it takes a product of fourteen to reach 1e308, and no formula has nearly so many.
/// `tests/physics/test_scale.py` has robots near both ends.
const LIGHTEST: f64 = 1e-12;
const HEAVIEST: f64 = 1e12;
/// Smallest mass of a moving part, as a fraction of the robot's.
///
/// Forces on light parts are computed together with those on heavy ones, which costs as many of the sixteen digits of
/// float64 as the ratio has: eleven remain. At a ratio of 1e-13, the Engineer slips where it otherwise climbs.
pub(super) const LEAST_FRACTION: f64 = 1e-5;
/// [m] Smallest and largest size of a part, and where it may be.
///
/// Contacts overlap by a fraction of a micrometre, and the error of a step is up to 0.3 um at the default accuracy. For
/// parts smaller than some hundred times that, shape has no meaning.
pub(super) const SMALLEST: f64 = 1e-4;
const LARGEST: f64 = 100.0;

pub(super) const MASS: Range = Range::between(LIGHTEST, HEAVIEST, "kg");
pub(super) const SIZE: Range = Range::between(SMALLEST, LARGEST, "m");
pub(super) const SIZE_OR_ZERO: Range = Range::between(0.0, LARGEST, "m");
pub(super) const COORDINATE: Range = Range::between(-LARGEST, LARGEST, "m");
pub(super) const GRAVITY: Range = Range::between(0.0, 1e3, "m/s^2");
/// [N] Up to the weight of the heaviest mass.
pub(super) const FORCE: Range = Range::above(0.0, 1e15, "N");
/// [N m] Up to that weight on the longest lever.
pub(super) const TORQUE: Range = Range::between(0.0, 1e17, "N m");
/// [kg m^2] From the lightest mass on the shortest lever to the heaviest on the longest.
pub(super) const INERTIA: Range = Range::between(1e-20, 1e16, "kg m^2");
/// [kg m^2] Inertia of a motor behind its gear; 0 if it is neglected.
pub(super) const ROTOR: Range = Range::between(0.0, 1e16, "kg m^2");
/// [N/m], [N s/m] Up to a spring on the heaviest mass that swings once, or a damper that stops it, in the shortest
/// step.
pub(super) const STIFFNESS: Range = Range::above(0.0, 1e22, "N/m");
pub(super) const DAMPING: Range = Range::between(0.0, 1e17, "N s/m");
/// [N m/rad], [N m s/rad] The same for rotation.
pub(super) const PIN_STIFFNESS: Range = Range::between(0.0, 1e22, "N m/rad");
pub(super) const PIN_DAMPING: Range = Range::between(0.0, 1e17, "N m s/rad");
/// [s] Shortest step.
pub(super) const SHORTEST: f64 = 1e-5;

/// Whether a number is left out of JSON: see [`Fields::number_or_zero`].
#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
pub(super) fn is_zero(number: &f64) -> bool {
    number.to_bits() == 0
}

/// Whether a flag is left out of JSON: see [`Fields::flag_or_false`].
#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
pub(super) fn is_false(flag: &bool) -> bool {
    !flag
}

/// A value that obeys its rules, or the first rule that is broken.
pub(super) type Checked<T> = Result<T, ScenarioError>;

/// A JSON object being read: every known field is read once; the others are errors.
pub(crate) struct Fields<'a> {
    path: String,
    map: &'a Map<String, Value>,
    known: Vec<&'static str>,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(path: &str, value: &'a Value) -> Checked<Self> {
        match value {
            Value::Object(map) => Ok(Self {
                path: path.to_owned(),
                map,
                known: Vec::new(),
            }),
            other => Err(ScenarioError::new(
                display(path),
                other,
                "must be an object",
            )),
        }
    }

    /// Path of a field of this object.
    pub(crate) fn path(&self, name: &str) -> String {
        joined(&self.path, name)
    }

    /// An error about a field of this object.
    pub(crate) fn error(
        &self,
        name: &str,
        value: impl ToString,
        rule: impl Into<String>,
    ) -> ScenarioError {
        ScenarioError::new(self.path(name), value, rule)
    }

    pub(crate) fn value(&mut self, name: &'static str) -> Checked<&'a Value> {
        // A field is read twice if null has its own meaning.
        if !self.known.contains(&name) {
            self.known.push(name);
        }
        let map = self.map;
        map.get(name).ok_or_else(|| self.missing(name))
    }

    fn missing(&self, name: &str) -> ScenarioError {
        let keys = self.map.keys().map(String::as_str);
        // A name may have megabytes; names twice as long are not compared.
        let unread = keys.filter(|key| key.len() < 2 * name.len() && !self.known.contains(key));
        let rule = match nearest(name, unread) {
            Some(key) => format!("must be given (is {key} a misspelling of it?)"),
            None => "must be given".to_owned(),
        };
        self.error(name, "nothing", rule)
    }

    /// Whether the object has a field, which need not be known.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.map.contains_key(name)
    }

    pub(crate) fn number(&mut self, name: &'static str, range: Range) -> Checked<f64> {
        let value = self.value(name)?;
        in_range(&self.path(name), value, range)
    }

    /// A number that JSON leaves out if it is 0, as do files older than the field.
    pub(crate) fn number_or_zero(&mut self, name: &'static str, range: Range) -> Checked<f64> {
        self.if_given(name, |f, name| f.number(name, range))
    }

    pub(crate) fn optional_number(
        &mut self,
        name: &'static str,
        range: Range,
    ) -> Checked<Option<f64>> {
        self.unless_null(name, |f, name| f.number(name, range))
    }

    pub(crate) fn integer(&mut self, name: &'static str, low: u32, high: u32) -> Checked<u32> {
        let value = self.value(name)?;
        let whole = value.as_u64().and_then(|n| u32::try_from(n).ok());
        whole.filter(|n| (low..=high).contains(n)).ok_or_else(|| {
            let rule = if low == high {
                format!("must be {low}")
            } else {
                format!("must be an integer from {low} to {high}")
            };
            self.error(name, value, rule)
        })
    }

    pub(crate) fn optional_integer(
        &mut self,
        name: &'static str,
        low: u32,
        high: u32,
    ) -> Checked<Option<u32>> {
        self.unless_null(name, |f, name| f.integer(name, low, high))
    }

    pub(crate) fn flag(&mut self, name: &'static str) -> Checked<bool> {
        let value = self.value(name)?;
        let flag = value.as_bool();
        flag.ok_or_else(|| self.error(name, value, "must be true or false"))
    }

    /// A flag that JSON leaves out if it is false, as do files older than the field.
    pub(crate) fn flag_or_false(&mut self, name: &'static str) -> Checked<bool> {
        self.if_given(name, Self::flag)
    }

    /// Reads a field by a function, unless it is null.
    pub(super) fn unless_null<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&mut Self, &'static str) -> Checked<T>,
    ) -> Checked<Option<T>> {
        if self.value(name)?.is_null() {
            return Ok(None);
        }
        read(self, name).map(Some)
    }

    /// Reads a field by a function, or takes the default, as for files older than the field.
    pub(super) fn if_given<T: Default>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&mut Self, &'static str) -> Checked<T>,
    ) -> Checked<T> {
        if self.has(name) {
            read(self, name)
        } else {
            Ok(T::default())
        }
    }

    pub(crate) fn text(&mut self, name: &'static str) -> Checked<&'a str> {
        /// Largest number of characters.
        const LONGEST: usize = 1000;

        let value = self.value(name)?;
        let text = value
            .as_str()
            .ok_or_else(|| self.error(name, value, "must be a string"))?;
        if text.chars().nth(LONGEST).is_some() {
            let rule = format!("must have at most {LONGEST} characters");
            return Err(self.error(name, text, rule));
        }
        Ok(text)
    }

    pub(crate) fn string(&mut self, name: &'static str) -> Checked<String> {
        self.text(name).map(str::to_owned)
    }

    pub(crate) fn point(&mut self, name: &'static str, range: Range) -> Checked<[f64; 2]> {
        let value = self.value(name)?;
        row(&self.path(name), value, [("x", range), ("y", range)])
    }

    /// Reads a list of rows of numbers; the path of an error includes the index, from 0.
    pub(crate) fn rows<const N: usize>(
        &mut self,
        name: &'static str,
        columns: [(&str, Range); N],
        most: usize,
    ) -> Checked<Vec<[f64; N]>> {
        let value = self.value(name)?;
        let names = columns.map(|(column, _)| column).join(", ");
        let Value::Array(rows) = value else {
            return Err(self.error(name, value, format!("must be a list of [{names}]")));
        };
        if rows.len() > most {
            let (count, rule) = (rows.len(), format!("must have at most {most} rows"));
            return Err(self.error(name, format!("{count} rows"), rule));
        }
        let (path, rows) = (self.path(name), rows.iter().enumerate());
        rows.map(|(i, given)| row(&format!("{path}[{i}]"), given, columns))
            .collect()
    }

    /// Reads a list of numbers, or null.
    pub(crate) fn numbers(
        &mut self,
        name: &'static str,
        range: Range,
        most: usize,
    ) -> Checked<Option<Vec<f64>>> {
        self.unless_null(name, |f, name| {
            let value = f.value(name)?;
            let Value::Array(cells) = value else {
                return Err(f.error(name, value, "must be a list of numbers"));
            };
            if cells.len() > most {
                let (count, rule) = (cells.len(), format!("must have at most {most} numbers"));
                return Err(f.error(name, format!("{count} numbers"), rule));
            }
            let (path, cells) = (f.path(name), cells.iter().enumerate());
            cells
                .map(|(i, cell)| in_range(&format!("{path}[{i}]"), cell, range))
                .collect()
        })
    }

    /// Reads a list of points.
    pub(crate) fn points(
        &mut self,
        name: &'static str,
        range: Range,
        most: usize,
    ) -> Checked<Vec<[f64; 2]>> {
        self.rows(name, [("x", range), ("y", range)], most)
    }

    pub(crate) fn child(&mut self, name: &'static str) -> Checked<Fields<'a>> {
        let value = self.value(name)?;
        Fields::new(&self.path(name), value)
    }

    /// Returns an error if the object has an unknown field.
    pub(crate) fn finish(self) -> Checked<()> {
        let mut fields = self.map.iter();
        let unknown = fields.find(|(name, _)| !self.known.contains(&name.as_str()));
        let Some((name, value)) = unknown else {
            return Ok(());
        };
        let rule = one_of(Some(name), &self.known);
        let rule = rule.replacen("must be one of", "must be a known field:", 1);
        // A path with an empty last part would name no field.
        let name = if name.is_empty() {
            "\"\""
        } else {
            name.as_str()
        };
        Err(self.error(name, value, rule))
    }
}

fn row<const N: usize>(
    path: &str,
    value: &Value,
    columns: [(&str, Range); N],
) -> Checked<[f64; N]> {
    let cells = value.as_array().filter(|cells| cells.len() == N);
    let Some(cells) = cells else {
        let names = columns.map(|(column, _)| column).join(", ");
        let rule = format!("must be [{names}]");
        return Err(ScenarioError::new(path, value, rule));
    };
    let mut row = [0.0; N];
    for (i, (_, range)) in columns.iter().enumerate() {
        row[i] = in_range(&format!("{path}[{i}]"), &cells[i], *range)?;
    }
    Ok(row)
}

fn in_range(path: &str, value: &Value, range: Range) -> Checked<f64> {
    // JSON has no non-finite numbers; they are passed as strings, so that the error can name the field.
    let x = match value {
        Value::String(text) if matches!(text.as_str(), "NaN" | "Infinity" | "-Infinity") => {
            return Err(ScenarioError::new(path, text, "must be a finite number"));
        }
        other => other
            .as_f64()
            .ok_or_else(|| ScenarioError::new(path, other, "must be a number"))?,
    };
    if !range.contains(x) {
        return Err(ScenarioError::new(path, value, range.rule()));
    }
    // Subnormal inputs are surely mistakes, and would silently lose digits.
    if x.is_subnormal() {
        let rule = format!("must be 0 or at least {:e} in magnitude", f64::MIN_POSITIVE);
        return Err(ScenarioError::new(path, value, rule));
    }
    // Turns -0.0 into 0.0: equal numbers must make the same scenario and the same motion.
    Ok(x + 0.0)
}

/// "must be one of ...", with the nearest name if there is one.
pub(crate) fn one_of(given: Option<&str>, names: &[&str]) -> String {
    let list = names.join(", ");
    match given.and_then(|given| nearest(given, names.iter().copied())) {
        Some(name) => format!("must be one of {list} (did you mean {name}?)"),
        None => format!("must be one of {list}"),
    }
}

/// The name that is most like another, if one is like it.
fn nearest<'a>(other: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    names
        .map(|name| (edit_distance(other, name), name))
        .filter(|(distance, name)| *distance <= name.len().max(3) / 3)
        .min()
        .map(|(_, name)| name)
}

/// Levenshtein distance, ignoring case; names are short.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.to_lowercase().chars().take(100).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// A number in few characters.
fn shown(x: f64) -> String {
    if x == 0.0 || (1e-4..1e9).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// Path of a field of the object at `path`.
pub(super) fn joined(path: &str, name: &str) -> String {
    if path.is_empty() {
        name.to_owned()
    } else {
        format!("{path}.{name}")
    }
}

fn display(path: &str) -> &str {
    if path.is_empty() { "scenario" } else { path }
}

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

#[cfg(test)]
mod tests;
