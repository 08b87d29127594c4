//! Plane statics of a stop: which forces within friction and torque limits could balance it?
//!
//! Every contact has a normal force and friction: anywhere in the friction cone while it sticks, against the slip
//! on the edge of the cone while it slides. Forces, the moment about the centre of mass and the torque of each
//! drive must balance; the imbalance is the smallest residual that any choice of forces leaves. A condition that
//! holds the robot is found by relaxing it.

#[cfg(test)]
mod tests;

use super::forces::{Forces, Push, Source, WITHOUT_LIMIT};
use crate::dynamics::{Direction, push_axis};
use crate::robot::Model;

/// A stop as a set of possible forces.
#[derive(Clone, Debug)]
pub(super) struct Statics {
    supports: Vec<Support>,
    /// Supports that would bear if every pocket were closed.
    closed: Vec<Support>,
    /// For each drive: +1 or -1, as commanded, if its motor acts on the ground; else 0.
    motors: Vec<f64>,
    /// For each drive: the sign of the motor's force if it is at its limit; else 0.
    stalled: Vec<f64>,
    /// Largest force of a motor, in weights.
    torque: f64,
    /// Smallest share of it at which a motor counts as at its limit.
    at_limit: f64,
    /// [m] Lever arm that converts moments to forces.
    lever: f64,
    radius: f64,
    /// Force along the chassis, of a model that pushes the chassis: direction and lever.
    push: Option<(f64, f64, f64)>,
    /// Pivots of the arms.
    hinges: Vec<Hinge>,
}

/// A contact that bears or could bear.
#[derive(Clone, Debug)]
pub(super) struct Support {
    pub normal: Direction,
    pub tangent: Direction,
    pub drive: Option<usize>,
    /// Pivot of the arm that it is on, if any.
    pub hinge: Option<usize>,
    /// Coefficient of friction.
    pub friction: f64,
    /// Sign of its slip along the tangent; 0 while it sticks.
    pub slides: f64,
    pub role: Role,
}

/// The pivot of the arms at one end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hinge {
    /// [m] Holding moment against the arms' weight about it, counter-clockwise, over the robot's weight.
    pub weight: f64,
    /// [m] Largest torque of their motors, over the robot's weight.
    pub torque: f64,
}

/// The role of a support in the diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// It bears on ground in a pocket.
    Pocket,
    /// The belly bears on it.
    Belly,
    /// Anything else.
    Track,
}

/// A condition of an equilibrium that can be relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The pockets of the track: closed, so that a belt runs over what is in them.
    Pocket,
    /// The belly: removed.
    Belly,
    /// The torque limit: lifted.
    Torque,
    /// The friction: doubled.
    Friction,
}

impl Condition {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Pocket, Self::Belly, Self::Torque, Self::Friction];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pocket => "pocket",
            Self::Belly => "belly",
            Self::Torque => "torque",
            Self::Friction => "friction",
        }
    }
}

/// What the drives do in an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drives {
    /// As observed, motors within their limits.
    AsFound,
    /// As observed, with motors at their limit held at it.
    Hold,
    /// All turn as commanded, and their surfaces slide.
    Turn,
    /// All stand still, with their motors at the limit.
    Stand,
}

impl Statics {
    /// `command` is the sign of the commanded speed, `torque` the largest force of a motor in weights, `at_limit` the
    /// share of it from which a motor counts as at its limit; `lever` [m] converts moments to forces.
    pub(super) fn new(
        model: &Model,
        angle: f64,
        (supports, closed): (Vec<Support>, Vec<Support>),
        stalled: Vec<f64>,
        hinges: Vec<Hinge>,
        command: f64,
        [torque, at_limit, lever]: [f64; 3],
    ) -> Self {
        let bears = |k: usize| {
            (model.pushes_chassis && k == 0) || supports.iter().any(|s| s.drive == Some(k))
        };
        let motors = (0..model.drives)
            .map(|k| {
                if k < model.motors && bears(k) {
                    command
                } else {
                    0.0
                }
            })
            .collect();
        let push = model.pushes_chassis.then(|| {
            let axis = push_axis(model, angle);
            (axis.unit.x, axis.unit.y, axis.lever)
        });
        Self {
            supports,
            closed,
            motors,
            stalled,
            torque,
            at_limit,
            lever,
            radius: model.drive_radius,
            push,
            hinges,
        }
    }

