//! A row: one contact as the solver sees it, with its levers on body and drive, its gap and its impulses.
//!
//! The equations: docs/physics.md, "Softness".

use super::LoadedContact;
use super::action::Action;
use super::damper::Damper;
use super::face::Face;
use super::grip::Grip;
use super::levers::{Direction, Levers, Place};
use super::meeting::Meeting;
use super::softness::Softness;
use super::state::{State, Twist};
use super::way::Way;
use crate::contact::Contact;
use crate::geometry::{Rotation, Vector};
use crate::robot::{Model, Mount};

/// Compliance of the contacts of shoes, in units of that of the contact frequency: shoes are light, but the
/// robot stands on them. Harder ones hardly reduce the penetration, and jam more.
const ON_GUIDE: f64 = 0.1;
const ON_GROUND: f64 = 0.3;

/// The bodies that a row connects.
#[derive(Clone, Copy, Debug)]
pub(super) enum Link {
    /// The chassis, or what a drive moves relative to it, to the ground.
    Chassis,
    /// A shoe to the ground.
    Shoe(usize),
    /// A shoe to the guide, or to a wheel of the chain: the chassis takes the reaction.
    Guide { shoe: usize, chain: usize },
    /// A flipper, or what a drive moves relative to it, to the ground.
    Flipper(usize),
    /// A pin of a shoe to a tooth: the sprocket takes the reaction, and the chassis takes it at the axle.
    Tooth { shoe: usize, chain: usize },
}

/// [1/kg] Velocity along normal and tangent per unit impulse along them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Admittance {
    pub normal: f64,
    pub tangent: f64,
    /// That of the mass that swings on its spring with the contact frequency.
    pub spring: f64,
}

/// One contact's constraint in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub normal: Direction,
    pub tangent: Direction,
    pub link: Link,
    pub drive: Option<usize>,
    pub friction: f64,
    /// Normal and tangent, with the motors in their state in this solve.
    pub actions: [Action; 2],
    pub admittance: Admittance,
    /// [m/s] Speed at which the gap may close or, if negative, must open.
    pub bias: f64,
    /// Compliance in units of the admittance of its spring.
    pub compliance: f64,
    /// The same of a grip that gives way elastically; it is damped about its impulse of the last step.
    pub give: f64,
    /// Share of a change of the friction of an elastic grip that its spring keeps; the rest is damping.
    pub springs: f64,
    /// Whether it can carry a load in this solve.
    pub bears: bool,
    /// [N s] Normal impulse in this step.
    pub normal_impulse: f64,
    /// [N s] Friction impulse in this step.
    pub friction_impulse: f64,
    /// The guessed state.
    pub grip: Grip,
    /// The state that fits the last velocities.
    pub fitting: Grip,
    /// Dampers of normal and tangent in this solve while no limit is reached.
    pub dampers: [Damper; 2],
    /// Its line in a step of Newton's method.
    pub way: Way,
    /// [N s] Impulses about which a direct solve damps it.
    pub center: (f64, f64),
    /// [N] Normal force to start from, the last one.
    pub normal_guess: f64,
    pub friction_guess: f64,
    /// [m] Current gap.
    pub gap: f64,
    pub meeting: Meeting,
    /// [m/s] How much faster the gap opens, and the surface slides, at the end of the step than with the levers of its
    /// middle.
    pub gains: [f64; 2],
    /// Index among the shoe's rests.
    pub place: usize,
    /// Its point in the middle of the step.
    pub middle: Place,
    /// [m] Gap at the start of the step.
    pub start: f64,
    /// The face on which an arc rolls, if it is on one.
    pub face: Face,
    /// [m] How far the ground has fallen away below an arc that has left its face within the step.
    pub overrun: f64,
}

