//! Stop windows over synthetic motion.
#![allow(clippy::float_cmp)] // distances and times here are exact in binary

use super::*;
use crate::geometry::Vector;

/// Checks in a window, one second apart.
const SPAN: usize = 8;
const LEAST: f64 = 0.25;
/// [m] Distance between the end axles.
const LENGTH: f64 = 0.5;

/// A robot commanded to go 1 m per second, checked every second.
struct Way {
    progress: Progress,
    time: f64,
    command: f64,
    /// [m/s] Set-point of the drivetrain.
    set_point: f64,
    /// [s] Length of the window.
    window: f64,
}

impl Way {
    fn new(command: f64) -> Self {
        Self {
            progress: Progress::default(),
            time: 0.0,
            command,
            set_point: command,
            window: SPAN as f64,
        }
    }

    /// Checks it at x [m], turned by an angle [rad]; returns the beginning of a stop that has ended.
    fn turned(&mut self, x: f64, angle: f64) -> Option<f64> {
        self.time += 1.0;
        let now = Reading {
            time: self.time,
            position: Vector::new(x, 0.0),
            velocity: Vector::ZERO,
            chassis_angle: angle,
            angular_velocity: 0.0,
            commanded_speed: self.set_point,
            track_speed: 0.0,
            track_position: 0.0,
        };
        let is_commanded = self.command != 0.0;
        let progress = &mut self.progress;
        progress.advance(&now, self.command, LENGTH, 1.0);
        let ended = progress.look(self.time, is_commanded, (self.window, 1.0), LEAST);
        let stop = |start| Event::stop(start, self.time, None);
        progress.stops.extend(ended.map(stop));
        ended
    }

    fn at(&mut self, x: f64) -> Option<f64> {
        self.turned(x, 0.0)
    }

    /// Makes this number of checks between two places, the one at `to` included.
    fn goes(&mut self, from: f64, to: f64, looks: usize) {
        for i in 1..=looks {
            self.at(from + (to - from) * i as f64 / looks as f64);
        }
    }

    fn stands(&mut self, x: f64, looks: usize) {
        self.goes(x, x, looks);
    }
}

#[test]
fn a_stop_begins_a_window_before_it_is_seen() {
    for command in [1.0, -1.0] {
        let mut way = Way::new(command);
        way.stands(3.0, SPAN);
        assert_eq!(way.progress.stop_since, None, "no whole window yet");
        assert_eq!(way.progress.share, 1.0);
        way.at(3.0);
        assert_eq!(way.progress.stop_since, Some(1.0));
        assert_eq!(way.progress.share, 0.0);
        way.stands(3.0, 20);
        assert_eq!(way.progress.stop_since, Some(1.0), "it lasts");
    }
}

#[test]
fn a_robot_that_comes_to_rest_has_stopped_when_a_window_holds_too_little() {
    let mut way = Way::new(1.0);
    way.goes(2.0, 22.0, 20);
    // Seven checks later the window still holds one metre of eight; two checks earlier, a quarter.
    way.stands(22.0, SPAN - 2);
    assert_eq!(way.progress.share, LEAST);
    assert_eq!(way.progress.stop_since, None);
    way.at(22.0);
    assert_eq!(way.progress.share, 0.125);
    assert_eq!(way.progress.stop_since, Some(27.0 - SPAN as f64));
}

#[test]
fn a_stop_ends_when_a_window_holds_enough_and_tells_when_it_began() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(forwards);
        way.stands(-5.0, 12);
        assert_eq!(way.at(-5.0 + forwards), None);
        assert_eq!(way.at(-5.0 + 2.0 * forwards), Some(1.0));
        assert_eq!(way.progress.stop_since, None);
        assert_eq!(way.at(-5.0 + 3.0 * forwards), None, "it is told once");
    }
}

#[test]
fn the_share_is_that_of_the_commanded_way_in_either_direction() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(4.0 * forwards);
        way.goes(7.0, 7.0 + 24.0 * forwards, 12);
        assert_eq!(way.progress.share, 0.5);
        assert_eq!(way.progress.stop_since, None);
    }
}

#[test]
fn a_share_ends_with_its_command() {
    for command in [0.0, -1.0] {
        let mut way = Way::new(1.0);
        way.goes(0.0, 5.0, 2 * SPAN);
        assert!(way.progress.share < 1.0);
        (way.command, way.set_point) = (command, command);
        way.stands(5.0, SPAN);
        assert_eq!(way.progress.share, 1.0, "no whole window yet");
    }
}

