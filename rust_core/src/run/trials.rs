//! Judges a stop by trials: one thing is changed in the pose of the stop, and the robot drives on.
//!
//! docs/decisions/0012 explains why, docs/conventions.md defines the words.

#[cfg(test)]
pub(super) mod tests;

use super::{Simulation, ValidScenario};
use crate::diagnosis::{Change, Diagnosis, Trial, Wanted};
use crate::error::Error;
use crate::limits::Cancel;
use crate::observe::Outcome;
use crate::scenario::{
    BeltTrack, ClosedSurface, ClosedTrack, Engine, Gait, Hold, Robot, Scenario, TorqueSharing,
    Track, scaled_friction,
};

/// Number of instants from which trials of a rattling stop start.
const STARTS: u32 = 5;
/// Number of these from which a change must free the robot.
const ENOUGH: u32 = 4;
/// [s] Longest duration of a trial, however slow the command is.
const LONGEST: f64 = 1e3;

/// Diagnoses a simulation's stop; `None` if it has not stopped.
///
/// # Errors
/// [`Error::Simulation`] if the state of a trial became non-finite, [`Error::Interrupted`] once `cancel` is asked.
pub fn diagnose(
    stop: &Simulation,
    wanted: Wanted,
    cancel: &Cancel,
) -> Result<Option<Diagnosis>, Error> {
    let Some(mut found) = stop.examine() else {
        return Ok(None);
    };
    if wanted.is_nothing() {
        return Ok(Some(found));
    }
    let mut series = TrialSeries::new(stop, &found, cancel);
    let is_transient = series.frees(Change::Nothing)?;
    let leaves = !is_transient && found.jammed && series.frees(Change::Rebuilt)?;
    if is_transient || leaves && !stop.is_in_an_engine() {
        found.outcome = Outcome::TimedOut;
    } else {
        // If our own dynamics do not stop where another engine did, they cannot say what would end that stop.
        if found.jammed && !leaves {
            let in_pose = series.frees(Change::ClosedTrack)?;
            let from_clear = series.frees(Change::ClosedTrackClear)?;
            // The model's bodies need not be at its track,
            if !in_pose {
                series.frees(Change::Belt)?;
            }
            // and a track need not get to this pose.
            if !series.frees(Change::BeltFromStart)? {
                series.frees(Change::ClosedTrackFromStart)?;
            }
            if in_pose || from_clear {
                // If one motor for all wheels frees the robot, some of them lacked torque.
                let lacks_torque = series.frees(Change::OneMotor)?;
                found.outcome = if lacks_torque {
                    Outcome::Stalled
                } else {
                    Outcome::Seized
                };
            }
        }
        if found.symptom == Outcome::HungUp && !found.jammed {
            // A closed track may cover the belly.
            series.frees(Change::ClosedTrack)?;
            series.frees(Change::NoBelly)?;
        }
        for change in wanted.changes() {
            series.frees(change)?;
        }
    }
    found.trials = series.trials;
    let rank = |trial: &Trial| Change::ALL.iter().position(|c| c.name() == trial.name);
    found.trials.sort_by_key(rank);
    Ok(Some(found))
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

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and makes trials there, except those that make
/// no sense for the robot.
///
/// # Errors
/// As [`simulate`](crate::simulate), and [`Error::Interrupted`] once `cancel` is asked.
pub fn make_trials(
    scenario: &ValidScenario,
    at: f64,
    wanted: Wanted,
    cancel: &Cancel,
) -> Result<Vec<Trial>, Error> {
    let stop = Simulation::replayed(scenario, at, cancel)?;
    let Some(found) = stop.examine() else {
        return Ok(Vec::new());
    };
    let mut series = TrialSeries::new(&stop, &found, cancel);
    for change in wanted.changes() {
        series.frees(change)?;
    }
    Ok(series.trials)
}

/// Simulates `scenario` up to the time `at` [s], where it has stopped, and tries to continue as `variant` with a push
/// that rises to a force [N] in a time [s]; `None` if it has not stopped. Also returns how many starts after the stop
/// the reported run began: see [`branch`](crate::branch).
///
/// # Errors
/// As [`branch`](crate::branch).
pub fn what_if(
    scenario: &ValidScenario,
    at: f64,
    (variant, push): (&ValidScenario, (f64, f64)),
    cancel: &Cancel,
) -> Result<Option<(Trial, usize)>, Error> {
    let stop = Simulation::replayed(scenario, at, cancel)?;
    let Some(found) = stop.examine() else {
        return Ok(None);
    };
    let start = |stop: &Simulation| {
        let mut branch = stop.branch(variant);
        branch.raise_push(push.0, push.1)?;
        Ok(Some(branch))
    };
    let mut series = TrialSeries::new(&stop, &found, cancel);
    series.attempt("changed", (STARTS, pose_duration(&stop)), &start)
}

/// The next instant from which trials of a stop start: a fifth of a stop window later.
pub(super) fn next_start(last: &Simulation, cancel: &Cancel) -> Result<Simulation, Error> {
    let mut next = last.copy();
    next.advance(last.stop_window() / f64::from(STARTS))?;
    cancel.check()?;
    Ok(next)
}

/// The start of the run that a trial reports, which for a rattling robot may be later than the stop. `None` if the
/// change makes no sense for the robot.
pub(super) fn shown_start(
    stop: &Simulation,
    change: Change,
    cancel: &Cancel,
) -> Result<Option<Simulation>, Error> {
    let Some(found) = stop.examine().filter(|found| !found.stationary) else {
        return start(&stop.copy(), change);
    };
    let mut series = TrialSeries::new(stop, &found, cancel);
    match series.attempt_change(change)? {
        Some((_, shown)) => start(series.start(shown)?, change),
        None => Ok(None),
    }
}

/// A simulation with a change that starts from a stop; `None` if the change makes no sense for the robot.
pub(super) fn start(stop: &Simulation, change: Change) -> Result<Option<Simulation>, Error> {
    if change == Change::Nothing {
        return Ok(Some(stop.copy()));
    }
    let Some(scenario) = variant_of(stop.scenario(), change) else {
        return Ok(None);
    };
    let start = Start::of(change);
    if start == Start::Anew {
        // Only the run of a scenario can be repeated: commands by hand, or before a branch, are not known here.
        let again = stop
            .follows_scenario()
            .then(|| ValidScenario::new(&scenario));
        return Ok(again.transpose()?.map(|checked| Simulation::new(&checked)));
    }
    let started = stop.varied(&scenario, start != Start::Continued)?;
    if start == Start::Clear {
        return Ok(started.clear_of_the_ground());
    }
    Ok(Some(started))
}

/// [s] Duration of the trial of a change.
pub(super) fn duration(stop: &Simulation, change: Change) -> f64 {
    if change.is_from_the_start() {
        stop.scenario().duration
    } else {
        pose_duration(stop)
    }
}

/// [s] The same for a change in the pose of the stop.
fn pose_duration(stop: &Simulation) -> f64 {
    let criteria = &stop.scenario().criteria;
    let time = criteria.escape_time + criteria.escape_distance / stop.command().abs();
    time.min(LONGEST)
}

/// A stop, with the trials made of it.
struct TrialSeries<'a> {
    /// The instants from which trials start; those after the first are computed on request.
    starts: Vec<Simulation>,
    rattles: bool,
    direction: f64,
    /// [m] Greatest position of the robot in the commanded direction.
    greatest: f64,
    trials: Vec<Trial>,
    cancel: &'a Cancel,
}

