//! Set-points, a driver who climbs, pushes, and what a driver remembers of schedules.

use super::*;
use crate::scenario::TorqueSharing;

const LIMITS: Drivetrain = Drivetrain {
    max_speed: 1.0,
    max_acceleration: 0.2,
    max_deceleration: 4.0,
    max_torque: 6.0,
    torque_sharing: TorqueSharing::Track,
    rotor_inertia: 0.0,
    no_load_speed: None,
    torque_curve: None,
    controller: None,
    self_locking: false,
};

#[test]
fn speeds_up_slowly_and_brakes_fast() {
    assert!((set_point(0.1, 0.4, &LIMITS, 0.1) - 0.12).abs() < 1e-15);
    assert!((set_point(0.4, 0.0, &LIMITS, 0.05) - 0.2).abs() < 1e-15);
    assert!((set_point(-0.1, -0.4, &LIMITS, 0.1) + 0.12).abs() < 1e-15);
}

#[test]
fn a_ramp_lasts_until_the_command_or_a_stand() {
    assert!((ramp_time(0.1, 0.4, &LIMITS) - 1.5).abs() < 1e-12);
    assert!((ramp_time(0.1, -0.4, &LIMITS) - 0.025).abs() < 1e-12);
    assert!(ramp_time(0.4, 0.4, &LIMITS).is_infinite());
}

#[test]
fn reversing_brakes_to_a_stand_first() {
    assert!((set_point(0.1, -0.4, &LIMITS, 0.1) - 0.0).abs() < 1e-15);
    assert!((set_point(0.0, -0.4, &LIMITS, 0.1) + 0.02).abs() < 1e-15);
}

#[test]
#[allow(clippy::float_cmp)] // a stand is exact
fn no_rounding_is_left_of_a_speed_that_is_reversed() {
    for k in 1..1000 {
        let (now, time) = (1e-3 * f64::from(k), 0.37 * f64::from(k));
        // A step ends at an instant, so that its length is rounded.
        let dt = time + ramp_time(now, -0.4, &LIMITS) - time;
        assert_eq!(set_point(now, -0.4, &LIMITS, dt), 0.0, "from {now} m/s");
    }
}

#[test]
fn reaches_the_command_and_stays() {
    assert!((set_point(0.399, 0.4, &LIMITS, 0.1) - 0.4).abs() < 1e-15);
}

const CLIMB: Climb = Climb {
    reach_angle: 0.7,
    sweep_angle: -0.2,
    push_angle: -0.5,
    level_angle: 0.1,
};

fn climbing() -> Drive {
    Drive {
        gait: Some(Gait::Climb(CLIMB)),
        speed: 0.4,
        schedule: None,
    }
}

/// What a driver sees of a robot that does not turn.
fn sight(time: f64, chassis_angle: f64, touches: [bool; 2]) -> DriverView {
    DriverView {
        time,
        chassis_angle,
        chassis_rate: 0.0,
        touches,
    }
}

/// Commands of a climbing driver who sees this for front and rear arms, which start at 0.3 rad.
fn commands(driver: &mut Driver, sight: DriverView) -> [FlipperCommand; 2] {
    driver.flippers(&climbing(), 0.3, sight)
}

/// The last of these commands, if each view lasts for half a second.
fn after(views: &[(f64, [bool; 2])]) -> [FlipperCommand; 2] {
    let mut driver = Driver::default();
    let seen = views.iter().flat_map(|view| [view; 50]);
    let views = (0_u32..)
        .zip(seen)
        .map(|(look, (angle, touches))| sight(f64::from(look) * LOOK.value(), *angle, *touches));
    let last = views.map(|sight| commands(&mut driver, sight)).last();
    last.expect("it has seen something")
}

#[test]
fn front_arms_reach_until_they_touch_and_then_press_down() {
    let (nothing, front) = ([false; 2], [true, false]);
    let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
    assert_eq!(after(&[(0.0, nothing)]), reach);
    let sweep = [
        FlipperCommand::Level(-0.2 - 0.05),
        FlipperCommand::Angle(0.3),
    ];
    assert_eq!(after(&[(0.0, nothing), (0.05, front)]), sweep);
    assert_eq!(after(&[(0.0, front), (0.05, front)]), sweep);
    assert_eq!(after(&[(0.05, front), (0.0, nothing)]), reach);
}

