//! Means of synthetic steps, computed by hand.
#![allow(clippy::float_cmp)] // numbers here are exact in binary

use super::*;
use crate::scenario::shared;
use crate::terrain::Ground;

/// Signals of steps of 0.25 s: place [m], and force [N] and place of one contact.
fn signals(steps: &[([f64; 2], f64, [f64; 2])]) -> Signals {
    let mut signals = Signals::default();
    for (k, (place, force, point)) in steps.iter().enumerate() {
        let now = Reading::at_rest(0.25 * (k + 1) as f64, Vector::from(*place));
        let normal = if k == 0 {
            Vector::Y
        } else {
            Vector::new(0.6, 0.8)
        };
        let contact = Contact {
            normal_force: *force,
            surface_speed: [1.0, 7.0][k.min(1)],
            ..Contact::new(0, (0, -1), (Vector::from(*point), normal), 0.0)
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
    let sum = Vector::new(0.0, 1.0) + Vector::new(0.6, 0.8) * 3.0;
    assert_eq!(bearing.contact.normal, sum.normalize());
    assert_eq!(bearing.contact.surface_speed, 5.5);
}

/// A surface that almost touches the ground could bear, and so counts even without a force.
#[test]
fn what_neither_bears_nor_touches_is_no_contact_of_a_stop() {
    let (near, far) = (0.5 * TOUCHES.value(), 2.0 * TOUCHES.value());
    for (force, distance, counts) in [
        (0.0, near, true),
        (0.0, TOUCHES.value(), false),
        (0.0, far, false),
        (1.0, near, true),
        (1.0, far, true),
    ] {
        let contact = Contact {
            normal_force: force,
            ..Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), distance)
        };
        let mut signals = Signals::default();
        let now = Reading::at_rest(0.5, Vector::ZERO);
        signals.add((&now, 0.5), &[contact], std::iter::empty(), 10.0);
        let found = signals.stance().bearings.len();
        assert_eq!(found, usize::from(counts), "{force} N at {distance} m");
    }
}

#[test]
fn the_range_of_motion_is_that_of_all_steps_and_of_no_other_place() {
    let places = [[3.0, -1.0], [7.0, -2.0], [5.0, -4.0], [5.0, -1.0]];
    let stance = signals(&places.map(|place| (place, 1.0, [0.0, 0.0]))).stance();
    assert_eq!(stance.range, [4.0, 3.0, 0.0]);
    assert_eq!(stance.position, Vector::new(5.0, -2.0));
}

/// Of the two ways, the shorter one counts, in one window or in two of two steps each.
#[test]
fn a_swing_is_the_way_there_and_back_again() {
    let swing = |path: &[f64; 4], window: f64| {
        let mut signals = Signals::default();
        for (k, x) in path.iter().enumerate() {
            let now = Reading::at_rest(0.25 * (k + 1) as f64, Vector::new(*x, 0.0));
            signals.add((&now, 0.25), &[], std::iter::empty(), window);
        }
        signals.stance().swing[0]
    };
    for (path, expected) in [
        ([0.0, 1.0, 3.0, 4.0], 0.0),
        ([4.0, 3.0, 1.0, 0.0], 0.0),
        ([0.0, 4.0, 3.0, 6.0], 1.0),
        ([6.0, 3.0, 4.0, 0.0], 1.0),
        ([0.0, 4.0, 0.0, 1.0], 4.0),
        ([2.0, 1.0, 0.0, 2.0], 2.0),
    ] {
        assert_eq!(swing(&path, 10.0), expected, "{path:?}");
        assert_eq!(swing(&path, 0.75), expected, "{path:?} in two windows");
    }
}

