//! What is simulated: plain data with one set of rules, read from JSON and written back exactly.
//!
//! JSON is parsed strictly, so that nothing gets lost silently: every key once, every number exactly as written.

mod drive;
mod drivetrain;
mod fields;
mod objects;
mod outline;
mod robot;
mod settings;
#[cfg(test)]
mod shared;
mod terrain;
mod track;
mod warnings;

use fields::{Checked, Fields, GRAVITY, Range, joined};
use objects::{FromJson, object};
use serde::de::{MapAccess, Visitor};
use serde::{Deserializer, Serialize};
use serde_json::value::RawValue;
use serde_json::{Error, Map, Value, from_str};
use sha2::{Digest, Sha256};

pub use drive::{Climb, Drive, Gait, Hold};
pub use drivetrain::{Drivetrain, Pi, TorqueSharing};
pub use fields::ScenarioError;
pub use outline::TrackOutline;
pub use robot::{End, Ends, Flippers, Robot};
pub use settings::{ContactMethod, Engine, SeizureCriteria, Solver, Start};
#[cfg(test)]
pub(crate) use shared::{shared, shared_text};
pub(crate) use terrain::scaled_friction;
pub use terrain::{FieldPattern, Friction, MAX_POINTS, Stepfield, Surface, Terrain};
pub use track::{
    BeltTrack, ChainMechanism, CircumferentialWheels, ClosedSurface, ClosedTrack, ForceSupport,
    ForceTrack, GearWheel, GrouserBeltTrack, HybridWheels, LineOfWheels, SegmentalTrack, ShoeShape,
    Track, Wheel,
};
pub(crate) use track::{MAX_GROUSERS, MAX_SHOES, MAX_WHEELS};
pub use warnings::Warning;

/// Version of the format.
pub const SCHEMA: u32 = 2;
/// Fields that are missing in files of version 1.
const OF_VERSION_1: &str = "must be 2; in a file of version 1, solver.accuracy takes the place of solver.substeps, and \
                            is null where solver.time_step is kept";

object! {
    /// Everything that defines a run: the same scenario and build give the same bits.
    pub struct Scenario {
        /// Version of the format.
        schema: u32 = integer(SCHEMA, SCHEMA),
        /// The robot.
        robot: Robot = object(),
        /// The ground.
        terrain: Terrain = object(),
        /// The command.
        drive: Drive = object(),
        /// How the robot stands at time 0.
        start: Start = object(),
        /// [m] The x that the whole robot must pass; `None` takes the terrain's.
        goal: Option<f64> = optional_number(Range::between(-1e7, 1e7, "m")),
        /// [m/s^2] Acceleration of gravity, downwards.
        gravity: f64 = number(GRAVITY),
        /// [s] Longest simulated time.
        duration: f64 = number(Range::between(0.0, 1e5, "s")),
        /// How the equations are solved.
        solver: Solver = object(),
        /// When a run ends, and what counts as a stop.
        criteria: SeizureCriteria = object(),
    }
}

impl Scenario {
    /// The canonical JSON of this scenario: fields in a fixed order, shortest exact numbers.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|e| unreachable!("plain data serialises: {e}"))
    }

    /// The identity of a scenario: SHA-256 of the canonical JSON, in hexadecimal.
    pub fn identity(&self) -> String {
        let digest = Sha256::digest(self.to_json().as_bytes());
        digest
            .iter()
            .fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
    }

    /// Reads a whole scenario; rules that need the built robot and ground are checked elsewhere.
    pub(crate) fn of_value(value: &Value) -> Checked<Self> {
        let mut f = Fields::new("", value)?;
        if value.get("schema").is_some_and(|version| version == 1) {
            return Err(ScenarioError::new("schema", 1, OF_VERSION_1));
        }
        let scenario = Self::read(&mut f)?;
        f.finish()?;
        Ok(scenario)
    }
}

/// Deepest nesting of objects and lists; a scenario has six levels. Each level is parsed once more.
const DEEPEST: usize = 12;

/// Parses a text; an error has the path of the faulty value.
pub(crate) fn parse(text: &str) -> Checked<Value> {
    let whole: &RawValue = from_str(text)
        .map_err(|e| ScenarioError::new("scenario", text, format!("must be JSON ({e})")))?;
    tree(&Place::Root, whole, 0)
}

/// Position of a value, which becomes a path only for an error, because there may be hundreds of thousands.
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

fn tree(place: &Place, raw: &RawValue, depth: usize) -> Checked<Value> {
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

/// Whether a number is written as 0; others may be read as 0 if they are too small for a float64.
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
