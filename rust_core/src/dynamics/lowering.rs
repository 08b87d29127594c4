//! The search that finds what no guess does: the robot is lowered onto its contacts.
//!
//! With all contacts lifted off, the solution is known. Lowered bit by bit, one condition after another is reached: a
//! contact touches, starts to slide or sticks again, a motor comes to its limit. Between two of these everything
//! changes linearly, so the next one is found exactly, and the state of what has reached it changes. Where that turns
//! the way round, the contacts rise for a while. This is Lemke's method (1965), which finds a solution of Coulomb's law
//! in the plane wherever contacts may come to rest at all (Anitescu and Potra 1997).
//!
//! The equations: docs/physics.md, "Lowering".

use super::Dynamics;
use super::grip::Grip;
use super::motor::{Motor, PAST};
use super::phase::Phase;
use super::row::Row;
use super::state::{State, Twist};

/// Conditions met on the way, at most, for each contact and motor.
const TURNS: usize = 16;
/// Conditions within this share of the way are met together: one by one, both tracks of a robot on equal ground would
/// part.
const TOGETHER: f64 = 1e-9;
/// Rounds in which all motors switch at once; from then on the first that has to, which cannot go on for ever (Murty
/// 1974).
const AT_ONCE: usize = 4;

/// What the state of a contact or a motor becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Switch {
    Contact(usize, Grip),
    Drive(usize, Motor),
    Arm(usize, Motor),
}

/// A condition of the present states: they hold as long as its value is above 0, and the switch is made where it
/// reaches 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    switch: Switch,
    /// Its value now, and where the present states are a solution on the ground.
    now: f64,
    there: f64,
}

/// What is met on the way, which leads down (1) or up (-1): conditions, after a share of the way to the ground; the
/// ground; or nothing, on a way up.
enum Met {
    Conditions { way: f64, share: f64 },
    Ground,
    Nothing,
}

/// The lowest point of a way: how far contacts are lifted there [m/s], and the turns up to it.
struct Lowest {
    lift: f64,
    turns: usize,
}

impl Dynamics {
    /// Goes down to a solution on the ground; returns the largest error of a velocity there [m/s], if it gets there. If
    /// not, contacts stay lifted as little as they have been on the way: they obey Coulomb's law, and take energy.
    pub(super) fn lower(&mut self, state: &mut State, phase: &Phase) -> Option<f64> {
        self.effort.lowerings += 1;
        self.settle();
        let turns = TURNS * (self.rows.len() + self.motors.len() + self.flippers.len());
        let lowest = self.go_down(state, phase, turns)?;
        if lowest.lift > 0.0 {
            self.go_down(state, phase, lowest.turns);
            for row in self.rows.iter_mut().filter(|row| row.bears) {
                let [approach, slip] = row.speeds(state);
                (row.grip, [row.normal_impulse, row.friction_impulse]) =
                    row.law([approach + lowest.lift, slip]);
            }
            return None;
        }
        Some(self.follow_velocities(state, phase))
    }

    /// Goes down from where all contacts are lifted off, by so many turns at most; returns the lowest point of the way,
    /// or nothing if the constraints contradict each other there.
    fn go_down(&mut self, state: &mut State, phase: &Phase, turns: usize) -> Option<Lowest> {
        self.lift_off(state, phase)?;
        let bearing = self.rows.iter().filter(|row| row.bears);
        let mut lift = bearing.fold(0.0, |lift: f64, row| lift.max(row.lift_for(state)));
        let mut lowest = Lowest { lift, turns: 0 };
        let mut conditions = std::mem::take(&mut self.conditions);
        let mut back = None;
        for turn in 1..=turns {
            let Some(change) = self.look_down(state, phase, lift, &mut conditions) else {
                break;
            };
            match first_met(&conditions, back) {
                Met::Ground => lift = 0.0,
                Met::Conditions { way, share } => {
                    self.move_by(state, &change, way * share - 1.0);
                    lift *= 1.0 - way * share;
                    self.bear(state, phase, lift);
                    let is_met = |c: &&Condition| {
                        let met = c.met(way, back);
                        met.is_some_and(|met| met <= share + TOGETHER)
                    };
                    let met = conditions.iter().filter(is_met);
                    back = self.make_all(met.map(|c| c.switch), state, phase);
                }
                Met::Nothing => {
                    self.move_by(state, &change, -1.0);
                    break;
                }
            }
            if lift < lowest.lift {
                lowest = Lowest { lift, turns: turn };
            }
            if lift == 0.0 {
                break;
            }
        }
        self.conditions = conditions;
        Some(lowest)
    }

