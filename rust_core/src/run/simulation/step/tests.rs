//! Steps: their ends, the range of their search for contacts, and the contacts that they leave out.

use super::*;
use crate::robot::Running;
use crate::run::ValidScenario;
use crate::scenario::{Track, Wheel, shared};

/// [m] Depth of the tips of gear wheels in the ground at their lowest.
const DIP: f64 = 5e-6;
const STEP: f64 = 0.01;
/// Times at which gaps are looked at in a step.
const LOOKS: u32 = 2000;

impl Simulation {
    /// [m] Gap of the lowest tip after a time [s], if nothing changes until then.
    fn gap_after(&mut self, time: f64) -> f64 {
        let model = self.dynamics.model();
        let pose = self.state.pose_after(time, model);
        let (mut running, mut contacts) = (Running::default(), Vec::new());
        self.state.running_after(time, model, &mut running);
        self.contact.find(pose, &running, 0.05, &mut contacts);
        let gaps = contacts.iter().map(|contact| contact.distance);
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// A step of `h` [s] at most, not kept.
    fn tried(&mut self, mut h: f64) -> Attempt {
        let mut attempt = Attempt::default();
        while let Err(shorter) = self.attempt_step(&mut attempt, h, f64::INFINITY) {
            h = shorter;
        }
        attempt
    }
}

/// A robot on gear wheels, at rest.
fn on_gears(phase: f64) -> Simulation {
    let mut scenario = shared("judge_gear3_step");
    scenario.start.track_phase = phase;
    Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"))
}

/// Gear wheels that turn by 0.5 rad in a step, above level ground.
fn spinning(phase: f64) -> Simulation {
    let mut simulation = on_gears(phase);
    let radius = simulation.dynamics.model().drive_radius;
    simulation.state.drives[0].spin = -0.5 / STEP * 0.06 / radius;
    simulation.state.center.x -= 0.5;
    simulation
}

/// Their phases are not symmetric, so the direction of rotation matters.
#[test]
fn a_robot_starts_with_its_lowest_tip_on_the_ground_whatever_its_phase() {
    for phase in [0.0, 0.004, 0.013, 0.031] {
        let mut scenario = on_gears(phase).scenario;
        if let Track::Line(line) = &mut scenario.robot.track
            && let Wheel::Gear(wheel) = &mut line.wheel
        {
            wheel.phase_fraction = 0.2;
        }
        let checked = ValidScenario::new(&scenario).expect("it is valid");
        let gap = Simulation::new(&checked).gap_after(0.0);
        assert!(gap.abs() < 1e-9, "{gap} m at {phase} m");
    }
}

/// At its start everything is at rest, and the ground farther away than contacts are searched for then.
#[test]
fn a_long_step_sees_the_ground_that_it_falls_on() {
    for i in 1..10 {
        let mut simulation = on_gears(0.0);
        simulation.state.center.y += 5e-5 * f64::from(i);
        let tried = simulation.tried(0.012);
        let error = simulation.local_error(&tried);
        assert!(tried.strikes || error > 1e-5, "{error} m");
    }
}

/// At the speed of its first step it would land almost twice as late.
#[test]
fn what_falls_lands_when_it_does() {
    let gap = 5e-5;
    let mut simulation = on_gears(0.0);
    let gravity = simulation.scenario.gravity;
    simulation.state.center.y += gap - simulation.gap_after(0.0);
    simulation.step().expect("it is finite");
    let left = libm::sqrt(2.0 * gap / gravity) - simulation.time();
    let (speed, fallen) = (gravity * simulation.time(), gap - simulation.gap_after(0.0));
    assert!((gap - fallen) / speed > 1.5 * left, "it must speed up");
    let tried = simulation.tried(STEP);
    let off = tried.length - left;
    assert!(
        off.abs() < COLLISION_STEP.value(),
        "{} s, {left} s",
        tried.length
    );
}

/// At 50 m/s, it would be a quarter of a metre under the ground in the middle of a step of 10 ms.
#[test]
fn a_robot_that_would_fall_through_the_ground_in_a_step_strikes_it() {
    let mut simulation = on_gears(0.0);
    simulation.state.center.y += 5e-5;
    simulation.step().expect("it is finite");
    let is_open = |contact: &Contact| contact.distance > 1e-5;
    assert!(simulation.loaded().iter().all(is_open));
    simulation.state.velocity.y = -50.0;
    let tried = simulation.tried(STEP);
    assert!(tried.strikes && tried.length < 1e-4, "{} s", tried.length);
}

#[test]
fn a_step_in_which_forces_move_more_than_the_room_of_gaps_left_out_is_halved() {
    let mut simulation = on_gears(0.0);
    simulation.advance(0.5).expect("it is finite");
    let mut tried = simulation.tried(1e-4);
    let strayed = |s: &Simulation| s.dynamics.strayed(&s.state, tried.length, s.reach);
    let (far, half) = (strayed(&simulation), 0.5 * tried.length);
    assert!(far > 0.0 && !tried.strikes);
    tried.room = 0.99 * far;
    assert_eq!(simulation.judge(&tried), Err(half));
    // No step is shorter than the shortest.
    let length = std::mem::replace(&mut tried.length, SHORTEST.value());
    tried.room = 0.0;
    assert_ne!(simulation.judge(&tried), Err(0.5 * SHORTEST.value()));
    (tried.length, tried.room) = (length, 1.01 * far);
    assert_ne!(simulation.judge(&tried), Err(half));
}

/// A longer one could be found too long repeatedly.
#[test]
fn no_piece_is_longer_than_the_step_that_was_asked_for() {
    let little = 0.3 * COLLISION_STEP.value();
    for h in [
        STEP,
        20.0 * COLLISION_STEP.value(),
        2.0 * COLLISION_STEP.value(),
    ] {
        for left in [h, h + little, h + 0.7 * COLLISION_STEP.value(), 2.0 * h] {
            for strike in [0.0, little, 0.5 * h, h - little, h] {
                let (piece, strikes) = cut_at_strike(strike, h, left);
                assert!(piece > 0.0 && piece <= h, "{piece} s of {h} s");
                assert_eq!(strikes, strike <= piece, "{strike} s, {piece} s of {h} s");
            }
        }
    }
}

/// The step ends 10 us after the strike. If less than 10 us remain then, a step that may be as long includes them.
#[test]
fn a_step_with_a_strike_leaves_no_short_rest() {
    for (strike, h, left, piece) in [
        (10e-6, 25e-6, 25e-6, 25e-6),
        (10e-6, 35e-6, 35e-6, 20e-6),
        (12e-6, 22e-6, 25e-6, 22e-6),
    ] {
        let (found, strikes) = cut_at_strike(strike, h, left);
        assert!((found - piece).abs() < 1e-15, "{found} s, {piece} s");
        assert!(strikes);
    }
}

#[test]
fn tips_that_come_and_go_within_a_step_strike() {
    let mut found = 0;
    for i in 0..40 {
        let mut simulation = spinning(0.005 * f64::from(i));
        // Two steps bring a tip to the bottom, whatever the phase.
        let times = (0..2 * LOOKS).map(|k| f64::from(k) / f64::from(LOOKS) * STEP);
        let gaps: Vec<f64> = times
            .clone()
            .map(|time| simulation.gap_after(time))
            .collect();
        let lowest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        simulation.state.center.y -= lowest + DIP;
        let lands = |(time, gap): (f64, &f64)| (*gap < lowest + DIP).then_some(time);
        let expected = times.zip(&gaps).find_map(lands).expect("a tip lands");
        if expected == 0.0 {
            continue;
        }
        let tried = simulation.tried(STEP);
        // Near the end of a step, the corner of a tip that lands may be another than in its middle.
        if expected < 0.9 * STEP {
            found += 1;
            let off = tried.length - expected;
            assert!(off.abs() < 0.05 * STEP, "{} s, {expected} s", tried.length);
        } else if expected > STEP {
            assert!(tried.length >= STEP, "{} s", tried.length);
        }
    }
    assert!(found > 10, "{found}");
}

const SCENARIOS: [&str; 3] = [
    "judge_gear3_step",
    "engineer_grouser_belt_step",
    "engineer_flippers_step",
];

/// A robot that falls at `speed` [m/s], with a contact found there `half` a step [s] later, each up to 8 ms long, at a
/// gap [m]: whether it is left out, and the room of what is.
fn is_left_out(speed: f64, half: f64, gap: f64) -> (bool, f64) {
    let mut simulation = on_gears(0.0);
    simulation.state.velocity = Vector::new(0.0, -speed);
    simulation.scenario.solver.prediction_distance = 1e-6;
    let longest = 8e-3;
    // Half of what it may move in the next step, and no more than half a millimetre into the ground.
    let travel = (speed + 2.0 * 9.81 * longest) * longest;
    let contact = |gap| Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), gap);
    let mut attempt = Attempt {
        contacts: vec![contact(0.9e-6), contact(gap), contact(1.0)],
        sight: 0.5 * travel - UNSEEN.value(),
        ..Attempt::default()
    };
    let room = simulation.leave_out(&mut attempt, half, speed);
    let gaps = attempt.contacts.iter().map(|contact| contact.distance);
    let kept: Vec<f64> = gaps.collect();
    assert!(
        kept[0] < 1e-6 && kept.iter().all(|gap| *gap < 1.0),
        "{kept:?}"
    );
    (kept.len() == 1, room)
}

