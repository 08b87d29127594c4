//! What a fuzzer that is guided by coverage calls, and the cases that it has kept: a function for each target, which panics
//! if bytes break a rule. Only tests and `make fuzz` compile it.

mod json;
mod run;
mod scenario;
mod snapshot;
mod solver;
mod terrain;

pub use json::mutated;
pub use run::run;
pub use scenario::scenario;
pub use snapshot::snapshot;
pub use solver::solver;
pub use terrain::terrain;

/// Texts of the shared scenarios, with which most targets begin.
pub(crate) const TEXTS: [&str; 12] = [
    include_str!("../../../tests/scenarios/engineer_belt_step.json"),
    include_str!("../../../tests/scenarios/engineer_chain_step.json"),
    include_str!("../../../tests/scenarios/engineer_flippers_step.json"),
    include_str!("../../../tests/scenarios/engineer_force_step.json"),
    include_str!("../../../tests/scenarios/engineer_gear3_step.json"),
    include_str!("../../../tests/scenarios/engineer_grouser_belt_step.json"),
    include_str!("../../../tests/scenarios/engineer_hybrid_step.json"),
    include_str!("../../../tests/scenarios/engineer_sprocket_step.json"),
    include_str!("../../../tests/scenarios/judge_gear3_bar.json"),
    include_str!("../../../tests/scenarios/judge_gear3_blocks.json"),
    include_str!("../../../tests/scenarios/peer_cwa24_gear_field.json"),
    include_str!("../../../tests/scenarios/peer_lwa5_round_step.json"),
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::draw::cases;

    /// Calls a target with each case that is kept for it; returns these.
    fn replay(name: &str, target: fn(&[u8])) -> Vec<Vec<u8>> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("fuzz/corpus")
            .join(name);
        let paths = std::fs::read_dir(&folder).expect("cases are kept");
        let cases: Vec<Vec<u8>> = paths
            .map(|path| std::fs::read(path.expect("a case").path()).expect("a case can be read"))
            .collect();
        assert!(cases.len() > 10, "{} cases of {name}", cases.len());
        for case in &cases {
            target(case);
        }
        cases
    }

    /// How many of some texts are scenarios.
    fn scenarios_among(cases: &[Vec<u8>]) -> usize {
        let is_scenario = |case: &&Vec<u8>| scenario::accepted(case).is_some();
        cases.iter().filter(is_scenario).count()
    }

    #[test]
    fn every_kept_text_is_a_scenario_or_is_refused() {
        let cases = replay("scenario", scenario);
        let accepted = scenarios_among(&cases);
        assert!(accepted > 5 && cases.len() > accepted + 5, "{accepted}");
    }

    #[test]
    fn every_kept_terrain_is_built_or_is_refused() {
        replay("terrain", terrain);
    }

    #[test]
    fn every_kept_damage_of_a_snapshot_is_refused_or_goes_on() {
        replay("snapshot", snapshot);
    }

    #[test]
    fn every_kept_problem_is_solved_by_the_laws() {
        replay("solver", solver);
    }

    #[test]
    fn every_kept_scenario_steps_to_numbers() {
        let accepted = scenarios_among(&replay("run", run));
        assert!(accepted > 10, "{accepted} that are stepped");
    }

    /// Changes the shared scenarios, and what came of them; counts those that are accepted.
    fn accepted_of(seeds: std::ops::Range<u32>) -> u32 {
        let mut texts = TEXTS.map(|text| text.as_bytes().to_vec());
        let mut accepted = 0;
        for seed in seeds {
            let place = seed as usize % TEXTS.len();
            let text = mutated(&texts[place], seed).expect("it is JSON");
            if scenario::accepted(&text).is_some() {
                accepted += 1;
                texts[place] = text;
            }
            // Changes upon changes lead far, but most of them to the same places.
            if seed.is_multiple_of(97) {
                texts[place] = TEXTS[place].as_bytes().to_vec();
            }
        }
        accepted
    }

    #[test]
    fn changed_scenarios_survive_or_are_refused() {
        let (threads, each) = (2, cases(1_500, 2_500_000) as u32);
        let accepted: u32 = std::thread::scope(|scope| {
            let run = |i| scope.spawn(move || accepted_of(i * each..(i + 1) * each));
            let all: Vec<_> = (0..threads).map(run).collect();
            all.into_iter()
                .map(|one| one.join().expect("no rule is broken"))
                .sum()
        });
        assert!(accepted > threads * each / 20, "{accepted}");
    }
}
