//! Contacts of the convex hull of discs with a lane, a belt's or a polygon's: exact, and as good when
//! the ground reaches deep inside.
//!
//! A hull meets the ground in two ways only: an arc, or a corner, bears on a face, or a corner of the
//! ground on the hull.

use std::f64::consts::TAU;

use rapier2d_f64::math::{Pose, Vector};

use super::Contact;
use super::lane::{Corner, Lane, On, Region};
use crate::outline::{Disc, Envelope};
use crate::robot::{Part, Shape};

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
    /// That of a part of discs or points.
    pub(super) fn new(index: usize, part: &Part) -> Self {
        let discs: Vec<Disc> = match &part.shape {
            Shape::Polygon { corners } => corners.iter().map(|c| Disc::point(*c)).collect(),
            _ => part.discs().map(|(tip, _)| tip).collect(),
        };
        let hull = Envelope::new(&discs);
        Self {
            part: index,
            arcs: hull
                .arcs()
                .into_iter()
                .map(|(disc, from, sweep)| Arc { disc, from, sweep })
                .collect(),
            hull,
        }
    }

    /// Adds every contact with a gap below `prediction`.
    pub(super) fn find(
        &self,
        lane: &Lane,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let center = |arc: &Arc| pose.transform_point(arc.disc.center);
        let (mut low, mut high) = (Vector::INFINITY, Vector::NEG_INFINITY);
        for arc in &self.arcs {
            let reach = Vector::splat(arc.disc.radius + prediction);
            low = low.min(center(arc) - reach);
            high = high.max(center(arc) + reach);
        }
        let region = lane.region(low.x, high.x);
        if lane.top(&region) < low.y {
            return;
        }
        for arc in &self.arcs {
            let reach = (prediction, SHALLOW);
            lane.touches_of_disc(center(arc), arc.disc.radius, reach, |touch| {
                let on_face = matches!(touch.on, On::Face(_));
                if on_face && arc.faces(pose.rotation.inverse() * -touch.normal) {
                    contacts.push(touch.contact(self.part));
                }
            });
        }
        self.find_corners(lane, &region, pose, prediction, contacts);
    }

    /// Corners of the ground on the hull; where the hull's normal lies outside the corner's cone, a
    /// face is nearer.
    fn find_corners(
        &self,
        lane: &Lane,
        region: &Region,
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        for i in region.corners() {
            let corner: &Corner = lane.corner(i);
            if !corner.stands_out {
                continue;
            }
            let place = pose.inverse_transform_point(corner.center);
            let depth = self.hull.depth(place) + corner.radius;
            if -depth >= prediction {
                continue;
            }
            let normal = -(pose.rotation * self.hull.outward_at(place));
            // Deep inside, every corner bears on the hull by itself.
            if depth > SHALLOW || corner.faces(normal) {
                contacts.push(corner.touch(i, normal, -depth).contact(self.part));
            }
        }
    }
}
