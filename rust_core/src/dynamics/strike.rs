//! When a contact strikes the ground in a step, if velocities go on changing as in the last one.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::Dynamics;
use super::state::State;
use super::touch::Touch;
use super::trend::Trend;
use crate::robot::Model;

/// Near the lowest point of a tip its gap is fitted again over this share of the step to either side: over a whole step a
/// wheel turns by up to [`crate::run::FARTHEST_TURN`], and a parabola is wrong by 10 um.
const CLOSELY: f64 = 0.125;

/// A gap as a function of time: `gap + slope s + bend s^2` at a time `s` after `at`.
#[derive(Clone, Copy, Debug)]
struct Parabola {
    at: f64,
    gap: f64,
    slope: f64,
    bend: f64,
}

impl Parabola {
    /// The parabola through the gaps `apart` [s] before the time `at` [s], at it, and `apart` after it.
    fn through([before, gap, after]: [f64; 3], at: f64, apart: f64) -> Self {
        Self {
            at,
            gap,
            slope: 0.5 * (after - before) / apart,
            bend: 0.5 * (before + after - 2.0 * gap) / (apart * apart),
        }
    }

    /// The same with an opening speed that in addition grows by `gain` [m/s^2] from a time of 0 on.
    fn speeding_up(self, gain: f64) -> Self {
        let Self {
            at,
            gap,
            slope,
            bend,
        } = self;
        Self {
            at,
            gap: gap + 0.5 * gain * at * at,
            slope: slope + gain * at,
            bend: bend + 0.5 * gain,
        }
    }

    /// [s] When the gap is smallest, if it shrinks and grows again.
    fn lowest(&self) -> Option<f64> {
        (self.bend > 0.0).then(|| self.at - 0.5 * self.slope / self.bend)
    }

    /// [s] When the gap closes, and [m/s] how fast.
    fn lands(&self) -> Option<(f64, f64)> {
        let squared = self.slope * self.slope - 4.0 * self.bend * self.gap;
        let speed = (squared >= 0.0).then(|| squared.sqrt())?;
        let closing = speed - self.slope;
        (closing > 0.0).then(|| (self.at + 2.0 * self.gap / closing, speed))
    }
}

impl Dynamics {
    /// [s] When the first part strikes the ground faster than `speed` [m/s] in a step of `h` [s], if velocities go on changing
    /// with this trend; infinite if none does. Also infinite with chains: their shoes hit the guide all the time, but are
    /// light, and so are their impacts.
    pub(crate) fn next_strike(
        &self,
        state: &State,
        (h, speed): (f64, f64),
        trend: Option<Trend>,
    ) -> f64 {
        if !self.chains.is_empty() {
            return f64::INFINITY;
        }
        let unknowns = &self.problem.unknowns;
        let last = trend.map(|trend| {
            let mut before = unknowns.clone();
            trend.write_velocities(self.problem.layout, &mut before);
            (trend, before)
        });
        let contacts = self.touches.iter().zip(&self.problem.contacts);
        let times = contacts.filter_map(|(touch, solved)| {
            let slope = solved.normal.along(unknowns);
            let gain = (last.as_ref()).map_or(0.0, |(trend, before)| {
                trend.gain(slope, solved.normal.along(before))
            });
            touch.strike((slope, gain), state, &self.model, (h, speed))
        });
        times.fold(f64::INFINITY, f64::min)
    }
}

impl Touch {
    /// [s] When the gap closes, if faster than `speed` [m/s], in a step of `h` [s]. It opens at `slope` [m/s], which grows by
    /// `gain` [m/s^2].
    ///
    /// A tip that a drive moves may come down and go up again within a step.
    pub(super) fn strike(
        &self,
        (slope, gain): (f64, f64),
        state: &State,
        model: &Model,
        (h, speed): (f64, f64),
    ) -> Option<f64> {
        let start = self.gap_before;
        if start <= 0.0 {
            // It is closed already; if it closes further, the local error makes the step short.
            return None;
        }
        let carried = self.mount().filter(|_| self.middle.carried.is_moving());
        let Some(mount) = carried else {
            let course = Parabola {
                at: 0.0,
                gap: start,
                slope,
                bend: 0.0,
            };
            let (time, closing) = course.speeding_up(gain).lands()?;
            return (closing > speed).then_some(time);
        };
        let gap = |time| self.gap_after(state, model, (mount, time));
        let gaps = [start, self.middle.gap, gap(h)];
        let whole = Parabola::through(gaps, 0.5 * h, 0.5 * h).speeding_up(gain);
        let course = match whole.lowest().filter(|time| (0.0..h).contains(time)) {
            None => whole,
            Some(lowest) => {
                let apart = CLOSELY * h;
                let gaps = [lowest - apart, lowest, lowest + apart].map(gap);
                Parabola::through(gaps, lowest, apart).speeding_up(gain)
            }
        };
        let (time, closing) = course.lands()?;
        // The parabola about the lowest point is inexact at the beginning of the step, where the gap is still open.
        (closing > speed).then_some(time.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn of(gap: impl Fn(f64) -> f64) -> Parabola {
        Parabola::through([0.1, 0.3, 0.5].map(gap), 0.3, 0.2)
    }

    #[test]
    fn a_gap_like_a_parabola_lands_where_that_does() {
        let fall = of(|t| 2.0 - 3.0 * t * t);
        let (time, speed) = fall.lands().expect("it falls");
        assert_relative_eq!(time, (2.0_f64 / 3.0).sqrt(), max_relative = 1e-12);
        assert_relative_eq!(speed, 6.0 * time, max_relative = 1e-12);
        assert_eq!(fall.lowest(), None);
    }

    #[test]
    fn the_first_of_two_roots_counts() {
        let dip = of(|t| (t - 0.2) * (t - 0.8));
        let (time, speed) = dip.lands().expect("it dips");
        assert_relative_eq!(time, 0.2, max_relative = 1e-12);
        assert_relative_eq!(speed, 0.6, max_relative = 1e-12);
        assert_relative_eq!(dip.lowest().expect("it turns"), 0.5, max_relative = 1e-12);
        let steeper = of(|t| 5.0 * (t - 0.2) * (t - 0.8));
        assert_relative_eq!(
            steeper.lowest().expect("it turns"),
            0.5,
            max_relative = 1e-12
        );
    }

    #[test]
    fn a_gap_may_be_on_its_way_up_and_land() {
        let (gap, slope, gain) = (0.02, 0.1, -2.0);
        let rises = of(|t| gap + slope * t);
        assert!(rises.lands().is_none());
        let (time, speed) = rises.speeding_up(gain).lands().expect("it falls");
        assert_relative_eq!(
            gap + (slope + 0.5 * gain * time) * time,
            0.0,
            epsilon = 1e-15
        );
        assert_relative_eq!(speed, -slope - gain * time, max_relative = 1e-12);
    }

    #[test]
    fn a_gap_that_stays_open_does_not_land() {
        assert!(of(|t| 1.0 + t * t).lands().is_none());
        assert!(of(|t| 1.0 + t).lands().is_none());
    }
}