impl<'a> TrialSeries<'a> {
    fn new(stop: &Simulation, found: &Diagnosis, cancel: &'a Cancel) -> Self {
        Self {
            starts: vec![stop.copy()],
            rattles: !found.stationary,
            direction: stop.direction(),
            greatest: stop.monitor().best_advance(),
            trials: Vec::new(),
            cancel,
        }
    }

    /// Whether a change frees the robot; the trial is made once.
    fn frees(&mut self, change: Change) -> Result<bool, Error> {
        let name = change.name();
        if let Some(made) = self.trials.iter().find(|trial| trial.name == name) {
            return Ok(made.freed);
        }
        // A robot that cannot be built, or whose state becomes non-finite, says nothing about the stop.
        let made = match self.attempt_change(change) {
            Err(Error::Scenario(_) | Error::Simulation(_)) => None,
            made => made?,
        };
        let freed = made.as_ref().is_some_and(|(trial, _)| trial.freed);
        self.trials.extend(made.map(|(trial, _)| trial));
        Ok(freed)
    }

    /// Tries a change; also returns the index of the start that the trial reports.
    fn attempt_change(&mut self, change: Change) -> Result<Option<(Trial, usize)>, Error> {
        // A run that continues passes through all other starts, and a run from the start has only one.
        let is_single = change == Change::Nothing || change.is_from_the_start();
        let most = if is_single { 1 } else { STARTS };
        let duration = duration(&self.starts[0], change);
        self.attempt(change.name(), (most, duration), &|stop| start(stop, change))
    }

