//! The solve of a robot with chains: Newton's method with a line search on the misfit of the contacts.
//!
//! If the guesses of the dozens of contacts of a chain were corrected all at once, they would upset each other.
//! Instead, the velocities move towards those of the next guess only as far as that helps. Between two
//! solutions of the linear system velocities change linearly, and so do the impulses that balance them; the
//! misfit is the difference between these impulses and those that the contact laws give at the velocities. In
//! Newton's method each law starts out along the line that the guess follows, so that at first all misfits
//! shrink in proportion to the step: a short enough step always helps, unless it starts at a kink.
//!
//! The equations: docs/physics.md, "Chains".

use super::Dynamics;
use super::phase::Phase;
use super::row::Row;
use super::solve::AGREEMENT;
use super::state::{State, Twist};

/// Steps at most; a typical solve takes three.
const STEPS: u32 = 20;
/// Smallest share of a step to take.
const LEAST: f64 = 1.0 / 16.0;
/// Smallest share of the promised improvement that a step must achieve.
const PAYS: f64 = 0.1;

impl Dynamics {
    /// Finds the impulses that satisfy all constraints, if steps lead there.
    pub(super) fn solve_in_steps(&mut self, state: &mut State, phase: &Phase) -> bool {
        self.settle();
        self.set_out(state);
        for step in 0..STEPS {
            self.effort.rounds += 1;
            self.assemble(phase);
            let Some(change) = self.solve_for_change(state) else {
                return false;
            };
            self.look_ahead(&change);
            // The impulses that balance the start velocities are not known.
            let share = if step == 0 {
                1.0
            } else {
                self.share_that_pays()
            };
            self.move_by(state, &change, share);
            let (change, fits) = self.arrive(state, phase, share);
            if !fits || share < 1.0 {
                continue;
            }
            self.turn_with_chassis(state, phase);
            if self.switch_motors(state, phase) {
                self.act_with_motors(state, phase);
                self.set_out(state);
            } else {
                if change < AGREEMENT {
                    return true;
                }
                self.settle();
            }
        }
        false
    }

    /// Starts the lines of all contacts at the current velocities.
    fn set_out(&mut self, state: &State) {
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            row.way.speeds = row.speeds(state);
        }
    }

    /// Finds where a whole step leads.
    fn look_ahead(&mut self, change: &Twist) {
        for i in 0..self.rows.len() {
            if self.rows[i].bears {
                let [n, t] = self.changes_of(&self.rows[i], change);
                let row = &mut self.rows[i];
                let [approach, slip] = row.way.speeds;
                row.way.to_speeds = [approach + n, slip + t];
                row.way.to_held = row.guessed(row.way.to_speeds);
            }
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
        let of_row = |row: &Row| {
            let [speeds, held] = row.way.after(share);
            let (_, law) = row.law(speeds);
            let normal = (law[0] - held[0]) * row.admittance.normal;
            let tangent = (law[1] - held[1]) * row.admittance.tangent;
            normal * normal + tangent * tangent
        };
        let bearing = self.rows.iter().filter(|row| row.bears);
        bearing.map(of_row).sum::<f64>().sqrt()
    }

    /// Ends a step; returns the largest error of a velocity [m/s], and whether the guess fits the velocities. If
    /// not, the next guess does.
    fn arrive(&mut self, state: &mut State, phase: &Phase, share: f64) -> (f64, bool) {
        let (mut change, mut fits): (f64, _) = (0.0, true);
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            [row.way.speeds, row.way.held] = row.way.after(share);
            change = change.max(row.follow_speeds(row.way.speeds));
            fits &= row.grip == row.fitting;
            row.grip = row.fitting;
        }
        (
            change.max(self.chains_follow_velocities(state, phase)),
            fits,
        )
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::dynamics::grip::Grip;
    use crate::geometry::Vector;
    use crate::robot::Model;
    use crate::scenario::Scenario;

    /// A chain that spins up in the air.
    fn spinning_up() -> (Dynamics, State) {
        let text = include_str!("../../../tests/scenarios/engineer_chain_step.json");
        let scenario = Scenario::from_json(text).expect("the shared scenario is valid");
        let model = Model::new(&scenario.robot).expect("the robot can be built");
        let mut state = State::at_rest(&model, Vector::new(0.0, 1.0), 0.0, 0.0);
        let mut dynamics = Dynamics::new(model, vec![0.9], scenario.gravity, scenario.solver);
        for _ in 0..40 {
            dynamics.take(&mut state, &[], 0.4, 5e-4);
        }
        (dynamics, state)
    }

    #[test]
    fn a_chain_is_solved_twice_a_step_in_a_few_rounds() {
        let (dynamics, _) = spinning_up();
        let effort = dynamics.effort();
        assert_eq!(effort.solves, 2);
        // Nothing strikes and pins are exact, so most first guesses are right.
        assert!(effort.rounds >= effort.solves);
        assert!(effort.rounds <= 3 * effort.solves);
        assert_eq!((effort.lowerings, effort.unresolved), (0, 0));
    }

    #[test]
    fn at_first_a_step_takes_its_share_of_the_misfit() {
        let (mut dynamics, mut state) = spinning_up();
        // All its rests on the guide are guessed wrong.
        for row in &mut dynamics.rows {
            row.grip = Grip::Open;
        }
        let phase = std::mem::take(&mut dynamics.phase);
        let look_ahead = |dynamics: &mut Dynamics, state: &State| {
            dynamics.assemble(&phase);
            let change = dynamics.solve_for_change(state).expect("a solution");
            dynamics.look_ahead(&change);
            change
        };
        dynamics.set_out(&state);
        let change = look_ahead(&mut dynamics, &state);
        dynamics.move_by(&mut state, &change, 1.0);
        let (_, fits) = dynamics.arrive(&mut state, &phase, 1.0);
        assert!(!fits);
        look_ahead(&mut dynamics, &state);
        let now = dynamics.misfit_after(0.0);
        assert!(now > 1e-3);
        for share in [1e-6, 1e-4] {
            // Linear until the first contact opens or closes; the remainder is rounding.
            let after = dynamics.misfit_after(share);
            assert_relative_eq!(after, (1.0 - share) * now, max_relative = 1e-9);
        }
    }
}
