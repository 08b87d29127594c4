//! The search that finds what no guess does: the bodies are lowered onto their contacts.
//!
//! With all contacts lifted off, the solution is known. Lowered bit by bit, one condition after another is reached: a
//! contact touches, starts to slide or sticks again, a motor comes to its limit. Between two of these everything
//! changes linearly, so the next one is found exactly, and the state of what has reached it changes. Where that turns
//! the way round, the contacts rise for a while. This is Lemke's method (1965), which finds a solution of Coulomb's law
//! in the plane wherever contacts may come to rest at all (Anitescu and Potra 1997).
//!
//! The equations: docs/physics.md, "Lowering".

use super::condition::{Condition, Switch};
use super::grip::Grip;
use super::motor::PAST;
use super::{Contact, Problem};

/// Conditions met on the way, at most, for each contact and motor.
const TURNS: usize = 16;
/// Conditions within this share of the way are met together: one by one, both sides of what is symmetric would part.
const TOGETHER: f64 = 1e-9;
/// That share where only the first is met.
const ALONE: f64 = 0.0;
/// Rounds in which all motors switch at once; from then on the first that has to, which cannot go on for ever (Murty
/// 1974).
const SIMULTANEOUS_ROUNDS: usize = 4;

/// What is met on the way, which leads down (1) or up (-1): conditions, after a share of the way to the ground; the
/// ground; or nothing, on a way up.
enum Met {
    Conditions { way: f64, share: f64 },
    Ground,
    Nothing,
}

/// The lowest point of a way: how far contacts are lifted there [m/s], and the turns up to it.
pub(super) struct Lowest {
    pub lift: f64,
    turns: usize,
}

impl Problem {
    /// Goes down to a solution on the ground; returns whether it gets there. If not, contacts stay lifted as little as they
    /// have been on the way: they obey Coulomb's law, and take energy.
    pub(super) fn lower(&mut self) -> bool {
        self.effort.lowerings += 1;
        self.settle();
        let turns = TURNS * (self.contacts.len() + self.motors.len());
        // What is met together can lead past a solution that one after the other leads to.
        let lowest = match self.go_down(turns, TOGETHER) {
            Some(lowest) if lowest.lift > 0.0 => self.go_down(turns, ALONE),
            lowest => lowest,
        };
        let Some(lowest) = lowest else {
            return false;
        };
        if lowest.lift > 0.0 {
            self.go_down(lowest.turns, ALONE);
            for contact in self.contacts.iter_mut().filter(|c| c.bears) {
                let [approach, slip] = contact.speeds(&self.velocities);
                (
                    contact.grip,
                    [contact.normal_impulse, contact.friction_impulse],
                ) = contact.law([approach + lowest.lift, slip]);
            }
            return false;
        }
        self.follow_velocities();
        true
    }

    /// Goes down from where all contacts are lifted off, by so many turns at most; conditions within a share of the way are
    /// met together. Returns the lowest point of the way, or nothing if the constraints contradict each other there.
    pub(super) fn go_down(&mut self, turns: usize, together: f64) -> Option<Lowest> {
        self.lift_off()?;
        let bearing = self.contacts.iter().filter(|c| c.bears);
        let velocities = &self.velocities;
        let mut lift = bearing.fold(0.0, |lift: f64, c| {
            lift.max(c.lift_for(c.speeds(velocities)))
        });
        let mut lowest = Lowest { lift, turns: 0 };
        let mut conditions = std::mem::take(&mut self.conditions);
        let mut back = None;
        for turn in 1..=turns {
            if self.look_down(lift, &mut conditions).is_none() {
                break;
            }
            match first_met(&conditions, back) {
                Met::Ground => lift = 0.0,
                Met::Conditions { way, share } => {
                    self.go(way * share - 1.0);
                    lift *= 1.0 - way * share;
                    self.bear(lift);
                    let is_met = |c: &&Condition| {
                        let met = c.met(way, back);
                        met.is_some_and(|met| met <= share + together)
                    };
                    let most = if together > 0.0 { usize::MAX } else { 1 };
                    let met = conditions.iter().filter(is_met).take(most);
                    back = self.make_all(met.map(|c| c.switch));
                }
                Met::Nothing => {
                    self.go(-1.0);
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

    /// Finds the conditions of the present states, from where contacts are lifted by `lift` [m/s] to where these states
    /// are a solution on the ground, and goes there; it stays where it is if there is none.
    fn look_down(&mut self, lift: f64, conditions: &mut Vec<Condition>) -> Option<()> {
        self.effort.rounds += 1;
        conditions.clear();
        self.bear(lift);
        self.conditions(lift, |switch, now| {
            let there = now;
            conditions.push(Condition { switch, now, there });
        });
        self.assemble();
        self.solve_for_change()?;
        self.go(1.0);
        self.bear(0.0);
        let mut all = conditions.iter_mut();
        self.conditions(0.0, |_, there| {
            if let Some(condition) = all.next() {
                condition.there = there;
            }
        });
        Some(())
    }

    /// Lifts all contacts off, and lets the motors find their states in the air; none if the constraints contradict each
    /// other.
    fn lift_off(&mut self) -> Option<()> {
        for contact in &mut self.contacts {
            contact.grip = Grip::Open;
        }
        for round in 0..=TURNS * self.motors.len() {
            self.effort.rounds += 1;
            self.assemble();
            self.solve_for_change()?;
            self.go(1.0);
            self.bear(0.0);
            if round < SIMULTANEOUS_ROUNDS {
                if !self.switch_motors() {
                    break;
                }
                self.tie();
            } else {
                let mut next = None;
                self.conditions(f64::INFINITY, |switch, value| {
                    if value < -PAST.value() && next.is_none() {
                        next = Some(switch);
                    }
                });
                match next {
                    Some(switch) => self.make(switch),
                    None => break,
                };
            }
        }
        Some(())
    }

    /// Sets all impulses to those of the present states at the velocities, while contacts are lifted.
    fn bear(&mut self, lift: f64) {
        for contact in self.contacts.iter_mut().filter(|c| c.bears) {
            let [approach, slip] = contact.speeds(&self.velocities);
            [contact.normal_impulse, contact.friction_impulse] =
                contact.guessed([approach + lift, slip]);
        }
        self.others_follow_velocities();
        self.turn_with_base();
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

impl Contact {
    /// [m/s] How far it has to be lifted to touch nothing, at these speeds.
    fn lift_for(&self, [approach, _]: [f64; 2]) -> f64 {
        self.dampers[0].speed_for(0.0) - approach
    }
}
