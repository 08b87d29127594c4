//! Contacts of the convex hull of discs with a profile, a belt's or a polygon's: exact, and as good
//! when the ground reaches deep inside.
//!
//! A hull meets a polyline in two ways only: an arc, or a corner, bears on a face, or a vertex on the
//! hull.

use std::f64::consts::TAU;

use rapier2d_f64::math::{Pose, Vector};

use super::Contact;
use crate::outline::{Disc, Envelope};
use crate::plane::{cross, left_of};
use crate::robot::{Part, Shape};
use crate::terrain::Profile;

/// Sine of the angle by which rounding may turn a normal out of the cone of a vertex.
const ROUNDING: f64 = 1e-9;

/// [m] Ground that is deeper inside did not get there by sinking in.
const SHALLOW: f64 = 1e-3;

/// A part that is the hull of discs, or of points.
pub(super) struct HullContact {
    part: usize,
    hull: Envelope,
    arcs: Vec<Arc>,
}

/// An arc of the hull, or a corner.
struct Arc {
    disc: Disc,
    /// [rad] Outward direction where it begins.
    from: f64,
    /// [rad] How far it turns from there, clockwise.
    sweep: f64,
}

impl Arc {
    /// Whether its outward directions hold `outward`, or nearly: on a face that is all but parallel to
    /// a run both ends of the run bear.
    fn faces(&self, outward: Vector) -> bool {
        /// [rad] An arc reaches less than 0.1 mm out of the hull where it goes on by this.
        const NEARLY: f64 = 0.05;

        let turn = self.from - libm::atan2(outward.y, outward.x) + NEARLY;
        turn.rem_euclid(TAU) <= self.sweep + 2.0 * NEARLY
    }
}

impl HullContact {
    /// That of a part, if it is such a hull.
    pub(super) fn of(index: usize, part: &Part) -> Option<Self> {
        let discs = match &part.shape {
            Shape::Hull { discs } => discs.clone(),
            Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
            Shape::Disc { .. } | Shape::Gear { .. } => return None,
        };
        let hull = Envelope::new(&discs);
        Some(Self {
            part: index,
            arcs: hull
                .arcs()
                .into_iter()
                .map(|(disc, from, sweep)| Arc { disc, from, sweep })
                .collect(),
            hull,
        })
    }

    /// Adds every contact with a gap below `prediction`.
    pub(super) fn find(
        &self,
        profile: &Profile,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for arc in &self.arcs {
            let center = pose.transform_point(arc.disc.center);
            let reach = arc.disc.radius + prediction;
            low = low.min(center.x - reach);
            high = high.max(center.x + reach);
            for facet in profile.facets(center.x - reach, center.x + reach) {
                let contact = self.on_face(profile, facet, center, arc.disc.radius, prediction);
                let faces = |c: &Contact| arc.faces(pose.rotation.inverse() * -c.normal);
                contacts.extend(contact.filter(faces));
            }
        }
        let facets = profile.facets(low, high);
        for vertex in facets.start.max(1)..(facets.end + 1).min(profile.points.len() - 1) {
            contacts.extend(self.on_vertex(profile, vertex, pose, prediction));
        }
    }

    /// An arc on a face, its centre outside, or a corner on it.
    fn on_face(
        &self,
        profile: &Profile,
        facet: usize,
        center: Vector,
        radius: f64,
        prediction: f64,
    ) -> Option<Contact> {
        let (a, b) = (profile.points[facet], profile.points[facet + 1]);
        let length = (b - a).length();
        let along = (b - a) / length;
        let normal = left_of(along);
        let spoke = center - a;
        let (height, foot) = (spoke.dot(normal), spoke.dot(along));
        let distance = height - radius;
        if height <= -SHALLOW || distance >= prediction || !(0.0..=length).contains(&foot) {
            return None;
        }
        let on_ground = a + along * foot;
        Some(Contact {
            part: self.part,
            facet,
            edge: profile.edge_at(facet, on_ground),
            point: on_ground + normal * (0.5 * distance),
            normal,
            distance,
        })
    }

    /// A vertex on the hull; where the hull's normal lies outside the vertex's cone, a face is nearer.
    fn on_vertex(
        &self,
        profile: &Profile,
        vertex: usize,
        pose: Pose,
        prediction: f64,
    ) -> Option<Contact> {
        let point = profile.points[vertex];
        let place = pose.inverse_transform_point(point);
        let depth = self.hull.depth(place);
        if -depth >= prediction {
            return None;
        }
        let normal = -(pose.rotation * self.hull.outward_at(place));
        let before = (point - profile.points[vertex - 1]).normalize();
        let behind = (profile.points[vertex + 1] - point).normalize();
        let in_cone = || {
            cross(normal, left_of(before)) >= -ROUNDING
                && cross(left_of(behind), normal) >= -ROUNDING
                && normal.dot(left_of(before) + left_of(behind)) > 0.0
        };
        // Deep inside, every vertex that stands out bears on the hull by itself.
        let stands_out = depth > SHALLOW && cross(before, behind) < 0.0;
        (stands_out || in_cone()).then(|| Contact {
            part: self.part,
            facet: vertex,
            edge: profile.edge_of_point[vertex],
            point,
            normal,
            distance: -depth,
        })
    }
}
