//! What to keep of a run, and how much that is.

use crate::diagnosis::Wanted;
use crate::robot::Model;
use crate::scenario::Scenario;

/// What to keep of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// [s] Time between two samples.
    pub sample_interval: f64,
    /// Keep the trace and the contact table; without it only outcome, metrics and events.
    pub history: bool,
    /// What to try if the run ends in a stop, besides what its outcome needs.
    pub trials: Wanted,
}

impl Default for Record {
    fn default() -> Self {
        Self {
            sample_interval: 0.01,
            history: true,
            trials: Wanted::default(),
        }
    }
}

impl Record {
    /// Only outcome, metrics and events.
    pub fn summary() -> Self {
        Self {
            history: false,
            ..Self::default()
        }
    }

    /// Number of samples of a run of full duration.
    pub(crate) fn samples(&self, scenario: &Scenario) -> u64 {
        (scenario.duration / self.sample_interval).ceil() as u64 + 2
    }
}

/// Numbers of the recorded things that a robot has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns {
    pub parts: usize,
    pub drives: usize,
    pub shoes: usize,
    pub flippers: usize,
}

impl Columns {
    /// Bytes of a row of the contact table.
    pub(crate) const BYTES_A_CONTACT: u64 = 15 * 8;

    pub(crate) fn of(model: &Model) -> Self {
        Self {
            parts: model.parts.len(),
            drives: model.drives,
            shoes: model.shoes(),
            flippers: model.flippers.len(),
        }
    }
}
