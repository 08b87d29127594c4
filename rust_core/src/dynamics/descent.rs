//! Descent: the solution of all constraints with frozen friction limits, which always exists.
//!
//! With frozen limits the impulses are the gradient of a convex potential of the velocities. Newton's method
//! with a line search that stops where the potential no longer falls ends at the one minimum from any start,
//! as in the primal solvers of friction by penalty (Todorov 2014). The impulses at the minimum take energy
//! out of the motion.
//!
//! The equations: docs/physics.md, "Descent".

use super::Dynamics;
use super::chain::Chain;
use super::damper::Damper;
use super::phase::Phase;
use super::row::Row;
use super::solve::AGREEMENT;
use super::state::{State, Twist};

/// Newton steps at most; a dozen contacts take three to six.
const STEPS: u32 = 30;
/// [m/s] Smaller changes are rounding: at a kink the potential falls no further.
const ROUNDING: f64 = 1e-14;
/// Factor by which friction limits beyond Coulomb's law shrink, at least, when no limits agree.
const SHRINKING: f64 = 0.9;
/// How often limits shrink at most: by then nothing is left of them.
const SHRINKINGS: u32 = 400;

impl Dynamics {
    /// Goes to the minimum for the limits given by the normal impulses; returns whether these give the same
    /// limits again.
    pub(super) fn descend(&mut self, state: &mut State, phase: &Phase) -> bool {
        self.effort.descents += 1;
        self.freeze_limits();
        self.set_servos(state, phase);
        let off = self.go_down(state, phase);
        self.obey_coulombs_law();
        self.end_servos(state, phase);
        if !self.chains.is_empty() && self.switch_motors(state, phase) {
            self.set_actions(state, phase);
            return false;
        }
        off < AGREEMENT
    }

    /// Ends a search in which the limits never agreed: keeps the last impulses unless they gain energy.
    pub(super) fn end_search(&mut self, state: &mut State, phase: &Phase) {
        // With chains or flippers the energy is not summed up; giving way is always safe.
        if self.model.is_one_body() {
            self.balance(state, phase);
        }
        if !self.model.is_one_body() || self.energy_of_contacts(state) > 0.0 {
            self.give_way(state, phase);
        }
    }

    /// Shrinks the limits until all friction obeys Coulomb's law. Sliding contacts may end up with less friction
    /// than the law allows, but gain no energy.
    fn give_way(&mut self, state: &mut State, phase: &Phase) {
        self.freeze_limits();
        self.set_servos(state, phase);
        for _ in 0..SHRINKINGS {
            self.go_down(state, phase);
            let mut fits = true;
            for row in &mut self.rows {
                let limit = row.friction * row.normal_impulse;
                let beyond = row.friction_impulse.abs() - limit;
                if beyond * row.admittance.tangent > AGREEMENT {
                    row.limit = limit.min(SHRINKING * row.limit);
                    fits = false;
                }
            }
            if fits {
                break;
            }
        }
        self.obey_coulombs_law();
        self.end_servos(state, phase);
        // The drives of chains are no servos, and each round one more may reach its limit.
        for _ in 0..self.chains.len() {
            if !self.limit_motors(state, phase) {
                break;
            }
            self.set_actions(state, phase);
            self.go_down(state, phase);
            self.obey_coulombs_law();
        }
    }

    /// Limits friction by the normal impulses that the contacts had last.
    fn freeze_limits(&mut self) {
        for row in &mut self.rows {
            row.limit = row.friction * row.normal_impulse;
        }
    }