#[test]
fn rear_arms_push_a_raised_chassis_until_it_is_level_and_they_bear_nothing() {
    let (nothing, rear) = ([false; 2], [false, true]);
    let push = |angle: f64| {
        [
            FlipperCommand::Level(-0.2 - angle),
            FlipperCommand::Level(-0.5 + angle),
        ]
    };
    assert_eq!(after(&[(0.2, nothing)]), push(0.2));
    assert_eq!(after(&[(0.2, rear), (0.05, rear)]), push(0.05));
    let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
    assert_eq!(after(&[(0.2, rear), (0.05, nothing)]), reach);
}

/// At 6 ms and 28 ms the arms touch nothing; only from 10 ms to 20 ms nothing was touched at any time.
#[test]
fn what_arms_have_touched_since_the_last_look_counts() {
    let mut driver = Driver::default();
    let mut front_at =
        |time: f64, touches: bool| commands(&mut driver, sight(time, 0.0, [touches, false]))[0];
    let (reach, sweep) = (FlipperCommand::Angle(0.7), FlipperCommand::Level(-0.2));
    for (time, touches, command) in [
        (0.0, true, sweep),
        (0.004, true, sweep),
        (0.006, false, sweep),
        (0.01, false, sweep),
        (0.015, false, sweep),
        (0.02, false, reach),
        (0.024, true, reach),
        (0.028, false, reach),
        (0.03, false, sweep),
    ] {
        assert_eq!(front_at(time, touches), command, "{time} s");
    }
}

/// A driver who has looked at the time 0 sees something at 2 and 4 ms, and looks again at 10 and 20 ms.
#[test]
#[allow(clippy::float_cmp)] // times are handed on
fn only_a_look_that_may_change_a_command_ends_a_step() {
    let (nothing, front, rear) = ([false; 2], [true, false], [false, true]);
    let next = |start: (f64, [bool; 2]), first: [bool; 2], now: (f64, f64, [bool; 2])| {
        let mut driver = Driver::default();
        commands(&mut driver, sight(0.0, start.0, start.1));
        commands(&mut driver, sight(0.002, start.0, first));
        let now = DriverView {
            chassis_rate: now.1,
            ..sight(0.004, now.0, now.2)
        };
        commands(&mut driver, now);
        driver.next_change(&CLIMB, now)
    };
    let (first, second, none) = (0.01, 0.02, f64::INFINITY);
    // It reaches, and touches something or is raised.
    let reaches = |now: (f64, f64, [bool; 2])| next((0.0, nothing), nothing, now);
    assert_eq!(reaches((0.0, 0.0, nothing)), none);
    assert_eq!(reaches((0.0, 0.0, front)), first);
    assert_eq!(reaches((0.11, 0.0, nothing)), first);
    // It turns by 6 and 16 mrad until then, and perhaps by twice as much.
    assert_eq!(reaches((0.09, 1.0, nothing)), first);
    assert_eq!(reaches((0.07, 1.0, nothing)), second);
    assert_eq!(reaches((0.067, 1.0, nothing)), none);
    assert_eq!(reaches((0.09, -1.0, nothing)), none);
    // It presses down, and goes on or loses what it pressed on, before or after it is seen again.
    let presses = |before: [bool; 2], now: [bool; 2]| next((0.0, front), before, (0.0, 0.0, now));
    assert_eq!(presses(front, front), none);
    assert_eq!(presses(front, nothing), second);
    assert_eq!(presses(nothing, nothing), first);
    // It lifts, comes down, and its rear arms bear or not; or it falls onto its nose.
    let lifts = |angle: f64, now: [bool; 2]| next((0.2, rear), now, (angle, 0.0, now));
    assert_eq!(lifts(0.05, rear), none);
    assert_eq!(lifts(0.05, nothing), first);
    assert_eq!(lifts(-0.11, rear), first);
    // It has not looked yet.
    let at_first = Driver::default().next_change(&CLIMB, sight(0.0, 0.0, front));
    assert_eq!(at_first, none);
}