/// Steps of three lengths over two windows, of a contact and a drive: each mean is the sum of value times time over the
/// time.
#[test]
fn means_over_two_windows_weigh_each_step_by_its_time() {
    let steps = [
        (0.5, 4.0),
        (0.5, 8.0),
        (0.75, -2.0),
        (0.5, 16.0),
        (1.75, 1.0),
    ];
    let (mut signals, mut time) = (Signals::default(), 0.0);
    let mean = |of: fn(f64) -> f64| {
        let sum: f64 = steps.iter().map(|(dt, value)| dt * of(*value)).sum();
        sum / 4.0
    };
    for (dt, value) in steps {
        time += dt;
        let mut now = Reading::at_rest(time, Vector::new(value, 3.0 * value));
        now.chassis_angle = 0.5 * value;
        let contact = Contact {
            normal_force: f64::max(value, 0.0),
            friction_force: 2.0 * value,
            ..Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), 0.0)
        };
        let drive = DriveState {
            force: 5.0 * value,
            ..DriveState::default()
        };
        let drives = [(drive, 7.0 * value)].into_iter();
        signals.add((&now, dt), &[contact], drives, 2.25);
    }
    let stance = signals.stance();
    assert_eq!(stance.position, Vector::new(mean(|x| x), mean(|x| 3.0 * x)));
    assert_eq!(stance.angle, mean(|x| 0.5 * x));
    assert_eq!(stance.range, [18.0, 54.0, 9.0]);
    let [drive] = &stance.drives[..] else {
        panic!("there is one drive");
    };
    assert_eq!(
        [drive.force, drive.speed],
        [mean(|x| 5.0 * x), mean(|x| 7.0 * x)]
    );
    let [bearing] = &stance.bearings[..] else {
        panic!("there is one contact");
    };
    assert_eq!(bearing.contact.normal_force, mean(|x| x.max(0.0)));
    assert_eq!(bearing.contact.friction_force, mean(|x| 2.0 * x));
    assert_eq!(bearing.duration, 3.25 / 4.0);
}

#[test]
fn loads_of_an_interval_are_means_of_each_contact_that_bears() {
    let contact = |number: u64, normal_force: f64, friction_force: f64| {
        let mut contact = Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), 0.0);
        (contact.number, contact.normal_force) = (number, normal_force);
        contact.friction_force = friction_force;
        contact
    };
    let mut loads = Loads::default();
    loads.add(
        &[
            contact(3, 4.0, -1.0),
            contact(5, 0.0, 0.0),
            contact(8, 1.0, 0.5),
        ],
        0.5,
    );
    loads.add(&[contact(3, 8.0, 2.0), contact(5, 2.0, 1.0)], 1.5);
    assert_eq!(loads.count(), 3);
    let means: Vec<_> = loads
        .drain()
        .map(|l| (l.number, l.normal_force, l.friction_force))
        .collect();
    assert_eq!(means, [(3, 7.0, 1.25), (8, 0.25, 0.125), (5, 1.5, 0.75)]);
    assert_eq!((loads.count(), loads.drain().count()), (0, 0));
}

/// Only data that a run can have gathered are accepted from a snapshot.
#[test]
fn sums_with_one_thing_spoilt_do_not_fit() {
    type Spoil = fn(&mut WindowSums);

    let scenario = shared("engineer_belt_step");
    let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
    let model = Model::on(&scenario.robot, &ground).expect("it can be built");
    let steps = [([0.0, 0.0], 1.0, [4.0, 0.0]), ([0.0, 0.0], 3.0, [8.0, 2.0])];
    assert!(signals(&steps).fits(&model, &ground.lanes));
    assert!(
        Signals::default().fits(&model, &ground.lanes),
        "nothing yet"
    );
    let all: [(&str, Spoil); 14] = [
        ("more drives than there are", |sums| {
            sums.drives = vec![DriveMean::default(); 99];
        }),
        ("start", |sums| sums.start = f64::NAN),
        ("time below 0", |sums| sums.time = -1.0),
        ("endless time", |sums| sums.time = f64::INFINITY),
        ("place", |sums| sums.place[1] = f64::NAN),
        ("lowest", |sums| sums.low[2] = f64::NEG_INFINITY),
        ("highest", |sums| sums.high[0] = f64::INFINITY),
        ("a contact twice", |sums| {
            sums.contacts.push(sums.contacts[0]);
        }),
        ("a facet that there is not", |sums| {
            sums.contacts[0].last.facet = 99;
        }),
        ("weight", |sums| sums.contacts[0].weight = 0.0),
        ("point", |sums| sums.contacts[0].point.x = f64::NAN),
        ("normal", |sums| sums.contacts[0].normal.y = f64::NAN),
        ("friction", |sums| {
            sums.contacts[0].friction_force = f64::INFINITY;
        }),
        ("slip", |sums| sums.contacts[0].slip = f64::NAN),
    ];
    for (what, spoil) in all {
        let mut spoilt = signals(&steps);
        spoil(&mut spoilt.newer);
        assert!(!spoilt.fits(&model, &ground.lanes), "{what}");
        std::mem::swap(&mut spoilt.newer, &mut spoilt.older);
        assert!(!spoilt.fits(&model, &ground.lanes), "{what} before");
    }
    let mut loads = Loads::default();
    assert!(loads.fits(&model, &ground.lanes));
    for time in [-1.0, f64::NAN, f64::INFINITY] {
        loads.time = time;
        assert!(!loads.fits(&model, &ground.lanes), "{time}");
    }
}
