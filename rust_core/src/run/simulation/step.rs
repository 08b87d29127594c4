//! One step: tried, judged by its local error, and kept or tried again with a shorter one.

use super::Simulation;
use crate::dynamics::{SetPoint, Trend};
use crate::error::{Error, SimulationError};
use crate::geometry::Vector;
use crate::run::step_length::{SAME_TIME, StepRule, arrive};
use crate::solver::Effort;
use crate::units::{Metres, MetresPerSecond, Seconds};

/// [m/s] A gap that closes faster is a collision; slower ones are contacts that open and close. Jammed small
/// gear wheels rattle at some mm/s: with 10 mm/s they would shake themselves free too often.
const COLLISION_SPEED: MetresPerSecond = MetresPerSecond(0.001);
/// [s] What closes up to so long after the first strike is of the same blow: the step ends then.
const SAME_BLOW: Seconds = Seconds(1e-5);
/// [s] How long before a strike the step before it ends.
const LEAD: Seconds = Seconds(1e-5);
/// [s] Length of the step with a strike, if it has its time before.
const COLLISION_STEP: Seconds = Seconds(LEAD.0 + SAME_BLOW.0);
/// [m] Depth up to which new contacts are found; half of what counts as sinking in.
const UNSEEN: Metres = Metres(5e-4);
/// How fast parts may gain speed within a step, in units of gravity, as far as the search for contacts looks ahead.
const GAIN: f64 = 2.0;
/// A step that is cut short by more than this share looks for its contacts again.
const CUT: f64 = 0.1;

/// A step that was taken, or tried.
pub(super) struct Taken {
    /// [s] Its length.
    pub h: f64,
    /// Whether something strikes the ground in it.
    pub strikes: bool,
    pub set_point: SetPoint,
}

impl Simulation {
    /// Advances by one step.
    ///
    /// # Errors
    /// [`Error::Simulation`] if the state has become non-finite; the simulation cannot go on then.
    pub fn step(&mut self) -> Result<(), Error> {
        self.step_until(f64::INFINITY)
    }

