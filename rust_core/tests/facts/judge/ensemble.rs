//! Many runs of one scene, by the judge and by the core, and how far apart they are.

use crawler2d_core::{Ground, Reading, Scenario, Simulation};

use super::motion::{Judge, Settings};
use super::scenes::Scene;
use super::statistics::{difference, fisher, median, wilson};
use crate::common::checked;

/// How one run went.
struct Verdict {
    /// Whether the chassis passed the goal.
    passed: bool,
    /// [m] Where it was then, or at the end.
    x: f64,
    /// [m] Deepest overlap; the core has its own measure of it.
    deepest: f64,
}

/// [m] What the chassis frame must pass.
fn goal(scenario: &Scenario) -> f64 {
    let ground =
        Ground::new(&scenario.terrain, scenario.robot.gauge).expect("the ground can be built");
    ground.goal_of(scenario)
}

fn by_judge(scenario: &Scenario, settings: Settings) -> Verdict {
    let (goal, tipped) = (goal(scenario), scenario.criteria.tip_over_angle);
    let mut judge = Judge::new(scenario, settings);
    // Looked at every millisecond, as in the core.
    for _ in 0..(scenario.duration / 1e-3).round() as u64 {
        judge.advance(1e-3);
        if judge.position().x > goal || judge.angle().abs() > tipped {
            break;
        }
    }
    let x = judge.position().x;
    Verdict {
        passed: x > goal,
        x,
        deepest: judge.deepest,
    }
}

fn by_core(scenario: &Scenario) -> Verdict {
    let end = end_by_core(scenario);
    Verdict {
        passed: end.position.x > goal(scenario),
        x: end.position.x,
        deepest: 0.0,
    }
}

/// Where the core's run ends: past the goal, at the end of its time or in a stop.
fn end_by_core(scenario: &Scenario) -> Reading {
    let goal = goal(scenario);
    let mut simulation = Simulation::new(&checked(scenario));
    loop {
        let reading = simulation.reading();
        let is_last = simulation.is_over() || simulation.time() >= scenario.duration;
        if reading.position.x > goal || is_last {
            return reading;
        }
        simulation
            .step_until(scenario.duration)
            .expect("the state stays finite");
    }
}

/// Runs that the core ends at a standstill, and how many of these stand still in the judge, too, when it
/// is put there at rest.
pub(crate) fn standstills(scene: &Scene, runs: u32) -> (u32, u32) {
    // About as stiff as the core's contacts, so that the overlap that it comes to rest with bears the
    // same load: springs that hold more push the robot off.
    let d = Settings::default();
    let settings = Settings {
        time_step: d.time_step / 4.0,
        stiffness: d.stiffness * 16.0,
        ..d
    };
    let (mut found, mut kept) = (0, 0);
    for i in 0..runs {
        let scenario = scene.run(i);
        let end = end_by_core(&scenario);
        if end.velocity.length() > 1e-4 {
            continue;
        }
        let mut judge = Judge::at_rest(&scenario, settings, &end);
        judge.advance(1.0);
        found += 1;
        kept += u32::from((judge.position() - end.position).length() < 1e-3);
    }
    (found, kept)
}

/// One scene, judged, and run by something else.
pub(crate) struct Tally {
    judge: Vec<Verdict>,
    other: Vec<Verdict>,
}

impl Tally {
    /// The judge and the core.
    pub(crate) fn of(scene: &Scene, runs: u32, settings: Settings) -> Self {
        let scenarios: Vec<Scenario> = (0..runs).map(|i| scene.run(i)).collect();
        Self {
            judge: scenarios.iter().map(|s| by_judge(s, settings)).collect(),
            other: scenarios.iter().map(by_core).collect(),
        }
    }

    /// The judge, and the judge with half the step and four times the stiffness.
    pub(crate) fn of_refined(scene: &Scene, runs: u32, settings: Settings) -> Self {
        let finer = Settings {
            time_step: 0.5 * settings.time_step,
            stiffness: 4.0 * settings.stiffness,
            ..settings
        };
        let scenarios: Vec<Scenario> = (0..runs).map(|i| scene.run(i)).collect();
        Self {
            judge: scenarios.iter().map(|s| by_judge(s, settings)).collect(),
            other: scenarios.iter().map(|s| by_judge(s, finer)).collect(),
        }
    }

    /// [m] Deepest overlap in any judged run.
    pub(crate) fn deepest(&self) -> f64 {
        self.judge.iter().map(|v| v.deepest).fold(0.0, f64::max)
    }

    fn hits(verdicts: &[Verdict]) -> u32 {
        verdicts.iter().filter(|v| v.passed).count() as u32
    }

    /// How many runs passed: the judge's, the other's.
    pub(crate) fn passes(&self) -> [u32; 2] {
        [&self.judge, &self.other].map(|verdicts| Self::hits(verdicts))
    }

    /// Probability that equal rates differ by as much.
    pub(crate) fn chance(&self) -> f64 {
        fisher(
            Self::hits(&self.other),
            Self::hits(&self.judge),
            self.judge.len() as u32,
        )
    }

    /// One line of text.
    pub(crate) fn report(&self) -> String {
        let runs = self.judge.len() as u32;
        let of = |verdicts: &[Verdict]| {
            let hits = Self::hits(verdicts);
            let [low, high] = wilson(hits, runs);
            let places: Vec<f64> = verdicts.iter().map(|v| v.x).collect();
            let x = median(&places);
            format!("{hits} of {runs} [{low:.2}, {high:.2}], median x {x:.3} m")
        };
        let [low, high] = difference(Self::hits(&self.other), Self::hits(&self.judge), runs);
        format!(
            "judge {}; other {}; difference [{low:+.2}, {high:+.2}], chance {:.3}",
            of(&self.judge),
            of(&self.other),
            self.chance()
        )
    }
}

/// How many of these runs of a scene pass in the core.
pub(crate) fn core_passes(scene: &Scene, runs: u32) -> u32 {
    (0..runs)
        .map(|i| u32::from(by_core(&scene.run(i)).passed))
        .sum()
}
