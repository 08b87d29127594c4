//! The solve with rings: Newton's method with a line search on the misfit of the contacts.
//!
//! If the guesses of the dozens of contacts of a ring were corrected all at once, they would upset each other.
//! Instead, the velocities move towards those of the next guess only as far as that helps. Between two
//! solutions of the linear system velocities change linearly, and so do the impulses that balance them; the
//! misfit is the difference between these impulses and those that the contact laws give at the velocities. In
//! Newton's method each law starts out along the line that the guess follows, so that at first all misfits
//! shrink in proportion to the step: a short enough step always helps, unless it starts at a kink. Where none does, all
//! guesses are corrected at once after all.
//!
//! The equations: docs/physics.md, "Chains".

use super::{AGREEMENT, Contact, Grip, Problem};

/// Steps at most. Of 188,000 solves with 22 or 44 shoes, two in three took one step, and one in 200 more than these.
const STEPS: u32 = 12;
/// Smallest share of a step to take.
const LEAST: f64 = 1.0 / 16.0;
/// Smallest share of the promised improvement that a step must achieve.
const PAYS: f64 = 0.1;

impl Problem {
    /// Finds the impulses that satisfy all constraints, if steps lead there.
    pub(super) fn solve_in_steps(&mut self) -> bool {
        self.settle();
        self.set_out();
        let mut last = None;
        for step in 0..STEPS {
            let before = last.take();
            self.effort.rounds += 1;
            self.assemble();
            if self.solve_for_change().is_none() {
                return false;
            }
            self.look_ahead();
            // The impulses that balance the start velocities are not known.
            let share = if step == 0 {
                1.0
            } else {
                self.share_that_pays()
            };
            self.go(share);
            let (off, fits) = self.arrive(share);
            if !fits || share < 1.0 {
                continue;
            }
            self.turn_with_base();
            if self.switch_motors() {
                self.act_with_motors();
                self.set_out();
            } else {
                if off < AGREEMENT.value() {
                    return true;
                }
                last = self.settle_after(before, off);
            }
        }
        self.solve_at_once()
    }

    /// Starts the lines of all contacts at the current velocities, at which some that are open close.
    fn set_out(&mut self) {
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            contact.way.speeds = contact.speeds(&self.velocities);
            if contact.grip == Grip::Open {
                contact.grip = contact.law(contact.way.speeds).0;
            }
        }
    }

    /// Finds where a whole step leads.
    fn look_ahead(&mut self) {
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            let [n, t] = contact.changes(&self.change);
            let [approach, slip] = contact.way.speeds;
            contact.way.to_speeds = [approach + n, slip + t];
            contact.way.to_held = contact.guessed(contact.way.to_speeds);
        }
    }

    /// The share of a step after which the misfit is smaller by enough of what the step promises.
    fn share_that_pays(&self) -> f64 {
        let now = self.misfit_after(0.0);
        let mut share = 1.0;
        while share > LEAST && self.misfit_after(share) > (1.0 - PAYS * share) * now {
            share *= 0.5;
        }
        share
    }

    /// [m/s] Difference between the impulses that balance the velocities and those of the contact laws, after a
    /// share of the step.
    fn misfit_after(&self, share: f64) -> f64 {
        let of_contact = |contact: &Contact| {
            let [speeds, held] = contact.way.after(share);
            let (_, law) = contact.law(speeds);
            let normal = (law[0] - held[0]) * contact.admittance.normal;
            let tangent = (law[1] - held[1]) * contact.admittance.tangent;
            normal * normal + tangent * tangent
        };
        let bearing = self.contacts.iter().filter(|c| c.bears);
        bearing.map(of_contact).sum::<f64>().sqrt()
    }

    /// Ends a step; returns the largest error of a velocity [m/s], and whether the guess fits the velocities. If
    /// not, the next guess does.
    fn arrive(&mut self, share: f64) -> (f64, bool) {
        let (mut off, mut fits): (f64, _) = (0.0, true);
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            [contact.way.speeds, contact.way.held] = contact.way.after(share);
            off = off.max(contact.follow_speeds(contact.way.speeds));
            fits &= contact.grip == contact.fitting;
            contact.grip = contact.fitting;
        }
        (off.max(self.others_follow_velocities()), fits)
    }
}