/// At 25 ms it sees that the chassis has turned by 50 mrad since 0: at 10 ms it was not raised, at 20 ms it was.
#[test]
fn looks_that_a_step_passed_are_made_up_for_at_their_times() {
    let mut driver = Driver::default();
    commands(&mut driver, sight(0.0, 0.07, [false; 2]));
    let now = DriverView {
        chassis_rate: 2.0,
        ..sight(0.025, 0.12, [true, false])
    };
    let [front, rear] = commands(&mut driver, now);
    assert_eq!(front, FlipperCommand::Level(-0.2 - 0.12));
    assert_eq!(rear, FlipperCommand::Level(-0.5 + 0.12));
    assert_eq!(driver.next_look, Some(0.03));
}

/// To make up for ten thousand million looks would take for ever.
#[test]
fn a_driver_whose_look_is_long_overdue_looks_once() {
    let mut driver = Driver {
        next_look: Some(0.0),
        ..Driver::default()
    };
    let [front, _] = commands(&mut driver, sight(1e8, 0.0, [true, false]));
    assert_eq!(front, FlipperCommand::Level(-0.2));
    assert_eq!(driver.next_look, Some(look_after(1e8)));
}

#[test]
#[allow(clippy::float_cmp)] // multiples of one number
fn looks_are_at_multiples_of_their_interval() {
    for (time, next) in [
        (0.0, 1.0),
        (0.013, 2.0),
        (0.05, 6.0),
        (0.05 - 0.9e-9, 6.0),
        (3.1234, 313.0),
    ] {
        assert_eq!(look_after(time), next * LOOK.value(), "{time} s");
    }
}

/// On level ground they would keep its tail raised for ever.
#[test]
fn rear_arms_that_have_stood_a_robot_on_its_nose_for_a_while_let_it_down() {
    let rear = [false, true];
    let [raised, down, level] = [0.2, -0.3, -0.05].map(|angle| (angle, rear));
    let reach = [FlipperCommand::Angle(0.7), FlipperCommand::Angle(0.3)];
    assert_eq!(after(&[raised, down, down, down]), reach);
    assert_ne!(after(&[raised, down]), reach);
    assert_ne!(after(&[raised, down, down, level, down]), reach);
}

#[test]
#[allow(clippy::float_cmp)] // halves of whole numbers
fn a_push_rises_evenly_and_stays() {
    let push = Push::default().raised(8.0, 1.0, 2.0);
    assert_eq!(
        [1.0, 1.5, 3.0, 9.0].map(|time| push.at(time)),
        [0.0, 2.0, 8.0, 8.0]
    );
    let more = push.raised(16.0, 2.0, 1.0);
    assert_eq!([2.0, 2.5, 3.0].map(|time| more.at(time)), [4.0, 10.0, 16.0]);
}

#[test]
fn only_a_push_that_can_be_commanded_is_taken_from_a_snapshot() {
    let fits = |from: f64, to: f64, since: f64, rise: f64| {
        let push = Push {
            from,
            to,
            since,
            rise,
        };
        push.fits()
    };
    assert!(Push::default().fits() && fits(1e15, -1e15, -3.0, 1e9));
    for force in [1.1e15, -1.1e15, f64::INFINITY, f64::NAN] {
        assert!(!fits(force, 0.0, 0.0, 0.0) && !fits(0.0, force, 0.0, 0.0));
        assert!(!Push::may_be(force));
    }
    assert!(!fits(0.0, 0.0, f64::NAN, 0.0) && !fits(0.0, 0.0, f64::INFINITY, 0.0));
    for rise in [-1e-9, f64::INFINITY, f64::NAN] {
        assert!(!fits(0.0, 0.0, 0.0, rise), "{rise} s");
    }
}