impl Row {
    /// The row of a contact found in the middle of the step, half of `time` [s] from now; `last` is the same
    /// contact in the last step.
    pub(super) fn new(
        contact: &Contact,
        last: Option<LoadedContact>,
        state: &State,
        model: &Model,
        time: f64,
    ) -> Self {
        let part = &model.parts[contact.part];
        let middle = state.carrier(part.mount, time, model);
        let of_drive = |of: &dyn Fn(usize) -> f64| part.drive.map_or(0.0, of);
        let drive_position = of_drive(&|k| state.run_over(part.mount, k, model));
        let advance = of_drive(&|k| state.speed_over(part.mount, k, model)) * time;
        let Levers {
            normal,
            tangent,
            arm,
            carried,
        } = Levers::new(
            contact,
            &middle,
            part.motion(drive_position + advance, advance.abs()),
            model,
        );
        let mut row = Self {
            drive: part.drive,
            friction: part.friction_limit,
            grip: last.map_or(Grip::Open, |l| l.grip),
            normal_guess: last.map_or(0.0, |l| l.normal_guess),
            friction_guess: last.map_or(0.0, |l| l.friction_guess),
            middle: Place {
                gap: contact.distance,
                carrier: middle,
                arm: arm - carried.spoke,
                carried,
                drive_position: drive_position + advance,
            },
            meeting: Meeting::of(contact, part, |point| {
                middle.center + Rotation::new(middle.angle) * (point - middle.origin)
            }),
            ..match part.mount {
                Mount::Flipper(k) => {
                    let pivot = middle.center - state.moved(time).0;
                    let [normal, tangent] = [normal, tangent].map(|d| d.on_flipper(pivot));
                    Self::between(normal, tangent, Link::Flipper(k))
                }
                Mount::Chassis | Mount::Shoe(_) => Self::between(normal, tangent, Link::Chassis),
            }
        };
        row.gap = row.gap_after(state, model, (part.mount, 0.0));
        row.start = row.gap;
        row
    }

    /// A row along these directions, without friction or history.
    pub(super) fn between(normal: Direction, tangent: Direction, link: Link) -> Self {
        Self {
            normal,
            tangent,
            link,
            drive: None,
            friction: 0.0,
            actions: [Action::default(); 2],
            admittance: Admittance::default(),
            bias: 0.0,
            compliance: 0.0,
            give: 0.0,
            springs: 1.0,
            bears: false,
            normal_impulse: 0.0,
            friction_impulse: 0.0,
            grip: Grip::Open,
            fitting: Grip::Open,
            dampers: [Damper::default(); 2],
            way: Way::default(),
            center: (0.0, 0.0),
            normal_guess: 0.0,
            friction_guess: 0.0,
            gap: 0.0,
            meeting: Meeting::Point,
            gains: [0.0; 2],
            place: 0,
            middle: Place::default(),
            start: 0.0,
            face: Face::default(),
            overrun: 0.0,
        }
    }

    /// The drive on whose spin it acts.
    pub(super) fn spin(&self) -> Option<usize> {
        self.drive
            .filter(|_| matches!(self.link, Link::Chassis | Link::Flipper(_)))
    }

    /// Whether the ground bears there, not the robot itself.
    pub(super) fn is_on_ground(&self) -> bool {
        !matches!(self.link, Link::Guide { .. } | Link::Tooth { .. })
    }

    /// The flipper on which it acts.
    pub(super) fn flipper(&self) -> Option<usize> {
        match self.link {
            Link::Flipper(k) => Some(k),
            _ => None,
        }
    }

    /// [m/s] Speed at which the gap opens.
    pub(super) fn opening_speed(&self, state: &State) -> f64 {
        self.speed_along(state, &self.normal)
    }

    /// [m/s] Velocity of the robot's surface over the ground along the tangent.
    pub(super) fn slip(&self, state: &State) -> f64 {
        self.speed_along(state, &self.tangent)
    }