    /// Smallest residual that any choice of forces leaves, as a share of the weight; `None` if the linear program has
    /// no solution.
    pub(super) fn imbalance(&self) -> Option<f64> {
        self.forces(Drives::AsFound, &[]).imbalance()
    }

    /// The largest push along `direction` at the centre of mass that can be balanced; `None` if none can. Contacts
    /// keep sliding and motors keep pushing. But a push may load a surface until its motor cannot turn it; then it
    /// holds by sticking.
    pub(super) fn escape(&self, direction: f64, tolerance: f64) -> Option<Push> {
        let mut statics = self.clone();
        let largest = |statics: &Self| {
            let forces = statics.forces(Drives::Hold, &[]);
            forces.largest_push(direction, tolerance)
        };
        let mut most = largest(&statics)?;
        while statics.stall(&most) {
            match largest(&statics) {
                Some(push) if push.force > most.force => most = push,
                _ => break,
            }
        }
        Some(most)
    }

    /// Stalls the drives that reach their limit under a push; false if there are none.
    fn stall(&mut self, push: &Push) -> bool {
        let mut any = false;
        for (k, force) in &push.motors {
            if self.stalled[*k] == 0.0 && force.abs() > self.torque * (1.0 - 1e-6) {
                self.stalled[*k] = force.signum();
                let on_it = self.supports.iter_mut().filter(|s| s.drive == Some(*k));
                on_it.for_each(|support| support.slides = 0.0);
                any = true;
            }
        }
        any
    }

    /// The same, with every contact and motor free to hold within its limits.
    pub(super) fn free_escape(&self, direction: f64, tolerance: f64) -> Option<Push> {
        let mut gripping = self.clone();
        for support in &mut gripping.supports {
            support.slides = 0.0;
        }
        gripping
            .forces(Drives::AsFound, &[])
            .largest_push(direction, tolerance)
    }

    /// All smallest sets of conditions whose relaxation leaves no equilibrium within `tolerance`.
    pub(super) fn cause(&self, tolerance: f64, given: &[Condition]) -> Vec<Vec<Condition>> {
        let subsets = || (1_u32..1 << given.len()).map(|bits| subset(given, bits));
        for size in 1..=given.len() {
            let ending: Vec<Vec<Condition>> = subsets()
                .filter(|set| set.len() == size && self.ends(set, tolerance))
                .collect();
            if !ending.is_empty() {
                return ending;
            }
        }
        Vec::new()
    }

    /// Whether there is no equilibrium without these conditions.
    pub(super) fn ends(&self, relaxed: &[Condition], tolerance: f64) -> bool {
        let balanced = |drives| {
            let imbalance = self.forces(drives, relaxed).imbalance();
            imbalance.is_none_or(|imbalance| imbalance <= tolerance)
        };
        // Without the torque limit, motors are no longer held at it.
        let as_found = !relaxed.contains(&Condition::Torque) && balanced(Drives::Hold);
        !as_found && !balanced(Drives::Turn) && !balanced(Drives::Stand)
    }

