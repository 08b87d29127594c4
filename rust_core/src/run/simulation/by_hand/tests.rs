//! Commands up to their limits are given; beyond them none is.

use super::*;
use crate::run::ValidScenario;
use crate::scenario::shared;

const NOTHING: ByHand = ByHand {
    speed: None,
    flippers: [None, None],
    push: None,
};

/// With arms at the front.
fn engineer() -> Simulation {
    Simulation::new(&ValidScenario::new(&shared("engineer_flippers_step")).expect("it is valid"))
}

fn speed(speed: f64) -> ByHand {
    let speed = Some(speed);
    ByHand { speed, ..NOTHING }
}

fn push(force: f64) -> ByHand {
    let push = Some(force);
    ByHand { push, ..NOTHING }
}

fn front(command: FlipperCommand) -> ByHand {
    let flippers = [Some(command), None];
    ByHand {
        flippers,
        ..NOTHING
    }
}

fn rear(command: FlipperCommand) -> ByHand {
    let flippers = [None, Some(command)];
    ByHand {
        flippers,
        ..NOTHING
    }
}

#[test]
fn a_command_beyond_its_limit_is_refused_and_the_last_one_within_it_is_not() {
    use FlipperCommand::{Angle, Level, Rate};
    let rules = [
        (
            speed(-1.39),
            speed(-1.4),
            "drive.speed must not exceed robot.drivetrain.max_speed = 1.39 m/s, got -1.4",
        ),
        (
            push(-1e15),
            push(1.1e15),
            "push must be >= -1e15 N and <= 1e15 N, got 1100000000000000",
        ),
        (
            front(Angle(-6.3)),
            front(Angle(6.31)),
            "flipper_angle must be >= -6.3 rad and <= 6.3 rad, got 6.31",
        ),
        (
            front(Level(6.3)),
            front(Level(-6.31)),
            "flipper_angle must be >= -6.3 rad and <= 6.3 rad, got -6.31",
        ),
        (
            front(Rate(1.0)),
            front(Rate(-1.01)),
            "flipper_rate must be >= -1 rad/s and <= 1 rad/s, got -1.01",
        ),
        (
            front(Rate(f64::MIN_POSITIVE)),
            front(Rate(f64::NAN)),
            "flipper_rate must be >= -1 rad/s and <= 1 rad/s, got NaN",
        ),
        (
            NOTHING,
            rear(Angle(0.0)),
            "rear_flipper_angle must not be given, because the robot has no flippers there, got 0",
        ),
        (
            NOTHING,
            rear(Rate(0.0)),
            "rear_flipper_rate must not be given, because the robot has no flippers there, got 0",
        ),
    ];
    let mut simulation = engineer();
    for (within, beyond, error) in rules {
        let given = simulation.check_commands(&within);
        assert!(given.is_ok(), "{given:?} for {within:?}");
        let refused = simulation.check_commands(&beyond).expect_err(error);
        assert_eq!(refused.to_string(), error);
    }
}

#[test]
fn a_push_takes_no_negative_time_and_at_most_100_000_s_to_rise() {
    let mut simulation = engineer();
    for (time, is_valid) in [(0.0, true), (1e5, true), (-1e-9, false), (1.1e5, false)] {
        assert_eq!(simulation.raise_push(1.0, time).is_ok(), is_valid, "{time}");
    }
    let refused = simulation.raise_push(1.0, -1.0).expect_err("it is no time");
    assert_eq!(
        refused.to_string(),
        "push.rise_time must be >= 0 s and <= 100000 s, got -1"
    );
}

#[test]
fn of_commands_of_which_one_is_refused_none_is_given() {
    let mut simulation = engineer();
    let pushed = |simulation: &Simulation| simulation.push().to_bits();
    simulation.command_all(&push(5.0)).expect("it is valid");
    let five = 5.0_f64.to_bits();
    assert_eq!(pushed(&simulation), five);
    let mixed = ByHand {
        speed: Some(99.0),
        ..push(7.0)
    };
    assert!(simulation.command_all(&mixed).is_err());
    assert_eq!(pushed(&simulation), five);
    simulation.check_commands(&push(7.0)).expect("it is valid");
    assert_eq!(pushed(&simulation), five);
}