    /// Advances by a duration [s]; the last step ends with it.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn advance(&mut self, duration: f64) -> Result<(), Error> {
        let end = self.time + duration;
        while self.time < end {
            self.step_until(end)?;
        }
        Ok(())
    }

    /// [s] Length of the last step.
    pub fn last_step(&self) -> f64 {
        self.length
    }

    /// Advances by one step that ends at `limit` [s] at the latest.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn step_until(&mut self, limit: f64) -> Result<(), Error> {
        self.decide();
        let limit = limit.min(self.next_change());
        if limit - self.time < SAME_TIME.value() {
            // Only rounding is left.
            self.time = limit;
            return Ok(());
        }
        self.effort = Effort {
            steps: 1,
            ..Effort::default()
        };
        std::mem::swap(&mut self.before, &mut self.earlier);
        self.before.copy(&self.state);
        let h = self.step_control.next(self.step_rule, self.time, limit);
        let engine = self.engine.take();
        let taken = if let Some(mut engine) = engine {
            let taken = self.take_in(&mut engine, h);
            self.engine = Some(engine);
            taken
        } else {
            self.take(h.min(self.known()), limit)
        };
        self.steps += 1;
        if !self.state.is_finite() {
            let body = "the robot".to_owned();
            let step = self.steps;
            return Err(SimulationError { step, body }.into());
        }
        self.keep_time(&taken, limit);
        if self.engine.is_none() {
            self.keep(&taken);
        }
        self.observe();
        Ok(())
    }

    /// Takes a step of `h` [s] at most, as long as its accuracy allows.
    fn take(&mut self, mut h: f64, limit: f64) -> Taken {
        loop {
            let tried = self.attempt(h, limit - self.time);
            self.effort = self.effort.plus(self.dynamics.effort());
            if tried.strikes && self.state.is_finite() {
                return tried;
            }
            let error = self.local_error(tried.h);
            match self.step_control.judge(self.step_rule, tried.h, error) {
                Ok(()) => return tried,
                Err(shorter) => {
                    self.state.copy(&self.before);
                    self.dynamics.rewind();
                    self.effort.repeated_steps += 1;
                    h = shorter;
                }
            }
        }
    }

    /// [m] The local error of the step that was tried, if that matters; infinite if the state is not finite.
    fn local_error(&self, h: f64) -> f64 {
        if let StepRule::Fixed(_) = self.step_rule {
            return 0.0;
        }
        if !self.state.is_finite() {
            return f64::INFINITY;
        }
        self.dynamics
            .local_error(&self.before, &self.state, h, self.reach)
    }

    /// Tries a step of `h` [s], of `left` [s] until something changes. It ends just before a part strikes the ground; the
    /// next, with the impact, is short.
    fn attempt(&mut self, h: f64, left: f64) -> Taken {
        let mut h = h;
        let strikes = loop {
            let travel = self.find_contacts(h);
            if h > 2.0 * COLLISION_STEP.value() && self.dynamics.has_lost(0.5 * travel) {
                h *= 0.5;
                continue;
            }
            let (piece, strikes) = self.piece(h, left);
            let is_cut = piece < (1.0 - CUT) * h;
            h = piece;
            // The middle of a shorter step is elsewhere.
            if !is_cut {
                break strikes;
            }
        };
        let set_point = SetPoint {
            middle: self.set_point_after(0.5 * h),
            end: self.set_point_after(h),
        };
        let angles = self.targets.map(|target| target.angle);
        let keep_level = self.targets.map(|target| target.keeps_level);
        let trend = Trend::since(&self.earlier, self.free);
        self.dynamics
            .command_flippers(&self.state, angles, keep_level, h, trend);
        self.dynamics
            .advance(&mut self.state, set_point, (h, strikes));
        Taken {
            h,
            strikes,
            set_point,
        }
    }

    /// [s] How much of the next `h` to take at once, and whether something strikes the ground in it.
    fn piece(&self, h: f64, left: f64) -> (f64, bool) {
        let (fast, trend) = (
            (h, COLLISION_SPEED.value()),
            Trend::since(&self.earlier, self.free),
        );
        let strike = self.dynamics.next_strike(&self.state, fast, trend);
        if strike > h {
            (h, false)
        } else {
            cut_at_strike(strike, h, left)
        }
    }

    /// [s] For how long the last search for contacts holds: nothing that it could not see may get deeper into the
    /// robot than the next one looks, which is in the middle of the next step.
    fn known(&self) -> f64 {
        let speed = self.dynamics.fastest(&self.state, self.reach);
        let room = 2.0 * (self.seen_ahead + UNSEEN.value());
        2.0 * room / (speed + (speed * speed + 4.0 * self.gain() * room).sqrt())
    }

    /// [m/s^2] How fast any part may gain speed.
    fn gain(&self) -> f64 {
        GAIN * self.scenario.gravity
    }

    /// Returns how far anything may move in the step [m].
    fn find_contacts(&mut self, h: f64) -> f64 {
        let speed = self.dynamics.fastest(&self.state, self.reach);
        let travel = (speed + self.gain() * h) * h;
        // A fast body finds a contact one step before it closes.
        let prediction = self.scenario.solver.prediction_distance.max(travel);
        self.seen_now = prediction - 0.5 * travel;
        // In the middle of the step: with normals from its beginning, the error would be as large as the angle that
        // a wheel turns round an edge in half a step.
        let (half, model) = (0.5 * h, self.dynamics.model());
        let middle = self.state.pose_after(half, model);
        self.state.running_after(half, model, &mut self.then);
        self.contact
            .find(middle, &self.then, prediction, &mut self.contacts);
        self.dynamics.recognise(&mut self.contacts, travel);
        self.dents_now.clone_from(&self.dents);
        let last = self.dynamics.loaded().iter().map(|l| &l.contact);
        self.dents_now.forgive(&mut self.contacts, &last);
        self.dynamics.outer_force = Vector::new(self.push.at(self.time + half), 0.0);
        self.dynamics
            .prepare(&self.state, &self.contacts, (h, travel));
        self.dynamics
            .bound_faces(&self.contacts, &self.ground.lanes);
        travel
    }

    /// Moves the time on by a step.
    fn keep_time(&mut self, taken: &Taken, limit: f64) {
        (self.began, self.length) = (self.time, taken.h);
        self.free = if taken.strikes { 0.0 } else { taken.h };
        self.time = arrive(self.time + taken.h, limit);
        self.set_point_before = self.set_point;
        self.set_point = taken.set_point.end;
    }

    /// Keeps what our own dynamics have found in a step, for the next one.
    fn keep(&mut self, taken: &Taken) {
        self.seen_ahead = self.seen_now;
        self.dynamics
            .keep(&self.state, &self.contacts, taken.h, taken.strikes);
        std::mem::swap(&mut self.dents, &mut self.dents_now);
        let contacts = self.dynamics.loaded().iter().map(|l| &l.contact);
        self.dents.heal(contacts);
    }
}

