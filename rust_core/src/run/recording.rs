//! A run while it is simulated, and its results.

use super::clock::Clock;
use super::metrics::Sinkage;
use super::record::{ContactTable, Record, Recorder, Trace};
use super::trials;
use super::{Metrics, Simulation};
use crate::diagnosis::Diagnosis;
use crate::error::Error;
use crate::limits::Cancel;
use crate::limits::memory::Budget;
use crate::observe::{Event, Outcome};
use crate::scenario::Warning;
use crate::terrain::Edge;

/// The results of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// How it ended.
    pub outcome: Outcome,
    /// Why it stopped, if it ended in a stop.
    pub diagnosis: Option<Diagnosis>,
    /// Figures of the whole run.
    pub metrics: Metrics,
    /// [m] Largest depth of the robot's outline in the ground, at some instants.
    pub depth: f64,
    /// Results that are unlikely to be right.
    pub warnings: Vec<Warning>,
    /// History, if recorded.
    pub trace: Trace,
    /// Contacts, if recorded.
    pub contacts: ContactTable,
    /// Corners of the ground.
    pub edges: Vec<Edge>,
    /// Stops and intrusions.
    pub events: Vec<Event>,
    /// Number of drives.
    pub drives: usize,
    /// Number of shoes of all chains.
    pub shoes: usize,
    /// Number of ends with flippers.
    pub flippers: usize,
    /// [s] Computing time; kept apart from the metrics, which repeat bit by bit. Not a number without a clock.
    pub wall_time: f64,
}

/// The results of a run while it is simulated.
pub(super) struct Recording<'a> {
    record: Record,
    clock: Clock,
    sinkage: Sinkage,
    /// The history, if it is recorded.
    recorder: Option<Recorder<'a>>,
}

impl<'a> Recording<'a> {
    /// Begins with the present state.
    pub(super) fn begin(
        simulation: &Simulation,
        record: Record,
        budget: &'a Budget,
        clock: Clock,
    ) -> Result<Self, Error> {
        let recorder = record
            .history
            .then(|| Recorder::new(simulation, record, budget));
        Ok(Self {
            record,
            clock,
            sinkage: Sinkage::from(simulation),
            recorder: recorder.transpose()?,
        })
    }

    /// Processes the last step.
    pub(super) fn step(&mut self, simulation: &Simulation) -> Result<(), Error> {
        self.sinkage.step(simulation);
        if let Some(recorder) = &mut self.recorder {
            recorder.step(simulation)?;
        }
        Ok(())
    }

    /// The results, with trials if the robot has stopped.
    pub(super) fn finish(self, simulation: &Simulation, cancel: &Cancel) -> Result<Run, Error> {
        let recorded = self.recorder.map(|recorder| recorder.finish(simulation));
        let (trace, contacts) = recorded.transpose()?.unwrap_or_default();
        let events = simulation.events();
        let diagnosis = trials::diagnose(simulation, self.record.trials, cancel)?;
        let ended = simulation.monitor().ended_as().unwrap_or(Outcome::TimedOut);
        let outcome = diagnosis.as_ref().map_or(ended, |found| found.outcome);
        let mut metrics = Metrics::of(simulation, &events);
        let warnings = Vec::from_iter(self.sinkage.warning(simulation));
        // Contacts that were not found say nothing about depth.
        for warning in &warnings {
            metrics.max_penetration = metrics.max_penetration.max(warning.value);
        }
        Ok(Run {
            outcome,
            diagnosis,
            metrics,
            depth: self.sinkage.deepest,
            warnings,
            trace,
            contacts,
            edges: simulation.ground().edges(),
            events,
            drives: simulation.drives(),
            shoes: simulation.shoes().len(),
            flippers: simulation.flipper_angles().count(),
            wall_time: self.clock.elapsed(),
        })
    }
}
