//! One step: attempted, judged by its local error, and kept, or dropped for a shorter one.

use super::Simulation;
use super::attempt::Attempt;
use crate::dynamics::SetPoint;
use crate::engine::Command;
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
const SPEED_GAIN: f64 = 2.0;
/// A step that is cut short by more than this share looks for its contacts again.
const CUT: f64 = 0.1;

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
        self.last.length
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
        let h = self.step_control.next(self.step_rule, self.time, limit);
        // Its buffers are used again.
        let mut attempt = std::mem::take(&mut self.attempt);
        let effort = if self.engine.is_some() {
            self.attempt_in_engine(&mut attempt, h);
            Effort::default()
        } else {
            let h = h.min(self.contacts_known_for());
            self.attempt_accurately(&mut attempt, h, limit)
        };
        self.steps += 1;
        let kept = self.keep(&mut attempt, limit);
        self.attempt = attempt;
        kept?;
        self.observe(Effort { steps: 1, ..effort });
        Ok(())
    }

    /// Attempts a step of `h` [s] at most, as long as its accuracy allows; returns the solver's work, with that of
    /// attempts that were dropped.
    fn attempt_accurately(&mut self, attempt: &mut Attempt, mut h: f64, limit: f64) -> Effort {
        let mut effort = Effort::default();
        loop {
            let attempted = self.attempt_step(attempt, h, limit - self.time);
            effort = effort.plus(self.dynamics.effort());
            match attempted.and_then(|()| self.judge(attempt)) {
                Ok(()) => return effort,
                Err(shorter) => {
                    self.dynamics.rewind();
                    effort.repeated_steps += 1;
                    h = shorter;
                }
            }
        }
    }

    /// Whether an attempt will do; if not, how long to try instead [s].
    fn judge(&mut self, attempt: &Attempt) -> Result<(), f64> {
        if attempt.strikes && attempt.state.is_finite() {
            return Ok(());
        }
        let error = self.local_error(attempt);
        self.step_control
            .judge(self.step_rule, attempt.length, error)
    }

    /// [m] The local error of an attempt, if that matters; infinite if its state is not finite.
    fn local_error(&self, attempt: &Attempt) -> f64 {
        if let StepRule::Fixed(_) = self.step_rule {
            return 0.0;
        }
        if !attempt.state.is_finite() {
            return f64::INFINITY;
        }
        let states = [&self.state, &attempt.state];
        let error = self
            .dynamics
            .local_error(states, attempt.length, self.reach);
        let overrun = (self.dynamics).overrun(&attempt.contacts, &self.ground.lanes);
        error.max(overrun)
    }

    /// Attempts a step of `h` [s], of `left` [s] until something changes. It ends just before a part strikes the
    /// ground; the next, with the impact, is short. Fails with the time [s] after which a force jumps if it should end
    /// there instead.
    fn attempt_step(&mut self, attempt: &mut Attempt, h: f64, left: f64) -> Result<(), f64> {
        let mut h = h;
        let strikes = loop {
            let travel = self.find_contacts(attempt, h);
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
        let set_point = self.set_points(h);
        self.dynamics
            .command_flippers(&self.state, self.commands.flippers, h, self.last.trend());
        attempt.state.copy(&self.state);
        self.dynamics
            .advance(&mut attempt.state, set_point, (h, strikes))?;
        (attempt.length, attempt.strikes) = (h, strikes);
        attempt.set_point = set_point.end;
        Ok(())
    }

    /// The same of `h` [s] in another engine; what that has given up is not finite.
    fn attempt_in_engine(&mut self, attempt: &mut Attempt, h: f64) {
        let set_point = self.set_points(h).end;
        let push = self.commands.push.at(self.time + 0.5 * h);
        let travel = self.dynamics.fastest(&self.state, self.reach) * h;
        attempt.state.copy(&self.state);
        (attempt.length, attempt.strikes) = (h, false);
        attempt.set_point = set_point;
        let Some(engine) = &mut self.engine else {
            return;
        };
        let world = (self.dynamics.model(), &*self.ground);
        let contacts = engine.step(world, &mut attempt.state, Command { set_point, push }, h);
        if engine.has_lost_something() {
            attempt.state.angle = f64::NAN;
        }
        self.dynamics.take_contacts(contacts, travel, h);
    }

    /// The set-points of the drivetrain in the next `h` [s].
    fn set_points(&self, h: f64) -> SetPoint {
        SetPoint {
            middle: self.set_point_after(0.5 * h),
            end: self.set_point_after(h),
        }
    }

    /// [s] How much of the next `h` to take at once, and whether something strikes the ground in it.
    fn piece(&self, h: f64, left: f64) -> (f64, bool) {
        let fast = (h, COLLISION_SPEED.value());
        let strike = self
            .dynamics
            .next_strike(&self.state, fast, self.last.trend());
        if strike > h {
            (h, false)
        } else {
            cut_at_strike(strike, h, left)
        }
    }

    /// [s] For how long the last search for contacts holds: nothing that it could not see may get deeper into the
    /// robot than the next one looks, which is in the middle of the next step.
    fn contacts_known_for(&self) -> f64 {
        let speed = self.dynamics.fastest(&self.state, self.reach);
        let room = 2.0 * (self.last.sight + UNSEEN.value());
        2.0 * room / (speed + (speed * speed + 4.0 * self.gain() * room).sqrt())
    }

    /// [m/s^2] How fast any part may gain speed.
    fn gain(&self) -> f64 {
        SPEED_GAIN * self.scenario.gravity
    }

    /// Finds the contacts of a step of `h` [s]; returns how far anything may move in it [m].
    fn find_contacts(&mut self, attempt: &mut Attempt, h: f64) -> f64 {
        let speed = self.dynamics.fastest(&self.state, self.reach);
        let travel = (speed + self.gain() * h) * h;
        // A fast body finds a contact one step before it closes.
        let prediction = self.scenario.solver.prediction_distance.max(travel);
        attempt.sight = prediction - 0.5 * travel;
        // In the middle of the step: with normals from its beginning, the error would be as large as the angle that
        // a wheel turns round an edge in half a step.
        let (half, model) = (0.5 * h, self.dynamics.model());
        let middle = self.state.pose_after(half, model);
        let (running, contacts) = (&mut attempt.running, &mut attempt.contacts);
        self.state.running_after(half, model, running);
        self.contact.find(middle, running, prediction, contacts);
        self.dynamics.recognise(contacts, travel);
        attempt.dents.clone_from(&self.dents);
        attempt.dents.forgive(contacts, self.dynamics.loaded());
        let push = self.commands.push.at(self.time + half);
        self.dynamics.outer_force = Vector::new(push, 0.0);
        self.dynamics.prepare(&self.state, contacts, (h, travel));
        travel
    }

    /// Makes an attempt the last step; what it replaces is left in it.
    fn keep(&mut self, attempt: &mut Attempt, limit: f64) -> Result<(), SimulationError> {
        std::mem::swap(&mut self.last.before, &mut self.state);
        std::mem::swap(&mut self.state, &mut attempt.state);
        if !self.state.is_finite() {
            let body = "the robot".to_owned();
            return Err(SimulationError {
                step: self.steps,
                body,
            });
        }
        let (h, strikes) = (attempt.length, attempt.strikes);
        (self.last.began, self.last.length) = (self.time, h);
        self.last.free = if strikes { 0.0 } else { h };
        self.last.set_point = self.set_point;
        self.set_point = attempt.set_point;
        self.time = arrive(self.time + h, limit);
        if self.engine.is_none() {
            self.last.sight = attempt.sight;
            self.dynamics.keep(&attempt.contacts, h, strikes);
            std::mem::swap(&mut self.dents, &mut attempt.dents);
            self.dents.heal(self.dynamics.loaded());
        }
        Ok(())
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
    use crate::robot::Running;
    use crate::run::ValidScenario;
    use crate::scenario::{Scenario, Track, Wheel};

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
            let (mut running, mut contacts) = (Running::default(), Vec::new());
            self.state.running_after(time, model, &mut running);
            self.contact.find(pose, &running, 0.05, &mut contacts);
            let gaps = contacts.iter().map(|contact| contact.distance);
            gaps.fold(f64::INFINITY, f64::min)
        }

        /// A step of `h` [s] at most, not kept.
        fn tried(&mut self, mut h: f64) -> Attempt {
            let mut attempt = Attempt::default();
            while let Err(shorter) = self.attempt_step(&mut attempt, h, f64::INFINITY) {
                h = shorter;
            }
            attempt
        }
    }

    /// A robot on gear wheels, at rest.
    fn on_gears(phase: f64) -> Simulation {
        let text = include_str!("../../../../tests/scenarios/judge_gear3_step.json");
        let mut scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        scenario.start.track_phase = phase;
        Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"))
    }

    /// Gear wheels that turn by 0.5 rad in a step, above level ground.
    fn spinning(phase: f64) -> Simulation {
        let mut simulation = on_gears(phase);
        let radius = simulation.dynamics.model().drive_radius;
        simulation.state.drives[0].spin = -0.5 / STEP * 0.06 / radius;
        simulation.state.center.x -= 0.5;
        simulation
    }

    /// Their phases are no mirror image of themselves: which way they turn matters.
    #[test]
    fn a_robot_starts_with_its_lowest_tip_on_the_ground_whatever_its_phase() {
        for phase in [0.0, 0.004, 0.013, 0.031] {
            let mut scenario = on_gears(phase).scenario;
            if let Track::Line(line) = &mut scenario.robot.track
                && let Wheel::Gear(wheel) = &mut line.wheel
            {
                wheel.phase_fraction = 0.2;
            }
            let checked = ValidScenario::new(&scenario).expect("it is valid");
            let gap = Simulation::new(&checked).gap_after(0.0);
            assert!(gap.abs() < 1e-9, "{gap} m at {phase} m");
        }
    }

    /// At its start everything is at rest, and the ground farther away than contacts are searched for then.
    #[test]
    fn a_long_step_sees_the_ground_that_it_falls_on() {
        for i in 1..10 {
            let mut simulation = on_gears(0.0);
            simulation.state.center.y += 5e-5 * f64::from(i);
            let tried = simulation.tried(0.012);
            let error = simulation.local_error(&tried);
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
        let tried = simulation.tried(STEP);
        let off = tried.length - left;
        assert!(
            off.abs() < COLLISION_STEP.value(),
            "{} s, {left} s",
            tried.length
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

    /// The step ends 10 us after the strike. Where less than 10 us are left then, a step that may be as long takes them.
    #[test]
    fn a_step_with_a_strike_leaves_no_short_rest() {
        for (strike, h, left, piece) in [
            (10e-6, 25e-6, 25e-6, 25e-6),
            (10e-6, 35e-6, 35e-6, 20e-6),
            (12e-6, 22e-6, 25e-6, 22e-6),
        ] {
            let (found, strikes) = cut_at_strike(strike, h, left);
            assert!((found - piece).abs() < 1e-15, "{found} s, {piece} s");
            assert!(strikes);
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
            let tried = simulation.tried(STEP);
            // Near the end of a step, the corner of a tip that lands may be another than in its middle.
            if expected < 0.9 * STEP {
                found += 1;
                let off = tried.length - expected;
                assert!(off.abs() < 0.05 * STEP, "{} s, {expected} s", tried.length);
            } else if expected > STEP {
                assert!(tried.length >= STEP, "{} s", tried.length);
            }
        }
        assert!(found > 10, "{found}");
    }
}
