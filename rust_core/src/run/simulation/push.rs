//! A push at the centre of mass that rises evenly to its force.

use serde::{Deserialize, Serialize};

/// A horizontal force over time: it rises evenly from one value to another, and stays there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Push {
    /// [N] Force before it rises.
    from: f64,
    /// [N] Force once it has risen.
    to: f64,
    /// [s] When it begins to rise, and for how long.
    since: f64,
    rise: f64,
}

impl Push {
    /// [N] Largest force that can be asked for: the weight of the heaviest robot.
    const MOST: f64 = 1e15;

    /// A push that rises from what it is now to a force [N].
    pub(super) fn raised(self, force: f64, now: f64, rise: f64) -> Self {
        Self {
            from: self.at(now),
            to: force,
            since: now,
            rise,
        }
    }

    /// [N] The force at a time [s].
    pub(super) fn at(self, time: f64) -> f64 {
        if time >= self.end() {
            self.to
        } else if time <= self.since {
            self.from
        } else {
            self.from + (self.to - self.from) * (time - self.since) / self.rise
        }
    }

    /// [s] When it has risen.
    pub(super) fn end(self) -> f64 {
        self.since + self.rise
    }

    /// Whether it can have been asked for.
    pub(super) fn fits(self) -> bool {
        let most = -Self::MOST..=Self::MOST;
        most.contains(&self.from)
            && most.contains(&self.to)
            && self.since.is_finite()
            && (0.0..f64::INFINITY).contains(&self.rise)
    }

    /// Whether a force [N] can be asked for.
    pub(super) fn may_be(force: f64) -> bool {
        (-Self::MOST..=Self::MOST).contains(&force)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // halves of whole numbers

    use super::*;

    #[test]
    fn a_push_rises_evenly_and_stays() {
        let push = Push::default().raised(8.0, 1.0, 2.0);
        assert_eq!(
            [1.0, 1.5, 3.0, 9.0].map(|time| push.at(time)),
            [0.0, 2.0, 8.0, 8.0]
        );
        let more = push.raised(16.0, 2.0, 1.0);
        assert_eq!([2.0, 2.5, 3.0].map(|time| more.at(time)), [4.0, 10.0, 16.0]);
    }

    #[test]
    fn a_push_without_a_rise_is_there_at_once() {
        let push = Push::default().raised(5.0, 1.0, 0.0);
        assert_eq!([0.5, 1.0].map(|time| push.at(time)), [0.0, 5.0]);
    }
}