#[test]
#[allow(clippy::float_cmp)] // halves of whole numbers
fn a_push_without_a_rise_is_there_at_once() {
    let push = Push::default().raised(5.0, 1.0, 0.0);
    assert_eq!([0.5, 1.0].map(|time| push.at(time)), [0.0, 5.0]);
}

fn drive(speeds: &[[f64; 2]], angles: &[[f64; 2]]) -> Drive {
    Drive {
        speed: 0.1,
        schedule: Some(speeds.to_vec()),
        gait: Some(Gait::Hold(Hold {
            angle: 0.5,
            schedule: Some(angles.to_vec()),
            front: None,
            rear: None,
        })),
    }
}

/// Entries at exactly this time are due from then on, and so are not followed.
#[test]
fn a_driver_who_ignores_schedules_keeps_the_angle_before() {
    let drive = drive(&[[1.0, 0.2], [9.0, 0.3]], &[[1.0, 0.6], [2.0, 0.7]]);
    for (now, past) in [(0.5, 0), (1.0, 0), (1.5, 1), (2.0, 1), (2.5, 2)] {
        let mut driver = Driver::default();
        driver.ignore_schedules(&drive, now);
        assert_eq!(driver.angles, Some(past), "{now} s");
        assert_eq!(driver.speed(&drive, 10.0), None, "{now} s");
    }
}

#[test]
fn a_driver_with_another_gait_goes_on_with_the_speeds_that_are_past() {
    let before = drive(&[[1.0, 0.2], [9.0, 0.3]], &[]);
    let mut driver = Driver::default();
    assert_eq!(driver.speed(&before, 2.0), Some(0.2));
    let gait = drive(&[[1.0, 0.2], [9.0, 0.3]], &[[1.0, 0.6]]);
    assert_eq!(driver.commanded(&before, &gait).speed(&gait, 3.0), None);
    assert_eq!(
        driver.commanded(&before, &gait).speed(&gait, 9.0),
        Some(0.3)
    );
    // Other speeds start from the beginning.
    let speeds = drive(&[[1.0, 0.4]], &[]);
    assert_eq!(
        driver.commanded(&before, &speeds).speed(&speeds, 3.0),
        Some(0.4)
    );
}

#[test]
fn arms_are_held_at_the_last_angle_that_is_due() {
    let Some(Gait::Hold(hold)) = drive(&[], &[[1.0, 0.6], [2.0, 0.7]]).gait else {
        panic!("they are held");
    };
    for (time, most, angle) in [
        (0.9, None, 0.5),
        (1.0, None, 0.6),
        (1.9, None, 0.6),
        (5.0, None, 0.7),
        (5.0, Some(1), 0.6),
        (5.0, Some(0), 0.5),
        (0.9, Some(2), 0.5),
    ] {
        let found = hold.angle_at(time, most);
        assert_eq!(found.to_bits(), f64::to_bits(angle), "{time} s {most:?}");
    }
}

#[test]
fn only_what_commands_lead_to_is_taken_from_a_snapshot() {
    let drive = drive(&[[1.0, 0.2], [9.0, 0.3]], &[]);
    let fits = |change: fn(&mut Driver)| {
        let mut driver = Driver::default();
        change(&mut driver);
        driver.fits(&drive, 1.0)
    };
    assert!(fits(|_| {}) && fits(|d| d.entries = 2) && fits(|d| d.nose_down_since = Some(0.3)));
    assert!(!fits(|d| d.entries = 3));
    assert!(!fits(|d| d.nose_down_since = Some(f64::NAN)));
    assert!(fits(|d| d.next_look = Some(1.01)));
    for next_look in [1.02, -0.01, f64::NAN] {
        let driver = Driver {
            next_look: Some(next_look),
            ..Driver::default()
        };
        assert!(!driver.fits(&drive, 1.0), "{next_look} s");
    }
    assert!(fits(|d| d.take(1, FlipperCommand::Angle(0.3))));
    for end in [0, 1] {
        let mut driver = Driver::default();
        driver.take(end, FlipperCommand::Angle(f64::INFINITY));
        assert!(!driver.fits(&drive, 1.0), "{end}");
    }
}
