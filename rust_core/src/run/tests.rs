//! Copies of a robot on another scale end at the same place after the same number of steps, if the lengths, times and
//! speeds of the method are scaled, too: no others matter.

use serde_json::{Map, Value};

use super::{Record, Run, ValidScenario, simulate};
use crate::draw::cases;
use crate::scenario::{Scenario, shared};
use crate::units::with_units;

/// Exponents of length, time and mass in the unit of a field.
type Unit = [i32; 3];

const NUMBER: Unit = [0, 0, 0];
const LENGTH: Unit = [1, 0, 0];
const TIME: Unit = [0, 1, 0];
const TORQUE: Unit = [2, -2, 1];

/// Factors of length, time and mass. Powers of two change no digit, and those of length are the squares of those of
/// time, so that gravity is the same.
const SCALES: [[f64; 3]; 4] = [
    [1.0 / 16.0, 0.25, 1.0],
    [0.25, 0.5, 1.0 / 64.0],
    [4.0, 2.0, 8.0],
    [16.0, 4.0, 4096.0],
];

/// The unit of a field of scenarios, from the package's list of them.
fn unit(room: &str, field: &str) -> Unit {
    match (room, field) {
        // The criteria have a fraction of the torque with the same name.
        ("flippers", "torque_limit") => return TORQUE,
        (_, "schema") => return NUMBER,
        _ => (),
    }
    let text = include_str!("../../../python/crawler2d/common/units.py");
    let list = text.split("_FIELDS_BY_UNIT = {").nth(1).expect("a list");
    let mut parts = list.split("\n}").next().expect("its end").split('"');
    let mut unit = "";
    while let (Some(_), Some(text)) = (parts.next(), parts.next()) {
        // A unit stands before a colon, the names of its fields do not.
        if parts
            .clone()
            .next()
            .is_some_and(|after| after.starts_with(':'))
        {
            unit = text;
        } else if text.split(' ').any(|name| name == field) {
            return exponents(unit);
        }
    }
    panic!("{field} has no unit")
}

fn exponents(unit: &str) -> Unit {
    match unit {
        "1" | "rad" => NUMBER,
        "m" => LENGTH,
        "s" => TIME,
        "Hz" | "rad/s" => [0, -1, 0],
        "m/s" => [1, -1, 0],
        "m/s^2" => [1, -2, 0],
        "kg" => [0, 0, 1],
        "kg m^2" => [2, 0, 1],
        "N m" => TORQUE,
        _ => panic!("no scenario here has a field in {unit}"),
    }
}

fn factor(unit: Unit, scale: [f64; 3]) -> f64 {
    let of = |k: usize| scale[k].powi(unit[k]);
    of(0) * of(1) * of(2)
}

fn multiply(value: &mut Value, by: f64) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|value| multiply(value, by)),
        Value::Number(number) if number.is_f64() => {
            *value = Value::from(number.as_f64().expect("it is one") * by);
        }
        _ => (),
    }
}

fn scale_fields(fields: &mut Map<String, Value>, room: &str, scale: [f64; 3]) {
    for (name, value) in fields.iter_mut() {
        match value {
            Value::Object(fields) => scale_fields(fields, name, scale),
            Value::Number(_) | Value::Array(_) => multiply(value, factor(unit(room, name), scale)),
            _ => (),
        }
    }
}

/// The same robot and ground on another scale.
fn copy(scenario: &Scenario, scale: [f64; 3]) -> Scenario {
    let text = scenario.to_json();
    let mut value: Value = serde_json::from_str(&text).expect("it is JSON");
    let fields = value.as_object_mut().expect("a scenario has fields");
    scale_fields(fields, "", scale);
    Scenario::from_json(&value.to_string()).expect("it is valid on that scale, too")
}

fn run(scenario: &Scenario, [length, time, _]: [f64; 3]) -> Run {
    with_units([length, time], || {
        let checked = ValidScenario::new(scenario).expect("it is valid");
        simulate(&checked, Record::default()).expect("it runs")
    })
}

/// Bits of the end of a run and of its counts, on the scale of the original.
fn bits(run: &Run, scale: [f64; 3]) -> Vec<u64> {
    let m = &run.metrics;
    let values = [
        (m.time, TIME),
        (m.final_x, LENGTH),
        (m.final_y, LENGTH),
        (m.final_angle, NUMBER),
        (m.steps, NUMBER),
    ];
    values
        .map(|(value, unit)| (value / factor(unit, scale)).to_bits())
        .to_vec()
}

/// A shared scenario, shorter, with rotors of this inertia [kg m^2].
fn shorter(name: &str, rotor_inertia: f64) -> Scenario {
    let mut scenario = shared(name);
    scenario.duration = scenario.duration.min(2.5);
    scenario.robot.drivetrain.rotor_inertia = rotor_inertia;
    scenario
}

/// In ordinary runs each of them on one scale, in turn. No chains: their steps are not cut at a strike, and the elimination of a ring was not checked for this.
#[test]
fn copies_on_other_scales_end_with_the_same_bits() {
    let robots = [
        ("engineer_belt_step", 0.0),
        ("engineer_grouser_belt_step", 0.04),
        ("engineer_flippers_step", 0.0),
        ("judge_engineer3_step", 0.04),
        ("judge_engineer5_step", 0.0),
        ("judge_gear3_step", 0.0),
        ("judge_gear3_bar", 0.04),
    ];
    for (place, (name, rotor_inertia)) in robots.into_iter().enumerate() {
        let original = shorter(name, rotor_inertia);
        let expected = run(&original, [1.0; 3]);
        let scales = SCALES.into_iter().cycle().skip(place);
        for scale in scales.take(cases(1, SCALES.len())) {
            let found = run(&copy(&original, scale), scale);
            assert_eq!(found.outcome, expected.outcome, "{name} {scale:?}");
            assert_eq!(
                bits(&found, scale),
                bits(&expected, [1.0; 3]),
                "{name} {scale:?}"
            );
        }
    }
}

/// So the test above can fail.
#[test]
fn without_the_units_of_the_method_a_copy_moves_otherwise() {
    let (original, scale) = (shorter("judge_gear3_step", 0.0), SCALES[0]);
    let copy = copy(&original, scale);
    let [same, other] = [scale, [1.0; 3]].map(|units| run(&copy, units));
    assert_ne!(bits(&same, scale), bits(&other, scale));
}
