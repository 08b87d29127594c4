//! Observations of a monitor, which are part of a snapshot: progress over a sliding window, and stops, where there is
//! none.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::{Event, IntrusionWatch, Loads, Outcome, Reading, Shaking, Signals};
use crate::robot::Model;
use crate::solver::Effort;
use crate::terrain::Profile;
use crate::units::Seconds;

/// [s] Time between two checks of the progress; far shorter than any stop window.
pub(super) const LOOK: Seconds = Seconds(0.01);

/// Fraction of the time between two checks by which a window may exceed a whole number of them, because of rounding.
const ROUNDING: f64 = 1e-9;

/// Observations of a run by a monitor.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Observations {
    /// [m] The x of the chassis frame and the track position where these observations begin.
    pub start: [f64; 2],
    pub(super) looks: u64,
    pub(super) last_time: f64,
    pub(super) progress: Progress,
    pub(super) signals: Signals,
    /// Forces since the last check.
    pub(super) loads: Loads,
    pub(super) intrusions: IntrusionWatch,
    pub(super) anchor: Option<Anchor>,
    pub(super) goal_since: Option<f64>,
    /// [m] Distance of the robot beyond the goal at the last reading.
    pub(super) beyond: f64,
    pub(super) ended: Option<Outcome>,
    pub(super) stays: bool,
    /// [s] When the robot reached the goal for good; infinite if it has not.
    pub time_to_clear: f64,
    /// [m] Deepest penetration so far.
    pub max_penetration: f64,
    /// [rad] Largest chassis angle so far.
    pub max_angle: f64,
    /// [rad] Smallest chassis angle so far.
    pub min_angle: f64,
    /// [J] Work of the motors so far.
    pub drive_work: f64,
    /// [m] Distance that the chassis frame has moved along its own axis so far.
    pub path_length: f64,
    /// Vibration of the chassis so far.
    pub shaking: Shaking,
    /// [N] Largest force in a pin of a chain so far.
    pub max_track_tension: f64,
    /// [m] Largest gap of a pin so far.
    pub max_pin_gap: f64,
    /// [m] Deepest penetration of a chain's guide, wheels or teeth by a shoe so far.
    pub max_guide_penetration: f64,
    /// [m] Largest difference in travel between a chain and its sprocket so far.
    pub max_sprocket_slip: f64,
    /// Work of the solver so far.
    pub effort: Effort,
}

impl Observations {
    /// No observations, at a time [s].
    pub(crate) fn from(time: f64) -> Self {
        Self {
            looks: (time / LOOK.value()).ceil() as u64,
            last_time: time,
            time_to_clear: f64::INFINITY,
            max_angle: f64::NEG_INFINITY,
            min_angle: f64::INFINITY,
            ..Self::default()
        }
    }

    /// Whether these can be the observations of a robot on these lanes up to a time [s].
    pub(crate) fn fits(&self, time: f64, model: &Model, lanes: &[Profile]) -> bool {
        let parts = model.parts.len();
        // Checks are counted; a count ahead of time would suppress them for a while.
        let next_look = self.looks as f64 * LOOK.value();
        let numbers = [
            self.time_to_clear,
            self.max_penetration,
            self.max_angle,
            self.min_angle,
            self.drive_work,
            self.path_length,
            self.max_track_tension,
            self.max_pin_gap,
            self.max_guide_penetration,
            self.max_sprocket_slip,
        ];
        next_look <= time + 2.0 * LOOK.value()
            && (self.last_time - time).abs() <= 2.0 * LOOK.value()
            && numbers.iter().all(|number| !number.is_nan())
            && self.start.iter().all(|number| number.is_finite())
            && self.goal_since.is_none_or(f64::is_finite)
            && self.progress.fits(parts, lanes)
            && self.intrusions.fits(parts, lanes)
            && self.signals.fits(model, lanes)
            && self.loads.fits(model, lanes)
    }
}

/// A pose that the robot has not left since a certain time.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Anchor {
    pub(super) since: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) angle: f64,
    /// Signature of the contacts that bear there.
    pub(super) bearing: u64,
}

/// The progress of the robot, and when it stopped.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Progress {
    /// +1 or -1 as commanded; 0 in a pause, and while the drives brake from the other direction.
    pub(super) direction: f64,
    history: VecDeque<Look>,
    best_advance: f64,
    best_angle: f64,
    commanded: f64,
    falters: bool,
    /// [s] When the robot stopped, if it is stopped.
    pub stop_since: Option<f64>,
    /// Stops that have ended.
    pub stops: Vec<Event>,
    /// [s] Duration of the longest stop that ended because the robot moved on, 0 if there was none.
    pub time_to_free: f64,
    /// Share of the commanded distance covered in the last window; 1 before the first window in a direction is over.
    pub share: f64,
}

