//! Names that are nearly right, and values as messages show them.

use super::*;

#[test]
fn the_distance_of_two_names_is_the_least_number_of_letters_to_change() {
    for (a, b, distance) in [
        ("", "", 0),
        ("", "abc", 3),
        ("abc", "", 3),
        ("speed", "Speed", 0),
        ("speed", "sped", 1),
        ("sped", "speed", 1),
        ("speed", "spead", 1),
        ("kitten", "sitting", 3),
        ("flaw", "lawn", 2),
        ("ab", "ba", 2),
        ("height", "weight", 1),
        ("axle_distance", "axledistance", 1),
    ] {
        assert_eq!(edit_distance(a, b), distance, "{a} {b}");
    }
}

/// A third of its letters may differ, and one of three.
#[test]
fn a_name_is_suggested_if_it_is_like_what_was_given() {
    let names = ["friction", "height", "yaw"];
    for (given, expected) in [
        ("fricton", Some("friction")),
        ("frction", Some("friction")),
        ("hight", Some("height")),
        ("hghh", None),
        ("yow", Some("yaw")),
        ("yow2", None),
        ("mass", None),
    ] {
        assert_eq!(nearest(given, names.into_iter()), expected, "{given}");
    }
    assert_eq!(
        one_of(Some("hight"), &names),
        "must be one of friction, height, yaw (did you mean height?)"
    );
    assert_eq!(
        one_of(Some("mass"), &names),
        "must be one of friction, height, yaw"
    );
    assert_eq!(one_of(None, &names), "must be one of friction, height, yaw");
}

#[test]
fn numbers_and_long_values_are_shown_in_few_characters() {
    for (x, text) in [
        (0.0, "0"),
        (1e-4, "0.0001"),
        (9.9e-5, "9.9e-5"),
        (-0.5, "-0.5"),
        (-1e9, "-1e9"),
        (9e8, "900000000"),
    ] {
        assert_eq!(shown(x), text);
    }
    let long = "x".repeat(80);
    assert_eq!(shorten(&long), long);
    assert_eq!(shorten(&format!("{long}y")), format!("{long}..."));
    assert_eq!(joined("", "speed"), "speed");
    assert_eq!(joined("drive", "speed"), "drive.speed");
}

/// One that is read has its meaning, however like it its name may be.
#[test]
fn an_error_of_a_missing_field_names_one_that_is_like_it_and_has_no_other_meaning() {
    let value =
        serde_json::json!({"frictions_new": 1.0, "frition": 2.0, "friktion": 3.0, "mass": 4.0});
    let mut fields = Fields::new("robot", &value).expect("it is an object");
    let mut rule = |read: &[&'static str]| {
        for name in read {
            fields.value(name).expect("it is there");
        }
        let error = fields.value("friction").expect_err("it is not there");
        assert_eq!(
            (error.path.as_str(), error.value.as_str()),
            ("robot.friction", "nothing")
        );
        error.rule
    };
    assert_eq!(
        rule(&[]),
        "must be given (is friktion a misspelling of it?)"
    );
    assert_eq!(
        rule(&["friktion"]),
        "must be given (is frition a misspelling of it?)"
    );
    assert_eq!(rule(&["frition"]), "must be given");
}

/// Half as long again, with as many letters more as may differ.
#[test]
fn a_longer_name_may_be_a_misspelling_too() {
    let value = serde_json::json!({"friction_new": 1.0});
    let mut fields = Fields::new("", &value).expect("it is an object");
    let error = fields.value("friction").expect_err("it is not there");
    assert!(error.rule.contains("friction_new"), "{}", error.rule);
}
