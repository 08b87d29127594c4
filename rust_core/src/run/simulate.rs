//! Simulates one scenario to its end.

use std::time::Instant;

use super::contact_table::ContactTable;
use super::record::Record;
use super::simulation::SAME_TIME;
use super::trace::{Recorder, Trace};
use super::{Checked, Metrics, Simulation, budget};
use crate::diagnosis::{Counterfactual, Diagnosis};
use crate::error::Error;
use crate::limits::Cancel;
use crate::limits::memory::Budget;
use crate::observe::{Event, Outcome};
use crate::scenario::ClosedSurface;
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
    /// [s] Computing time; kept apart from the metrics, which repeat bit by bit.
    pub wall_time: f64,
}

/// Simulates a scenario to its end.
///
/// # Errors
/// [`Error::Limit`] before the run or if the record needs too much memory, [`Error::Simulation`] if the
/// state became non-finite.
pub fn simulate(checked: &Checked, record: Record) -> Result<Run, Error> {
    let budget = budget::of_batch(std::slice::from_ref(checked), record, 1)?;
    simulate_within(checked, record, (&budget, &Cancel::default()))
}

/// The same within a budget of memory; ends early with [`Error::Interrupted`] if asked to.
pub(crate) fn simulate_within(
    checked: &Checked,
    record: Record,
    limits: Limits,
) -> Result<Run, Error> {
    let begin = Instant::now();
    let end = checked.scenario().duration;
    advance(&mut Simulation::new(checked), end, record, limits, begin)
}

/// Simulates `scenario` up to the time `at` [s], then continues as `variant` for its whole duration, with a push that
/// rises to a force [N] in a time [s].
///
/// # Errors
/// As [`simulate`], [`Error::Scenario`] if the push is out of range, and [`Error::Interrupted`] once `cancel` is asked.
pub fn branch(
    scenario: &Checked,
    at: f64,
    (variant, push): (&Checked, (f64, f64)),
    record: Record,
    cancel: &Cancel,
) -> Result<Run, Error> {
    let begin = Instant::now();
    let budget = budget::of_batch(std::slice::from_ref(variant), record, 1)?;
    let trunk = replay(scenario, at, cancel)?;
    let mut simulation = trunk.branch(variant);
    simulation.raise_push(push.0, push.1)?;
    let end = simulation.time() + variant.scenario().duration;
    advance(&mut simulation, end, record, (&budget, cancel), begin)
}

/// Simulates `scenario` up to the time `at` [s] and tries a closed belt there.
///
/// # Errors
/// As [`simulate`], [`Error::Scenario`] if the belt is to have grousers but the track has none, and
/// [`Error::Interrupted`] once `cancel` is asked.
pub fn counterfactual(
    scenario: &Checked,
    at: f64,
    surface: ClosedSurface,
    cancel: &Cancel,
) -> Result<Counterfactual, Error> {
    replay(scenario, at, cancel)?.counterfactual(surface, cancel)
}

/// The simulation of a scenario at the end of its first step that reaches a time [s].
fn replay(scenario: &Checked, at: f64, cancel: &Cancel) -> Result<Simulation, Error> {
    let mut simulation = Simulation::new(scenario);
    let end = scenario.scenario().duration.max(at);
    while simulation.time() < at - SAME_TIME {
        simulation.step_until(end)?;
        cancel.check()?;
    }
    Ok(simulation)
}

/// Limits of a run: memory, and a request to end.
type Limits<'a> = (&'a Budget, &'a Cancel);

/// Simulates up to the time `end` [s], or until the outcome is certain.
fn advance(
    simulation: &mut Simulation,
    end: f64,
    record: Record,
    (budget, cancel): Limits,
    begin: Instant,
) -> Result<Run, Error> {
    let start = simulation.reading();
    let recorder = record
        .history
        .then(|| Recorder::new(simulation, record, budget));
    let mut recorder = recorder.transpose()?;
    while simulation.time() < end && !simulation.is_over() {
        simulation.step_until(end)?;
        if let Some(recorder) = &mut recorder {
            recorder.step(simulation)?;
        }
        cancel.check()?;
    }
    let recorded = recorder.map(|recorder| recorder.finish(simulation));
    let (trace, contacts) = recorded.transpose()?.unwrap_or_default();
    let events = simulation.events();
    let mut diagnosis = simulation.diagnosis();
    if let Some(diagnosis) = diagnosis.as_mut().filter(|_| record.counterfactual) {
        diagnosis.counterfactual = Some(simulation.counterfactual(ClosedSurface::Smooth, cancel)?);
    }
    let outcome = diagnosis
        .as_ref()
        .map_or_else(|| simulation.outcome_now(), |d| d.outcome);
    let metrics = Metrics::of(simulation, &start, &events);
    Ok(Run {
        outcome,
        diagnosis,
        metrics,
        trace,
        contacts,
        edges: simulation.ground().edges(),
        events,
        drives: simulation.drives(),
        shoes: simulation.shoes().len(),
        flippers: simulation.flipper_angles().count(),
        wall_time: begin.elapsed().as_secs_f64(),
    })
}
