//! Finding the states of contacts and motors, and the impulses about which constraints are damped: states that do not fit
//! are corrected, and the centres of the dampers follow the impulses that a solution gives, until neither changes.
//!
//! Close to a jam each solution of the system comes only a little nearer than the last, always by the same ratio. What is
//! left is then a geometric series, and is added at once (Aitken 1926).
//!
//! The equations: docs/physics.md, "Settling".

use super::contact::{Contact, Grip, beyond};
use super::row::TURN;
use super::{AGREEMENT, Problem};
use crate::units::MetresPerSecond;

/// Maximum number of solutions of the system: as all misfits are corrected at once, corrections could alternate for ever.
const SOLUTIONS: u32 = 8;
/// Up to this many are no sign of a jam.
const FAR_FROM_JAM: u32 = 4;
/// The most by which a change is extrapolated, in units of that change.
const FARTHEST: f64 = 1e6;
/// [m/s] How much the base may still have to move where a search close to a jam ends, ...
const CLOSE: MetresPerSecond = MetresPerSecond(1e-6);
/// ... and the most that it moves between two solutions if it stands.
const STANDS: MetresPerSecond = MetresPerSecond(1e-10);

/// What is left of a geometric series, in units of its last change, from the error before that and the one now; none if
/// there was no error before or if errors do not fall.
fn rest_of_series(before: Option<f64>, now: f64) -> Option<f64> {
    let before = before.filter(|before| now < *before)?;
    Some((now / (before - now)).min(FARTHEST))
}

/// Whether the base stands, from how far the last two solutions have moved it [m/s].
fn stands(before: Option<f64>, moved: f64) -> bool {
    let rest = rest_of_series(before, moved).map(|times| times * moved);
    moved < STANDS.value() || rest.is_some_and(|rest| rest < CLOSE.value())
}

impl Problem {
    /// Solves with the present states and corrects all that do not fit; once all fit, repeats the solution about the impulses
    /// that it gives, until all constraints are satisfied. Returns whether they are. Close to a jam they are before the base
    /// has come to rest: after some solutions, or a path, it must stand as well.
    pub(super) fn settle(&mut self, is_after_path: bool) -> bool {
        self.center();
        self.expect_to_close();
        let mut last = None;
        for solution in 0..SOLUTIONS {
            let before = last.take();
            if self.solve_states().is_none() {
                break;
            }
            let off = self.apply_laws();
            if !self.correct_contacts() {
                continue;
            }
            if self.switch_motors() {
                self.tie();
                self.bearing().for_each(Contact::place_dampers);
                continue;
            }
            let must_stand = is_after_path || solution >= FAR_FROM_JAM;
            let error = if must_stand { self.base_change() } else { off };
            // An error of contacts before this one says nothing of how the base moves.
            let is_alike = is_after_path || solution != FAR_FROM_JAM;
            let before = before.filter(|_| is_alike);
            if off < AGREEMENT.value() && (!must_stand || stands(before, error)) {
                return true;
            }
            last = self.center_after(before, error);
        }
        self.uncenter();
        false
    }

    /// Closes contacts that are open but would close at the present velocities.
    fn expect_to_close(&mut self) {
        let unknowns = &self.unknowns;
        let bearing = self.contacts.iter_mut().filter(|c| c.bears);
        for contact in bearing.filter(|c| c.grip == Grip::Open) {
            contact.apply_law(unknowns);
            contact.grip = contact.fitting;
        }
    }

    /// The contacts that can bear a load.
    pub(super) fn bearing(&mut self) -> impl Iterator<Item = &mut Contact> {
        self.contacts.iter_mut().filter(|c| c.bears)
    }

    /// Makes all dampers act about the current impulses.
    pub(super) fn center(&mut self) {
        self.bearing().for_each(Contact::center);
        for bilateral in &mut self.bilaterals {
            bilateral.center = bilateral.impulse;
        }
    }

    /// Restores the impulses about which the dampers act.
    pub(super) fn uncenter(&mut self) {
        self.bearing().for_each(Contact::uncenter);
        for bilateral in &mut self.bilaterals {
            bilateral.impulse = bilateral.center;
        }
    }

    /// As [`Self::center`], after a solution with an error. If the solution before had the same states and a larger error, the
    /// impulses are first extrapolated to the limit of such changes; if not, returns this error, for the next solution.
    fn center_after(&mut self, before: Option<f64>, error: f64) -> Option<f64> {
        let rest = rest_of_series(before, error);
        if let Some(times) = rest {
            self.bearing().for_each(|contact| contact.lead(times));
            for bilateral in &mut self.bilaterals {
                bilateral.impulse = beyond(bilateral.center, bilateral.impulse, times);
            }
        }
        self.center();
        rest.is_none().then_some(error)
    }

    /// Updates all impulses to match the velocities; returns the largest error of a velocity [m/s].
    pub(super) fn apply_laws(&mut self) -> f64 {
        let mut off: f64 = 0.0;
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            off = off.max(contact.apply_law(&self.unknowns));
        }
        off.max(self.apply_laws_of_bilaterals())
    }

    /// The same for bilaterals alone.
    pub(super) fn apply_laws_of_bilaterals(&mut self) -> f64 {
        let unknowns = &self.unknowns;
        let bilaterals = self.bilaterals.iter_mut();
        bilaterals.fold(0.0, |off: f64, each| off.max(each.apply_law(unknowns)))
    }

    /// Corrects the states of contacts that do not fit; returns whether all fitted.
    fn correct_contacts(&mut self) -> bool {
        let unknowns = &self.unknowns;
        let mut all_fit = true;
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            if !contact.fits(unknowns) {
                contact.grip = contact.grip.towards(contact.fitting);
                all_fit = false;
            }
        }
        all_fit
    }

    /// Whether all states fit the velocities.
    pub(super) fn fits(&self) -> bool {
        let mut bearing = self.contacts.iter().filter(|c| c.bears);
        bearing.all(|c| c.fits(&self.unknowns))
    }

    /// [m/s] How far the last solution has moved the base.
    pub(super) fn base_change(&self) -> f64 {
        let [x, y, turn] = [0, 1, TURN].map(|i| self.change[i]);
        let weights = &self.system.weights;
        libm::hypot(x, y) + turn.abs() * (weights[0] / weights[TURN]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn the_rest_of_a_geometric_series_is_known_from_two_of_its_terms() {
        let (first, ratio): (f64, f64) = (0.3, 0.9);
        let rest = rest_of_series(Some(first), first * ratio).expect("it falls");
        // a r (r + r^2 + ...) = a r * r / (1 - r)
        assert_relative_eq!(rest, ratio / (1.0 - ratio), max_relative = 1e-12);
        assert_eq!(rest_of_series(None, 0.1), None);
        assert_eq!(rest_of_series(Some(0.1), 0.1), None);
    }

    #[test]
    fn the_base_stands_if_it_hardly_moves_or_has_a_short_way_left() {
        let least = STANDS.value();
        assert!(stands(None, 0.5 * least));
        assert!(!stands(None, 2.0 * least));
        // A change that is half of the one before has as far to go again, one that is 4/5 of it four times as far.
        let moved = 0.5 * CLOSE.value();
        assert!(stands(Some(2.0 * moved), moved));
        assert!(!stands(Some(1.25 * moved), moved));
        assert!(!stands(Some(moved), moved));
    }
}
