//! The impulses about which constraints are damped: they follow those that a solve finds, until both are the same.
//!
//! Close to a jam each solution of the system comes only a little nearer than the last, always by the same ratio. The
//! rest of the way is then a geometric series, and is taken at once (Aitken 1926).
//!
//! The equations: docs/physics.md, "Settling".

use super::{AGREEMENT, Contact, Problem, Twist};
use crate::units::MetresPerSecond;

/// Solutions with the same states at most.
const MOST_ITERATIONS: u32 = 8;
/// Changes that are taken at once at most.
const FARTHEST: f64 = 1e6;
/// [m/s] By how much the base may still move where a search ends close to a jam, ...
const CLOSE: MetresPerSecond = MetresPerSecond(1e-6);
/// ... and by how much it moves at most if it stands.
const STANDS: MetresPerSecond = MetresPerSecond(1e-10);

/// How many times the last change the rest of a series is, from an error before it and the one now; nothing if there was
/// none before, or if it does not fall.
fn rest_of_series(before: Option<f64>, now: f64) -> Option<f64> {
    let before = before.filter(|before| now < *before)?;
    Some((now / (before - now)).min(FARTHEST))
}

/// What lies beyond the second of two values, by so many times their difference.
pub(super) fn beyond(from: f64, to: f64, times: f64) -> f64 {
    to + times * (to - from)
}

impl Problem {
    /// Makes the current impulses the ones about which constraints are damped.
    pub(super) fn settle(&mut self) {
        self.contacts.iter_mut().for_each(Contact::settle);
        for ring in &mut self.rings {
            ring.drive.center = ring.drive.impulse;
        }
        for row in &mut self.bilaterals {
            row.center = row.impulse;
        }
    }

    /// The same after a solution with an error, the states being those of the last one with its error, if there was one:
    /// then the impulses are taken to where such changes lead. Returns the error of this one, if they are not.
    pub(super) fn settle_after(&mut self, before: Option<f64>, error: f64) -> Option<f64> {
        let rest = rest_of_series(before, error);
        if let Some(times) = rest {
            self.lead(times);
        }
        self.settle();
        rest.is_none().then_some(error)
    }

    /// Takes all impulses ahead by so many times their change.
    fn lead(&mut self, times: f64) {
        for contact in &mut self.contacts {
            contact.lead(times);
        }
        for ring in &mut self.rings {
            let drive = &mut ring.drive;
            drive.impulse = beyond(drive.center, drive.impulse, times);
        }
        for row in &mut self.bilaterals {
            row.impulse = beyond(row.center, row.impulse, times);
        }
    }

    /// Comes closer to the solution with the present states, from impulses near it, until the base stands; returns whether
    /// it gets there, and all states fit.
    pub(super) fn close_in(&mut self) -> bool {
        self.settle();
        let mut last = None;
        for _ in 0..MOST_ITERATIONS {
            let before = last.take();
            self.effort.rounds += 1;
            self.assemble();
            if self.solve_for_change().is_none() {
                break;
            }
            self.go(1.0);
            let off = self.follow_velocities();
            self.turn_with_base();
            if !self.fits() || self.switch_motors() {
                break;
            }
            let moved = self.moved();
            let rest = rest_of_series(before, moved).map(|times| times * moved);
            if off < AGREEMENT.value()
                && (moved < STANDS.value() || rest.is_some_and(|rest| rest < CLOSE.value()))
            {
                return true;
            }
            last = self.settle_after(before, moved);
        }
        self.contacts.iter_mut().for_each(Contact::unsettle);
        false
    }

    /// Whether the states fit the velocities, but for what makes no difference to these.
    fn fits(&self) -> bool {
        let mut bearing = self.contacts.iter().filter(|c| c.bears);
        bearing.all(|c| c.misfit(c.speeds(&self.velocities)) < AGREEMENT.value())
    }

    /// [m/s] How far the last solution has moved the base.
    fn moved(&self) -> f64 {
        let Twist { velocity, turn } = self.change.base;
        velocity.length() + turn.abs() * (self.inertia / self.base.mass).sqrt()
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
}
