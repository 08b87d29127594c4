//! Scenarios that the tests start from, and small tools to run them.

use crawler2d_core::{
    BeltTrack, Cancel, ChainMechanism, CircumferentialWheels, Climb, Ends, Engine, Flippers,
    ForceSupport, ForceTrack, Gait, GearWheel, Ground, GrouserBeltTrack, Hold, HybridWheels,
    LineOfWheels, Outcome, Profile, Record, Run, Scenario, SegmentalTrack, ShoeShape, Simulation,
    Surface, Terrain, Track, ValidScenario, Wheel, outcome_of, simulate,
};

/// [m/s^2] The gravity of every scenario here.
pub(crate) const G: f64 = 9.81;

/// Whether there is time for many more cases: `make soak` says so.
pub(crate) fn is_soak() -> bool {
    std::env::var_os("CRAWLER2D_SOAK").is_some()
}

/// How many cases to try: few, or many where there is time.
pub(crate) fn few_or_many(few: u32, many: u32) -> u32 {
    if is_soak() { many } else { few }
}

/// The Engineer with a belt before a step, as the Python presets write it.
pub(crate) fn engineer() -> Scenario {
    let text = include_str!("../../../tests/scenarios/engineer_belt_step.json");
    Scenario::from_json(text).expect("the shared scenario is valid")
}

/// A scenario as it comes out of the door.
pub(crate) fn checked(scenario: &Scenario) -> ValidScenario {
    ValidScenario::new(scenario).expect("the scenario is valid")
}

/// The outcome if a simulation ended now.
pub(crate) fn outcome_now(simulation: &Simulation) -> Outcome {
    outcome_of(simulation, &Cancel::default()).expect("the state stays finite")
}

/// The same on a track.
pub(crate) fn engineer_on(track: Track) -> Scenario {
    let mut scenario = engineer();
    scenario.robot.track = track;
    scenario
}

/// The same with its arms, along the chassis, in place of as much of its mass. Their moment of inertia is added:
/// the chassis alone has hardly as much as arms and shoes together.
pub(crate) fn with_flippers(ends: Ends, track: Track) -> Scenario {
    let mut scenario = engineer_on(track);
    let pairs = if ends == Ends::Both { 2.0 } else { 1.0 };
    let about = 0.34 * 0.34 / 12.0 + (0.1825 + 0.17) * (0.1825 + 0.17) + 0.02 * 0.02;
    scenario.robot.moment_of_inertia += pairs * 2.0 * 0.775 * about;
    scenario.robot.flippers = Some(Flippers {
        length: 0.34,
        root_radius: 0.064,
        tip_radius: 0.037,
        mass: 0.775,
        ends,
        angle: 0.0,
        rate_limit: 1.0,
        torque_limit: 30.0,
        rotor_inertia: 0.0,
        self_locking: false,
        track: None,
    });
    scenario
}

/// The same with arms at both ends at an angle [rad].
pub(crate) fn on_arms(angle: f64, track: Track) -> Scenario {
    let mut scenario = with_flippers(Ends::Both, track);
    flippers(&mut scenario).angle = angle;
    scenario
}

pub(crate) fn hold(angle: f64) -> Gait {
    Gait::Hold(Hold {
        angle,
        schedule: None,
        front: None,
        rear: None,
    })
}

/// The gait that the studies use.
pub(crate) fn climb() -> Gait {
    Gait::Climb(Climb {
        reach_angle: 0.8,
        sweep_angle: 0.0,
        push_angle: -0.8,
        level_angle: 0.1,
    })
}

pub(crate) fn flippers(scenario: &mut Scenario) -> &mut Flippers {
    scenario.robot.flippers.as_mut().expect("it has flippers")
}

/// Robots of which more moves over the chassis than wheels and a smooth belt: grousers, shoes, arms. Arms
/// stand up, or the robot stands on them.
pub(crate) fn articulated() -> Vec<(&'static str, Scenario)> {
    let (up, down) = (0.6, -0.3);
    vec![
        ("belt with grousers", engineer_on(grouser_belt())),
        ("chain", engineer_on(segmental(None))),
        ("chain on a sprocket", engineer_on(sprocketed(None))),
        ("belt, arms up", on_arms(up, belt())),
        ("belt, on arms", on_arms(down, belt())),
        ("line of 5, on arms", on_arms(down, line(5))),
        (
            "gear wheels, on arms",
            on_arms(down, line_of(3, paper_gear())),
        ),
        ("belt with grousers, on arms", on_arms(down, grouser_belt())),
        ("chain, arms up", on_arms(up, segmental(None))),
        ("chain, on arms", on_arms(down, segmental(None))),
        (
            "chain on a sprocket, on arms",
            on_arms(down, sprocketed(None)),
        ),
        ("force, on arms", on_arms(down, force())),
    ]
}

