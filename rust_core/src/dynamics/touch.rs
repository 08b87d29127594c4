//! A contact of the robot in one step: where it is, its gap, and how fast and how softly it may close.
//!
//! The equations: docs/physics.md, "Softness".

use super::levers::{Levers, Place};
use super::meeting::Meeting;
use super::softness::Softness;
use super::state::State;
use crate::geometry::{Rotation, Vector, right_of};
use crate::robot::{Model, Mount};
use crate::solver::{Contact, Grip, Layout};

/// Compliance of the contacts of shoes, in units of that which the contact frequency gives: shoes are light, but the robot
/// stands on them. Stiffer contacts hardly reduce the penetration, and jam more.
const ON_GUIDE: f64 = 0.1;
const ON_GROUND: f64 = 0.3;

/// The two sides of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum On {
    /// The chassis or a flipper on the ground.
    Ground(Mount),
    /// A shoe on the ground.
    #[default]
    Shoe,
    /// A shoe on the guide of its chain, a wheel in it or a tooth.
    Guide { chain: usize, shoe: usize },
}

/// What a step starts from.
pub(super) struct Start<'a> {
    pub state: &'a State,
    /// Its velocities as the unknowns of a solve, and their order.
    pub unknowns: &'a [f64],
    pub layout: Layout,
    pub model: &'a Model,
    /// [s] Half of the step.
    pub half: f64,
}

impl<'a> Start<'a> {
    pub(super) fn new(
        (state, model): (&'a State, &'a Model),
        (layout, unknowns): (Layout, &'a [f64]),
        half: f64,
    ) -> Self {
        Self {
            state,
            unknowns,
            layout,
            model,
            half,
        }
    }
}

/// Data of a contact in a step, in addition to those of its solves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Touch {
    pub on: On,
    /// Unit normal, away from the other side.
    pub normal: Vector,
    /// The drive of its part.
    pub drive: Option<usize>,
    /// [m] Levers of normal and tangent on the spin of that drive.
    pub spin_levers: [f64; 2],
    /// [N] The last forces along normal and tangent, from which a solve starts.
    pub normal_guess: f64,
    pub friction_guess: f64,
    /// [m] Current gap.
    pub gap: f64,
    /// [m] Gap at the start of the step.
    pub gap_before: f64,
    pub meeting: Meeting,
    /// Its point in the middle of the step.
    pub middle: Place,
    /// [m] Distance that an arc has rolled on its face since the middle of the step.
    pub rolled: f64,
    /// Whether it closes in a step in which something strikes the ground.
    pub strikes: bool,
    /// Index among the possible rests of its shoe.
    pub rest_index: usize,
}

impl Touch {
    /// The data of a contact that was found in the middle of the step, and the contact as the solver sees it; `last` is the same
    /// contact in the last step.
    pub(super) fn new(
        contact: &crate::contact::Contact,
        last: Option<crate::contact::Contact>,
        start: &Start,
    ) -> (Self, Contact) {
        let Start { state, model, .. } = *start;
        let part = &model.parts[contact.part];
        let middle = state.carrier(part.mount, start.half, model);
        let of_drive = |of: &dyn Fn(usize) -> f64| part.drive.map_or(0.0, of);
        let drive_position = of_drive(&|k| state.run_over(part.mount, k, model));
        let advance = of_drive(&|k| state.speed_over(part.mount, k, model)) * start.half;
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
        let (directions, flipper) = match part.mount {
            Mount::Flipper(k) => {
                let pivot = middle.center - state.mass_pose_after(start.half).0;
                let on_flipper = [normal, tangent].map(|along| along.on_flipper(pivot));
                (on_flipper, Some(k))
            }
            Mount::Chassis | Mount::Shoe(_) => ([normal, tangent], None),
        };
        let mut solved = Contact::new(directions.map(|d| d.row(start.layout, part.drive, flipper)));
        let mut touch = Self {
            on: On::Ground(part.mount),
            normal: contact.normal,
            drive: part.drive,
            spin_levers: directions.map(|along| along.spin_lever),
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
            ..Self::default()
        };
        touch.gap = touch.gap_after(state, model, (part.mount, 0.0));
        touch.gap_before = touch.gap;
        touch.go_on(&mut solved, last);
        (touch, solved)
    }

    /// Starts from the forces and the grip of the last step.
    pub(super) fn go_on(&mut self, solved: &mut Contact, last: Option<crate::contact::Contact>) {
        solved.grip = last.map_or(Grip::Open, |l| l.grip);
        self.normal_guess = last.map_or(0.0, |l| l.normal_guess);
        self.friction_guess = last.map_or(0.0, |l| l.friction_guess);
    }

    /// Sets a contact up for a motion of `h` [s] on a spring: an open gap may close, and a penetration is pushed out. The solve
    /// finds the impulse of a `time` [s].
    pub(super) fn close(
        &self,
        solved: &mut Contact,
        (h, time): (f64, f64),
        soft: Softness,
        max_push_speed: f64,
    ) {
        solved.bears = true;
        solved.compliance = soft.compliance * (h / time);
        solved.bias = if self.gap > 0.0 {
            self.gap / h
        } else {
            (soft.push_rate * self.gap).max(-max_push_speed)
        };
    }

    /// The same for a robot with chains, whose contacts are stiffer; their grips give way as well.
    pub(super) fn close_softly(
        &self,
        solved: &mut Contact,
        (h, time): (f64, f64),
        soft: Softness,
        max_push_speed: f64,
    ) {
        self.close(solved, (h, time), soft, max_push_speed);
        solved.compliance *= if self.is_on_ground() {
            ON_GROUND
        } else {
            ON_GUIDE
        };
        let springs = (soft.push_rate * h).min(1.0);
        solved.give_way(solved.compliance, springs, self.friction_guess * time);
    }

    /// Whether it is on the ground, not on the robot itself.
    pub(super) fn is_on_ground(&self) -> bool {
        !matches!(self.on, On::Guide { .. })
    }

    /// Its carrier, unless that is a shoe.
    pub(super) fn mount(&self) -> Option<Mount> {
        match self.on {
            On::Ground(mount) => Some(mount),
            _ => None,
        }
    }

    /// The components of a vector along normal and tangent.
    pub(super) fn along(&self, v: Vector) -> [f64; 2] {
        [self.normal.dot(v), right_of(self.normal).dot(v)]
    }

    /// [N s] Impulse on the robot, or the shoe.
    pub(super) fn impulse(&self, solved: &Contact) -> Vector {
        self.normal * solved.normal_impulse + right_of(self.normal) * solved.friction_impulse
    }

    /// [N m s] Angular impulse on the drive.
    pub(super) fn torque(&self, solved: &Contact) -> f64 {
        let [normal, tangent] = self.spin_levers;
        normal * solved.normal_impulse + tangent * solved.friction_impulse
    }
}