    fn speed_along(&self, state: &State, along: &Direction) -> f64 {
        let of = |twist: Twist, lever: f64| along.unit.dot(twist.velocity) + lever * twist.turn;
        let spin = || self.drive.map_or(0.0, |k| state.drives[k].spin);
        match self.link {
            Link::Chassis => of(state.twist(), along.lever) + along.drive_lever * spin(),
            Link::Flipper(k) => {
                let chassis = of(state.twist(), along.lever);
                chassis + along.flipper_lever * state.flippers[k].rate + along.drive_lever * spin()
            }
            Link::Shoe(i) => of(state.shoes[i].twist, along.lever),
            Link::Guide { shoe, chain } => {
                of(state.shoes[shoe].twist, along.lever) - of(state.twist(), along.back)
                    + along.drive_lever * state.idlers[chain].rate
            }
            Link::Tooth { shoe, chain } => {
                of(state.shoes[shoe].twist, along.lever) - of(state.twist(), along.back)
                    + along.drive_lever * state.drives[chain].spin
            }
        }
    }

    /// [m/s] Speeds along normal and tangent from velocities of chassis, shoes, drives, idlers and flippers.
    pub(super) fn count(
        &self,
        chassis: Twist,
        shoe: impl Fn(usize) -> Twist,
        spin: impl Fn(usize) -> f64,
        idler: impl Fn(usize) -> f64,
        flipper: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let [n, t] = &self.actions;
        let along = |twist: Twist, spin: f64| {
            [n, t].map(|action| action.change(twist.velocity, twist.turn, spin))
        };
        match self.link {
            Link::Chassis => along(chassis, self.drive.map_or(0.0, spin)),
            Link::Flipper(k) => {
                let [of_n, of_t] = along(chassis, self.drive.map_or(0.0, spin));
                let rate = flipper(k);
                [of_n + n.flipper_lever * rate, of_t + t.flipper_lever * rate]
            }
            Link::Shoe(i) => along(shoe(i), 0.0),
            Link::Guide { shoe: i, chain } | Link::Tooth { shoe: i, chain } => {
                let beside = match self.link {
                    Link::Tooth { .. } => spin(chain),
                    _ => idler(chain),
                };
                let [of_n, of_t] = along(shoe(i), beside);
                let back = |a: &Action| a.unit.dot(chassis.velocity) + a.back * chassis.turn;
                [of_n - back(n), of_t - back(t)]
            }
        }
    }

    /// Sets it up for a motion of `h` [s]: an open gap may just close, softly; a penetration is pushed out. The
    /// solve finds the impulse of a `time` [s].
    pub(super) fn close_softly(
        &mut self,
        (h, time): (f64, f64),
        soft: Softness,
        max_push_speed: f64,
    ) {
        let share = match self.link {
            Link::Guide { .. } | Link::Tooth { .. } => ON_GUIDE,
            _ => ON_GROUND,
        };
        self.bears = true;
        self.give = share * soft.compliance * h / time;
        self.compliance = self.give;
        self.springs = (soft.push_rate * h).min(1.0);
        self.center.1 = self.friction_guess * time;
        self.bias = if self.gap > 0.0 {
            self.gap / h
        } else {
            (soft.push_rate * self.gap).max(-max_push_speed)
        };
    }

    /// Sets it up before the motion: an open gap may just close, and a penetration is pushed out softly.
    pub(super) fn close(&mut self, h: f64, soft: Softness, max_push_speed: f64) {
        self.bears = true;
        if self.gap > 0.0 {
            (self.bias, self.compliance) = (self.gap / h, 0.0);
        } else {
            self.bias = (soft.push_rate * self.gap).max(-max_push_speed);
            // Here the impulse of half the step stands for that of all of it.
            self.compliance = 2.0 * soft.compliance;
        }
    }

    /// [N s] Friction impulse without the part of the damper, from which the next step starts.
    pub(super) fn friction_kept(&self) -> f64 {
        if self.give == 0.0 || self.grip != Grip::Sticks {
            return self.friction_impulse;
        }
        self.center.1 + (self.friction_impulse - self.center.1) * self.springs
    }

    /// [N s] Impulse on the robot.
    pub(super) fn impulse(&self) -> Vector {
        let [n, t] = &self.actions;
        n.unit * self.normal_impulse + t.unit * self.friction_impulse
    }

    /// [N m s] Angular impulse on the drive.
    pub(super) fn torque(&self) -> f64 {
        self.normal.drive_lever * self.normal_impulse
            + self.tangent.drive_lever * self.friction_impulse
    }
}