    /// Cuts friction to what the current normal impulses allow.
    fn obey_coulombs_law(&mut self) {
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            let limit = row.friction * row.normal_impulse;
            // Not `clamp`, which panics on NaN; a NaN is found after the step, with all others.
            row.friction_impulse = row.friction_impulse.max(-limit).min(limit);
            row.guess_grip();
        }
    }

    /// Goes to the minimum for the current limits; returns the largest velocity that corresponds to the change of
    /// a limit towards the new normal impulses [m/s].
    fn go_down(&mut self, state: &mut State, phase: &Phase) -> f64 {
        self.settle();
        self.chains.iter_mut().for_each(Chain::hold_as_pushed);
        self.choose_dampers(state);
        for step in 0..STEPS {
            self.assemble_frozen(phase);
            let Some(change) = self.solve_for_change(state) else {
                break;
            };
            // The first step of a chain may have to join its pins.
            let share = if step == 0 && !self.chains.is_empty() {
                1.0
            } else {
                self.share_that_falls(state, &change, phase)
            };
            self.move_by(state, &change, share);
            let same = self.choose_dampers(state);
            if (same && share >= 1.0) || share * self.largest(&change) < ROUNDING {
                break;
            }
        }
        let mut off: f64 = 0.0;
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            off = off.max(row.follow_frozen(state));
        }
        if let Some(push) = &mut self.push {
            off = off.max(push.follow_velocities(state));
        }
        self.chains_follow_velocities(state, phase);
        self.turn_with_chassis(state, phase);
        off
    }

    /// Sets each contact's dampers for the current velocities; returns whether none has changed.
    fn choose_dampers(&mut self, state: &State) -> bool {
        let mut same = self.choose_servos(state);
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            let frozen = row.frozen_dampers(row.speeds(state));
            same &= frozen == row.frozen;
            row.frozen = frozen;
        }
        same
    }

    /// Assembles the system of the contacts at the current velocities.
    fn assemble_frozen(&mut self, phase: &Phase) {
        self.assemble_bodies(phase);
        for i in 0..self.rows.len() {
            let row = &self.rows[i];
            if row.bears {
                for (action, damper) in row.actions.into_iter().zip(row.frozen) {
                    self.add(i, &action, &action, damper);
                }
            }
        }
        self.add_push();
        self.add_servos();
    }

    /// The share of a change up to which the potential falls.
    fn share_that_falls(&mut self, state: &State, change: &Twist, phase: &Phase) -> f64 {
        if self.slope(state, change, phase, 1.0) <= 0.0 {
            return 1.0;
        }
        // The slope rises, linearly between two kinks.
        let mut kinks = std::mem::take(&mut self.kinks);
        kinks.clear();
        let mut keep = |share: f64| {
            if 0.0 < share && share < 1.0 {
                kinks.push(share);
            }
        };
        for row in self.rows.iter().filter(|row| row.bears) {
            let changes = self.changes_of(row, change);
            row.kinks(state, changes, &mut keep);
        }
        self.kinks_of_servos(state, change, keep);
        kinks.sort_unstable_by(f64::total_cmp);
        let falls = |share: &f64| self.slope(state, change, phase, *share) <= 0.0;
        let next = kinks.partition_point(falls);
        let low = if next > 0 { kinks[next - 1] } else { 0.0 };
        let high = kinks.get(next).copied().unwrap_or(1.0);
        self.kinks = kinks;
        let [at_low, at_high] = [low, high].map(|share| self.slope(state, change, phase, share));
        if at_high > at_low {
            low + (high - low) * (at_low / (at_low - at_high)).clamp(0.0, 1.0)
        } else {
            low
        }
    }

    /// The slope of the potential along a change, at a share of it.
    fn slope(&self, state: &State, change: &Twist, phase: &Phase, share: f64) -> f64 {
        let m = &self.model;
        let velocity = state.velocity + change.velocity * share - phase.velocity;
        let moment = self.inertia * (state.angular_velocity + change.turn * share);
        let mut slope = m.mass * velocity.dot(change.velocity)
            + (moment - self.free_moment(phase)) * change.turn;
        for (k, spin) in self.system.spins.iter().enumerate() {
            if let Some(of_motor) = self.motors[k].share().filter(|_| k >= self.chains.len()) {
                let inertia = m.drive_inertia(k);
                let free = inertia * phase.spins[k] - phase.motor_turn(of_motor, m);
                let moment = inertia * (state.drives[k].spin + spin.change * share);
                slope += (moment - free) * spin.change;
            }
        }
        for row in self.rows.iter().filter(|row| row.bears) {
            let [of_approach, of_slip] = self.changes_of(row, change);
            let [approach, slip] = row.speeds(state);
            let speeds = [approach + of_approach * share, slip + of_slip * share];
            let [normal, tangent] = row.frozen_dampers(speeds);
            slope -= normal.at(speeds[0]) * of_approach + tangent.at(speeds[1]) * of_slip;
        }
        if let Some(push) = &self.push {
            let spin = self.system.spins[0].change;
            let of_push = push.action.change(change.velocity, change.turn, spin);
            slope -= push.damper().at(push.slip(state) + of_push * share) * of_push;
        }
        slope
            + self.slope_of_chains(state, change, phase, share)
            + self.slope_of_flippers(state, change, phase, share)
            + self.slope_of_servos(state, change, share)
    }
}

impl Row {
    /// The dampers of normal and tangent at these speeds with the friction limit frozen: beyond a limit, a
    /// constant impulse.
    fn frozen_dampers(&self, [approach, slip]: [f64; 2]) -> [Damper; 2] {
        let [normal, tangent] = self.dampers;
        [
            if normal.at(approach) > 0.0 {
                normal
            } else {
                Damper::default()
            },
            tangent.up_to(self.limit, slip),
        ]
    }

    /// Calls `found` with the shares of a change at which a damper reaches or leaves a limit.
    fn kinks(&self, state: &State, changes: [f64; 2], mut found: impl FnMut(f64)) {
        let [approach, slip] = self.speeds(state);
        let [normal, tangent] = self.dampers;
        found((normal.speed_for(0.0) - approach) / changes[0]);
        for limit in [-self.limit, self.limit] {
            found((tangent.speed_for(limit) - slip) / changes[1]);
        }
    }

    /// Updates the impulses to match the velocities; returns the velocity that corresponds to the change of its
    /// limit towards the new normal impulse [m/s].
    fn follow_frozen(&mut self, state: &State) -> f64 {
        let [approach, slip] = self.speeds(state);
        let [normal, tangent] = self.frozen;
        self.normal_impulse = normal.at(approach);
        self.friction_impulse = tangent.at(slip);
        let limit = self.friction * self.normal_impulse;
        let slides = tangent.stiffness == 0.0;
        let off = if slides {
            (limit - self.limit).abs()
        } else {
            (self.friction_impulse.abs() - limit).max(0.0)
        };
        off * self.admittance.tangent
    }
}