/// It is where it falls to at its speed in half a step. Forces that pull at most twice as much as gravity must not
/// close it in this step, nor bring it deeper than half a millimetre by the middle of the next.
#[test]
fn a_gap_that_a_fall_at_twice_gravity_leaves_open_is_left_out() {
    let longest = 8e-3;
    for (speed, half, is_of_this_step) in [(0.01, 1e-3, true), (0.1, 4e-3, false)] {
        let closed = |time: f64| speed * (time - half) + 9.81 * time * time;
        let now = closed(2.0 * half);
        let later = closed(2.0 * half + 0.5 * longest) - 0.5e-3;
        assert_eq!(now > later, is_of_this_step);
        let least = now.max(later);
        for (gap, is_open) in [(0.999 * least, false), (1.001 * least, true)] {
            let (found, room) = is_left_out(speed, half, gap);
            assert_eq!(found, is_open, "{gap} m at {speed} m/s");
            let gap = if is_open { gap } else { 1.0 };
            assert!((room - (gap - speed * half)).abs() < 1e-12, "{room} m");
        }
    }
}

/// What falls at twice gravity in a step is looked for, and no less than the scenario says; half of that is seen from
/// the step's middle.
#[test]
fn a_search_for_contacts_reaches_as_far_as_a_fall_in_its_step() {
    for (h, reach) in [(1e-3, 2e-4), (0.01, 2.0 * 9.81 * 1e-4)] {
        let (mut simulation, mut attempt) = (on_gears(0.0), Attempt::default());
        let travel = simulation.find_contacts(&mut attempt, h);
        assert!((travel - 2.0 * 9.81 * h * h).abs() < 1e-15, "{travel} m");
        assert!((attempt.sight - (reach - 0.5 * travel)).abs() < 1e-15);
    }
}

