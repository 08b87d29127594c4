//! The reference contact: the engine's broad and narrow phase on one oriented polyline a lane.
//!
//! One-sided segments and exact vertex normals make flat ground flat however it is cut. Nothing is
//! kept from step to step but the engine's own tracking, so a contact is always of this pose.

use rapier2d_f64::math::{Pose, Rotation, Vector};
use rapier2d_f64::prelude::{
    BroadPhaseBvh, ColliderBuilder, ColliderHandle, ColliderSet, CollisionPipeline, Group,
    InteractionGroups, InteractionTestMode, IslandManager, NarrowPhase, RigidBodyBuilder,
    RigidBodyHandle, RigidBodySet, SharedShape,
};

use super::{Contact, without_redundant};
use crate::robot::{Part, Shape};
use crate::terrain::Profile;

/// [m] A contact this close to a vertex touches the edge, not the face beside it.
const AT_VERTEX: f64 = 1e-7;
/// [rad] Turn of one facet of the larger end of a tapering belt: its chord lies below 1 um deep.
const FACET_TURN: f64 = 0.01;

/// The engine's collision world of one run.
pub(crate) struct ReferenceContact {
    bodies: RigidBodySet,
    colliders: ColliderSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    pipeline: CollisionPipeline,
    chassis: RigidBodyHandle,
    ground: ColliderHandle,
    profile: Profile,
}

impl ReferenceContact {
    /// The world of a robot's parts above a profile.
    pub(crate) fn new(parts: &[Part], profile: &Profile) -> Self {
        let (of_robot, of_ground) = (Group::GROUP_1, Group::GROUP_2);
        let mut bodies = RigidBodySet::new();
        let mut colliders = ColliderSet::new();
        let chassis = bodies.insert(RigidBodyBuilder::dynamic().can_sleep(false));
        for (i, part) in parts.iter().enumerate() {
            let (shape, position) = engine_shape(&part.shape);
            let collider = ColliderBuilder::new(shape)
                .position(position)
                .density(0.0)
                .user_data(i as u128)
                .collision_groups(InteractionGroups::new(
                    of_robot,
                    of_ground,
                    InteractionTestMode::And,
                ));
            colliders.insert_with_parent(collider, chassis, &mut bodies);
        }
        // Outside lies on the right of each segment, so the ground runs from +x to -x.
        let vertices: Vec<Vector> = profile.points.iter().rev().copied().collect();
        let ground = colliders.insert(
            ColliderBuilder::oriented_polyline(vertices, None).collision_groups(
                InteractionGroups::new(of_ground, of_robot, InteractionTestMode::And),
            ),
        );
        Self {
            bodies,
            colliders,
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            pipeline: CollisionPipeline::new(),
            chassis,
            ground,
            profile: profile.clone(),
        }
    }

    /// Writes every contact with a gap below `prediction` into `contacts`.
    pub(crate) fn find(&mut self, pose: Pose, prediction: f64, contacts: &mut Vec<Contact>) {
        self.bodies[self.chassis].set_position(pose, false);
        self.pipeline.step(
            prediction,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &(),
            &(),
        );
        contacts.clear();
        for pair in self.narrow_phase.contact_pairs() {
            let ground_first = pair.collider1 == self.ground;
            let (part, sign) = if ground_first {
                (pair.collider2, 1.0)
            } else {
                (pair.collider1, -1.0)
            };
            let part = self.colliders[part].user_data as usize;
            let (pose1, pose2) = (
                self.colliders[pair.collider1].position(),
                self.colliders[pair.collider2].position(),
            );
            for manifold in pair.manifolds() {
                let subshape = if ground_first {
                    manifold.subshape1
                } else {
                    manifold.subshape2
                };
                let facet = self.profile.points.len() - 2 - subshape as usize;
                let pose1 = manifold
                    .subshape_pos1()
                    .map_or(*pose1, |inner| *pose1 * *inner);
                let pose2 = manifold
                    .subshape_pos2()
                    .map_or(*pose2, |inner| *pose2 * *inner);
                let normal = pose1.transform_vector(manifold.local_n1) * sign;
                for point in &manifold.points {
                    let (p1, p2) = (
                        pose1.transform_point(point.local_p1),
                        pose2.transform_point(point.local_p2),
                    );
                    if point.dist < prediction {
                        contacts.push(Contact {
                            part,
                            facet,
                            edge: self.edge_at(facet, if ground_first { p1 } else { p2 }),
                            point: 0.5 * (p1 + p2),
                            normal,
                            distance: point.dist,
                        });
                    }
                }
            }
        }
        without_redundant(contacts);
    }

    fn edge_at(&self, facet: usize, point: Vector) -> i32 {
        let (points, edges) = (&self.profile.points, &self.profile.edge_of_point);
        let (left, right) = (edges[facet], edges[facet + 1]);
        let on_arc = left == right && left >= 0;
        if on_arc || (point - points[facet]).length() < AT_VERTEX {
            left
        } else if (point - points[facet + 1]).length() < AT_VERTEX {
            right
        } else {
            -1
        }
    }
}

/// The engine's shape and its place in the chassis frame.
fn engine_shape(shape: &Shape) -> (SharedShape, Pose) {
    match shape {
        Shape::Disc { center, radius } => {
            (SharedShape::ball(*radius), Pose::from_translation(*center))
        }
        Shape::Hull {
            rear,
            rear_radius,
            front,
            front_radius,
        } => (
            hull(*rear, *rear_radius, *front, *front_radius),
            Pose::identity(),
        ),
        Shape::Polygon { corners } => {
            let polygon = SharedShape::convex_polyline(corners.clone());
            (
                polygon.expect("the scenario holds a convex polygon"),
                Pose::identity(),
            )
        }
    }
}

/// The hull of two discs is the hull of a disc and a point, grown by the smaller radius all round.
fn hull(rear: Vector, rear_radius: f64, front: Vector, front_radius: f64) -> SharedShape {
    let border = rear_radius.min(front_radius);
    let extra = (rear_radius - front_radius).abs();
    if extra == 0.0 {
        return SharedShape::capsule(rear, front, border);
    }
    let (big, small) = if rear_radius > front_radius {
        (rear, front)
    } else {
        (front, rear)
    };
    let facets = (std::f64::consts::TAU / FACET_TURN).ceil() as usize;
    let mut points: Vec<Vector> = (0..facets)
        .map(|i| {
            big + Rotation::new(std::f64::consts::TAU * i as f64 / facets as f64)
                * Vector::X
                * extra
        })
        .collect();
    points.push(small);
    SharedShape::round_convex_hull(&points, border)
        .expect("a disc and a point outside it span a hull")
}
