//! The path from given states to a solution.
//!
//! All laws are relaxed just enough to make the present states a solution, and the relaxation is then reduced to zero.
//! On the way one condition after another is met: a contact touches or opens, starts to slide or sticks again, a motor
//! reaches its limit. In between everything changes linearly, so the next condition is found exactly; whatever meets it
//! changes its state, which is a pivot. A pivot may turn the path back: the relaxation then grows for a while.
//! This is the method of Lemke (1965) from an advanced start (Tomlin 1978). Started with all contacts open, it finds a
//! solution of Coulomb's law in the plane wherever contacts can come to rest at all (Anitescu and Potra 1997).
//!
//! The equations: docs/physics.md, "The path".

use super::contact::Grip;
use super::motor::{Motor, MotorState};
use super::{AGREEMENT, Problem, Start};

/// Maximum number of pivots for each contact and motor if all contacts are open at first, ...
const FROM_AIR: usize = 16;
/// ... and from the last states: a path from there is short or goes round in circles.
const FROM_LAST_STATES: usize = 4;
/// Conditions that are met within this share of the path count as met together: pivots one by one would break symmetry.
const TOGETHER: f64 = 1e-9;
/// That share if only the first one is to count.
const ALONE: f64 = 0.0;
/// What the state of a contact or a motor becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Switch {
    Contact(usize, Grip),
    Motor(usize, MotorState),
}

/// A condition for the present states: they are valid while its value is above 0, and the switch is made where it reaches 0.
#[derive(Clone, Copy, Debug)]
struct Condition {
    switch: Switch,
    /// Its value now, and at the point where the present states are a solution without relaxation.
    now: f64,
    there: f64,
}

impl Problem {
    /// Follows the path from the present states or with all contacts open; returns the largest error of a velocity [m/s] at
    /// its end. If the path has no end, impulses stay as they were.
    pub(super) fn follow_path(&mut self, start: Start) -> Option<f64> {
        self.effort.paths += 1;
        self.center();
        let off = if start == Start::LastStates {
            let end = self.pivot(FROM_LAST_STATES, TOGETHER);
            end.filter(|_| self.fits())
        } else {
            // Pivots made together can miss a solution that they find one by one.
            [TOGETHER, ALONE].into_iter().find_map(|together| {
                self.bearing().for_each(|contact| contact.grip = Grip::Open);
                let motors = self.motors.iter_mut();
                for motor in motors.filter(|motor| motor.state != MotorState::Absent) {
                    motor.state = MotorState::Holds;
                }
                self.tie();
                self.pivot(FROM_AIR, together)
            })
        };
        if off.is_none() {
            self.uncenter();
        }
        off
    }

    /// Pivots until the relaxation is zero, at most `pivots` times for each contact and motor; conditions within the share
    /// `together` of the path are met together. Returns the error at the end, if the path has one.
    fn pivot(&mut self, pivots: usize, together: f64) -> Option<f64> {
        loop {
            self.solve_states()?;
            self.hold_states(0.0);
            if !self.hold_with_motors() {
                break;
            }
        }
        let most = self.relax();
        let ends = most == 0.0 || self.pivot_along(pivots, together);
        // Pivots made together may leave a motor in a state that does not fit.
        (ends && self.motors_off(|_| true) < AGREEMENT.value()).then(|| self.apply_laws())
    }

    /// The pivots of [`Problem::pivot`], once laws are relaxed; returns whether the relaxation has become zero.
    fn pivot_along(&mut self, pivots: usize, together: f64) -> bool {
        let mut conditions = Vec::new();
        let (mut share, mut back) = (1.0, None);
        self.change.fill(0.0);
        for pivot in 0..pivots * (self.contacts.len() + self.motors.len()) {
            let is_start = pivot == 0;
            if (self.look_ahead(share, is_start, &mut conditions)).is_none() {
                return false;
            }
            let (direction, of_rest) = first_met(&conditions, back);
            if direction > 0.0 && of_rest >= 1.0 {
                return true;
            }
            if of_rest.is_infinite() {
                return false;
            }
            self.go(direction * of_rest - 1.0);
            share *= 1.0 - direction * of_rest;
            self.hold_states(share);
            let is_met = |c: &&Condition| {
                let met = c.met(direction, back);
                met.is_some_and(|met| met <= of_rest + together)
            };
            let count = if together > 0.0 { usize::MAX } else { 1 };
            let met = conditions.iter().filter(is_met).take(count);
            back = self.make_all(met.map(|c| c.switch), share);
        }
        false
    }

