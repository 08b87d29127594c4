//! The reference contact: parry's own queries on one oriented polyline a lane, and our own of hulls.
//!
//! One-sided segments and exact vertex normals make flat ground flat however it is cut. Nothing is
//! kept from step to step, so a contact is always of this pose.

use rapier2d_f64::math::{Pose, Rotation, Vector};
use rapier2d_f64::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
};
use rapier2d_f64::parry::shape::{Polyline, PolylineFlags};
use rapier2d_f64::prelude::SharedShape;

use super::hull::HullContact;
use super::lane::Lane;
use super::{Contact, without_redundant};
use crate::robot::{Part, Shape, TurningWheel};
use crate::terrain::Profile;

/// Shapes of one robot and one ground.
pub(crate) struct ReferenceContact {
    bodies: Vec<Body>,
    lanes: Vec<Ground>,
    manifolds: Vec<ContactManifold<(), ()>>,
}

/// A lane.
struct Ground {
    line: Polyline,
    profile: Profile,
    /// For the hulls.
    lane: Lane,
}

/// A part as convex pieces.
struct Body {
    part: usize,
    lane: usize,
    /// [m] A disc round it, in the chassis frame.
    bound: (Vector, f64),
    /// Round parts that are more than a disc.
    hull: Option<HullContact>,
    solids: Vec<Solid>,
}

/// One convex piece.
struct Solid {
    shape: SharedShape,
    /// Place in the frame of the wheel that it turns with, or of the chassis.
    place: Pose,
    wheel: Option<TurningWheel>,
}

impl Solid {
    /// Place in the chassis frame when the drives have run so far [m].
    fn at(&self, drives: &[f64]) -> Pose {
        self.wheel.map_or(self.place, |wheel| {
            let turned = Rotation::new(-drives[wheel.drive] / wheel.radius);
            Pose::from_parts(wheel.center, turned) * self.place
        })
    }
}

impl Ground {
    fn new(profile: &Profile) -> Self {
        // Outside lies on the right of each segment, so the ground runs from +x to -x.
        let vertices: Vec<Vector> = profile.points.iter().rev().copied().collect();
        Self {
            line: Polyline::with_flags(vertices, None, PolylineFlags::ORIENTED),
            profile: profile.clone(),
            lane: Lane::new(profile),
        }
    }
}

impl ReferenceContact {
    /// The shapes of a robot's parts and of the lanes that they meet.
    pub(crate) fn new(parts: &[Part], lanes: &[Profile]) -> Self {
        Self {
            bodies: parts
                .iter()
                .enumerate()
                .map(|(i, part)| Body {
                    part: i,
                    lane: part.lane,
                    bound: part.bound(),
                    hull: matches!(part.shape, Shape::Hull { .. } | Shape::Polygon { .. })
                        .then(|| HullContact::new(i, part)),
                    solids: solids_of(part),
                })
                .collect(),
            lanes: lanes.iter().map(Ground::new).collect(),
            manifolds: Vec::new(),
        }
    }

    /// Writes every contact with a gap below `prediction` into `contacts`.
    ///
    /// `drives` holds how far the surface of each drive has run [m].
    pub(crate) fn find(
        &mut self,
        pose: Pose,
        drives: &[f64],
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        for i in 0..self.bodies.len() {
            let (center, radius) = self.bodies[i].bound;
            let center = pose.transform_point(center);
            let ground = &self.lanes[self.bodies[i].lane];
            if ground.profile.is_clear_of(center, radius + prediction) {
                continue;
            }
            if let Some(hull) = &self.bodies[i].hull {
                hull.find(&ground.lane, pose, prediction, contacts);
            }
            for k in 0..self.bodies[i].solids.len() {
                let place = pose * self.bodies[i].solids[k].at(drives);
                self.find_solid((i, k), place, prediction, contacts);
            }
        }
        without_redundant(contacts);
    }

    fn find_solid(
        &mut self,
        (body, solid): (usize, usize),
        pose: Pose,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        let Body { part, lane, .. } = self.bodies[body];
        let Ground { line, profile, .. } = &self.lanes[lane];
        let solid = &self.bodies[body].solids[solid];
        // A manifold that was kept would be reused until the pose changes by a degree.
        self.manifolds.clear();
        DefaultQueryDispatcher
            .contact_manifolds(
                &pose,
                line,
                &*solid.shape,
                prediction,
                &mut self.manifolds,
                &mut None,
            )
            .unwrap_or_else(|e| unreachable!("polylines meet every convex shape: {e}"));
        for manifold in &self.manifolds {
            let facet = profile.points.len() - 2 - manifold.subshape1 as usize;
            for point in manifold.points.iter().filter(|p| p.dist < prediction) {
                let on_solid = pose.transform_point(point.local_p2);
                contacts.push(Contact {
                    part,
                    facet,
                    edge: profile.edge_at(facet, point.local_p1),
                    point: 0.5 * (point.local_p1 + on_solid),
                    normal: manifold.local_n1,
                    distance: point.dist,
                });
            }
        }
    }
}

/// The convex pieces of a part.
fn solids_of(part: &Part) -> Vec<Solid> {
    let solid = |shape, place, wheel| Solid {
        shape,
        place,
        wheel,
    };
    let on_chassis = |shape, place| vec![solid(shape, place, None)];
    match &part.shape {
        Shape::Disc { center, radius } => {
            on_chassis(SharedShape::ball(*radius), Pose::from_translation(*center))
        }
        Shape::Gear { center, gear } => {
            let place = Pose::from_translation(*center);
            let root = solid(SharedShape::ball(gear.root_radius), place, None);
            let wheel = part.turning();
            let grousers = gear.directions().map(|direction| {
                let corners = gear.corners(direction).to_vec();
                solid(polygon(corners), Pose::identity(), wheel)
            });
            std::iter::once(root).chain(grousers).collect()
        }
        // Their contacts are our own: see `HullContact`.
        Shape::Hull { .. } | Shape::Polygon { .. } => Vec::new(),
    }
}

fn polygon(corners: Vec<Vector>) -> SharedShape {
    SharedShape::convex_polyline(corners).expect("the corners are those of a convex polygon")
}
