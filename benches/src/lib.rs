//! The scenes that the benchmarks time, from scenario files shared with the tests.

use crawler2d_core::{Engine, Scenario, ValidScenario};

/// [s] Length of a step of rapier's dynamics: the default there.
pub const ENGINE_STEP: f64 = 2.5e-4;

/// A robot in front of an obstacle.
pub struct Scene {
    /// Name in the report.
    pub name: &'static str,
    /// The scenario's JSON.
    text: &'static str,
}

macro_rules! scene {
    ($file:literal) => {
        Scene {
            name: $file,
            text: include_str!(concat!("../../tests/scenarios/", $file, ".json")),
        }
    };
}

/// A robot of 20 kg on 5 wheels in line or 24 all round, round or with 12 or 10 grousers, in front of a step of
/// 0.15 m or on a field of 20 blocks; and the Engineer in front of a step: on a belt, without and with grousers, on
/// chains of 22 shoes on a guide and with a sprocket, and with its flippers.
pub const SCENES: [Scene; 13] = [
    scene!("peer_lwa5_round_step"),
    scene!("peer_lwa5_gear_step"),
    scene!("peer_cwa24_round_step"),
    scene!("peer_cwa24_gear_step"),
    scene!("peer_lwa5_round_field"),
    scene!("peer_lwa5_gear_field"),
    scene!("peer_cwa24_round_field"),
    scene!("peer_cwa24_gear_field"),
    scene!("engineer_belt_step"),
    scene!("engineer_grouser_belt_step"),
    scene!("engineer_chain_step"),
    scene!("engineer_sprocket_step"),
    scene!("engineer_flippers_step"),
];

impl Scene {
    /// The scenario.
    ///
    /// # Panics
    /// If the shared file is not valid.
    pub fn scenario(&self) -> Scenario {
        Scenario::from_json(self.text).expect("the shared scenario is valid")
    }

    /// The validated scenario.
    ///
    /// # Panics
    /// As [`Self::scenario`].
    pub fn checked(&self) -> ValidScenario {
        ValidScenario::from_json(self.text).expect("the shared scenario is valid")
    }

    /// The same moved by rapier's dynamics; `None` if they cannot hold its robot.
    pub fn in_rapier(&self) -> Option<ValidScenario> {
        let mut scenario = self.scenario();
        scenario.solver.engine = Engine::Rapier;
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(ENGINE_STEP));
        ValidScenario::new(&scenario).ok()
    }

    /// [s] An instant at which the robot is on its obstacle: one second, plus the time to the obstacle and a third of
    /// its length at the commanded speed.
    pub fn in_the_climb(&self) -> f64 {
        let scenario = self.scenario();
        let way = scenario.start.approach + scenario.robot.outline.axle_distance() / 3.0;
        1.0 + way / scenario.drive.speed
    }
}
