//! The scenes that the benchmarks time; tests and benchmarks share them.

use crawler2d_core::{LineOfWheels, Scenario, Terrain, TorqueSharing, Track, Wheel};

#[path = "../../rust_core/tests/facts/engine_world.rs"]
mod engine_world;

pub use engine_world::{EngineSettings, EngineWorld};

/// A robot before a step.
pub struct Scene {
    /// Name in the report.
    pub name: &'static str,
    /// Wheels, each with its own motor; none for a belt.
    pub wheels: Option<u32>,
    /// [m] Height of the step.
    pub height: f64,
}

/// Both climb: three wheels over an easy step, nine over half a robot's length of them.
pub const SCENES: [Scene; 3] = [
    Scene {
        name: "line_of_3/step_50mm",
        wheels: Some(3),
        height: 0.05,
    },
    Scene {
        name: "line_of_9/step_75mm",
        wheels: Some(9),
        height: 0.075,
    },
    Scene {
        name: "belt/step_75mm",
        wheels: None,
        height: 0.075,
    },
];

impl Scene {
    /// The scenario, from the file that the tests start from.
    ///
    /// # Panics
    /// If the shared scenario is not valid.
    pub fn scenario(&self) -> Scenario {
        let text = include_str!("../../tests/scenarios/engineer_belt_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        if let Some(count) = self.wheels {
            scenario.robot.track = Track::Line(LineOfWheels {
                count,
                wheel_radius: None,
                wheel: Wheel::Round,
            });
            scenario.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
        }
        scenario.robot.drivetrain.max_torque = 20.0;
        scenario.terrain = Terrain::Step {
            height: self.height,
            edge_radius: 0.0,
            friction: 0.9,
        };
        scenario
    }

    /// The same in the bare engine, with as many steps and substeps.
    pub fn engine(&self) -> Option<EngineWorld> {
        let scenario = self.scenario();
        let settings = EngineSettings {
            time_step: scenario.solver.time_step,
            substeps: scenario.solver.substeps as usize,
        };
        self.wheels
            .map(|count| EngineWorld::new(&scenario, count, self.height, settings))
    }
}