    /// Tries a change for a time [s] from as many starts as it takes to decide: at most `most` if the robot rattles,
    /// else one. Returns the first trial that ended like most of them, and its index.
    fn attempt(
        &mut self,
        name: &'static str,
        (most, duration): (u32, f64),
        start: &dyn Fn(&Simulation) -> Result<Option<Simulation>, Error>,
    ) -> Result<Option<(Trial, usize)>, Error> {
        let most = if self.rattles { most } else { 1 };
        let enough = ENOUGH.min(most);
        let mut runs: [Vec<(Trial, usize)>; 2] = Default::default();
        for i in 0..most {
            let place = i as usize;
            let Some(started) = start(self.start(place)?)? else {
                return Ok(None);
            };
            let run = self.follow(started, name, duration)?;
            runs[usize::from(run.freed)].push((run, place));
            let [stays, frees] = [0, 1].map(|k| runs[k].len() as u32);
            if frees == enough || stays > most - enough {
                break;
            }
        }
        let [stays, freeing] = [0, 1].map(|k| runs[k].len() as u32);
        let freed = freeing >= enough;
        let first = runs[usize::from(freed)].drain(..).next();
        Ok(first.map(|(run, place)| {
            let trial = Trial {
                freed,
                starts: stays + freeing,
                freeing,
                ..run
            };
            (trial, place)
        }))
    }

    /// The instant number `i` from which trials start; 0 is the stop.
    fn start(&mut self, i: usize) -> Result<&Simulation, Error> {
        while self.starts.len() <= i {
            let next = next_start(&self.starts[self.starts.len() - 1], self.cancel)?;
            self.starts.push(next);
        }
        Ok(&self.starts[i])
    }

    /// Simulates from one start for a time [s]. Time and forward direction are those of the stop, whatever a change
    /// commands.
    fn follow(
        &self,
        mut simulation: Simulation,
        name: &'static str,
        duration: f64,
    ) -> Result<Trial, Error> {
        let begin = simulation.time();
        let end = begin + duration;
        let criteria = simulation.scenario().criteria.clone();
        let (mut distance, mut time) = (f64::NEG_INFINITY, f64::INFINITY);
        while simulation.time() < end && !simulation.is_over() {
            simulation.step_until(end)?;
            self.cancel.check()?;
            let ahead = self.direction * simulation.reading().position.x - self.greatest;
            distance = distance.max(ahead);
            let gets_away = match simulation.monitor().ended_as() {
                None => ahead > criteria.escape_distance,
                Some(outcome) => outcome == Outcome::Cleared,
            };
            if gets_away {
                time = time.min(simulation.time() - begin);
            }
        }
        let ended = simulation.monitor().ended_as();
        if ended.is_some_and(|outcome| outcome != Outcome::Cleared) {
            // A robot that falls over, off the ground or out of its track is not free.
            time = f64::INFINITY;
        }
        let stop = simulation.examine();
        let symptom = stop.as_ref().map_or(Outcome::TimedOut, |d| d.symptom);
        let jammed = stop.as_ref().is_some_and(|d| d.jammed);
        let now = simulation.reading();
        let mut angles = simulation.flipper_angles();
        let flipper_angles = std::array::from_fn(|_| angles.next().unwrap_or(f64::NAN));
        let freed = time.is_finite();
        Ok(Trial {
            name,
            freed,
            starts: 1,
            freeing: u32::from(freed),
            distance,
            time,
            outcome: ended.unwrap_or(symptom),
            jammed,
            intrusion: stop.and_then(|d| d.intrusion),
            duration,
            pose: [now.position.x, now.position.y, now.chassis_angle],
            flipper_angles,
        })
    }
}

