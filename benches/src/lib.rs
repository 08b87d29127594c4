//! The scenes that the benchmarks time, from scenario files shared with the tests.

use crawler2d_core::{Engine, Scenario, Simulation, ValidScenario};

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
/// 0.15 m or on a field of 20 blocks; and the Engineer in front of a step: on a belt, without and with grousers, moved
/// by a force on wheels, on wheels of two sizes, on 3 gear wheels, on chains of 22 shoes on a guide and with a
/// sprocket, and with its flippers.
pub const SCENES: [Scene; 16] = [
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
    scene!("engineer_force_step"),
    scene!("engineer_hybrid_step"),
    scene!("engineer_gear3_step"),
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

    /// The same with rapier's dynamics; `None` if they cannot represent its robot.
    pub fn in_rapier(&self) -> Option<ValidScenario> {
        let mut scenario = self.scenario();
        scenario.solver.engine = Engine::Rapier;
        (scenario.solver.accuracy, scenario.solver.time_step) = (None, Some(ENGINE_STEP));
        ValidScenario::new(&scenario).ok()
    }

    /// A simulation in the middle of its climb: after one second, plus the time to the obstacle and a third of its
    /// length at the commanded speed.
    ///
    /// # Panics
    /// If it does not get there.
    pub fn climbing(&self, checked: &ValidScenario) -> Simulation {
        let scenario = self.scenario();
        let way = scenario.start.approach + scenario.robot.outline.axle_distance() / 3.0;
        let mut simulation = Simulation::new(checked);
        simulation
            .advance(1.0 + way / scenario.drive.speed)
            .expect("a finite state");
        simulation
    }
}

/// [ms] A time of `seconds` [s].
pub fn milliseconds(seconds: f64) -> u64 {
    (1e3 * seconds).round() as u64
}
