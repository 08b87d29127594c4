//! A snapshot loses nothing, and every part of it affects what comes next. One with correct head and digest may still
//! hold a state that no simulation can reach.

use super::*;
use crate::contact::Contact;
use crate::dynamics::FlipperCommand;
use crate::geometry::Vector;
use crate::scenario::{
    BeltTrack, End, Ends, Flippers, LineOfWheels, Surface, Terrain, Track, Wheel,
};
use crate::scenario::{Scenario, shared};

/// The Engineer with front arms, on three wheels in front of a post, after some time.
fn on_wheels() -> Simulation {
    let mut scenario = shared("engineer_belt_step");
    scenario.robot.track = Track::Line(LineOfWheels {
        count: 3,
        wheel_radius: None,
        wheel: Wheel::Round,
        as_track: true,
    });
    scenario.robot.flippers = Some(Flippers {
        length: 0.34,
        root_radius: 0.064,
        tip_radius: 0.037,
        mass: 0.775,
        ends: Ends::Front,
        angle: 0.6,
        rate_limit: 1.0,
        torque_limit: 30.0,
        rotor_inertia: 0.0,
        self_locking: false,
        track: None,
    });
    scenario.terrain = Terrain::Barrier {
        height: 0.03,
        thickness: 0.01,
        surface: Surface::sharp(0.9),
    };
    let mut simulation =
        Simulation::new(&ValidScenario::new(&scenario).expect("the scenario is valid"));
    // The post is now in the gap between the middle and the front wheel.
    let x = simulation.reading().position.x;
    simulation.state.center.x -= x + 0.085;
    advance(&mut simulation);
    simulation
}

/// A simulation in which every part of the state differs from that at the start.
fn busy() -> Simulation {
    let wheels = on_wheels();
    let mut variant = wheels.scenario().clone();
    variant.robot.track = Track::Belt(BeltTrack {});
    let mut belt = wheels.branch(&ValidScenario::new(&variant).expect("the variant is valid"));
    // Backwards, so that it makes a difference at once.
    belt.set_speed(-0.3).expect("within the drivetrain's");
    belt.set_push(20.0).expect("within the limits");
    let arms = belt.command_flippers(End::Front, FlipperCommand::Angle(0.2));
    arms.expect("it has arms there");
    advance(&mut belt);
    belt
}

fn advance(simulation: &mut Simulation) {
    for _ in 0..20 {
        simulation.step().expect("the state stays finite");
    }
}

/// The bits of the next steps, as users see them.
fn future(mut simulation: Simulation) -> Vec<[u64; 7]> {
    let mut look = || {
        simulation.step().expect("the state stays finite");
        let now = simulation.reading();
        let observed = &simulation.monitor.observed;
        let path = observed.path_length;
        let Vector { x, y } = now.position;
        let angles: f64 = simulation.flipper_angles().sum();
        [
            now.time,
            x,
            y,
            now.chassis_angle,
            now.track_speed,
            angles,
            path,
        ]
        .map(f64::to_bits)
    };
    (0..20).map(|_| look()).collect()
}

#[test]
fn a_simulation_goes_on_from_its_snapshot_with_the_same_bits() {
    let whole = busy();
    let snapshot = whole.snapshot().expect("our own dynamics");
    let copy = Simulation::from_snapshot(&snapshot).expect("it was just made");
    assert!(copy.snapshot().expect("our own dynamics") == snapshot);
    assert_eq!(future(copy), future(whole));
}

#[test]
fn the_number_is_the_same_after_a_snapshot() {
    let numbers = |mut simulation: Simulation| {
        let mut look = || {
            simulation.step().expect("the state stays finite");
            let loaded = simulation.loaded().iter();
            loaded.map(|l| l.number).collect::<Vec<u64>>()
        };
        (0..300).map(|_| look()).collect::<Vec<_>>()
    };
    // Its wheels come down on the post and off it; each contact has its own number.
    let mut whole = on_wheels();
    whole.advance(0.1).expect("the state stays finite");
    let copy = Simulation::from_snapshot(&whole.snapshot().expect("our own dynamics"))
        .expect("it was just made");
    let all = numbers(whole);
    let given = all.iter().flatten().max();
    assert!(given > all[0].iter().max(), "none comes: {all:?}");
    assert_eq!(numbers(copy), all);
}

#[test]
fn whatever_a_snapshot_forgot_would_change_what_comes_next() {
    type Forget = fn(&mut Simulation, Simulation);
    let all: [(&str, Forget); 10] = [
        ("time", |s, fresh| {
            (s.time, s.last.began) = (fresh.time, fresh.time);
        }),
        ("step_control", |s, fresh| {
            s.step_control = fresh.step_control;
        }),
        ("command", |s, fresh| {
            s.commands.speed = fresh.commands.speed;
        }),
        ("driver", |s, fresh| {
            s.commands.driver = fresh.commands.driver;
        }),
        ("set point", |s, fresh| s.set_point = fresh.set_point),
        ("push", |s, fresh| s.commands.push = fresh.commands.push),
        ("state", |s, fresh| s.state = fresh.state),
        ("impulses", |s, fresh| {
            s.dynamics.start_from(fresh.dynamics.impulses());
        }),
        ("dents", |s, fresh| s.dents = fresh.dents),
        ("what was observed", |s, fresh| {
            s.monitor.observed = fresh.monitor.observed;
        }),
    ];
    let whole = busy();
    let snapshot = whole.snapshot().expect("our own dynamics");
    let expected = future(whole);
    for (what, forget) in all {
        let mut copy = Simulation::from_snapshot(&snapshot).expect("it was just made");
        let fresh =
            Simulation::new(&ValidScenario::new(copy.scenario()).expect("the scenario is valid"));
        forget(&mut copy, fresh);
        assert!(
            copy.snapshot().expect("our own dynamics") != snapshot,
            "no {what} in it"
        );
        assert!(future(copy) != expected, "without its {what}");
    }
}