#[test]
fn way_that_is_made_twice_counts_once() {
    let mut way = Way::new(1.0);
    way.goes(0.0, 10.0, 10);
    // Thrown back by 5 m, it covers that distance again.
    way.goes(5.0, 10.0, SPAN);
    assert_eq!(way.progress.share, 0.0);
    assert!(way.progress.stop_since.is_some());
}

#[test]
fn a_nose_that_rises_makes_way() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(forwards);
        for i in 0..20 {
            way.turned(3.0, forwards * (0.25 + f64::from(i)));
        }
        assert_eq!(way.progress.share, LENGTH);
        assert_eq!(way.progress.stop_since, None);
        for _ in 0..20 {
            way.turned(3.0, 0.0);
        }
        assert!(way.progress.stop_since.is_some(), "it has sunk");
    }
}

#[test]
fn without_a_command_there_is_no_stop() {
    let mut way = Way::new(0.0);
    way.stands(3.0, 3 * SPAN);
    assert_eq!(way.progress.stop_since, None);
    assert_eq!(way.progress.share, 1.0);
    assert!(!way.progress.falters());
}

#[test]
fn a_drivetrain_that_asks_for_no_way_yet_lets_nothing_stop() {
    let mut way = Way::new(1.0);
    way.set_point = 0.0;
    way.stands(3.0, 3 * SPAN);
    assert_eq!(way.progress.stop_since, None);
    assert_eq!(way.progress.share, 1.0);
    assert!(!way.progress.falters());
}

#[test]
fn a_command_that_ends_or_turns_round_ends_a_stop_but_frees_nobody() {
    for command in [0.0, -1.0] {
        let mut way = Way::new(1.0);
        way.stands(3.0, SPAN + 1);
        way.command = command;
        assert_eq!(way.at(3.0), Some(1.0));
        assert!(!way.progress.falters());
        assert_eq!(way.progress.time_to_free, 0.0, "it has not moved");
        way.command = 1.0;
        way.stands(3.0, SPAN + 1);
        way.goes(4.0, 6.0, 2);
        assert_eq!(way.progress.time_to_free, SPAN as f64 + 1.0);
    }
}

/// A slower command has a longer window, which is incomplete at first.
#[test]
fn a_stop_goes_on_when_the_command_gets_slower() {
    let mut way = Way::new(1.0);
    way.stands(3.0, SPAN + 1);
    way.window *= 2.0;
    for _ in 0..2 * SPAN {
        assert_eq!(way.at(3.0), None);
        assert_eq!(way.progress.stop_since, Some(1.0));
        assert!(way.progress.falters(), "it is still a stop");
    }
    way.goes(3.0, 13.0, 5);
    assert_eq!(way.progress.stop_since, None);
}

/// The last jump counts for a window, the first no longer.
#[test]
fn a_stop_between_two_jumps_begins_when_the_one_before_it_ended() {
    let mut way = Way::new(1.0);
    way.stands(0.0, SPAN + 1);
    way.stands(1.5, SPAN - 2);
    assert_eq!(way.at(3.0), Some(1.0));
    let ended = way.time;
    way.stands(3.0, 2);
    assert_eq!(way.progress.stop_since, Some(ended));
}

#[test]
fn a_new_direction_begins_anew() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(forwards);
        way.stands(3.0, SPAN + 1);
        (way.command, way.set_point) = (-forwards, -forwards);
        assert_eq!(way.at(3.0), Some(1.0));
        way.stands(3.0, SPAN - 1);
        assert_eq!(way.progress.stop_since, None);
        way.at(3.0);
        assert_eq!(way.progress.stop_since, Some(SPAN as f64 + 2.0));
    }
}

#[test]
fn way_that_was_made_forwards_is_made_again_backwards() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(forwards);
        way.goes(0.0, 20.0 * forwards, 20);
        (way.command, way.set_point) = (-forwards, -forwards);
        way.goes(20.0 * forwards, 0.0, 20);
        assert_eq!(way.progress.share, 1.0);
        assert_eq!(way.progress.stop_since, None);
    }
}

#[test]
fn a_pause_begins_anew_in_either_direction() {
    for forwards in [1.0, -1.0] {
        let mut way = Way::new(forwards);
        way.stands(3.0, SPAN + 1);
        way.command = 0.0;
        assert_eq!(way.at(3.0), Some(1.0));
        way.at(3.0);
        let resumed = way.time + 1.0;
        way.command = forwards;
        way.stands(3.0, SPAN);
        assert_eq!(
            way.progress.stop_since, None,
            "the pause is no part of a stop"
        );
        way.at(3.0);
        assert_eq!(way.progress.stop_since, Some(resumed));
    }
}