    /// Finds the conditions of the present states, and how velocities change from where contacts are lifted by `lift`
    /// [m/s] to where these states are a solution on the ground. The state is there then; it stays if there is none.
    fn look_down(
        &mut self,
        state: &mut State,
        phase: &Phase,
        lift: f64,
        conditions: &mut Vec<Condition>,
    ) -> Option<Twist> {
        self.effort.rounds += 1;
        conditions.clear();
        self.bear(state, phase, lift);
        self.conditions(state, phase, lift, |switch, now| {
            let there = now;
            conditions.push(Condition { switch, now, there });
        });
        self.assemble(phase);
        let change = self.solve_for_change(state)?;
        self.move_by(state, &change, 1.0);
        self.bear(state, phase, 0.0);
        let mut all = conditions.iter_mut();
        self.conditions(state, phase, 0.0, |_, there| {
            if let Some(condition) = all.next() {
                condition.there = there;
            }
        });
        Some(change)
    }

    /// Lifts all contacts off, and lets the motors find their states in the air; none if the constraints contradict each
    /// other.
    fn lift_off(&mut self, state: &mut State, phase: &Phase) -> Option<()> {
        for row in &mut self.rows {
            row.grip = Grip::Open;
        }
        for round in 0..TURNS * (self.motors.len() + self.flippers.len()) {
            self.effort.rounds += 1;
            self.assemble(phase);
            let change = self.solve_for_change(state)?;
            self.move_by(state, &change, 1.0);
            self.bear(state, phase, 0.0);
            if round < AT_ONCE {
                if !self.switch_motors(state, phase) {
                    break;
                }
                self.set_actions(state, phase);
            } else {
                let mut next = None;
                self.conditions(state, phase, f64::INFINITY, |switch, value| {
                    if value < -PAST && next.is_none() {
                        next = Some(switch);
                    }
                });
                match next {
                    Some(switch) => self.make(switch, state, phase),
                    None => break,
                };
            }
        }
        Some(())
    }

    /// Sets all impulses to those of the present states at the velocities, while contacts are lifted.
    fn bear(&mut self, state: &mut State, phase: &Phase, lift: f64) {
        for row in self.rows.iter_mut().filter(|row| row.bears) {
            let [approach, slip] = row.speeds(state);
            [row.normal_impulse, row.friction_impulse] = row.guessed([approach + lift, slip]);
        }
        if let Some(push) = &mut self.push {
            push.follow_velocities(state);
        }
        self.chains_follow_velocities(state, phase);
        self.turn_with_chassis(state, phase);
    }

    /// Calls `found` with the conditions of the present states and their values.
    fn conditions(
        &self,
        state: &State,
        phase: &Phase,
        lift: f64,
        mut found: impl FnMut(Switch, f64),
    ) {
        for (i, row) in self.rows.iter().enumerate().filter(|(_, row)| row.bears) {
            row.conditions(row.speeds(state), lift, |grip, value| {
                found(Switch::Contact(i, grip), value);
            });
        }
        for (k, motor) in self.motors.iter().enumerate() {
            let (limit, ahead) = (
                phase.motor_impulse(1.0, &self.model),
                self.ahead(state, phase, k),
            );
            // The drive of a chain holds softly, so its impulse tells when it may hold again.
            let (impulse, ahead) = match self.chains.get(k) {
                Some(chain) => {
                    let impulse = chain.held(ahead);
                    (impulse, limit * motor.share().unwrap_or_default() - impulse)
                }
                None => (self.motor_impulse(state, phase, k), ahead),
            };
            motor.conditions([impulse, limit], ahead, |motor, value| {
                found(Switch::Drive(k, motor), value);
            });
        }
        for (k, arm) in self.flippers.iter().enumerate() {
            let impulses = [self.flipper_impulse(state, phase, k), arm.given(1.0, phase)];
            let ahead = self.flipper_ahead(state, k);
            arm.motor.conditions(impulses, ahead, |motor, value| {
                found(Switch::Arm(k, motor), value);
            });
        }
    }