/// The message with which bytes are rejected.
fn refusal(bytes: &[u8]) -> String {
    match Simulation::from_snapshot(bytes) {
        Err(Error::Scenario(e)) => {
            assert_eq!(e.path, "snapshot");
            format!("{} {}", e.value, e.rule)
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("they were taken"),
    }
}

/// A snapshot with correct head and digest.
fn sealed(payload: &Payload) -> Vec<u8> {
    let mut snapshot = MAGIC.to_vec();
    snapshot.extend(bytes(payload));
    let digest = Sha256::digest(&snapshot);
    snapshot.extend_from_slice(&digest);
    snapshot
}

#[test]
fn bytes_that_are_no_whole_snapshot_are_refused() {
    let snapshot = on_wheels().snapshot().expect("our own dynamics");
    assert!(refusal(b"").contains("must be a snapshot of crawler2d"));
    assert!(refusal(&snapshot[1..]).contains("must be a snapshot of crawler2d"));
    for length in [MAGIC.len(), MAGIC.len() + DIGEST, snapshot.len() - 1] {
        assert!(refusal(&snapshot[..length]).contains("must be complete and unchanged"));
    }
    for place in [MAGIC.len(), snapshot.len() / 2, snapshot.len() - 1] {
        let mut changed = snapshot.clone();
        changed[place] ^= 1;
        assert!(refusal(&changed).contains("must be complete and unchanged"));
    }
}

#[test]
fn a_snapshot_of_another_build_is_refused() {
    let payload = Payload {
        build: "another".to_owned(),
        rest: Vec::new(),
    };
    let refusal = refusal(&sealed(&payload));
    assert!(refusal.contains("a snapshot of build another"), "{refusal}");
    assert!(refusal.contains(BUILD_ID), "{refusal}");
}

/// [m] Allowed distance of a robot beyond the ground.
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
        let payload: Payload = postcard::from_bytes(body).expect("it was just made");
        let rest = payload.rest;
        Self { simulation, rest }
    }

    fn saved(&self) -> SavedState {
        postcard::from_bytes(&self.rest).expect("it was just made")
    }

    /// Whether a moment with one change is accepted.
    fn fits(&self, change: impl Fn(&mut SavedState)) -> bool {
        let mut saved = self.saved();
        change(&mut saved);
        self.simulation.fits(&saved)
    }
}

/// A contact that no robot here has.
fn of_nobody() -> Contact {
    Contact {
        number: 999,
        ..Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), -0.001)
    }
}

type Spoil = fn(&mut SavedState);

/// Each makes one thing invalid.
const SPOILS: [(&str, Spoil); 18] = [
    ("time", |m| m.time += 1.0),
    ("step_control", |m| m.step_control = StepControl::never()),
    ("last step", |m| m.last.free = f64::NAN),
    ("velocity before it", |m| {
        m.last.before.velocity.x = f64::NAN;
    }),
    ("range of the search", |m| m.last.sight = -1e-9),
    ("push", |m| {
        m.commands.push = m.commands.push.raised(f64::NAN, 0.0, 0.0);
    }),
    ("x", |m| m.state.center.x = f64::NAN),
    ("y", |m| m.state.center.y = f64::NAN),
    ("endless height", |m| m.state.center.y = f64::INFINITY),
    ("endless depth", |m| m.state.center.y = f64::NEG_INFINITY),
    ("command", |m| m.commands.speed = f64::NAN),
    ("set point", |m| m.set_point = f64::NAN),
    ("driver", |m| {
        m.commands.driver.take(0, FlipperCommand::Rate(f64::NAN));
    }),
    ("velocity", |m| m.state.velocity.x = f64::NAN),
    ("a flipper less", |m| m.state.flippers.clear()),
    ("impulses of a robot without flippers", |m| {
        let mut scenario = Scenario::from_json(&m.scenario).expect("it was just made");
        scenario.robot.flippers = None;
        let other = Simulation::new(&ValidScenario::new(&scenario).expect("the scenario is valid"));
        m.impulses = other.dynamics.impulses();
    }),
    ("dents", |m| m.dents = Dents::of(&[of_nobody()])),
    ("seen", |m| m.observed.max_angle = f64::NAN),
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
        let mut saved = genuine.saved();
        spoil(&mut saved);
        let refusal = refusal(&sealed(&Payload {
            build: BUILD_ID.to_owned(),
            rest: bytes(&saved),
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
            m.observed = Observations::from(time);
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
            let command = genuine.fits(|m| m.commands.speed = side * speed);
            let set_point = genuine.fits(|m| m.set_point = side * speed);
            [command, set_point]
        };
        assert_eq!(both(fastest), [true; 2], "to {side}");
        assert_eq!(both(fastest.next_up()), [false; 2], "to {side}");
    }
}
