//! One step: attempted, judged by its local error, and kept or replaced by a shorter one.

#[cfg(test)]
mod tests;

use super::Simulation;
use super::attempt::Attempt;
use crate::contact::Contact;
use crate::dynamics::{SHORTEST, SetPoint};
use crate::engine::Command;
use crate::error::{Error, SimulationError};
use crate::geometry::Vector;
use crate::run::step_length::{SAME_TIME, StepRule, arrive};
use crate::solver::Effort;
use crate::units::{Metres, MetresPerSecond, Seconds};

/// [m/s] A gap that closes faster is a collision; slower ones are contacts that open and close. Jammed small gear
/// wheels rattle at some mm/s; with a limit of 10 mm/s they would shake themselves free too often.
const COLLISION_SPEED: MetresPerSecond = MetresPerSecond(0.001);
/// [s] Gaps that close within this time after the first strike belong to the same impact; the step ends then.
const SAME_IMPACT: Seconds = Seconds(1e-5);
/// [s] Time before a strike at which the preceding step ends.
const LEAD: Seconds = Seconds(1e-5);
/// [s] Length of the step with a strike, if a step precedes it.
const COLLISION_STEP: Seconds = Seconds(LEAD.0 + SAME_IMPACT.0);
/// [m] Depth up to which new contacts are found; half of what counts as penetration.
const UNSEEN: Metres = Metres(5e-4);
/// Acceleration of parts within a step that the search for contacts allows for, in units of gravity.
const SPEED_GAIN: f64 = 2.0;
/// A step that is cut short by more than this fraction searches for its contacts again.
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

    /// [s] Length of the last step; 0 if the time to its end was only rounding.
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
            // The rest is rounding.
            (self.time, self.last.length) = (limit, 0.0);
            return Ok(());
        }
        let h = self.step_control.next(self.step_rule, self.time, limit);
        // Its buffers are reused.
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

    /// Attempts a step of at most `h` [s], as long as its accuracy allows; returns the solver's work, including dropped
    /// attempts.
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

    /// Whether an attempt is accepted; if not, the length to try instead [s].
    fn judge(&mut self, attempt: &Attempt) -> Result<(), f64> {
        if attempt.strikes && attempt.state.is_finite() {
            return Ok(());
        }
        if self.strays_too_far(attempt) {
            return Err(0.5 * attempt.length);
        }
        let error = self.local_error(attempt);
        self.step_control
            .judge(self.step_rule, attempt.length, error)
    }

    /// [m] The local error of an attempt, if needed; infinite if its state is not finite.
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
            let ahead = (0.5 * h, 0.5 * travel);
            if h > 2.0 * COLLISION_STEP.value()
                && self
                    .dynamics
                    .has_lost(&self.state, ahead, self.strays(0.5 * h))
            {
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

    /// The same for `h` [s] in another engine; after a failure of that, the state is not finite.
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

    /// [s] Length of the next step, at most `h`, and whether something strikes the ground in it.
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

    /// Finds the contacts of a step of `h` [s]; returns the largest possible motion in it [m].
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
        attempt.room = self.leave_out(attempt, half, speed);
        let contacts = &mut attempt.contacts;
        self.dynamics.recognise(contacts, travel);
        attempt.dents.clone_from(&self.dents);
        attempt.dents.forgive(contacts, self.dynamics.loaded());
        let push = self.commands.push.at(self.time + half);
        self.dynamics.outer_force = Vector::new(push, 0.0);
        self.dynamics.prepare(&self.state, contacts, (h, travel));
        travel
    }

    /// [s] Time for which the last search for contacts is valid: nothing beyond its range may get deeper into the robot
    /// than the next search looks, which is in the middle of the next step.
    fn contacts_known_for(&self) -> f64 {
        self.known_for(
            self.last.sight,
            self.dynamics.fastest(&self.state, self.reach),
        )
    }

    /// [s] The same for a search with this range [m], at a speed [m/s].
    fn known_for(&self, sight: f64, speed: f64) -> f64 {
        let room = 2.0 * (sight + UNSEEN.value());
        2.0 * room / (speed + (speed * speed + 4.0 * self.gain() * room).sqrt())
    }

    /// [m/s^2] Largest acceleration of any part.
    fn gain(&self) -> f64 {
        SPEED_GAIN * self.scenario.gravity
    }

    /// Removes contacts, found `half` [s] ahead in the middle of a step, whose gaps stay open in it, unless they might
    /// get deeper than the next search looks; returns the smallest gap [m] of those removed at these velocities.
    fn leave_out(&self, attempt: &mut Attempt, half: f64, speed: f64) -> f64 {
        let mut least = f64::INFINITY;
        let near = self.scenario.solver.prediction_distance;
        let is_far = |contact: &Contact| contact.distance >= near;
        if matches!(self.step_rule, StepRule::Fixed(_)) || !attempt.contacts.iter().any(is_far) {
            return least;
        }
        let next = half + 0.5 * self.known_for(attempt.sight, speed);
        let [strays, later] = [2.0 * half, half + next].map(|time| self.strays(time));
        attempt.contacts.retain(|contact| {
            let gap = contact.distance;
            if !is_far(contact) {
                return true;
            }
            let closing = self.dynamics.closing(contact, (&self.state, half));
            let room = gap - closing.within(half);
            let stays = room < strays || gap + UNSEEN.value() - closing.within(next) < later;
            if !stays {
                least = least.min(room);
            }
            stays
        });
        least
    }

    /// Whether forces have moved an attempt farther than the gaps of removed contacts allow.
    fn strays_too_far(&self, attempt: &Attempt) -> bool {
        let far = || {
            self.dynamics
                .strayed(&self.state, attempt.length, self.reach)
        };
        attempt.room.is_finite() && attempt.length > SHORTEST.value() && far() > attempt.room
    }

    /// [m] Largest deviation that forces cause in a `time` [s] from the motion without them.
    fn strays(&self, time: f64) -> f64 {
        0.5 * self.gain() * time * time
    }

    /// Makes an attempt the last step, by exchanging their contents.
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

/// [s] Length to take of a step of `h` [s], with `left` [s] until something changes, if something strikes the ground at
/// this time [s]; and whether it does so in that piece.
fn cut_at_strike(strike: f64, h: f64, left: f64) -> (f64, bool) {
    // Leaves enough for the collision.
    let before = (strike - LEAD.value()).min(left - COLLISION_STEP.value());
    if before > COLLISION_STEP.value() {
        return (before, strike <= before);
    }
    let after = (strike + SAME_IMPACT.value())
        .min(h.max(COLLISION_STEP.value()))
        .min(left);
    // Avoids a short step at the end.
    let piece = if left <= h && left - after < LEAD.value() {
        left
    } else {
        after
    };
    (piece, strike <= piece)
}