    /// Makes switches, one of each contact and motor; returns the one that would take back the first.
    fn make_all(
        &mut self,
        switches: impl Iterator<Item = Switch>,
        state: &State,
        phase: &Phase,
    ) -> Option<Switch> {
        let mut made: Vec<Switch> = Vec::new();
        for switch in switches {
            if !made.iter().any(|other| other.is_of_the_same(switch)) {
                made.push(self.make(switch, state, phase));
            }
        }
        made.first().copied()
    }

    /// Makes a switch; returns the one that would take it back.
    fn make(&mut self, switch: Switch, state: &State, phase: &Phase) -> Switch {
        match switch {
            Switch::Contact(i, next) => {
                let row = &mut self.rows[i];
                let before = row.grip;
                row.grip = match before {
                    Grip::Open => row.slides(row.speeds(state)),
                    _ => next,
                };
                // An open contact has one condition, whatever it becomes.
                Switch::Contact(
                    i,
                    if next == Grip::Open {
                        Grip::Sticks
                    } else {
                        before
                    },
                )
            }
            Switch::Drive(k, next) => {
                let before = std::mem::replace(&mut self.motors[k], next);
                self.set_actions(state, phase);
                Switch::Drive(k, before)
            }
            Switch::Arm(k, next) => {
                let before = std::mem::replace(&mut self.flippers[k].motor, next);
                self.set_actions(state, phase);
                Switch::Arm(k, before)
            }
        }
    }
}

/// What is met first on the way to where the present states are a solution on the ground. The condition that the last
/// switch has left must grow; if it falls on the way down, the way leads up.
fn first_met(conditions: &[Condition], back: Option<Switch>) -> Met {
    let left = conditions.iter().find(|c| Some(c.switch) == back);
    let way = match left {
        Some(left) if left.there < left.now => -1.0,
        _ => 1.0,
    };
    let met = conditions.iter().filter_map(|c| c.met(way, back));
    let share = met.fold(f64::INFINITY, f64::min);
    if share < 1.0 || (way < 0.0 && share.is_finite()) {
        Met::Conditions { way, share }
    } else if way > 0.0 {
        Met::Ground
    } else {
        Met::Nothing
    }
}

impl Condition {
    /// The share of the way, down or up, after which it is met, if it is.
    fn met(&self, way: f64, back: Option<Switch>) -> Option<f64> {
        let falls = (self.now - self.there) * way;
        (falls > 0.0 && Some(self.switch) != back).then(|| self.now.max(0.0) / falls)
    }
}

impl Switch {
    /// Whether both are switches of one contact or motor.
    fn is_of_the_same(self, other: Self) -> bool {
        match (self, other) {
            (Self::Contact(i, _), Self::Contact(k, _))
            | (Self::Drive(i, _), Self::Drive(k, _))
            | (Self::Arm(i, _), Self::Arm(k, _)) => i == k,
            _ => false,
        }
    }
}

impl Row {
    /// [m/s] How far it has to be lifted to touch nothing.
    fn lift_for(&self, state: &State) -> f64 {
        let [approach, _] = self.speeds(state);
        self.dampers[0].speed_for(0.0) - approach
    }

    /// [N s] Impulses along normal and tangent, without limits, of a contact that is lifted.
    fn unlimited(&self, [approach, slip]: [f64; 2], lift: f64) -> [f64; 2] {
        [
            self.dampers[0].at(approach + lift),
            self.dampers[1].at(slip),
        ]
    }

    /// The way in which it starts to slide when it touches.
    fn slides(&self, [_, slip]: [f64; 2]) -> Grip {
        if self.dampers[1].at(slip) < 0.0 {
            Grip::Backwards
        } else {
            Grip::Forwards
        }
    }