/// How a trial continues from a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// With all of the state.
    Continued,
    /// With pose and speeds; ground inside is let out without a push.
    Rebuilt,
    /// At rest, in the nearest pose in which no ground is inside.
    Clear,
    /// Where the scenario begins.
    Anew,
}

impl Start {
    /// The kind of start for a change.
    fn of(change: Change) -> Self {
        match change {
            Change::Nothing
            | Change::TwiceTheTorque
            | Change::TenTimesTheTorque
            | Change::TwiceTheFriction
            | Change::NoBelly
            | Change::FlippersLevel => Self::Continued,
            Change::Rebuilt
            | Change::ClosedTrack
            | Change::ClosedSmoothTrack
            | Change::Belt
            | Change::OneMotor => Self::Rebuilt,
            Change::ClosedTrackClear => Self::Clear,
            Change::BeltFromStart | Change::ClosedTrackFromStart => Self::Anew,
        }
    }
}

/// The variant that a change makes of a scenario; `None` if it makes no sense for its robot.
fn variant_of(scenario: &Scenario, change: Change) -> Option<Scenario> {
    let mut variant = scenario.clone();
    // Trials of another engine's stops use our own dynamics, with the other engine's time step.
    variant.solver.engine = Engine::Own;
    let robot = &mut variant.robot;
    match change {
        Change::Nothing | Change::Rebuilt => {}
        Change::ClosedTrack | Change::ClosedTrackClear | Change::ClosedTrackFromStart => {
            robot.track = closed(robot, ClosedSurface::Own)?;
        }
        Change::ClosedSmoothTrack => {
            any_track(robot, Track::has_grousers).then_some(())?;
            robot.track = closed(robot, ClosedSurface::Smooth)?;
        }
        Change::Belt | Change::BeltFromStart => {
            any_track(robot, Track::has_pockets).then_some(())?;
            robot.track = Track::Belt(BeltTrack {});
            robot.drivetrain.torque_sharing = TorqueSharing::Track;
            if let Some(flippers) = &mut robot.flippers {
                flippers.track = None;
            }
        }
        Change::OneMotor => {
            let sharing = &mut robot.drivetrain.torque_sharing;
            (*sharing == TorqueSharing::Wheel).then_some(())?;
            *sharing = TorqueSharing::Track;
        }
        Change::TwiceTheTorque => robot.drivetrain.scale_torque(2.0),
        Change::TenTimesTheTorque => robot.drivetrain.scale_torque(10.0),
        Change::TwiceTheFriction => {
            variant.terrain.scale_friction(2.0);
            if let Track::Force(force) = &mut robot.track {
                force.skid_friction = scaled_friction(force.skid_friction, 2.0);
            }
        }
        Change::NoBelly => *robot = robot.without_belly()?,
        Change::FlippersLevel => {
            robot.flippers.as_ref()?;
            variant.drive.gait = Some(Gait::Hold(Hold {
                angle: 0.0,
                schedule: None,
                front: None,
                rear: None,
            }));
        }
    }
    Some(variant)
}

/// The robot's track, closed; `None` if it has no pockets to close.
fn closed(robot: &Robot, surface: ClosedSurface) -> Option<Track> {
    any_track(robot, Track::has_pockets).then(|| {
        Track::Closed(ClosedTrack {
            of: Box::new(robot.track.clone()),
            surface,
        })
    })
}

/// Whether a condition is true for the robot's track or that of its arms.
fn any_track(robot: &Robot, is_so: fn(&Track) -> bool) -> bool {
    let arms = robot.flippers.as_ref().and_then(|f| f.track.as_ref());
    is_so(&robot.track) || arms.is_some_and(is_so)
}