/// Progress at one check.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Look {
    advance: f64,
    angle: f64,
    commanded: f64,
}

impl Look {
    /// Share of the commanded distance covered since then, either in x or by raising the nose.
    fn share_since(&self, then: &Self) -> f64 {
        let progress = (self.advance - then.advance).max(self.angle - then.angle);
        let commanded = self.commanded - then.commanded;
        if commanded > 0.0 {
            progress / commanded
        } else {
            1.0
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            direction: 0.0,
            history: VecDeque::new(),
            best_advance: f64::NEG_INFINITY,
            best_angle: f64::NEG_INFINITY,
            commanded: 0.0,
            falters: false,
            stop_since: None,
            stops: Vec::new(),
            time_to_free: 0.0,
            share: 1.0,
        }
    }
}

impl Progress {
    /// Whether a robot with this number of parts on these lanes can have produced it.
    pub(super) fn fits(&self, parts: usize, lanes: &[Profile]) -> bool {
        let looks = self.history.iter();
        let known = |look: &Look| {
            let gained = look.advance + look.angle;
            !gained.is_nan() && look.commanded.is_finite()
        };
        [-1.0, 0.0, 1.0].contains(&self.direction)
            && looks.clone().all(known)
            && !(self.best_advance + self.best_angle).is_nan()
            && self.commanded.is_finite()
            && self.share.is_finite()
            && self.time_to_free.is_finite()
            && self.stop_since.is_none_or(f64::is_finite)
            && self.stops.iter().all(|stop| stop.fits(parts, lanes))
    }

    /// Processes one step of `dt` [s] of a robot whose end axles are `length` [m] apart.
    pub(super) fn advance(&mut self, now: &Reading, command: f64, length: f64, dt: f64) {
        // While braking from the other direction, it cannot follow.
        let direction = if command == 0.0 || command * now.commanded_speed < 0.0 {
            0.0
        } else {
            command.signum()
        };
        if direction * self.direction <= 0.0 {
            // Distance covered in the other direction, or before a pause, does not count for the new command.
            self.direction = direction;
            self.history.clear();
            (self.best_advance, self.best_angle) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            self.share = 1.0;
        }
        self.best_advance = self.best_advance.max(direction * now.position.x);
        self.best_angle = self.best_angle.max(direction * now.chassis_angle * length);
        self.commanded += now.commanded_speed.abs() * dt;
    }

    /// Compares with the state one window ago, at checks `every` [s]; progress below `least` of the commanded distance
    /// is a stop. Returns the beginning of a stop that has just ended.
    pub(super) fn look(
        &mut self,
        time: f64,
        commanded: bool,
        (window, every): (f64, f64),
        least: f64,
    ) -> Option<f64> {
        let here = Look {
            advance: self.best_advance,
            angle: self.best_angle,
            commanded: self.commanded,
        };
        let is_anew = self.history.is_empty();
        self.history.push_back(here);
        // For slow commands the window may be longer than any run, and is then never complete.
        let span = (window / every - ROUNDING).ceil() as usize;
        while self.history.len() > span.saturating_add(1) {
            self.history.pop_front();
        }
        let whole = self.history.len() > span;
        if whole {
            self.share = here.share_since(&self.history[0]);
        }
        let half = self.history.len() > span / 2;
        let recently = half.then(|| &self.history[self.history.len() - 1 - span / 2]);
        let stopped = commanded && whole && self.share < least;
        if stopped && self.stop_since.is_none() {
            // Times before the end of the last stop belong to that.
            let last = self.stops.last().map_or(f64::NEG_INFINITY, |stop| stop.end);
            self.stop_since = Some(last.max(time - window));
        }
        // A slower command has a longer window; until that is complete, nothing has changed.
        let moves_on = whole && !stopped;
        let ended = self.stop_since.take_if(|_| is_anew || moves_on);
        if let Some(start) = ended.filter(|_| moves_on) {
            self.time_to_free = self.time_to_free.max(time - start);
        }
        self.falters = self.stop_since.is_some()
            || (commanded && recently.is_some_and(|then| here.share_since(then) < least));
        ended
    }

    /// [m] Greatest advance since the last change of direction.
    pub(super) fn best_advance(&self) -> f64 {
        self.best_advance
    }

    /// Whether half a window has passed without progress, so that a stop may be near.
    pub(super) fn falters(&self) -> bool {
        self.falters
    }
}
