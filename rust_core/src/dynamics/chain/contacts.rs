//! Contacts of shoes as the solver sees them: with the ground, and with the guide, wheels and teeth.
//!
//! The equations: docs/physics.md, "Chains".

use super::RestMemory;
use super::rest::{Bearing, Rest};
use crate::contact;
use crate::dynamics::touch::{On, Start, Touch};
use crate::geometry::{Vector, cross, right_of};
use crate::solver::{Contact, Link, Row};

impl Touch {
    /// A shoe's contact with the ground, found half a step (`time` [s]) from now.
    pub(in crate::dynamics) fn of_shoe(
        contact: &contact::Contact,
        last: Option<contact::Contact>,
        shoe: usize,
        start: &Start,
    ) -> (Self, Contact) {
        let model = start.model;
        let part = &model.parts[contact.part];
        let then = start.state.shoes[shoe].after(start.half);
        let (arm, travel) = (contact.point - then.center, then.along());
        let units = [contact.normal, right_of(contact.normal)];
        let ring = model.chains.iter().position(|c| c.shoes.contains(&shoe));
        let link = Link::new(start.layout, ring.unwrap_or_default(), shoe);
        let rows = units.map(|unit| Row::on_link(link, levers(unit, arm)));
        let mut touch = Self {
            drive: part.drive,
            on: On::Shoe,
            normal: contact.normal,
            spin_levers: units.map(|unit| -model.drive_radius * unit.dot(travel)),
            gap: contact.distance - rows[0].along(start.unknowns) * start.half,
            ..Self::default()
        };
        let mut solved = Contact::new(rows);
        touch.go_on(&mut solved, last);
        (touch, solved)
    }

    /// The frictionless contact of a shoe that rests on the guide, a wheel or a tooth.
    pub(in crate::dynamics) fn at_rest(
        rest: &Rest,
        last: RestMemory,
        (shoe, chain): (usize, usize),
        start: &Start,
    ) -> (Self, Contact) {
        let layout = start.layout;
        let arm = rest.point - start.state.shoes[shoe].after(start.half).center;
        let center = start.state.mass_pose_after(start.half).0;
        let borne_at = match rest.on {
            Bearing::Chassis(_) => rest.point,
            Bearing::Tooth(axle) => axle,
        };
        let link = Link::new(layout, chain, shoe);
        let rows = [rest.normal, right_of(rest.normal)].map(|unit| {
            let (at, lever) = match rest.on {
                Bearing::Chassis(slides) => (layout.slide(chain), -unit.dot(slides)),
                Bearing::Tooth(axle) => (layout.spin(chain), -cross(rest.point - axle, unit)),
            };
            Row::on_link(link, levers(unit, arm))
                .against_base(levers(unit, borne_at - center))
                .and(at, lever)
        });
        let mut solved = Contact::new(rows);
        solved.grip = last.grip;
        let touch = Self {
            on: On::Guide { chain, shoe },
            normal: rest.normal,
            normal_guess: last.force,
            rest_index: rest.index,
            gap: rest.gap - rows[0].along(start.unknowns) * start.half,
            ..Self::default()
        };
        (touch, solved)
    }
}

/// The levers of a body for a direction at a point, at `arm` [m] from its centre.
fn levers(unit: Vector, arm: Vector) -> [f64; 3] {
    [unit.x, unit.y, cross(arm, unit)]
}