/// [s] How much to take of a step of `h` [s], of `left` [s] until something changes, in which something strikes the
/// ground at this time [s], and whether it does so in that piece.
fn cut_at_strike(strike: f64, h: f64, left: f64) -> (f64, bool) {
    // Leaves enough for the collision.
    let before = (strike - LEAD.value()).min(left - COLLISION_STEP.value());
    if before > COLLISION_STEP.value() {
        return (before, strike <= before);
    }
    let after = (strike + SAME_BLOW.value())
        .min(h.max(COLLISION_STEP.value()))
        .min(left);
    // Leaves no short step for the end.
    let piece = if left <= h && left - after < LEAD.value() {
        left
    } else {
        after
    };
    (piece, strike <= piece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Checked;
    use crate::scenario::Scenario;

    /// [m] How far the tips of gear wheels reach into the ground at their lowest.
    const DIP: f64 = 5e-6;
    const STEP: f64 = 0.01;
    /// Times at which gaps are looked at in a step.
    const LOOKS: u32 = 2000;

    impl Simulation {
        /// [m] Gap of the lowest tip after a time [s], if nothing changes until then.
        fn gap_after(&mut self, time: f64) -> f64 {
            let model = self.dynamics.model();
            let pose = self.state.pose_after(time, model);
            self.state.running_after(time, model, &mut self.then);
            self.contact
                .find(pose, &self.then, 0.05, &mut self.contacts);
            let gaps = self.contacts.iter().map(|contact| contact.distance);
            gaps.fold(f64::INFINITY, f64::min)
        }
    }

    /// A robot on gear wheels, at rest.
    fn on_gears(phase: f64) -> Simulation {
        let text = include_str!("../../../../tests/scenarios/judge_gear3_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        scenario.start.track_phase = phase;
        Simulation::new(&Checked::new(&scenario).expect("it is valid"))
    }

    /// Gear wheels that turn by 0.5 rad in a step, above level ground.
    fn spinning(phase: f64) -> Simulation {
        let mut simulation = on_gears(phase);
        let radius = simulation.dynamics.model().drive_radius;
        simulation.state.drives[0].spin = -0.5 / STEP * 0.06 / radius;
        simulation.state.center.x -= 0.5;
        simulation
    }

    /// At its start everything is at rest, and the ground farther away than contacts are searched for then.
    #[test]
    fn a_long_step_sees_the_ground_that_it_falls_on() {
        for i in 1..10 {
            let mut simulation = on_gears(0.0);
            simulation.state.center.y += 5e-5 * f64::from(i);
            simulation.before.copy(&simulation.state);
            let tried = simulation.attempt(0.012, f64::INFINITY);
            let error = simulation.local_error(tried.h);
            assert!(tried.strikes || error > 1e-5, "{error} m");
        }
    }

    /// At the speed of its first step it would land almost twice as late.
    #[test]
    fn what_falls_lands_when_it_does() {
        let gap = 5e-5;
        let mut simulation = on_gears(0.0);
        let gravity = simulation.scenario.gravity;
        simulation.state.center.y += gap - simulation.gap_after(0.0);
        simulation.step().expect("it is finite");
        let left = libm::sqrt(2.0 * gap / gravity) - simulation.time();
        let (speed, fallen) = (gravity * simulation.time(), gap - simulation.gap_after(0.0));
        assert!((gap - fallen) / speed > 1.5 * left, "it must speed up");
        simulation.before.copy(&simulation.state);
        let tried = simulation.attempt(STEP, f64::INFINITY);
        let off = tried.h - left;
        assert!(
            off.abs() < COLLISION_STEP.value(),
            "{} s, {left} s",
            tried.h
        );
    }

    /// One that were longer could be found too long again and again.
    #[test]
    fn no_piece_is_longer_than_the_step_that_was_asked_for() {
        let little = 0.3 * COLLISION_STEP.value();
        for h in [
            STEP,
            20.0 * COLLISION_STEP.value(),
            2.0 * COLLISION_STEP.value(),
        ] {
            for left in [h, h + little, h + 0.7 * COLLISION_STEP.value(), 2.0 * h] {
                for strike in [0.0, little, 0.5 * h, h - little, h] {
                    let (piece, strikes) = cut_at_strike(strike, h, left);
                    assert!(piece > 0.0 && piece <= h, "{piece} s of {h} s");
                    assert_eq!(strikes, strike <= piece, "{strike} s, {piece} s of {h} s");
                }
            }
        }
    }

    #[test]
    fn tips_that_come_and_go_within_a_step_strike() {
        let mut found = 0;
        for i in 0..40 {
            let mut simulation = spinning(0.005 * f64::from(i));
            // Two steps bring a tip to the bottom, whatever the phase.
            let times = (0..2 * LOOKS).map(|k| f64::from(k) / f64::from(LOOKS) * STEP);
            let gaps: Vec<f64> = times
                .clone()
                .map(|time| simulation.gap_after(time))
                .collect();
            let lowest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
            simulation.state.center.y -= lowest + DIP;
            let lands = |(time, gap): (f64, &f64)| (*gap < lowest + DIP).then_some(time);
            let expected = times.zip(&gaps).find_map(lands).expect("a tip lands");
            if expected == 0.0 {
                continue;
            }
            let tried = simulation.attempt(STEP, f64::INFINITY);
            // Near the end of a step, the corner of a tip that lands may be another than in its middle.
            if expected < 0.9 * STEP {
                found += 1;
                let off = tried.h - expected;
                assert!(off.abs() < 0.05 * STEP, "{} s, {expected} s", tried.h);
            } else if expected > STEP {
                assert!(tried.h >= STEP, "{} s", tried.h);
            }
        }
        assert!(found > 10, "{found}");
    }
}
