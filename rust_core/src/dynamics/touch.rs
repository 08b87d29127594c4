//! A contact of the robot in one step: where it touches, its gap, and how hard and how softly it may close.
//!
//! The equations: docs/physics.md, "Softness".

use super::face::Face;
use super::levers::{Levers, Place};
use super::meeting::Meeting;
use super::softness::Softness;
use super::state::State;
use crate::geometry::Rotation;
use crate::robot::{Model, Mount};
use crate::solver::{ActsOn, Contact, Grip};

/// Compliance of the contacts of shoes, in units of that of the contact frequency: shoes are light, but the
/// robot stands on them. Harder ones hardly reduce the penetration, and jam more.
const ON_GUIDE: f64 = 0.1;
const ON_GROUND: f64 = 0.3;

/// What a step knows of a contact besides what its solves do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Touch {
    /// The drive of its part.
    pub drive: Option<usize>,
    /// [N] Forces to start from, the last ones.
    pub normal_guess: f64,
    pub friction_guess: f64,
    /// [m] Current gap.
    pub gap: f64,
    /// [m] Gap at the start of the step.
    pub start: f64,
    pub meeting: Meeting,
    /// Its point in the middle of the step.
    pub middle: Place,
    /// The face on which an arc rolls, if it is on one.
    pub face: Face,
    /// [m] How far the ground has fallen away below an arc that has left its face within the step.
    pub overrun: f64,
    /// Whether it closes in a step in which something strikes the ground.
    pub strikes: bool,
    /// Index among the shoe's rests.
    pub place: usize,
}

impl Touch {
    /// That of a contact found in the middle of the step, half of `time` [s] from now, and the contact as the solver
    /// sees it; `last` is the same contact in the last step.
    pub(super) fn new(
        contact: &crate::contact::Contact,
        last: Option<crate::contact::Contact>,
        state: &State,
        model: &Model,
        time: f64,
    ) -> (Self, Contact) {
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
        let spin = part.drive;
        let solved = match part.mount {
            Mount::Flipper(k) => {
                let pivot = middle.center - state.moved(time).0;
                let joint = Some(k);
                let directions = [normal, tangent].map(|along| along.on_flipper(pivot));
                Contact::new(ActsOn::Base { joint, spin }, directions)
            }
            Mount::Chassis | Mount::Shoe(_) => {
                let joint = None;
                Contact::new(ActsOn::Base { joint, spin }, [normal, tangent])
            }
        };
        let mut touch = Self {
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
        touch.drive = part.drive;
        touch.gap = touch.gap_after(&solved, state, model, (part.mount, 0.0));
        touch.start = touch.gap;
        touch.continued(solved, last)
    }

    /// The same with the forces and the grip of the last step.
    pub(super) fn continued(
        mut self,
        mut solved: Contact,
        last: Option<crate::contact::Contact>,
    ) -> (Self, Contact) {
        solved.grip = last.map_or(Grip::Open, |l| l.grip);
        self.normal_guess = last.map_or(0.0, |l| l.normal_guess);
        self.friction_guess = last.map_or(0.0, |l| l.friction_guess);
        (self, solved)
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
        let share = if is_on_ground(solved) {
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
}

/// Whether the ground bears at a contact, not the robot itself.
pub(super) fn is_on_ground(solved: &Contact) -> bool {
    matches!(solved.acts, ActsOn::Base { .. } | ActsOn::Link(_))
}

/// What carries a contact, if that is no shoe.
pub(super) fn mount(solved: &Contact) -> Option<Mount> {
    match solved.acts {
        ActsOn::Base { joint: Some(k), .. } => Some(Mount::Flipper(k)),
        ActsOn::Base { joint: None, .. } => Some(Mount::Chassis),
        _ => None,
    }
}