    /// Calls `found` with the conditions of its state: the state that follows, and the value.
    fn conditions(&self, speeds: [f64; 2], lift: f64, mut found: impl FnMut(Grip, f64)) {
        let [normal, friction] = self.unlimited(speeds, lift);
        let limit = self.friction * normal;
        if self.grip == Grip::Open {
            found(Grip::Sticks, -normal);
            return;
        }
        found(Grip::Open, normal);
        match self.grip {
            Grip::Sticks => {
                found(Grip::Forwards, limit - friction);
                found(Grip::Backwards, limit + friction);
            }
            Grip::Forwards if self.friction > 0.0 => found(Grip::Sticks, friction - limit),
            Grip::Backwards if self.friction > 0.0 => found(Grip::Sticks, -friction - limit),
            _ => {}
        }
    }
}

impl Motor {
    /// Calls `found` with the conditions of its state: the state that follows, and the value, from its impulse and the
    /// limit of that [N s], and from how much too fast it is.
    fn conditions(self, [impulse, limit]: [f64; 2], ahead: f64, mut found: impl FnMut(Self, f64)) {
        match self {
            Self::Holds => {
                found(Self::Pushes, limit - impulse);
                found(Self::Brakes, limit + impulse);
            }
            Self::Pushes => found(Self::Holds, -ahead),
            Self::Brakes => found(Self::Holds, ahead),
            Self::Free => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::contact::Contact;
    use crate::dynamics::Dynamics;
    use crate::dynamics::tests::setup;
    use crate::geometry::Vector;

    /// A belt that drives off on level ground, with the motors at their limit, in its last solve.
    fn driving_off() -> (Dynamics, State, Phase) {
        let (mut dynamics, mut state) = setup(|_| {});
        for _ in 0..20 {
            let below = |x: f64| Contact {
                part: 0,
                facet: 0,
                edge: -1,
                point: Vector::new(state.center.x + x, 0.9),
                normal: Vector::Y,
                distance: -1e-7,
                number: 0,
                began: Vector::ZERO,
            };
            let contacts = [-0.2, 0.15].map(below);
            dynamics.take(&mut state, &contacts, 5.0, 1e-3);
        }
        let phase = std::mem::take(&mut dynamics.phase);
        (dynamics, state, phase)
    }

    fn impulses(dynamics: &Dynamics) -> Vec<f64> {
        let of_row = |row: &Row| [row.normal_impulse, row.friction_impulse];
        dynamics.rows.iter().flat_map(of_row).collect()
    }

    #[test]
    fn lowering_finds_what_a_right_guess_finds() {
        let (mut dynamics, mut state, phase) = driving_off();
        let (found, before) = (impulses(&dynamics), state.clone());
        assert_eq!(dynamics.motors, [Motor::Pushes]);
        dynamics.motors[0] = Motor::Holds;
        dynamics.set_actions(&state, &phase);
        let error = dynamics.lower(&mut state, &phase).expect("it gets down");
        assert!(error < 1e-9);
        assert_eq!(dynamics.motors, [Motor::Pushes]);
        for (lowered, guessed) in impulses(&dynamics).into_iter().zip(found) {
            assert_relative_eq!(lowered, guessed, max_relative = 1e-6);
        }
        assert_relative_eq!(state.velocity.x, before.velocity.x, epsilon = 1e-9);
        assert_relative_eq!(state.drives[0].spin, before.drives[0].spin, epsilon = 1e-6);
    }

    #[test]
    fn the_way_down_touches_with_one_contact_after_the_other() {
        let (mut dynamics, mut state, phase) = driving_off();
        dynamics.settle();
        let mut touching = Vec::new();
        for turns in 1..4 {
            let lowest = dynamics.go_down(&mut state, &phase, turns).expect("a way");
            touching.push(
                dynamics
                    .rows
                    .iter()
                    .filter(|r| r.grip != Grip::Open)
                    .count(),
            );
            if lowest.lift == 0.0 {
                break;
            }
        }
        assert_eq!(touching[0], 1);
        assert!(touching.is_sorted());
        assert_eq!(touching.last(), Some(&2));
    }
}
