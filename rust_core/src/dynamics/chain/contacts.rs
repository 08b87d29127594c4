//! Contacts of shoes as the solver sees them: with the ground, and with the guide, wheels and teeth.
//!
//! The equations: docs/physics.md, "Chains".

use super::RestMemory;
use super::rest::{Bearing, Rest};
use crate::contact;
use crate::dynamics::state::State;
use crate::dynamics::touch::Touch;
use crate::geometry::{Vector, cross, right_of};
use crate::robot::Model;
use crate::solver::{ActsOn, Contact, Direction, Link};

impl Touch {
    /// A shoe's contact with the ground, found half a step (`time` [s]) from now.
    pub(in crate::dynamics) fn of_shoe(
        contact: &contact::Contact,
        last: Option<contact::Contact>,
        state: &State,
        model: &Model,
        (shoe, time): (usize, f64),
    ) -> (Self, Contact) {
        let part = &model.parts[contact.part];
        let then = state.shoes[shoe].after(time);
        let (arm, travel) = (contact.point - then.center, then.along());
        let directions = [contact.normal, right_of(contact.normal)].map(|unit: Vector| Direction {
            unit,
            lever: cross(arm, unit),
            spin_lever: -model.drive_radius * unit.dot(travel),
            ..Direction::default()
        });
        let ring = model.chains.iter().position(|c| c.shoes.contains(&shoe));
        let link = Link {
            ring: ring.unwrap_or_default(),
            number: shoe,
        };
        let solved = Contact::new(ActsOn::Link(link), directions);
        let touch = Self {
            drive: part.drive,
            gap: contact.distance - solved.opening_speed(state) * time,
            ..Self::default()
        };
        touch.continued(solved, last)
    }

    /// A place where a shoe rests on the guide, a wheel or a tooth, without friction.
    pub(in crate::dynamics) fn at_rest(
        rest: &Rest,
        last: RestMemory,
        state: &State,
        (shoe, chain): (usize, usize),
        time: f64,
    ) -> (Self, Contact) {
        let arm = rest.point - state.shoes[shoe].after(time).center;
        let center = state.moved(time).0;
        let link = Link {
            ring: chain,
            number: shoe,
        };
        let (acts, borne_at) = match rest.on {
            Bearing::Chassis(_) => (ActsOn::LinkAndSlide(link), rest.point),
            Bearing::Tooth(axle) => (ActsOn::LinkAndSpin { link, spin: chain }, axle),
        };
        let directions = [rest.normal, right_of(rest.normal)].map(|unit| Direction {
            unit,
            lever: cross(arm, unit),
            spin_lever: match rest.on {
                Bearing::Chassis(slides) => -unit.dot(slides),
                Bearing::Tooth(axle) => -cross(rest.point - axle, unit),
            },
            back: cross(borne_at - center, unit),
            ..Direction::default()
        });
        let mut solved = Contact::new(acts, directions);
        solved.grip = last.grip;
        let touch = Self {
            normal_guess: last.force,
            place: rest.place,
            gap: rest.gap - solved.opening_speed(state) * time,
            ..Self::default()
        };
        (touch, solved)
    }
}
