//! Scenarios that the tests start from, and small tools to run them.

use crawler2d_core::{
    BeltTrack, ChainMechanism, CircumferentialWheels, ForceSupport, ForceTrack, GearWheel, Ground,
    GrouserBeltTrack, HybridWheels, LineOfWheels, Profile, Record, Run, Scenario, SegmentalTrack,
    ShoeShape, Simulation, Terrain, Track, Wheel, simulate,
};

/// [m/s^2] The gravity of every scenario here.
pub(crate) const G: f64 = 9.81;

/// The Engineer with a belt before a step, as the Python presets write it.
pub(crate) fn engineer() -> Scenario {
    let text = include_str!("../../../tests/scenarios/engineer_belt_step.json");
    Scenario::from_json(text).expect("the shared scenario is valid")
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

pub(crate) fn line_of(count: u32, wheel: Wheel) -> Track {
    Track::Line(LineOfWheels {
        count,
        wheel_radius: None,
        wheel,
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
        edge_radius: 0.0,
        friction,
    }
}

/// One straight slope through the origin, rising forwards if the angle is positive.
pub(crate) fn slope(angle: f64, friction: f64) -> Terrain {
    let (s, c) = libm::sincos(angle);
    let points = vec![[-20.0 * c, -20.0 * s], [20.0 * c, 20.0 * s]];
    Terrain::Points {
        points,
        goal: 19.0 * c,
        edge_radius: 0.0,
        friction,
    }
}

pub(crate) fn run(scenario: &Scenario) -> Run {
    simulate(scenario, Record::default()).expect("the scenario runs")
}

pub(crate) fn summary(scenario: &Scenario) -> Run {
    simulate(scenario, Record::summary()).expect("the scenario runs")
}

/// Advances a fresh simulation and hands it over.
pub(crate) fn after(scenario: &Scenario, duration: f64) -> Simulation {
    let mut simulation = Simulation::new(scenario).expect("the scenario is valid");
    advance(&mut simulation, duration);
    simulation
}

pub(crate) fn advance(simulation: &mut Simulation, duration: f64) {
    let steps = (duration / simulation.time_step()).round() as u64;
    for _ in 0..steps {
        simulation.step().expect("the state stays finite");
    }
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
