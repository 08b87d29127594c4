//! Contacts of shoes as the solver sees them: with the ground, and with the guide, wheels and teeth.
//!
//! The equations: docs/physics.md, "Chains".

use super::RestMemory;
use super::rest::{Bearing, Rest};
use crate::contact::Contact;
use crate::dynamics::LoadedContact;
use crate::dynamics::grip::Grip;
use crate::dynamics::levers::Direction;
use crate::dynamics::row::{Link, Row};
use crate::dynamics::state::State;
use crate::geometry::{Vector, cross, right_of};
use crate::robot::Model;

impl Direction {
    /// A direction at a contact of a shoe: `arm` leads from the shoe's centre to the contact, and the track
    /// moves along `travel`.
    fn on_shoe(unit: Vector, arm: Vector, travel: Vector, model: &Model) -> Self {
        Self {
            unit,
            lever: cross(arm, unit),
            drive_lever: -model.drive_radius * unit.dot(travel),
            back: 0.0,
            flipper_lever: 0.0,
        }
    }
}

impl Row {
    /// The row of a shoe's contact with the ground, found half a step (`time` [s]) from now.
    pub(in crate::dynamics) fn of_shoe(
        contact: &Contact,
        last: Option<LoadedContact>,
        state: &State,
        model: &Model,
        (shoe, time): (usize, f64),
    ) -> Self {
        let part = &model.parts[contact.part];
        let then = state.shoes[shoe].after(time);
        let (arm, travel) = (contact.point - then.center, then.along());
        let [normal, tangent] = [contact.normal, right_of(contact.normal)]
            .map(|unit| Direction::on_shoe(unit, arm, travel, model));
        let mut row = Self::between(normal, tangent, Link::Shoe(shoe));
        row.drive = part.drive;
        row.friction = part.friction_limit;
        row.grip = last.map_or(Grip::Open, |l| l.grip);
        row.normal_guess = last.map_or(0.0, |l| l.normal_guess);
        row.friction_guess = last.map_or(0.0, |l| l.friction_guess);
        row.gap = contact.distance - row.opening_speed(state) * time;
        row
    }

    /// The row of a place where a shoe rests on the guide, a wheel or a tooth, without friction.
    pub(in crate::dynamics) fn at_rest(
        rest: &Rest,
        last: RestMemory,
        state: &State,
        (shoe, chain): (usize, usize),
        time: f64,
    ) -> Self {
        let arm = rest.point - state.shoes[shoe].after(time).center;
        let center = state.moved(time).0;
        let (link, borne_at) = match rest.on {
            Bearing::Chassis(_) => (Link::Guide { shoe, chain }, rest.point),
            Bearing::Tooth(axle) => (Link::Tooth { shoe, chain }, axle),
        };
        let [normal, tangent] = [rest.normal, right_of(rest.normal)].map(|unit| Direction {
            unit,
            lever: cross(arm, unit),
            drive_lever: match rest.on {
                Bearing::Chassis(slides) => -unit.dot(slides),
                Bearing::Tooth(axle) => -cross(rest.point - axle, unit),
            },
            back: cross(borne_at - center, unit),
            flipper_lever: 0.0,
        });
        let mut row = Self::between(normal, tangent, link);
        row.grip = last.grip;
        row.normal_guess = last.force;
        row.place = rest.place;
        row.gap = rest.gap - row.opening_speed(state) * time;
        row
    }
}
