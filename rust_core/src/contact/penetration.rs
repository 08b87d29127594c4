//! Depths of parts in the ground: from outlines alone, even where no contact was found, and in dents, which the ground
//! made when one track replaced another.
//!
//! The equations: docs/physics.md, "Softness", and of dents: docs/physics.md, "Contacts".

use std::collections::HashSet;

use rapier2d_f64::parry::query::PointQuery;
use rapier2d_f64::parry::shape::Segment;
use serde::{Deserialize, Serialize};

use super::Contact;
use crate::geometry::{Disc, Pose, Vector, plausible};
use crate::robot::{Part, Shape};
use crate::terrain::Profile;
use crate::units::Metres;

/// [m] Largest depth of a part at a place in a lane; 0 above it and at the ends of the ground, which have no faces:
/// what hangs over them may fall beside the ground.
pub(crate) fn depth(part: &Part, place: Pose, lane: &Profile) -> f64 {
    let (middle, bound) = part.bound();
    let center = place.transform_point(middle);
    let (low, high) = lane.extent();
    let hangs_over = center.x - bound < low || center.x + bound > high;
    if hangs_over || lane.is_clear_of(center, bound) {
        return 0.0;
    }
    let arcs_and_corners = arcs_and_corners(part).into_iter();
    let depth = |d: Disc| depth_of_disc(place.transform_point(d.center), d.radius, lane);
    arcs_and_corners.map(depth).fold(0.0, f64::max)
}

/// Arcs and corners of a part in its own frame.
fn arcs_and_corners(part: &Part) -> Vec<Disc> {
    match &part.shape {
        Shape::Disc { radius, .. } => vec![Disc {
            center: Vector::ZERO,
            radius: *radius,
        }],
        Shape::Gear { gear, .. } => {
            let root = Disc {
                center: Vector::ZERO,
                radius: gear.root_radius,
            };
            let corners = gear.directions().flat_map(|d| gear.corners(d));
            std::iter::once(root)
                .chain(corners.map(Disc::point))
                .collect()
        }
        Shape::Hull { .. } => part.discs().map(|(_, root)| root).collect(),
        Shape::Grouser(grouser) => grouser.corners().map(Disc::point).to_vec(),
        Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
    }
}

/// [m] Distance that a disc must move to be out of the ground; a corner is a disc of radius 0.
fn depth_of_disc(center: Vector, radius: f64, lane: &Profile) -> f64 {
    let below = lane.height_under_disc(center.x, 0.0) - center.y;
    let is_inside = below > 0.0;
    // Inside, the surface is no farther than its point right above.
    let far = if is_inside { below } else { radius };
    let distance = |facet: usize| {
        let face = Segment::new(lane.points[facet], lane.points[facet + 1]);
        (face.project_local_point(center, true).point - center).length()
    };
    let facets = lane.facets(center.x - far, center.x + far);
    let nearest = facets.map(distance).fold(far, f64::min);
    if is_inside {
        radius + nearest
    } else {
        radius - nearest
    }
}

/// [m] Ground that begins to bear this close to a dent was inside it.
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

    /// Whether these dents can remain after a step that ended with these contacts.
    pub(crate) fn fits(&self, contacts: &[Contact]) -> bool {
        let numbers: HashSet<u64> = contacts.iter().map(|c| c.number).collect();
        let fits = |d: &Dent| plausible(&[d.depth]) && numbers.contains(&d.contact);
        self.dents.iter().all(fits)
    }

    /// Measures gaps from the bottom of the dents; `last` holds the contacts of the last step.
    ///
    /// If ground in a dent begins to bear on another face of the part, that face gets an equally deep dent.
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

    /// Reduces the dents by the actual motion of the robot; the contacts are those after a step.
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
    use crate::robot::{BodyKind, Mount};
    use crate::scenario::Surface;

    #[test]
    fn a_disc_is_as_deep_as_the_shortest_way_out() {
        let step = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
        let lane = Profile::new("terrain", &step, Surface::sharp(0.9), true).expect("a profile");
        for (x, y, radius, depth) in [
            (-0.5, 0.06, 0.05, -0.01),
            (-0.5, 0.03, 0.05, 0.02),
            (-0.04, 0.06, 0.05, 0.01),
            (0.5, 0.09, 0.0, 0.01),
            (0.02, 0.03, 0.0, 0.02),
            (0.02, 0.03, 0.05, 0.07),
            (0.5, 0.11, 0.0, 0.0),
        ] {
            let found = depth_of_disc(Vector::new(x, y), radius, &lane);
            assert!(
                (found - f64::max(depth, 0.0)).abs() < 1e-12,
                "{x} {y} {radius}: {found}"
            );
        }
    }

    #[test]
    fn what_hangs_over_an_end_of_the_ground_is_not_in_it() {
        let flat = [[-1.0, 0.0], [1.0, 0.0]];
        let lane = Profile::new("terrain", &flat, Surface::sharp(0.9), true).expect("a profile");
        let wheel = |radius: f64| Part {
            kind: BodyKind::Wheel,
            shape: Shape::Disc {
                center: Vector::ZERO,
                radius,
            },
            drive: Some(0),
            friction_limit: f64::INFINITY,
            lane: 0,
            mount: Mount::Chassis,
        };
        let at = |x: f64| depth(&wheel(0.1), Pose::new(Vector::new(x, 0.08), 0.0), &lane);
        for x in [-0.89, 0.0, 0.89] {
            assert!((at(x) - 0.02).abs() < 1e-12);
        }
        for x in [-0.91, 0.91, -1.5, 1.5] {
            assert_eq!(at(x), 0.0);
        }
        // In numbers without rounding: a wheel that ends where the ground ends does not hang over.
        let flush = |x: f64| depth(&wheel(0.25), Pose::new(Vector::new(x, 0.125), 0.0), &lane);
        assert_eq!([-0.75, 0.75].map(flush), [0.125; 2]);
    }

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
            // Its dent is then as deep as the ground was inside it. In micrometres:
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

    #[test]
    fn ground_beside_a_dent_is_forgiven_wherever_the_dent_is() {
        for place in [-3.0, 0.5, 2.0] {
            for (apart, forgiven) in [(0.009, 0.01), (-0.009, 0.01), (0.011, -0.03)] {
                let last = [contact(1, place, -0.04)];
                let mut dents = Dents::of(&last);
                let mut contacts = [last[0], contact(2, place + apart, -0.03)];
                dents.forgive(&mut contacts, &last);
                let off = contacts[1].distance - forgiven;
                assert!(off.abs() < 1e-15, "{apart} m from one at {place} m");
            }
        }
    }
}
