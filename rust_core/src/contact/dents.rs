//! Dents: ground that was inside a part when one track replaced another is let out without a push.
//!
//! The part counts as dented there: the initial overlap is not a penetration. A dent cannot grow, and it
//! heals as the robot's own motion lets the ground out, so it never adds energy.
//!
//! The equations: docs/physics.md, "Contacts".

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use super::Contact;
use crate::geometry::plausible;
use crate::units::Metres;

/// [m] Ground that comes to bear this close to a dent was inside it.
const BESIDE: Metres = Metres(0.01);

/// The dents that remain.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Dents {
    dents: Vec<Dent>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Dent {
    /// Number of the contact at the dent.
    contact: u64,
    /// [m] Depth of the dent.
    depth: f64,
}

impl Dents {
    /// Dents as deep as the overlap of these contacts.
    pub(crate) fn of(contacts: &[Contact]) -> Self {
        let overlapping = contacts.iter().filter(|c| c.distance < 0.0);
        let dents = overlapping.map(|c| Dent {
            contact: c.number,
            depth: -c.distance,
        });
        Self {
            dents: dents.collect(),
        }
    }

    /// Whether a step that ended with these contacts can have left the dents.
    pub(crate) fn fits(&self, contacts: &[Contact]) -> bool {
        let numbers: HashSet<u64> = contacts.iter().map(|c| c.number).collect();
        let fits = |d: &Dent| plausible(&[d.depth]) && numbers.contains(&d.contact);
        self.dents.iter().all(fits)
    }

    /// Measures gaps from the bottom of the dents; `last` holds the contacts of the last step.
    ///
    /// If ground in a dent also comes to bear on another face of the part, that face is dented as deep.
    pub(crate) fn forgive(&mut self, contacts: &mut [Contact], last: &[Contact]) {
        if self.dents.is_empty() {
            return;
        }
        for contact in contacts {
            let is_new = || last.iter().all(|c| c.number != contact.number);
            let known = self.depth_at(contact);
            if let Some(depth) = known {
                contact.distance += depth;
            } else if is_new()
                && let Some(depth) = self.depth_beside(contact, last)
            {
                contact.distance += depth;
                self.dents.push(Dent {
                    contact: contact.number,
                    depth,
                });
            }
        }
    }

    /// Lets the dents heal by the actual motion of the robot; the contacts are those after a step.
    pub(crate) fn heal(&mut self, contacts: &[Contact]) {
        if self.dents.is_empty() {
            return;
        }
        let left = contacts.iter().filter_map(|contact| {
            let depth = self.depth_at(contact)? - contact.distance.max(0.0);
            (depth > 0.0).then_some(Dent {
                contact: contact.number,
                depth,
            })
        });
        self.dents = left.collect();
    }

    /// [m] Depth of the dent at a contact, if there is one.
    fn depth_at(&self, contact: &Contact) -> Option<f64> {
        let mut dents = self.dents.iter();
        let at = dents.find(|dent| dent.contact == contact.number);
        at.map(|dent| dent.depth)
    }

    /// [m] Depth of the dent nearest to a contact on the same part, if there is one.
    fn depth_beside(&self, contact: &Contact, last: &[Contact]) -> Option<f64> {
        let apart = |c: &Contact| (c.point - contact.point).length();
        let of_part = last
            .iter()
            .filter(|c| c.part == contact.part && apart(c) < BESIDE.value());
        let dented = of_part.filter_map(|c| Some((apart(c), self.depth_at(c)?)));
        let nearest = dented.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, depth)| depth)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // sums of exact lengths

    use super::*;
    use crate::geometry::Vector;

    fn contact(number: u64, x: f64, distance: f64) -> Contact {
        Contact {
            number,
            ..Contact::new(0, (0, 1), (Vector::new(x, 0.0), Vector::Y), distance)
        }
    }

    /// The gap left at a contact that the last step already had.
    fn gap(dents: &mut Dents, x: f64, distance: f64) -> f64 {
        let last = contact(1, x, distance);
        let mut contacts = [last];
        dents.forgive(&mut contacts, &[last]);
        contacts[0].distance
    }

    /// A step that ends at this distance.
    fn step(dents: &mut Dents, x: f64, distance: f64) {
        let contact = contact(1, x, gap(dents, x, distance));
        dents.heal(&[contact]);
    }

    #[test]
    fn a_dent_is_no_penetration_but_may_not_grow() {
        let mut dents = Dents::of(&[contact(1, 0.0, -0.04)]);
        assert!(gap(&mut dents, 0.0, -0.04).abs() < 1e-15);
        step(&mut dents, 0.001, -0.05);
        assert!((gap(&mut dents, 0.001, -0.05) + 0.01).abs() < 1e-15);
    }

    #[test]
    fn a_dent_heals_and_stays_healed() {
        let mut dents = Dents::of(&[contact(1, 0.0, -0.04)]);
        step(&mut dents, 0.0, -0.03);
        assert!((gap(&mut dents, 0.0, -0.04) + 0.01).abs() < 1e-15);
        step(&mut dents, 0.0, 0.001);
        assert!((gap(&mut dents, 0.0, -0.001) + 0.001).abs() < 1e-15);
    }

    #[test]
    fn another_contact_beside_a_dent_has_none_of_it() {
        let mut dents = Dents::of(&[contact(1, 0.0, -0.04)]);
        let last = [contact(1, 0.0, -0.04), contact(2, 0.009, 0.0)];
        let mut contacts = [contact(1, 0.0, -0.04), contact(2, 0.009, -0.02)];
        dents.forgive(&mut contacts, &last);
        assert_eq!(contacts.map(|c| c.distance), [0.0, -0.02]);
    }

    #[test]
    fn ground_in_a_dent_is_forgiven_where_it_comes_to_bear_on_another_face() {
        let gap = |x: f64, part: usize| {
            let mut dents = Dents::of(&[contact(1, 0.0, -0.04)]);
            let last = [contact(1, 0.0, -0.04)];
            let mut closed = contact(2, x, -0.03);
            closed.part = part;
            let mut contacts = [last[0], closed];
            dents.forgive(&mut contacts, &last);
            dents.heal(&contacts);
            // From then on its dent is as deep as the ground was inside it. In micrometres:
            let mut deeper = [contact(2, x, -0.05)];
            dents.forgive(&mut deeper, &contacts);
            [contacts[1].distance, deeper[0].distance].map(|gap| (gap * 1e6).round())
        };
        assert_eq!(gap(0.009, 0), [10_000.0, -20_000.0]);
        assert_eq!(gap(0.011, 0), [-30_000.0, -50_000.0], "that is elsewhere");
        assert_eq!(
            gap(0.009, 1),
            [-30_000.0, -50_000.0],
            "that is another part"
        );
    }
}
