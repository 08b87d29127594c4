//! The length of the next step: a given one, or one whose local error is what was asked for.

use crate::units::Seconds;
use serde::{Deserialize, Serialize};

/// [s] Longest step: the accuracy of rates gains nothing from a limit, but what is looked at between two steps does.
const LONGEST: Seconds = Seconds(0.016);
/// [s] Shortest step that is tried for the sake of accuracy.
const SHORTEST: Seconds = Seconds(2e-5);
/// [s] Length of the first step.
const FIRST: Seconds = Seconds(1e-3);
/// [rad] Farthest that anything may turn in a step: it would pass over corners without contact.
pub(crate) const FARTHEST_TURN: f64 = 0.7;
/// Exponents of the controller, on the last error and on the one before (Gustafsson 1991), and the order of the
/// error.
const PROPORTIONAL: f64 = 0.7;
const MEMORY: f64 = 0.4;
const ORDER: f64 = 2.0;
/// By how much a step may grow or shrink over the one before.
const GROWTH: f64 = 2.5;
const SHRINKAGE: f64 = 0.1;
/// Share of the accuracy that the next step aims at.
const AIM: f64 = 0.8;
/// A step is taken again if its error exceeds the accuracy by this factor.
const TOO_MUCH: f64 = 1.5;
/// Smallest error in units of the accuracy that the controller remembers.
const LEAST: f64 = 1e-3;
/// [s] Times closer than this are the same.
pub(in crate::run) const SAME_TIME: Seconds = Seconds(1e-9);

/// How long steps are.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rule {
    /// [s] As long as given.
    Fixed(f64),
    /// [m] Such that their local error is this.
    Accuracy { accuracy: f64, longest: f64 },
}

impl Rule {
    /// Steps of an accuracy [m] of a robot of which nothing turns faster than a rate [rad/s].
    pub(super) fn accurate(accuracy: f64, rate: f64) -> Self {
        Self::Accuracy {
            accuracy,
            longest: LONGEST.value().min(FARTHEST_TURN / rate),
        }
    }
}

/// Decides how long the next step is.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Pace {
    /// [s] Length that the last errors suggest.
    wanted: f64,
    /// The last error in units of the accuracy.
    last: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            wanted: FIRST.value(),
            last: 1.0,
        }
    }
}

impl Pace {
    /// [s] Length of the next step, which is to end at `limit` at the latest.
    pub(super) fn next(&self, rule: Rule, time: f64, limit: f64) -> f64 {
        let (limit, wanted) = match rule {
            Rule::Fixed(step) => {
                let next = ((time + SAME_TIME.value()) / step).floor() + 1.0;
                (limit.min(next * step), step)
            }
            Rule::Accuracy { longest, .. } => (limit, self.wanted.min(longest)),
        };
        let left = limit - time;
        if left <= wanted + SAME_TIME.value() {
            left
        } else {
            // Leaves no short step for the end.
            wanted.min(0.5 * left)
        }
    }

    /// Whether a step of `h` [s] with this error [m] will do; if not, how long to try instead.
    pub(super) fn judge(&mut self, rule: Rule, h: f64, error: f64) -> Result<(), f64> {
        let Rule::Accuracy { accuracy, .. } = rule else {
            return Ok(());
        };
        let ratio = (error / accuracy).max(LEAST);
        let too_much = ratio > TOO_MUCH;
        let share = AIM / ratio;
        if too_much && h > SHORTEST.value() {
            let factor = if ratio.is_finite() {
                libm::pow(share, 1.0 / ORDER).clamp(SHRINKAGE, 0.7)
            } else {
                SHRINKAGE
            };
            self.wanted = (h * factor).max(SHORTEST.value());
            return Err(self.wanted);
        }
        let factor = libm::pow(share, PROPORTIONAL / ORDER) * libm::pow(self.last, MEMORY / ORDER);
        let next = (h * factor.clamp(SHRINKAGE, GROWTH)).max(SHORTEST.value());
        // A step that was cut short says nothing against a longer one.
        self.wanted = if factor >= 1.0 {
            next.max(self.wanted)
        } else {
            next
        };
        self.wanted = self.wanted.min(LONGEST.value());
        self.last = ratio;
        Ok(())
    }

    /// One that no step leaves behind.
    #[cfg(test)]
    pub(super) fn never() -> Self {
        Self {
            wanted: -1.0,
            last: 1.0,
        }
    }

    /// Whether steps can have led to it.
    pub(super) fn fits(&self) -> bool {
        (0.0..=LONGEST.value()).contains(&self.wanted) && self.last.is_finite() && self.last > 0.0
    }
}

/// [s] The time after a step that is to end at `limit` if it comes near it.
pub(super) fn arrive(time: f64, limit: f64) -> f64 {
    if (limit - time).abs() < SAME_TIME.value() {
        limit
    } else {
        time
    }
}
