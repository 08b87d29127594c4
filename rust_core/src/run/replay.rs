//! The log of a simulation's commands and steps, from which the same run is repeated with its history.

use super::clock::Clock;
use super::record::{Record, batch_budget};
use super::recording::{Recording, Run};
use super::{ByHand, Simulation, ValidScenario};
use crate::error::Error;
use crate::limits::Cancel;
use crate::scenario::Scenario;

/// All commands and steps of a simulation since its start or a snapshot; the same steps give the same bits.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// The snapshot where it began; `None` is the start of its scenario.
    snapshot: Option<Vec<u8>>,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
enum Entry {
    /// Steps that were to end at one time [s], and the time reached.
    Steps {
        end: f64,
        reached: f64,
    },
    ByHand(Box<ByHand>),
}

impl Log {
    /// The log of a simulation that continues from a snapshot.
    pub fn after(snapshot: Vec<u8>) -> Self {
        Self {
            snapshot: Some(snapshot),
            entries: Vec::new(),
        }
    }

    /// Records steps that are to end at a time [s].
    pub fn note_steps(&mut self, end: f64) {
        self.entries.push(Entry::Steps { end, reached: end });
    }

    /// Records the time [s] at which the last steps ended.
    pub fn has_reached(&mut self, time: f64) {
        if let Some(Entry::Steps { reached, .. }) = self.entries.last_mut() {
            *reached = time;
        }
    }

    /// Records accepted commands.
    pub fn note_commands(&mut self, commands: ByHand) {
        self.entries.push(Entry::ByHand(Box::new(commands)));
    }

    /// Simulates it again, and records what `record` says.
    ///
    /// # Errors
    /// As [`simulate`](crate::simulate), and [`Error::Interrupted`] once `cancel` is asked.
    pub fn replay(
        &self,
        scenario: &Scenario,
        record: Record,
        cancel: &Cancel,
    ) -> Result<Run, Error> {
        let clock = Clock::start();
        let checked = ValidScenario::new(scenario)?;
        let budget = batch_budget(std::slice::from_ref(&checked), record, 1)?;
        let mut simulation = match &self.snapshot {
            Some(snapshot) => Simulation::from_snapshot(snapshot)?,
            None => Simulation::new(&checked),
        };
        let mut recording = Recording::begin(&simulation, record, &budget, clock)?;
        for entry in &self.entries {
            match entry {
                Entry::ByHand(commands) => simulation.command_all(commands)?,
                Entry::Steps { end, reached } => {
                    while simulation.time() < *reached {
                        simulation.step_until(*end)?;
                        recording.step(&simulation)?;
                        cancel.check()?;
                    }
                }
            }
        }
        recording.finish(&simulation, cancel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::trials::tests::engineer;

    /// Drives on for 0.05 s, is told to go back, and is interrupted half way through 0.1 s more; notes all of that.
    fn drive(simulation: &mut Simulation, log: &mut Log) {
        let back = ByHand {
            speed: Some(-0.2),
            flippers: [None, None],
            push: None,
        };
        for (time, share, commands) in [(0.05, 1.0, Some(back)), (0.1, 0.5, None)] {
            let begin = simulation.time();
            log.note_steps(begin + time);
            while simulation.time() < begin + share * time {
                let end = simulation.step_until(begin + time);
                end.expect("the state stays finite");
            }
            log.has_reached(simulation.time());
            if let Some(commands) = commands {
                log.note_commands(commands);
                simulation
                    .command_all(&commands)
                    .expect("they are within limits");
            }
        }
    }

    #[test]
    fn a_run_that_is_made_again_ends_where_it_was_interrupted_with_the_same_bits() {
        let scenario = engineer();
        let checked = ValidScenario::new(&scenario).expect("it is valid");
        let mut simulation = Simulation::new(&checked);
        let mut log = Log::default();
        for _ in 0..2 {
            drive(&mut simulation, &mut log);
            let again = log.replay(&scenario, Record::summary(), &Cancel::default());
            let found = again.expect("the state stays finite").metrics;
            let now = simulation.reading();
            assert_eq!(found.time.to_bits(), simulation.time().to_bits());
            assert_eq!(found.final_x.to_bits(), now.position.x.to_bits());
            assert_eq!(found.final_angle.to_bits(), now.chassis_angle.to_bits());
            // And it goes on from a snapshot.
            log = Log::after(simulation.snapshot().expect("its engine is our own"));
        }
    }
}