    fn forces(&self, drives: Drives, relaxed: &[Condition]) -> Forces {
        let without = |condition| relaxed.contains(&condition);
        let stays = |s: &&Support| match s.role {
            Role::Pocket => !without(Condition::Pocket),
            Role::Belly => !without(Condition::Belly),
            Role::Track => true,
        };
        let closed = if without(Condition::Pocket) {
            &self.closed[..]
        } else {
            &[]
        };
        let raised = if without(Condition::Friction) {
            2.0
        } else {
            1.0
        };
        let hung = self.hinges.iter().map(|hinge| hinge.weight / self.lever);
        let mut forces = Forces::bearing(hung.collect());
        let bearing: Vec<&Support> = self.supports.iter().filter(stays).chain(closed).collect();
        for (i, support) in bearing.iter().enumerate() {
            let motor = support.drive.map_or(0.0, |k| self.motors[k]);
            let slides = match drives {
                _ if motor == 0.0 => support.slides,
                Drives::AsFound | Drives::Hold => support.slides,
                Drives::Turn => support.slip_at(motor),
                Drives::Stand => 0.0,
            };
            let friction = raised * support.friction;
            let sides: &[f64] = if slides == 0.0 {
                &[-1.0, 1.0]
            } else {
                &[-slides.signum()]
            };
            for side in sides {
                let column = self.column(support, side * friction);
                forces.push(Source::Support(i), column, (0.0, f64::INFINITY));
            }
        }
        let torque = if without(Condition::Torque) {
            WITHOUT_LIMIT
        } else {
            self.torque
        };
        let at_limit = self.at_limit * torque;
        for (k, motor) in self.motors.iter().enumerate().filter(|(_, m)| **m != 0.0) {
            // A motor without a support to act on turns freely.
            let bears = self.push.is_some() || bearing.iter().any(|s| s.drive == Some(k));
            let bounds = match drives {
                _ if !bears => (-torque, torque),
                Drives::Stand => (motor * torque, motor * torque),
                Drives::Hold if self.stalled[k] > 0.0 => (at_limit, torque),
                Drives::Hold if self.stalled[k] < 0.0 => (-torque, -at_limit),
                _ => (-torque, torque),
            };
            forces.push(Source::Motor(k), self.motor_column(k), bounds);
        }
        for (k, hinge) in self.hinges.iter().enumerate() {
            let mut column = self.zero();
            column[3 + self.motors.len() + k] = 1.0;
            let most = hinge.torque / self.lever;
            forces.push(Source::Outside, column, (-most, most));
        }
        if let Some((x, y, lever)) = self.push {
            let mut column = self.zero();
            (column[0], column[1], column[2]) = (x, y, lever / self.lever);
            column[3] = 1.0;
            forces.push(Source::Outside, column, (-WITHOUT_LIMIT, WITHOUT_LIMIT));
        }
        forces
    }

    fn zero(&self) -> Vec<f64> {
        vec![0.0; 3 + self.motors.len() + self.hinges.len()]
    }

    /// The effect of a unit normal force with friction along the tangent.
    fn column(&self, support: &Support, friction: f64) -> Vec<f64> {
        let (n, t) = (&support.normal, &support.tangent);
        let unit = n.unit + t.unit * friction;
        let mut column = self.zero();
        (column[0], column[1]) = (unit.x, unit.y);
        column[2] = (n.lever + t.lever * friction) / self.lever;
        if let Some(k) = support.drive {
            column[3 + k] = (n.drive_lever + t.drive_lever * friction) / self.radius;
        }
        if let Some(k) = support.hinge {
            let lever = n.flipper_lever + t.flipper_lever * friction;
            column[3 + self.motors.len() + k] = lever / self.lever;
        }
        column
    }

    /// The effect of a unit motor force at the surface, with its reaction on the chassis.
    fn motor_column(&self, k: usize) -> Vec<f64> {
        let mut column = self.zero();
        column[2] = self.radius / self.lever;
        column[3 + k] = -1.0;
        column
    }
}

impl Support {
    /// Sign of the slip of a surface whose drive turns in this direction.
    pub(super) fn slip_at(&self, motor: f64) -> f64 {
        // A surface speed of 1 moves the surface by -drive_lever / drive_radius.
        -self.tangent.drive_lever * motor
    }
}

fn subset(given: &[Condition], bits: u32) -> Vec<Condition> {
    let chosen = |(i, c): (usize, &Condition)| (bits & (1 << i) != 0).then_some(*c);
    given.iter().enumerate().filter_map(chosen).collect()
}