/// Steps of a fixed length [s], for impacts: where they fall in a step of an accuracy depends on its rounding, and the
/// next steps on that.
pub(crate) fn fixed(scenario: &mut Scenario, time_step: f64) {
    (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(time_step));
}

/// The same, moved by rapier's bodies, joints and motors, at the step that is usual there.
pub(crate) fn in_rapier(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.solver.engine = Engine::Rapier;
    fixed(&mut scenario, 1.25e-4);
    scenario
}

/// Whether grousers or shoes of a robot of that name strike the ground: impacts pass differences of rounding on.
pub(crate) fn strikes(name: &str) -> bool {
    ["gear", "grousers", "chain"]
        .iter()
        .any(|word| name.contains(word))
}

pub(crate) fn is_on_chain(scenario: &Scenario) -> bool {
    matches!(scenario.robot.track, Track::Segmental(_))
}

/// The same without a belly, slow and strong: what the quasi-static oracles assume.
pub(crate) fn slow_and_strong() -> Scenario {
    let mut scenario = engineer();
    scenario.robot.belly = None;
    scenario.robot.drivetrain.max_torque = 100.0;
    scenario.robot.drivetrain.max_acceleration = 1.0;
    scenario.drive.speed = 0.05;
    scenario.start.approach = 0.02;
    scenario.duration = 60.0;
    scenario
}

pub(crate) fn line(count: u32) -> Track {
    line_of(count, Wheel::Round)
}

/// Round wheels in a row, 14 more all round, or as many of any size anywhere between the ends of the track.
pub(crate) fn drawn_wheels(draw: &mut Draw, count: u32) -> Track {
    match draw.between(0.0, 3.0) as u32 {
        0 => line(count),
        1 => circumferential(14 + count, Wheel::Round),
        _ => {
            let mut wheel = |_| {
                let x = draw.between(-0.1825, 0.1825);
                [x, draw.between(-0.03, 0.03), draw.between(0.02, 0.0675)]
            };
            let mut placements: Vec<[f64; 3]> = (0..count).map(&mut wheel).collect();
            placements.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let wheel = Wheel::Round;
            Track::Hybrid(HybridWheels { placements, wheel })
        }
    }
}

pub(crate) fn line_of(count: u32, wheel: Wheel) -> Track {
    Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel,
        as_track: true,
    })
}

/// A gear wheel with all its figures from the outline.
pub(crate) fn gear(phase_fraction: f64) -> Wheel {
    Wheel::Gear(GearWheel {
        grouser_count: None,
        grouser_height: None,
        tip_thickness: None,
        base_thickness: None,
        phase_fraction,
    })
}

/// The paper's gear wheel.
pub(crate) fn paper_gear() -> Wheel {
    gear(1.0 / 3.0)
}

/// Wheels all round, touching.
pub(crate) fn circumferential(count: u32, wheel: Wheel) -> Track {
    Track::Circumferential(CircumferentialWheels {
        count,
        wheel_radius: None,
        wheel,
    })
}

/// Two large wheels with small ones between them below.
pub(crate) fn hybrid(wheel: Wheel) -> Track {
    let small = |x: f64| [x, -0.034, 0.03];
    let placements = vec![
        [-0.1825, 0.0, 0.064],
        small(-0.07),
        small(0.0),
        small(0.07),
        [0.1825, 0.0, 0.064],
    ];
    Track::Hybrid(HybridWheels { placements, wheel })
}

pub(crate) fn belt() -> Track {
    Track::Belt(BeltTrack {})
}

pub(crate) fn grouser_belt() -> Track {
    Track::GrouserBelt(GrouserBeltTrack {
        grouser_count: None,
    })
}

/// A chain of so many shoes, or of as many as the outline's pitch asks for.
pub(crate) fn segmental(shoe_count: Option<u32>) -> Track {
    Track::Segmental(SegmentalTrack {
        shoe_count,
        shoe_shape: ShoeShape::Rectangle,
        plate_thickness: None,
        pre_tension: None,
        mechanism: ChainMechanism::Guide,
        tensioner_stiffness: None,
        tensioner_damping: None,
        pin_stiffness: 0.0,
        pin_damping: 0.0,
        road_wheel_count: None,
        return_roller_count: None,
    })
}

/// The same round a sprocket.
pub(crate) fn sprocketed(shoe_count: Option<u32>) -> Track {
    match segmental(shoe_count) {
        Track::Segmental(track) => Track::Segmental(SegmentalTrack {
            mechanism: ChainMechanism::Sprocket,
            ..track
        }),
        other => other,
    }
}

pub(crate) fn force() -> Track {
    Track::Force(ForceTrack {
        support: ForceSupport::Skids,
        skid_friction: 0.0,
        wheel_count: 5,
    })
}

pub(crate) fn force_on_wheels() -> Track {
    Track::Force(ForceTrack {
        support: ForceSupport::Wheels,
        skid_friction: 0.0,
        wheel_count: 5,
    })
}

