//! Problems with known solutions, and random ones beside another method.

mod impact;
mod interior_point;
mod offsets;
mod path;
mod random;
mod rings;
mod worst;

use approx::assert_relative_eq;

use super::judge::*;
use super::*;
use crate::geometry::{Twist, Vector, right_of};

/// [m/s^2], and [s] the time of a solve here.
const GRAVITY: f64 = 9.81;
const TIME: f64 = 0.01;

/// A body of 2 kg and 0.1 kg m^2 on which nothing acts, that would have a velocity without constraints.
fn body(velocity: Vector, turn: f64) -> Problem {
    body_with(&[], velocity, turn)
}

/// The same with bodies of these moments of inertia that spin on it.
fn body_with(spins: &[f64], velocity: Vector, turn: f64) -> Problem {
    let mut problem = Problem::new([2.0, 0.1], 0, spins, &[]);
    problem.set_free(velocity, turn);
    problem
}

impl Problem {
    /// The velocity of the base.
    fn base(&self) -> Twist {
        Twist::from([self.unknowns[0], self.unknowns[1], self.unknowns[2]])
    }
}

/// The velocity that the weight gives to a body on a slope [rad], with x along it and y off it.
fn on_slope(angle: f64) -> Vector {
    Vector::new(angle.sin(), -angle.cos()) * (GRAVITY * TIME)
}

#[test]
fn a_box_on_a_slope_starts_to_slide_at_the_friction_angle() {
    let friction: f64 = 0.5;
    for (angle, slides) in [(0.4, false), (0.46, false), (0.47, true), (0.8, true)] {
        assert_eq!(slides, angle > friction.atan());
        let mut problem = body(on_slope(angle), 0.0);
        for x in [-0.3, 0.3] {
            let corner = Vector::new(x, -0.1);
            problem.contacts.push(contact(corner, Vector::Y, friction));
        }
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0);
        let free = on_slope(angle);
        let expected = (free.x + friction * free.y).max(0.0);
        let Twist { velocity, turn } = problem.base();
        assert_relative_eq!(velocity.x, expected, epsilon = 1e-9);
        assert_relative_eq!(velocity.y, 0.0, epsilon = 1e-9);
        assert_relative_eq!(turn, 0.0, epsilon = 1e-9);
        // The lower corner, ahead, takes what friction would otherwise turn the box by.
        let [rear, front] = [0, 1].map(|i| problem.contacts[i].normal_impulse);
        let of_friction: f64 = problem.contacts.iter().map(|c| c.friction_impulse).sum();
        assert_relative_eq!(rear + front, -2.0 * free.y, max_relative = 1e-9);
        assert_relative_eq!(
            0.3 * (front - rear),
            -0.1 * of_friction,
            max_relative = 1e-6
        );
    }
}

/// Painleve's rod: it slides on one end, and friction would press that end into the ground faster than the push of the
/// ground lifts it. No force lets it go on; an impact stops it.
#[test]
fn a_rod_that_jams_stops_at_once() {
    let arm = Vector::new(0.15, -0.6); // from the centre to the end on the ground
    let (mass, inertia, friction) = (2.0, 0.1, 2.0);
    // Acceleration of the end along the normal by a push with the friction of sliding in the direction of x.
    let lifts = 1.0 / mass + arm.x * (arm.x - friction * arm.y.abs()) / inertia;
    assert!(lifts < 0.0, "it is no such rod: {lifts}");
    let mut problem = body(Vector::new(1.0, -GRAVITY * TIME), 0.0);
    problem.contacts.push(contact(arm, Vector::Y, friction));
    problem.contacts[0].grip = Grip::Backwards;
    problem.solve();
    assert_eq!(problem.effort.unresolved, 0);
    let end = problem.base().at(arm);
    assert!(end.length() < 1e-7, "the end moves at {end} m/s");
    let contact = &problem.contacts[0];
    assert!(contact.normal_impulse > 0.0);
    assert!(contact.friction_impulse.abs() <= friction * contact.normal_impulse);
}

#[test]
fn of_redundant_supports_the_nearest_forces_to_the_guess_are_taken() {
    let places = [-0.4, -0.1, 0.0, 0.2, 0.3];
    let guesses = [0.0, 0.0, 0.05, 0.01, 0.0];
    let mut problem = body(Vector::new(0.0, -GRAVITY * TIME), 0.0);
    for (x, guess) in places.into_iter().zip(guesses) {
        let mut support = contact(Vector::new(x, -0.1), Vector::Y, 0.0);
        support.normal_impulse = guess;
        support.grip = Grip::Forwards; // without friction that is: it bears
        problem.contacts.push(support);
    }
    problem.solve();
    let found: Vec<f64> = problem.contacts.iter().map(|c| c.normal_impulse).collect();
    let weight = 2.0 * GRAVITY * TIME;
    let sum: f64 = found.iter().sum();
    assert_relative_eq!(sum, weight, epsilon = 2.0 * AGREEMENT.value());
    let moment: f64 = places.iter().zip(&found).map(|(x, n)| x * n).sum();
    assert!(moment.abs() < 0.1 * AGREEMENT.value());
    // So changes are a line over x.
    let change = |i: usize| found[i] - guesses[i];
    let slope = (change(4) - change(0)) / (places[4] - places[0]);
    for i in 1..4 {
        let on_line = change(0) + slope * (places[i] - places[0]);
        assert_relative_eq!(change(i), on_line, epsilon = 1e-6);
    }
}

