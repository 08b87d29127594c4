//! A snapshot with correct head and digest may still hold a state that no simulation can reach.

use super::*;
use crate::contact::Contact;

/// [m] How far beyond the ground a robot may be.
const FAR: f64 = 1e6;

/// A simulation, and the contents of its snapshot.
struct Genuine {
    simulation: Simulation,
    rest: Vec<u8>,
}

impl Genuine {
    fn new() -> Self {
        let simulation = busy();
        let snapshot = simulation.snapshot().expect("our own dynamics");
        let body = &snapshot[MAGIC.len()..snapshot.len() - DIGEST];
        let image: Image = postcard::from_bytes(body).expect("it was just made");
        let rest = image.rest;
        Self { simulation, rest }
    }

    fn moment(&self) -> Moment {
        postcard::from_bytes(&self.rest).expect("it was just made")
    }

    /// Whether a moment with one change is accepted.
    fn fits(&self, change: impl Fn(&mut Moment)) -> bool {
        let mut moment = self.moment();
        change(&mut moment);
        self.simulation.fits(&moment)
    }
}

/// A contact that no robot here has.
fn of_nobody() -> Contact {
    Contact {
        number: 999,
        ..Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), -0.001)
    }
}

type Spoil = fn(&mut Moment);

/// Each spoils one thing.
const SPOILS: [(&str, Spoil); 16] = [
    ("time", |m| m.time += 1.0),
    ("step_control", |m| m.step_control = StepControl::never()),
    ("last step", |m| m.free = f64::NAN),
    ("velocity before it", |m| m.before.velocity.x = f64::NAN),
    ("x", |m| m.state.center.x = f64::NAN),
    ("y", |m| m.state.center.y = f64::NAN),
    ("endless height", |m| m.state.center.y = f64::INFINITY),
    ("endless depth", |m| m.state.center.y = f64::NEG_INFINITY),
    ("command", |m| m.command = f64::NAN),
    ("set point", |m| m.set_point = f64::NAN),
    ("driver", |m| m.driver.hold(0, f64::NAN)),
    ("velocity", |m| m.state.velocity.x = f64::NAN),
    ("a flipper less", |m| m.state.flippers.clear()),
    ("impulses of a robot without flippers", |m| {
        let mut scenario = Scenario::from_json(&m.scenario).expect("it was just made");
        scenario.robot.flippers = None;
        let other = Simulation::new(&Checked::new(&scenario).expect("the scenario is valid"));
        m.impulses = other.dynamics.impulses();
    }),
    ("dents", |m| m.dents = Dents::of(&[of_nobody()])),
    ("seen", |m| m.seen.max_angle = f64::NAN),
];

#[test]
fn a_moment_with_one_thing_spoilt_does_not_fit() {
    let genuine = Genuine::new();
    assert!(genuine.fits(|_| {}));
    for (what, spoil) in SPOILS {
        assert!(!genuine.fits(spoil), "{what}");
    }
}

#[test]
fn a_snapshot_of_a_moment_that_does_not_fit_is_refused() {
    let genuine = Genuine::new();
    for (what, spoil) in SPOILS {
        let mut moment = genuine.moment();
        spoil(&mut moment);
        let refusal = refusal(&sealed(&Image {
            build: BUILD_ID.to_owned(),
            rest: bytes(&moment),
        }));
        assert!(refusal.contains("must hold a state that its own"), "{what}");
    }
}

#[test]
fn a_moment_fits_up_to_the_latest_time_and_the_most_steps() {
    let genuine = Genuine::new();
    let at = |time: f64| {
        genuine.fits(|m| {
            m.time = time;
            m.seen = Seen::from(time);
        })
    };
    assert!(at(0.0) && at(1e9_f64.next_down()));
    assert!(!at(1e9) && !at(-1.0) && !at(f64::NAN));
    let after = |steps: u64| genuine.fits(|m| m.steps = steps);
    assert!(after(1 << 50));
    assert!(!after((1 << 50) + 1));
}

#[test]
fn a_moment_fits_a_thousand_kilometres_beyond_its_ground_and_above_it() {
    let genuine = Genuine::new();
    let ground = &genuine.simulation.ground;
    let (low, high) = ground.extent();
    let x = |x: f64| genuine.fits(|m| m.state.center.x = x);
    assert!(x(low - FAR));
    assert!(!x((low - FAR).next_down()));
    assert!(x(high + FAR));
    assert!(!x((high + FAR).next_up()));

    let y = |y: f64| genuine.fits(|m| m.state.center.y = y);
    let top = FAR + ground.highest();
    assert!(top > FAR, "the ground is not level");
    assert!(y(top.next_down()));
    assert!(!y(top));
    assert!(!y(top.next_up()));
    assert!(y(-2.0 * FAR), "what falls");
}

#[test]
fn a_moment_fits_up_to_the_speed_of_the_drivetrain_either_way() {
    let genuine = Genuine::new();
    let fastest = genuine.simulation.scenario.robot.drivetrain.max_speed;
    for side in [1.0, -1.0] {
        let both = |speed: f64| {
            let command = genuine.fits(|m| m.command = side * speed);
            let set_point = genuine.fits(|m| m.set_point = side * speed);
            [command, set_point]
        };
        assert_eq!(both(fastest), [true; 2], "to {side}");
        assert_eq!(both(fastest.next_up()), [false; 2], "to {side}");
    }
}
