//! What a monitor has observed of a run; part of a snapshot.

use serde::{Deserialize, Serialize};

use super::progress::Progress;
use super::{IntrusionWatch, Loads, Outcome, Shaking, Signals};
use crate::robot::Model;
use crate::solver::Effort;
use crate::terrain::Profile;
use crate::units::Seconds;

/// [s] Time between two checks of the progress; far shorter than any stop window.
pub(super) const LOOK: Seconds = Seconds(0.01);

/// What a monitor has observed of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Seen {
    pub(super) looks: u64,
    pub(super) last_time: f64,
    pub(super) progress: Progress,
    pub(super) signals: Signals,
    /// Forces since the last check.
    pub(super) loads: Loads,
    pub(super) intrusions: IntrusionWatch,
    pub(super) anchor: Option<Anchor>,
    pub(super) goal_since: Option<f64>,
    /// [m] How far the robot was beyond the goal at the last reading.
    pub(super) beyond: f64,
    pub(super) ended: Option<Outcome>,
    pub(super) stays: bool,
    /// [s] When the goal was first held, if ever.
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
    /// Shaking of the chassis so far.
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

impl Seen {
    /// No observations, at a time [s].
    pub(crate) fn from(time: f64) -> Self {
        Self {
            looks: (time / LOOK.value()).ceil() as u64,
            last_time: time,
            progress: Progress::default(),
            signals: Signals::default(),
            loads: Loads::default(),
            intrusions: IntrusionWatch::default(),
            anchor: None,
            goal_since: None,
            beyond: 0.0,
            ended: None,
            stays: false,
            time_to_clear: f64::INFINITY,
            max_penetration: 0.0,
            max_angle: f64::NEG_INFINITY,
            min_angle: f64::INFINITY,
            drive_work: 0.0,
            path_length: 0.0,
            shaking: Shaking::default(),
            max_track_tension: 0.0,
            max_pin_gap: 0.0,
            max_guide_penetration: 0.0,
            max_sprocket_slip: 0.0,
            effort: Effort::default(),
        }
    }

    /// Whether these can be the observations of a robot on these lanes up to a time [s].
    pub(crate) fn fits(&self, time: f64, model: &Model, lanes: &[Profile]) -> bool {
        let parts = model.parts.len();
        // Checks are counted; if the count were ahead of time, there would be none for a while.
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
    /// Signature of what bears there.
    pub(super) bearing: u64,
}