/// A body that was pressed into a wedge between two walls, and is pulled out: friction alone holds it in a narrow one.
#[test]
fn a_narrow_wedge_holds_what_a_wide_one_lets_go() {
    let friction: f64 = 0.5;
    for (half_angle, holds) in [(0.3, true), (0.6, false)] {
        assert_eq!(holds, half_angle < friction.atan());
        // It opens upwards; something pulls the body out, after it was pressed in.
        let mut problem = body(Vector::new(0.0, 0.02), 0.0);
        for side in [-1.0, 1.0] {
            let (sin, cos) = f64::sin_cos(half_angle);
            let arm = Vector::new(0.1 * side, 0.0);
            let mut wall = contact(arm, Vector::new(-side * cos, sin), friction);
            (wall.normal_impulse, wall.grip) = (1.0, Grip::Sticks);
            problem.contacts.push(wall);
        }
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0);
        let left = problem.base().velocity.y;
        let loads = problem.contacts.iter().map(|c| c.normal_impulse);
        if holds {
            assert!(left.abs() < 1e-7, "{left} m/s");
            assert!(loads.sum::<f64>() > 1.0);
        } else {
            assert_relative_eq!(left, 0.02, max_relative = 1e-9);
            assert!(loads.sum::<f64>() < 1e-9);
        }
    }
}

/// Two walls that are almost parallel hold what falls between them. Each solution comes nearer to rest by a ratio of
/// 1 / (1 + 2 a^2 / 1e-6) for walls at an angle a from vertical.
#[test]
fn what_falls_into_a_narrow_gap_stands_there() {
    for angle in [1e-2, 1e-3, 3e-4, 1e-4_f64] {
        let mut problem = body(Vector::new(0.0, -1.0), 0.0);
        for side in [-1.0, 1.0] {
            let normal = Vector::new(-side * angle.cos(), angle.sin());
            let arm = Vector::new(0.1 * side, 0.0);
            problem.contacts.push(contact(arm, normal, 0.0));
        }
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0);
        let speed = problem.base().velocity.length();
        assert!(speed < 1e-6, "{speed} m/s at {angle}");
    }
}

/// A belt, without torque, between floor and ceiling that pull it opposite ways: its drive takes the difference only.
#[test]
fn opposed_contacts_on_one_belt_share_its_motor() {
    let (radius, friction) = (0.1, 0.5);
    for most in [0.0, 0.02, 1.0] {
        let mut problem = body_with(&[0.01], Vector::new(1.0, 0.0), 0.0);
        let spin = problem.layout.spin(0);
        let mut motor = Motor::new(Driven::Body(spin), -radius, most > 0.0);
        motor.aim(0.0, most);
        problem.motors.push(motor);
        for (up, load) in [(1.0, 0.3), (-1.0, 0.2)] {
            // The belt's surface moves with the body, and along by what the drive spins: forwards below, back above.
            let arm = Vector::new(0.0, -0.1 * up);
            let mut next = on_belt(arm, Vector::Y * up, friction, (spin, radius));
            // Soft, so that the loads stay as they are.
            (next.compliance, next.bias) = (1e9, -load * 1e9 / 2.0);
            problem.contacts.push(next);
        }
        problem.solve();
        assert_eq!(problem.effort.unresolved, 0);
        let [below, above] = [0, 1].map(|i| &problem.contacts[i]);
        assert_relative_eq!(below.normal_impulse, 0.3, max_relative = 1e-6);
        assert_relative_eq!(above.normal_impulse, 0.2, max_relative = 1e-6);
        let on_belt = radius * (below.friction_impulse + above.friction_impulse);
        let motor = problem.motor_impulses().next().expect("there is one");
        let gained = 0.01 * (problem.unknowns[spin] - problem.free[spin]);
        assert_relative_eq!(on_belt - radius * motor, gained, epsilon = 1e-9);
        assert!(motor.abs() <= most * (1.0 + 1e-9));
        for c in [below, above] {
            assert!(c.friction_impulse.abs() <= friction * c.normal_impulse * (1.0 + 1e-9));
        }
    }
}

/// A turn counts at the radius of gyration.
#[test]
fn a_change_of_the_base_is_that_of_a_point_on_it() {
    let mut problem = body(Vector::ZERO, 0.0);
    problem.tie();
    problem.change[..BASE].copy_from_slice(&[3.0, -4.0, -2.0]);
    let expected = 5.0 + 2.0 * (0.1_f64 / 2.0).sqrt();
    assert_relative_eq!(problem.base_change(), expected, max_relative = 1e-12);
}

#[test]
fn friction_is_a_share_of_the_most_under_its_load_and_gives_way_like_a_constraint() {
    let mut held = contact(Vector::ZERO, Vector::Y, 0.8);
    held.set_impulses([0.5, -0.3]);
    assert_relative_eq!(held.friction_load(), 0.75);
    let mut problem = body(Vector::ZERO, 0.0);
    problem.contacts.push(held);
    problem.tie();
    problem.center();
    let [_, grip] = problem.contacts[0].dampers;
    assert_relative_eq!(grip.at(0.0), -0.3);
    // The body has 2 kg.
    assert_relative_eq!(grip.at(-1e-6), -0.3 + 2.0, max_relative = 1e-12);
}

#[test]
fn a_constraint_gives_way_by_a_millionth_of_what_its_impulse_would_move() {
    let mut held = Bilateral::new(Row::on_base([1.0, 0.0, 0.0]));
    (held.admittance, held.center) = (0.5, 3.0);
    let damper = held.damper();
    assert_relative_eq!(damper.at(0.0), 3.0);
    assert_relative_eq!(damper.at(-1e-6), 5.0, max_relative = 1e-12);
}