    /// Relaxes all laws so that the present states are a solution at the present velocities, by as much as the law that is
    /// violated most needs; returns that, as a speed [m/s].
    fn relax(&mut self) -> f64 {
        let unknowns = &self.unknowns;
        let bearing = self.contacts.iter().filter(|c| c.bears);
        let of_contacts = bearing.fold(0.0, |most: f64, c| most.max(c.violation(unknowns)));
        let most = of_contacts.max(self.motors_off(|motor| motor.state == MotorState::Holds));
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            contact.relax(&self.unknowns, most);
        }
        for motor in &mut self.motors {
            let wider = most / motor.admittance(&self.system);
            motor.relaxed = if motor.state == MotorState::Holds {
                wider
            } else {
                0.0
            };
        }
        most
    }

    /// [m/s] By how much the worst of some motors violates the conditions of its state.
    fn motors_off(&self, are: impl Fn(&&Motor) -> bool) -> f64 {
        let off = |motor: &Motor| {
            let mut short: f64 = 0.0;
            self.conditions_of(motor, |_, value| short = short.max(-value));
            let is_impulse = motor.given().is_none() || motor.correction.is_some();
            if is_impulse {
                short * motor.admittance(&self.system)
            } else {
                short
            }
        };
        let motors = self.motors.iter().filter(are);
        motors.map(off).fold(0.0, f64::max)
    }

    /// Lets motors whose state, at a limit or locked, does not fit hold their speed: with limits wide enough, all can.
    /// Returns whether any changed.
    fn hold_with_motors(&mut self) -> bool {
        let mut changed = false;
        for k in 0..self.motors.len() {
            let motor = &self.motors[k];
            if motor.state != MotorState::Holds && self.next_of(motor) != motor.state {
                self.motors[k].state = MotorState::Holds;
                changed = true;
            }
        }
        if changed {
            self.tie();
        }
        changed
    }

    /// Finds the conditions of the present states at this share of the relaxation and without any, and moves the unknowns to
    /// the solution of these states without relaxation, where they are already at the start. None if the system is singular.
    fn look_ahead(
        &mut self,
        share: f64,
        is_start: bool,
        conditions: &mut Vec<Condition>,
    ) -> Option<()> {
        conditions.clear();
        self.hold_states(share);
        self.conditions(share, |switch, now| {
            let there = now;
            conditions.push(Condition { switch, now, there });
        });
        if !is_start {
            self.solve_states()?;
        }
        self.hold_states(0.0);
        let mut all = conditions.iter_mut();
        self.conditions(0.0, |_, there| {
            if let Some(condition) = all.next() {
                condition.there = there;
            }
        });
        Some(())
    }

    /// Sets all impulses to those of the present states, with a share of the relaxation.
    fn hold_states(&mut self, share: f64) {
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            let impulses = contact.held(&self.unknowns, share);
            contact.set_impulses(impulses);
        }
        self.apply_laws_of_bilaterals();
        self.note_loads();
    }

    /// Calls `each` with the conditions of the present states and their values, with a share of all relaxations.
    fn conditions(&self, share: f64, mut each: impl FnMut(Switch, f64)) {
        for (i, contact) in self.contacts.iter().enumerate().filter(|(_, c)| c.bears) {
            contact.conditions(&self.unknowns, share, |grip, value| {
                each(Switch::Contact(i, grip), value);
            });
        }
        for (k, motor) in self.motors.iter().enumerate() {
            self.conditions_of(motor, |hold, value| {
                let value = value + share * motor.relaxed_by(hold);
                each(Switch::Motor(k, hold), value);
            });
        }
    }

    /// Makes switches, at most one for each contact and motor; returns the one that would undo the first.
    fn make_all(&mut self, switches: impl Iterator<Item = Switch>, share: f64) -> Option<Switch> {
        let mut made: Vec<Switch> = Vec::new();
        for switch in switches {
            if !made.iter().any(|other| other.is_of_the_same(switch)) {
                made.push(self.make(switch, share));
            }
        }
        made.first().copied()
    }

    /// Makes a switch; returns the one that would undo it.
    fn make(&mut self, switch: Switch, share: f64) -> Switch {
        match switch {
            Switch::Contact(i, next) => {
                let contact = &mut self.contacts[i];
                let before = contact.grip;
                contact.grip = match before {
                    Grip::Open => contact.slides(&self.unknowns, share),
                    _ => next,
                };
                // An open contact has one condition, whichever state follows.
                let back = if next == Grip::Open {
                    Grip::Sticks
                } else {
                    before
                };
                Switch::Contact(i, back)
            }
            Switch::Motor(k, next) => {
                let before = std::mem::replace(&mut self.motors[k].state, next);
                self.tie();
                Switch::Motor(k, before)
            }
        }
    }
}

/// Whether the relaxation falls (1) or grows (-1) from here, and the share of the remaining path after which the next
/// condition is met. The condition `back`, which would undo the last switch, has just been met and must grow; if it falls
/// as the relaxation falls, the path turns back.
fn first_met(conditions: &[Condition], back: Option<Switch>) -> (f64, f64) {
    let left = conditions.iter().find(|c| Some(c.switch) == back);
    let direction = match left {
        Some(left) if left.there < left.now => -1.0,
        _ => 1.0,
    };
    let met = conditions.iter().filter_map(|c| c.met(direction, back));
    (direction, met.fold(f64::INFINITY, f64::min))
}

impl Condition {
    /// The share of the remaining path, forwards or backwards, after which it is met, if it is.
    fn met(&self, direction: f64, back: Option<Switch>) -> Option<f64> {
        let falls = (self.now - self.there) * direction;
        (falls > 0.0 && Some(self.switch) != back).then(|| self.now.max(0.0) / falls)
    }
}

impl Switch {
    /// Whether both switch the same contact or motor.
    fn is_of_the_same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Contact(i, _), Self::Contact(k, _)) | (Self::Motor(i, _), Self::Motor(k, _)) => {
                i == k
            }
            _ => false,
        }
    }
}
