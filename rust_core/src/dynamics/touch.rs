//! A contact of the robot in one step: where it touches, its gap, and how hard and how softly it may close.
//!
//! The equations: docs/physics.md, "Softness".

use super::levers::{Levers, Place};
use super::meeting::Meeting;
use super::softness::Softness;
use super::state::State;
use crate::geometry::{Rotation, Vector, right_of};
use crate::robot::{Model, Mount};
use crate::solver::{Contact, Grip, Layout};

/// Compliance of the contacts of shoes, in units of that of the contact frequency: shoes are light, but the
/// robot stands on them. Harder ones hardly reduce the penetration, and jam more.
const ON_GUIDE: f64 = 0.1;
const ON_GROUND: f64 = 0.3;

/// What a contact of a step is on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum On {
    /// The ground, at the chassis or a flipper.
    Ground(Mount),
    /// The ground, at a shoe.
    #[default]
    Shoe,
    /// The guide of a chain, a wheel in it or a tooth, at a shoe.
    Guide { chain: usize, shoe: usize },
}

/// What a step starts from.
pub(super) struct Start<'a> {
    pub state: &'a State,
    /// Its velocities as the unknowns of a solve, and where they stand.
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
    /// Unit normal away from the surface that it touches.
    pub normal: Vector,
    /// The drive of its part.
    pub drive: Option<usize>,
    /// [m] Levers of normal and tangent on the spin of that drive.
    pub spin_levers: [f64; 2],
    /// [N] Forces to start from, the last ones.
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
    /// Index among the shoe's rests.
    pub rest_index: usize,
}

impl Touch {
    /// That of a contact found in the middle of the step, and the contact as the solver sees it; `last` is the same contact in
    /// the last step.
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

    /// Takes over the forces and the grip of the last step.
    pub(super) fn go_on(&mut self, solved: &mut Contact, last: Option<crate::contact::Contact>) {
        solved.grip = last.map_or(Grip::Open, |l| l.grip);
        self.normal_guess = last.map_or(0.0, |l| l.normal_guess);
        self.friction_guess = last.map_or(0.0, |l| l.friction_guess);
    }

    /// Sets a contact up for a motion of `h` [s]: an open gap may just close, softly; a penetration is pushed out. The
    /// solve finds the impulse of a `time` [s].
    pub(super) fn close_softly(
        &self,
        solved: &mut Contact,
        (h, time): (f64, f64),
        soft: Softness,
        max_push_speed: f64,
    ) {
        let share = if self.is_on_ground() {
            ON_GROUND
        } else {
            ON_GUIDE
        };
        let compliance = share * soft.compliance * h / time;
        solved.bears = true;
        solved.compliance = compliance;
        let springs = (soft.push_rate * h).min(1.0);
        solved.give_way(compliance, springs, self.friction_guess * time);
        solved.bias = if self.gap > 0.0 {
            self.gap / h
        } else {
            (soft.push_rate * self.gap).max(-max_push_speed)
        };
    }

    /// Sets it up before the motion: an open gap may just close, and a penetration is pushed out softly.
    pub(super) fn close(&self, solved: &mut Contact, h: f64, soft: Softness, max_push_speed: f64) {
        solved.bears = true;
        if self.gap > 0.0 {
            (solved.bias, solved.compliance) = (self.gap / h, 0.0);
        } else {
            solved.bias = (soft.push_rate * self.gap).max(-max_push_speed);
            // Here the impulse of half the step stands for that of all of it.
            solved.compliance = 2.0 * soft.compliance;
        }
    }

    /// Whether the ground bears, not the robot itself.
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

    /// The parts of a vector along normal and tangent.
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
