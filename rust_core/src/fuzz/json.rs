//! Changes of texts that leave them JSON: values, keys and parts of other scenarios.

use std::sync::OnceLock;

use serde_json::{Map, Number, Value, from_str};

use super::TEXTS;
use crate::draw::Draw;

/// Replacements of a number.
const NUMBERS: [f64; 16] = [
    0.0, -0.0, 1.0, -1.0, 2.0, 3.0, 0.5, 200.0, 1e-20, 1e-9, 1e-6, 1e-3, 100.0, 1e6, 1e9, 1e308,
];
/// Replacements of a string.
const WORDS: [&str; 24] = [
    "flat",
    "step",
    "ramp",
    "barrier",
    "ridge",
    "gap",
    "stairs",
    "half_round",
    "diagonal_barrier",
    "random_stepfield",
    "points",
    "lanes",
    "belt",
    "grouser_belt",
    "segmental",
    "closed",
    "line",
    "circumferential",
    "hybrid",
    "force",
    "rapier",
    "own",
    "round",
    "gear",
];

/// A text with one to three changes; unchanged if it is not JSON.
pub fn mutated(data: &[u8], seed: u32) -> Option<Vec<u8>> {
    let mut whole: Value = serde_json::from_slice(data).ok()?;
    let mut draw = Draw(u64::from(seed));
    for _ in 0..=draw.below(3) {
        let count = places(&mut whole, &mut |_| {});
        let chosen = draw.below(count);
        let mut number = 0;
        let draw = &mut draw;
        places(&mut whole, &mut |value| {
            if number == chosen {
                change(value, draw);
            }
            number += 1;
        });
    }
    serde_json::to_vec(&whole).ok()
}

/// Calls `each` with every value, parts before their whole; returns how many there are.
fn places(value: &mut Value, each: &mut impl FnMut(&mut Value)) -> usize {
    let mut count = 1;
    match value {
        Value::Object(members) => {
            for (_, member) in members.iter_mut() {
                count += places(member, each);
            }
        }
        Value::Array(items) => {
            for item in items {
                count += places(item, each);
            }
        }
        _ => {}
    }
    each(value);
    count
}

fn change(value: &mut Value, draw: &mut Draw) {
    match value {
        Value::Number(number) if draw.chance(0.95) => {
            let now = number.as_f64().unwrap_or_default();
            *value = changed(now, draw);
        }
        Value::Object(members) if draw.chance(0.9) => change_members(members, draw),
        Value::Array(items) if draw.chance(0.8) && !items.is_empty() => {
            let at = draw.below(items.len());
            match draw.below(4) {
                0 => drop(items.remove(at)),
                1 => items.insert(at, items[draw.below(items.len())].clone()),
                2 => {
                    let other = draw.below(items.len());
                    items.swap(at, other);
                }
                _ => change(&mut items[at], draw),
            }
        }
        Value::String(_) if draw.chance(0.9) => {
            *value = Value::from(WORDS[draw.below(WORDS.len())]);
        }
        Value::Bool(is_so) if draw.chance(0.9) => *is_so = !*is_so,
        _ => *value = of_another(draw),
    }
}

fn changed(now: f64, draw: &mut Draw) -> Value {
    let new = match draw.below(6) {
        0 => NUMBERS[draw.below(NUMBERS.len())],
        1 => now * draw.size(1e-3, 1e3),
        2 => return Value::from(draw.below(300)),
        3 => -now,
        4 => draw.size(1e-9, 1e6),
        _ => now * draw.size(0.5, 2.0),
    };
    Number::from_f64(new).map_or(Value::Null, Value::Number)
}

fn change_members(members: &mut Map<String, Value>, draw: &mut Draw) {
    let names: Vec<String> = members.keys().cloned().collect();
    let other = of_another(draw);
    match draw.below(4) {
        0 if !names.is_empty() => {
            members.remove(&names[draw.below(names.len())]);
        }
        1 if !names.is_empty() => {
            members.insert(names[draw.below(names.len())].clone(), other);
        }
        _ => {
            // What another scenario has by that name, or beside such names.
            if let Value::Object(others) = other {
                for (name, value) in others {
                    if draw.chance(0.5) || !members.contains_key(&name) {
                        members.insert(name, value);
                    }
                }
            }
        }
    }
}

/// A part of one of the shared scenarios.
fn of_another(draw: &mut Draw) -> Value {
    static TREES: OnceLock<Vec<Value>> = OnceLock::new();
    let trees = TREES.get_or_init(|| {
        let trees = TEXTS.iter().map(|text| from_str(text));
        trees.map(|tree| tree.expect("it is JSON")).collect()
    });
    let mut whole = trees[draw.below(trees.len())].clone();
    let chosen = draw.below(places(&mut whole, &mut |_| {}));
    let (mut number, mut found) = (0, Value::Null);
    places(&mut whole, &mut |value| {
        if number == chosen {
            found = value.clone();
        }
        number += 1;
    });
    found
}