/// Half of the way that a part can make in the next step, as that looks in its middle, is the range, and half a
/// millimetre more.
#[test]
fn a_search_holds_until_a_part_may_be_half_a_millimetre_beyond_it() {
    let simulation = on_gears(0.0);
    for (sight, speed) in [
        (0.0, 0.0),
        (1e-3, 0.0),
        (2e-3, 0.4),
        (0.02, 1.5),
        (-1e-4, 0.3),
    ] {
        let time = simulation.known_for(sight, speed);
        let way = (speed + 2.0 * 9.81 * time) * time;
        assert!(
            time > 0.0 && (0.5 * way - sight - 0.5e-3).abs() < 1e-15,
            "{time} s"
        );
    }
}

/// Steps of one length look at all that they find.
#[test]
fn steps_of_a_given_length_leave_nothing_out() {
    let mut simulation = on_gears(0.0);
    simulation.step_rule = StepRule::Fixed(1e-3);
    let mut attempt = Attempt {
        contacts: vec![Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), 1.0)],
        ..Attempt::default()
    };
    assert!(simulation.leave_out(&mut attempt, 5e-4, 0.0).is_infinite());
    assert_eq!(attempt.contacts.len(), 1);
}

#[test]
fn contacts_that_a_step_leaves_out_stay_open_in_it() {
    for name in SCENARIOS {
        let mut simulation =
            Simulation::new(&ValidScenario::new(&shared(name)).expect("it is valid"));
        let mut left_out = 0;
        while simulation.time() < 2.0 {
            simulation.step().expect("it is finite");
            left_out += u32::from(simulation.attempt.room.is_finite());
            for sunk in simulation
                .contacts_now()
                .iter()
                .filter(|c| c.distance < -1e-6)
            {
                let is_it =
                    |l: &Contact| l.part == sunk.part && (l.point - sunk.point).length() < 5e-3;
                let at = simulation.time();
                assert!(simulation.loaded().iter().any(is_it), "{sunk:?} at {at} s");
            }
        }
        assert!(left_out > 50, "{left_out}");
    }
}
