//! Stops: their begin and end, their events, and the data for a diagnosis.

use super::*;
use crate::observe::EventKind;

/// [s] Resolution of stop times: one check, and one step of the robot.
const ABOUT: f64 = 0.011;

/// A robot that straddles a step up at the origin, with the edge inside its belt.
pub(super) fn astride() -> Watched {
    let mut robot = Watched::with(|scenario| {
        let points = [[-END, 0.0], [0.0, 0.0], [0.0, 0.125], [END, 0.125]];
        scenario.terrain = ground(&points);
    });
    robot.now.position = Vector::new(0.0, 0.125);
    robot
}

/// Its belt bears on the top of the step with a force [N].
fn on_top(force: f64) -> Contact {
    let mut contact = on_facet(2, force);
    contact.point = Vector::new(0.05, 0.125);
    contact
}

#[test]
fn a_stop_begins_when_the_robot_came_to_rest() {
    let mut robot = Watched::with(|_| {});
    robot.goes_until(2.0, [0.4, 0.0], 0.0);
    assert_eq!(robot.monitor.stop_since(), None);
    assert_relative_eq!(robot.monitor.progress(), 1.0, max_relative = 1e-9);
    robot.stands_until(2.93);
    assert_eq!(robot.monitor.stop_since(), None);
    robot.stands_until(4.0);
    let since = robot.monitor.stop_since().expect("it stands");
    // Up to a twentieth of a window's distance does not count as progress.
    assert!((since - 1.95).abs() < ABOUT, "{since} s");
    assert!(robot.monitor.progress() < 1e-9);
    let events = robot.monitor.events(4.0);
    assert_eq!(events, [Event::stop(since, 4.0, None)]);
    assert_eq!(robot.monitor.time_to_free(), 0.0, "it is not free yet");

    robot.goes_until(6.0, [0.4, 0.0], 0.0);
    assert_eq!(robot.monitor.stop_since(), None);
    let events = robot.monitor.events(6.0);
    assert_eq!((events.len(), events[0].start), (1, since));
    assert!((events[0].end - 4.05).abs() < ABOUT, "{} s", events[0].end);
    let stood = events[0].end - events[0].start;
    assert_eq!(robot.monitor.time_to_free(), stood);
}

#[test]
fn the_longest_of_several_stops_counts() {
    let mut robot = Watched::with(|_| {});
    let mut time = 0.0;
    for stands in [2.0, 3.0, 2.5] {
        robot.stands_until(time + stands);
        robot.goes_until(time + stands + 2.0, [0.2, 0.0], 0.0);
        time += stands + 2.0;
    }
    let stops = robot.monitor.events(time);
    let lengths = stops.iter().map(|stop| stop.end - stop.start);
    let longest = lengths.fold(0.0, f64::max);
    assert_eq!(stops.len(), 3);
    assert_eq!(robot.monitor.time_to_free(), longest);
    // At half the commanded speed, a tenth of a window on either side is without progress.
    assert!((longest - 3.2).abs() < 2.0 * ABOUT, "{longest} s");
}

#[test]
fn a_robot_that_is_not_told_to_move_has_not_stopped() {
    let mut robot = Watched::with(|_| {});
    robot.command = 0.0;
    robot.stands_until(5.0);
    assert_eq!(robot.monitor.stop_since(), None);
    assert!(!robot.monitor.is_over());
}

#[test]
fn a_pause_parts_a_stop_in_two_that_do_not_overlap() {
    for speed in [0.4, -0.4] {
        let mut robot = Watched::with(|_| {});
        for (until, command) in [(3.0, speed), (3.5, 0.0), (5.0, speed)] {
            robot.command = command;
            robot.stands_until(until);
        }
        let stops = robot.monitor.events(5.0);
        let times: Vec<[f64; 2]> = stops.iter().map(|stop| [stop.start, stop.end]).collect();
        for (found, expected) in times.iter().flatten().zip([0.0, 3.0, 3.5, 5.0]) {
            assert!((found - expected).abs() < ABOUT, "{times:?}");
        }
        assert_eq!(times.len(), 2);
        assert_eq!(robot.monitor.time_to_free(), 0.0, "it has not moved");
    }
}

