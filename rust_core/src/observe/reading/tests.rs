//! Means of synthetic checks, computed by hand.
#![allow(clippy::float_cmp)] // nothing is exactly 0

use approx::assert_relative_eq;

use super::*;
use crate::geometry::Vector;

fn reading(time: f64, vertical_speed: f64, angular_velocity: f64) -> Reading {
    Reading {
        velocity: Vector::new(0.3, vertical_speed),
        angular_velocity,
        ..Reading::at_rest(time, Vector::ZERO)
    }
}

#[test]
fn a_run_without_a_span_of_time_does_not_shake() {
    let mut shaking = Shaking::default();
    shaking.look(&reading(3.0, 2.0, 5.0));
    assert_eq!(shaking.vertical_acceleration(), 0.0);
    assert_eq!(shaking.angular_velocity(), 0.0);
}

#[test]
fn longer_spans_count_for_more() {
    let mut shaking = Shaking::default();
    shaking.look(&reading(3.0, 1.0, 7.0));
    // Half a second at 2 m/s^2, then one and a half at -4 m/s^2; rates are those at the end of each span.
    shaking.look(&reading(3.5, 2.0, 3.0));
    shaking.look(&reading(5.0, -4.0, -2.0));
    let mean = |first: f64, then: f64| (first * first * 0.25 + then * then * 0.75).sqrt();
    assert_relative_eq!(
        shaking.vertical_acceleration(),
        mean(2.0, 4.0),
        max_relative = 1e-15
    );
    assert_relative_eq!(
        shaking.angular_velocity(),
        mean(3.0, 2.0),
        max_relative = 1e-15
    );
}
