//! What is judged: robots before obstacles, each with small variations from run to run.

use crawler2d_core::{GearWheel, Scenario, Surface, Terrain, Track, Wheel};

use crate::common::*;

/// A robot before an obstacle.
pub(crate) struct Scene {
    pub name: String,
    scenario: Scenario,
    /// Whether each run has a field of blocks of its own, up to this height [m].
    blocks: Option<f64>,
    seed: u64,
}

impl Scene {
    /// The same with contacts that give back a share of the impulses of impacts.
    pub(crate) fn giving_back(mut self, share: f64) -> Self {
        self.scenario.solver.restitution = share;
        self
    }

    /// The same before a step of another height [m].
    pub(crate) fn on_step(mut self, height: f64) -> Self {
        self.name = format!("{}, on a step of {height} m", self.name);
        self.scenario.terrain = step(height, 0.8);
        self
    }

    /// Run number `i`: speed by 10 % either way, any phase of the grousers, any approach of 0.1 m.
    pub(super) fn run(&self, i: u32) -> Scenario {
        let mut draw = Draw(self.seed.wrapping_mul(1_000_003).wrapping_add(u64::from(i)));
        let mut scenario = self.scenario.clone();
        scenario.drive.speed *= draw.between(0.9, 1.1);
        scenario.start.track_phase = draw.between(0.0, scenario.robot.outline.grouser_pitch);
        scenario.start.approach += draw.between(0.0, 0.1);
        if let Some(height) = self.blocks {
            scenario.terrain = blocks(&mut draw, height, friction(&scenario.terrain));
        }
        scenario
    }
}

fn friction(terrain: &Terrain) -> f64 {
    match terrain {
        Terrain::Points { surface, .. } => surface.friction.coefficient,
        _ => panic!("a field of blocks is a list of points"),
    }
}

/// Twenty blocks of 0.1 m, each of any height up to the given one.
fn blocks(draw: &mut Draw, height: f64, friction: f64) -> Terrain {
    let mut points = vec![[-5.0, 0.0]];
    for i in 0..20 {
        let y = draw.between(0.0, height);
        points.extend([[0.1 * f64::from(i), y], [0.1 * f64::from(i + 1), y]]);
        if i == 0 {
            points.insert(1, [0.0, 0.0]);
        }
    }
    points.extend([[2.0, 0.0], [8.0, 0.0]]);
    Terrain::Points {
        points,
        goal: 0.75,
        surface: Surface::sharp(friction),
        segment_friction: None,
    }
}

/// Scenes chosen because robots often fail in them.
pub(crate) fn fixed_scenes() -> Vec<Scene> {
    let scene = |name: &str, text: &str, blocks, seed| Scene {
        name: name.to_owned(),
        scenario: Scenario::from_json(text).expect("the scene is valid"),
        blocks,
        seed,
    };
    macro_rules! file {
        ($name:literal) => {
            include_str!(concat!(
                "../../../../tests/scenarios/judge_",
                $name,
                ".json"
            ))
        };
    }
    vec![
        scene("3 gears, step of 0.15 m", file!("gear3_step"), None, 1),
        scene("3 gears, Engineer, step", file!("engineer3_step"), None, 2),
        scene("5 gears, Engineer, step", file!("engineer5_step"), None, 3),
        scene("3 gears, bar of 10 mm", file!("gear3_bar"), None, 4),
        scene(
            "3 gears, blocks up to 0.15 m",
            file!("gear3_blocks"),
            Some(0.15),
            5,
        ),
    ]
}

/// A track and a ground drawn from a seed.
pub(crate) fn drawn_scene(seed: u64) -> Scene {
    let mut draw = Draw(seed);
    let mut scenario = engineer();
    let wheel = if draw.unit() < 0.7 {
        Wheel::Gear(GearWheel {
            grouser_count: Some(6 + (draw.unit() * 7.0) as u32),
            grouser_height: None,
            tip_thickness: None,
            base_thickness: None,
            phase_fraction: draw.unit(),
        })
    } else {
        Wheel::Round
    };
    scenario.robot.track = match (draw.unit() * 4.0) as u32 {
        0 => circumferential(20 + 4 * (draw.unit() * 3.0) as u32, wheel),
        _ => line_of(3 + (draw.unit() * 4.0) as u32, wheel),
    };
    if let Track::Circumferential(track) = &mut scenario.robot.track
        && let Wheel::Gear(gear) = &mut track.wheel
    {
        gear.grouser_count = None;
    }
    scenario.robot.drivetrain.max_acceleration = 1.0;
    scenario.robot.center_of_mass[0] = draw.between(-0.03, 0.05);
    scenario.start.approach = 0.05;
    scenario.duration = 8.0;
    scenario.criteria.clear_time = 100.0;
    let (friction, height, edge_radius) = (draw.between(0.6, 1.0), draw.between(0.05, 0.12), 0.0);
    let (kind, mut field) = ((draw.unit() * 5.0) as u32, None);
    scenario.terrain = match kind {
        0 => step(height, friction),
        1 => Terrain::Barrier {
            height,
            thickness: draw.between(0.01, 0.2),
            surface: Surface::rounded(edge_radius, friction),
        },
        2 => Terrain::Ridge {
            height,
            edge_angle: draw.between(0.6, 2.0),
            surface: Surface::rounded(edge_radius, friction),
        },
        3 => Terrain::Stairs {
            count: 3,
            rise: 0.8 * height,
            run: draw.between(0.15, 0.3),
            surface: Surface::rounded(edge_radius, friction),
        },
        _ => {
            field = Some(height);
            blocks(&mut draw, height, friction)
        }
    };
    scenario.goal = Some(0.3);
    let wheels = match &scenario.robot.track {
        Track::Line(t) => format!("line of {}", t.count),
        Track::Circumferential(t) => format!("{} all round", t.count),
        _ => unreachable!("no other track is drawn"),
    };
    let (shape, ground) = (
        if matches!(wheel_of(&scenario), Wheel::Round) {
            "round"
        } else {
            "gear"
        },
        ["step", "barrier", "ridge", "stairs", "blocks"][kind.min(4) as usize],
    );
    Scene {
        name: format!("seed {seed}: {wheels} {shape}, {ground} of {height:.3} m"),
        scenario,
        blocks: field,
        seed,
    }
}

fn wheel_of(scenario: &Scenario) -> &Wheel {
    match &scenario.robot.track {
        Track::Line(t) => &t.wheel,
        Track::Circumferential(t) => &t.wheel,
        _ => unreachable!("no other track is drawn"),
    }
}