/// As in another engine with a fixed step.
#[test]
fn a_stop_is_seen_as_soon_if_steps_are_longer_than_the_time_between_two_looks() {
    let mut robot = Watched::with(|_| {});
    while robot.monitor.stop_since().is_none() {
        robot.now.time += 3.0 * LOOK.value();
        robot.now.commanded_speed = robot.command;
        let mut from = robot.now.time - 3.0 * LOOK.value();
        let end = robot.now.time;
        while from < end {
            let look = robot.monitor.next_look();
            robot.now.time = if look > from { look.min(end) } else { end };
            let drives = robot.drives.iter().copied();
            let (now, command) = ((&robot.now, 0.0), robot.command);
            robot
                .monitor
                .observe(now, command, &[], drives, &robot.running);
            from = robot.now.time;
        }
    }
    assert!(robot.now.time < 1.1, "{} s", robot.now.time);
}

#[test]
fn a_slow_robot_is_given_the_time_of_its_grousers_pitches() {
    // Three pitches of 48 mm at 0.05 m/s.
    let window = 2.88;
    for speed in [0.05, -0.05] {
        let mut robot = Watched::with(|_| {});
        robot.command = speed;
        robot.stands_until(window - 0.015);
        assert_eq!(robot.monitor.stop_since(), None);
        robot.stands_until(window + 0.015);
        assert!(robot.monitor.stop_since().is_some());
    }
}

#[test]
fn a_nose_that_rises_fast_enough_is_no_stop() {
    // A twentieth of 0.4 m/s over the distance of the end axles is 0.04 rad/s.
    let has_stopped = |rate: f64| {
        let mut robot = Watched::with(|_| {});
        robot.goes_until(3.0, [0.0, 0.0], rate);
        robot.monitor.stop_since().is_some()
    };
    assert!(has_stopped(0.038));
    assert!(!has_stopped(0.042));
}

#[test]
fn what_is_remembered_of_a_stop_is_its_own() {
    let mut robot = Watched::with(|_| {});
    robot.stands_until(2.0);
    robot.goes_until(4.0, [0.4, 0.0], 0.0);
    robot.loaded = vec![on_facet(0, 50.0)];
    robot.stands_until(5.1);
    assert!(robot.monitor.stop_since().is_some());
    let stance = robot.monitor.stance();
    assert!(
        (stance.position.x + 0.2).abs() < 0.01,
        "{}",
        stance.position
    );
    assert!(stance.range[0] < 0.01, "it knows of the first stop");
    assert_relative_eq!(
        stance.bearings[0].contact.normal_force,
        50.0,
        max_relative = 1e-9
    );
}

#[test]
fn an_edge_inside_the_track_is_an_event_with_the_force_on_it() {
    let mut robot = astride();
    robot.loaded = vec![on_top(60.0), on_top(40.0), on_facet(0, 500.0)];
    for (number, loaded) in (1..).zip(&mut robot.loaded) {
        loaded.number = number;
    }
    robot.stands_until(0.5);
    let events = robot.monitor.events(0.5);
    let kinds: Vec<EventKind> = events.iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [EventKind::Intrusion]);
    let inside = robot.monitor.intrusion().expect("the edge is inside");
    // The belt runs 62.5 mm below the axles, which are as high as the top of the step.
    assert_relative_eq!(inside.depth, RADIUS, max_relative = 1e-9);
    assert_relative_eq!(inside.force, 100.0, max_relative = 1e-9);
    assert_eq!((inside.edge, events[0].end), (1, 0.5));

    robot.now.position.y = 0.5;
    robot.stands_until(0.6);
    assert!(robot.monitor.intrusion().is_none());
    assert_eq!(robot.monitor.events(0.6).len(), 1);
}

#[test]
fn ground_without_an_edge_that_stands_out_is_no_event() {
    let mut robot = Watched::with(|_| {});
    // Deep in level ground there is a piece of it inside, but no edge.
    robot.now.position.y = 0.0;
    robot.stands_until(0.5);
    assert!(robot.monitor.events(0.5).is_empty());
}

#[test]
fn events_are_in_the_order_of_their_start() {
    let mut robot = astride();
    robot.now.position = Vector::new(-1.0, RADIUS);
    robot.stands_until(1.5);
    robot.now.position = Vector::new(0.0, 0.125);
    robot.loaded = vec![on_top(60.0)];
    robot.stands_until(4.0);
    let events = robot.monitor.events(4.0);
    let kinds: Vec<EventKind> = events.iter().map(|event| event.kind).collect();
    let expected = [EventKind::Stop, EventKind::Intrusion, EventKind::Stop];
    assert_eq!(kinds, expected, "{events:?}");
    assert!(events.is_sorted_by(|a, b| a.start <= b.start));
    // The first stop ended as the edge came in; the last one goes on with the edge inside.
    assert!(events.iter().all(|event| event.edge == 1));
    assert_eq!(events[2].force, events[1].force);
}