pub(crate) fn step(height: f64, friction: f64) -> Terrain {
    Terrain::Step {
        height,
        surface: Surface::sharp(friction),
    }
}

/// One straight slope through the origin, rising forwards if the angle is positive.
pub(crate) fn slope(angle: f64, friction: f64) -> Terrain {
    let (s, c) = libm::sincos(angle);
    let points = vec![[-20.0 * c, -20.0 * s], [20.0 * c, 20.0 * s]];
    Terrain::Points {
        points,
        goal: 19.0 * c,
        surface: Surface::sharp(friction),
        segment_friction: None,
    }
}

pub(crate) fn run(scenario: &Scenario) -> Run {
    simulate(&checked(scenario), Record::default()).expect("the scenario runs")
}

pub(crate) fn summary(scenario: &Scenario) -> Run {
    simulate(&checked(scenario), Record::summary()).expect("the scenario runs")
}

/// Advances a fresh simulation and hands it over.
pub(crate) fn after(scenario: &Scenario, duration: f64) -> Simulation {
    let mut simulation = Simulation::new(&checked(scenario));
    advance(&mut simulation, duration);
    simulation
}

pub(crate) fn advance(simulation: &mut Simulation, duration: f64) {
    simulation
        .advance(duration)
        .expect("the state stays finite");
}

/// The largest x in [low, high] for which `holds` is true, to a relative 1e-4; it must hold at low only.
pub(crate) fn bisect(mut low: f64, mut high: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
    assert!(
        holds(low) && !holds(high),
        "the boundary lies outside [{low}, {high}]"
    );
    while high - low > 1e-4 * high {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// A small generator of test cases: the printed seed makes every case again (splitmix64).
pub(crate) struct Draw(pub u64);

impl Draw {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// Sums of the contact forces along x and y, and of their moments about a point.
pub(crate) fn contact_sums(simulation: &Simulation, x: f64, y: f64) -> (f64, f64, f64) {
    let c = simulation.contact_table();
    let (mut fx, mut fy, mut moment) = (0.0, 0.0, 0.0);
    for i in 0..c.time.len() {
        let (nx, ny) = (c.normal_x[i], c.normal_y[i]);
        let (px, py) = (
            c.normal_force[i] * nx + c.friction_force[i] * ny,
            c.normal_force[i] * ny - c.friction_force[i] * nx,
        );
        fx += px;
        fy += py;
        moment += (c.x[i] - x) * py - (c.y[i] - y) * px;
    }
    (fx, fy, moment)
}

/// How far [m, rad] two equal lanes kept apart and the lumped robot are from each other at most, over half a
/// second: at 0.2 m/s^2 it ends 0.02 m before the step is reached. In pose, and in the speed of the track.
pub(crate) fn equal_lanes_off(scenario: &Scenario) -> (f64, f64) {
    let ground = equal_lanes(&scenario.terrain);
    let mut apart = Simulation::on_ground(scenario, ground).expect("it fits");
    let mut lumped = Simulation::new(&checked(scenario));
    let (mut pose, mut speed) = (0.0_f64, 0.0_f64);
    for _ in 0..500 {
        advance(&mut apart, 1e-3);
        advance(&mut lumped, 1e-3);
        let (a, b) = (apart.reading(), lumped.reading());
        pose = pose.max((a.position - b.position).length());
        pose = pose.max((a.chassis_angle - b.chassis_angle).abs());
        speed = speed.max((a.track_speed - b.track_speed).abs());
    }
    (pose, speed)
}

fn profile(terrain: &Terrain) -> (Profile, f64) {
    let mut ground = Ground::new(terrain, 0.2).expect("a ground");
    (ground.lanes.remove(0), ground.goal)
}

/// The same profile thrice.
pub(crate) fn equal_lanes(terrain: &Terrain) -> Ground {
    let (lane, goal) = profile(terrain);
    let tracks = [lane.clone(), lane.clone()];
    Ground::apart(tracks, Some(lane), goal).expect("they overlap")
}

/// A robot on its rear wheel, without friction, whose front wheel comes down, and what a plastic impact leaves of its turn:
/// (I - m a^2) / (I + m a^2), with the wheels at the distance a from the centre of mass.
pub(crate) fn falling_on_its_front_wheel() -> (Scenario, f64) {
    let mut scenario = engineer_on(line(2));
    scenario.robot.belly = None;
    scenario.robot.center_of_mass = [0.0, 0.0];
    scenario.robot.moment_of_inertia = 2.5;
    scenario.terrain = slope(0.0, 0.0);
    scenario.drive.speed = 0.0;
    scenario.start.angle = 0.1;
    let (robot, inertia) = (&scenario.robot, scenario.robot.moment_of_inertia);
    let of_mass = robot.mass * (0.5 * robot.outline.axle_distance()).powi(2);
    let kept = (inertia - of_mass) / (inertia + of_mass);
    (scenario, kept)
}
