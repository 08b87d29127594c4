//! Means of synthetic steps, computed by hand.
#![allow(clippy::float_cmp)] // numbers here are exact in binary

use super::*;

/// Signals of steps of 0.25 s: place [m], and force [N] and place of one contact.
fn signals(steps: &[([f64; 2], f64, [f64; 2])]) -> Signals {
    let mut signals = Signals::default();
    for (k, (place, force, point)) in steps.iter().enumerate() {
        let now = Reading::at_rest(0.25 * (k + 1) as f64, Vector::from(*place));
        let contact = Contact {
            normal_force: *force,
            ..Contact::new(0, (0, -1), (Vector::from(*point), Vector::Y), 0.0)
        };
        signals.add((&now, 0.25), &[contact], std::iter::empty(), 10.0);
    }
    signals
}

#[test]
fn a_contact_is_where_it_was_weighed_by_its_force() {
    let stance = signals(&[([0.0, 0.0], 1.0, [4.0, 0.0]), ([0.0, 0.0], 3.0, [8.0, 2.0])]).stance();
    let [bearing] = &stance.bearings[..] else {
        panic!("there is one contact");
    };
    assert_eq!(bearing.contact.point, Vector::new(7.0, 1.5));
    assert_eq!(bearing.contact.normal_force, 2.0);
    assert_eq!(bearing.duration, 1.0);
}

#[test]
fn the_range_of_motion_is_that_of_all_steps_and_of_no_other_place() {
    let places = [[3.0, -1.0], [7.0, -2.0], [5.0, -4.0], [5.0, -1.0]];
    let stance = signals(&places.map(|place| (place, 1.0, [0.0, 0.0]))).stance();
    assert_eq!(stance.range, [4.0, 3.0, 0.0]);
    assert_eq!(stance.position, Vector::new(5.0, -2.0));
}