#[test]
fn it_falters_after_half_a_window_without_way() {
    let mut way = Way::new(1.0);
    // The metre between the first two checks is a quarter of half a window.
    way.at(3.0);
    way.stands(4.0, SPAN / 2);
    assert!(!way.progress.falters());
    way.at(4.0);
    assert!(way.progress.falters());
    way.goes(4.0, 8.0, 4);
    assert!(!way.progress.falters());
}

#[test]
fn it_does_not_falter_before_half_a_window() {
    let mut way = Way::new(1.0);
    way.stands(3.0, SPAN / 2);
    assert!(!way.progress.falters());
    way.at(3.0);
    assert!(way.progress.falters());
}

#[test]
fn a_stop_falters_even_if_a_little_way_is_made_in_the_end() {
    let mut way = Way::new(1.0);
    way.stands(3.0, SPAN);
    way.at(4.0);
    // A quarter of the distance commanded in half a window, an eighth of that in the whole.
    assert!(way.progress.stop_since.is_some());
    assert!(way.progress.falters());
}

#[test]
fn progress_with_one_thing_spoilt_does_not_fit() {
    type Spoil = fn(&mut Progress);

    // A stop without an edge needs no lane.
    let fits = |progress: &Progress| progress.fits(1, &[]);
    let genuine = || {
        let mut way = Way::new(1.0);
        way.stands(3.0, SPAN + 1);
        let mut progress = way.progress;
        progress.stops.push(Event::stop(1.0, 2.0, None));
        assert!(progress.stop_since.is_some());
        progress
    };
    assert!(fits(&genuine()));
    let all: [(&str, Spoil); 16] = [
        ("direction", |p| p.direction = 0.5),
        ("direction that is no number", |p| p.direction = f64::NAN),
        ("advance then", |p| p.history[2].advance = f64::NAN),
        ("angle then", |p| p.history[2].angle = f64::NAN),
        // Each is finite, but their sum is not a number.
        ("advance and angle then", |p| {
            (p.history[2].advance, p.history[2].angle) = (f64::INFINITY, f64::NEG_INFINITY);
        }),
        ("command then", |p| p.history[2].commanded = f64::NAN),
        ("endless command then", |p| {
            p.history[2].commanded = f64::INFINITY;
        }),
        ("advance", |p| p.best_advance = f64::NAN),
        ("angle", |p| p.best_angle = f64::NAN),
        ("advance and angle", |p| {
            (p.best_advance, p.best_angle) = (f64::INFINITY, f64::NEG_INFINITY);
        }),
        ("command", |p| p.commanded = f64::NAN),
        ("endless command", |p| p.commanded = f64::INFINITY),
        ("share", |p| p.share = f64::NAN),
        ("endless share", |p| p.share = f64::INFINITY),
        ("stop", |p| p.stop_since = Some(f64::INFINITY)),
        ("earlier stop", |p| p.stops[0].end = f64::NAN),
    ];
    for (what, spoil) in all {
        let mut progress = genuine();
        spoil(&mut progress);
        assert!(!fits(&progress), "{what}");
    }
}

#[test]
fn progress_fits_before_its_first_step_and_in_each_direction() {
    assert!(Progress::default().fits(1, &[]), "nothing gained yet");
    for command in [1.0, 0.0, -1.0] {
        let mut way = Way::new(command);
        way.at(3.0);
        assert_eq!(way.progress.direction, command);
        assert!(way.progress.fits(1, &[]), "at {command}");
    }
}

#[test]
fn a_robot_that_still_brakes_from_the_other_direction_has_not_stopped() {
    let mut way = Way::new(-1.0);
    way.set_point = 0.5;
    way.stands(3.0, 3 * SPAN);
    assert_eq!(
        (way.progress.stop_since, way.progress.direction),
        (None, 0.0)
    );
    // From here on it could follow.
    way.set_point = -1.0;
    let begin = way.time;
    way.stands(3.0, SPAN + 1);
    assert!(way.progress.stop_since.is_some_and(|since| since >= begin));
}

#[test]
fn a_robot_that_is_told_to_drive_off_has_its_direction_before_its_set_point_moves() {
    for command in [1.0, -1.0] {
        let mut way = Way::new(command);
        way.set_point = 0.0;
        way.at(3.0);
        assert_eq!(way.progress.direction, command);
        assert_eq!(way.progress.best_advance(), command * 3.0);
    }
}

#[test]
fn a_window_of_whole_checks_is_as_many_checks_long() {
    for checks in 1..200 {
        let window = f64::from(checks) * 0.01;
        let mut progress = Progress::default();
        progress.look(0.0, true, (window, 0.01), LEAST);
        for _ in 0..400 {
            progress.look(0.0, true, (window, 0.01), LEAST);
        }
        assert_eq!(progress.history.len(), checks as usize + 1, "{window} s");
    }
}
