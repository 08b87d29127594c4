//! Simulates one scenario to its end.

use std::time::Instant;

use super::contact_table::ContactTable;
use super::record::Record;
use super::sinkage::Sinkage;
use super::step_length::SAME_TIME;
use super::trace::{Recorder, Trace};
use super::trials::{self, EscapeForce};
use super::{Checked, Metrics, Simulation, budget};
use crate::diagnosis::{Balance, Change, Diagnosis, Trial, Wanted};
use crate::error::Error;
use crate::limits::Cancel;
use crate::limits::memory::Budget;
use crate::observe::{Event, Outcome};
use crate::scenario::{Doubt, Scenario};
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
    /// [m] How deep the robot was in the ground, by its outline alone, at some instants.
    pub depth: f64,
    /// What in it is hardly right.
    pub doubts: Vec<Doubt>,
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

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and makes trials there; those that make no sense
/// for the robot are left out.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn make_trials(
    scenario: &Checked,
    at: f64,
    wanted: Wanted,
    cancel: &Cancel,
) -> Result<Vec<Trial>, Error> {
    trials::make(&replay(scenario, at, cancel)?, wanted, cancel)
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and tries to continue as `variant` with a push
/// that rises to a force [N] in a time [s]; `None` if it has not stopped.
///
/// # Errors
/// As [`branch`].
pub fn what_if(
    scenario: &Checked,
    at: f64,
    changes: (&Checked, (f64, f64)),
    cancel: &Cancel,
) -> Result<Option<Trial>, Error> {
    trials::what_if(&replay(scenario, at, cancel)?, changes, cancel)
}

/// The scenario of a trial made at a stop of `scenario` at the time `at` [s], and its run; `None` if the change makes no
/// sense for the robot.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn run_of_trial(
    scenario: &Checked,
    at: f64,
    change: Change,
    record: Record,
    cancel: &Cancel,
) -> Result<Option<(Scenario, Run)>, Error> {
    let begin = Instant::now();
    let stop = replay(scenario, at, cancel)?;
    let Some(mut started) = trials::start(&stop, change)? else {
        return Ok(None);
    };
    let budget = budget::of_batch(std::slice::from_ref(scenario), record, 1)?;
    let end = started.time() + trials::duration(&stop, change);
    let run = advance(&mut started, end, record, (&budget, cancel), begin)?;
    Ok(Some((started.scenario().clone(), run)))
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and measures the push that moves it on.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn escape_force(scenario: &Checked, at: f64, cancel: &Cancel) -> Result<EscapeForce, Error> {
    trials::escape_force(&replay(scenario, at, cancel)?, cancel)
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and says whether forces could hold it there; `None`
/// if it has not stopped, or has no weight.
///
/// # Errors
/// As [`simulate`], and [`Error::Interrupted`] once `cancel` is asked.
pub fn balance(scenario: &Checked, at: f64, cancel: &Cancel) -> Result<Option<Balance>, Error> {
    Ok(replay(scenario, at, cancel)?.balance())
}

/// Diagnoses a simulation's stop; `None` if it has not stopped.
///
/// # Errors
/// [`Error::Simulation`] if the state of a trial became non-finite, [`Error::Interrupted`] once `cancel` is asked.
pub fn diagnose(
    simulation: &Simulation,
    wanted: Wanted,
    cancel: &Cancel,
) -> Result<Option<Diagnosis>, Error> {
    trials::judge(simulation, wanted, cancel)
}

/// The outcome if a simulation ended now.
///
/// # Errors
/// As [`diagnose`].
pub fn outcome_of(simulation: &Simulation, cancel: &Cancel) -> Result<Outcome, Error> {
    if let Some(outcome) = simulation.monitor().ended_as() {
        return Ok(outcome);
    }
    let found = diagnose(simulation, Wanted::default(), cancel)?;
    Ok(found.map_or(Outcome::TimedOut, |found| found.outcome))
}

/// The simulation of a scenario at the end of its first step that reaches a time [s].
fn replay(scenario: &Checked, at: f64, cancel: &Cancel) -> Result<Simulation, Error> {
    let mut simulation = Simulation::new(scenario);
    let end = scenario.scenario().duration.max(at);
    while simulation.time() < at - SAME_TIME.value() {
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
    let mut sinkage = Sinkage::from(simulation);
    while simulation.time() < end && !simulation.is_over() {
        simulation.step_until(end)?;
        sinkage.step(simulation);
        if let Some(recorder) = &mut recorder {
            recorder.step(simulation)?;
        }
        cancel.check()?;
    }
    let recorded = recorder.map(|recorder| recorder.finish(simulation));
    let (trace, contacts) = recorded.transpose()?.unwrap_or_default();
    let events = simulation.events();
    let diagnosis = trials::judge(simulation, record.trials, cancel)?;
    let ended = simulation.monitor().ended_as().unwrap_or(Outcome::TimedOut);
    let outcome = diagnosis.as_ref().map_or(ended, |found| found.outcome);
    let mut metrics = Metrics::of(simulation, &start, &events);
    let doubts = Vec::from_iter(sinkage.doubt(simulation));
    // Where contacts were not found they do not tell how deep it was.
    for doubt in &doubts {
        metrics.max_penetration = metrics.max_penetration.max(doubt.value);
    }
    Ok(Run {
        outcome,
        diagnosis,
        metrics,
        depth: sinkage.deepest,
        doubts,
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
