//! The reference contact method: parry's queries on one oriented polyline per lane, and our own for hulls.
//!
//! One-sided segments and exact vertex normals make flat ground flat, however it is divided. Nothing is
//! stored between steps, so contacts depend only on the current pose.
//!
//! The equations: docs/physics.md, "Contacts".

use rapier2d_f64::parry::query::{
    ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher,
};
use rapier2d_f64::parry::shape::{Polyline, PolylineFlags};
use rapier2d_f64::prelude::SharedShape;

use super::Contact;
use super::hull::HullContact;
use super::lane::Lane;
use super::redundant::without_redundant;
use crate::geometry::{Gear, Pose, Vector};
use crate::robot::{Part, Running, Shape};
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
    /// The same lane for hulls.
    lane: Lane,
}

/// A part as convex pieces.
struct Body {
    part: Part,
    /// [m] A disc that contains it, in its own frame.
    bound: (Vector, f64),
    /// Our own contact method, for parts that are neither discs nor gears.
    hull: Option<HullContact>,
    /// Its shapes in its own frame.
    solids: Vec<SharedShape>,
}

impl Ground {
    fn new(profile: &Profile) -> Self {
        // Outside is on the right of each segment, so the ground runs from +x to -x.
        let vertices: Vec<Vector> = profile.points.iter().rev().copied().collect();
        Self {
            line: Polyline::with_flags(vertices, None, PolylineFlags::ORIENTED),
            profile: profile.clone(),
            lane: Lane::new(profile),
        }
    }
}

impl ReferenceContact {
    /// Prepares the shapes of a robot's parts and the lanes under them.
    pub(crate) fn new(parts: &[Part], lanes: &[Profile]) -> Self {
        Self {
            bodies: parts
                .iter()
                .enumerate()
                .map(|(i, part)| Body {
                    part: part.clone(),
                    bound: part.bound(),
                    hull: match part.shape {
                        Shape::Disc { .. } | Shape::Gear { .. } => None,
                        _ => Some(HullContact::new(i, part)),
                    },
                    solids: solids_of(part),
                })
                .collect(),
            lanes: lanes.iter().map(Ground::new).collect(),
            manifolds: Vec::new(),
        }
    }

    /// Adds every contact with a gap below `prediction` to `contacts`.
    pub(crate) fn find(
        &mut self,
        pose: Pose,
        running: &Running,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        for i in 0..self.bodies.len() {
            let Body { part, bound, .. } = &self.bodies[i];
            let place = running.mounted(part.mount, pose) * part.place(running);
            let (center, radius) = (place.transform_point(bound.0), bound.1);
            let ground = &self.lanes[part.lane];
            if ground.profile.is_clear_of(center, radius + prediction) {
                continue;
            }
            if let Some(hull) = &self.bodies[i].hull {
                hull.find(&ground.lane, place, prediction, contacts);
            }
            for k in 0..self.bodies[i].solids.len() {
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
        let (part, shape) = (&self.bodies[body].part, &self.bodies[body].solids[solid]);
        let Ground { line, profile, .. } = &self.lanes[part.lane];
        // parry would reuse a stored manifold until the pose changes by a degree.
        self.manifolds.clear();
        DefaultQueryDispatcher
            .contact_manifolds(
                &pose,
                line,
                &**shape,
                prediction,
                &mut self.manifolds,
                &mut None,
            )
            .unwrap_or_else(|e| unreachable!("polylines meet every convex shape: {e}"));
        for manifold in &self.manifolds {
            let facet = profile.points.len() - 2 - manifold.subshape1 as usize;
            for point in manifold.points.iter().filter(|p| p.dist < prediction) {
                let on_solid = pose.transform_point(point.local_p2);
                let middle = 0.5 * (point.local_p1 + on_solid);
                let edge = profile.edge_at(facet, point.local_p1);
                let place = (middle, manifold.local_n1);
                contacts.push(Contact::new(body, (facet, edge), place, point.dist));
            }
        }
    }
}

/// [m] Smallest thickness of grousers for the engine, which rejects polygons as thin as a rounding error.
const THINNEST: f64 = 1e-9;

/// The convex pieces of a part in its own frame; hulls use our own contacts and have none.
pub(crate) fn solids_of(part: &Part) -> Vec<SharedShape> {
    match &part.shape {
        Shape::Disc { radius, .. } => vec![SharedShape::ball(*radius)],
        Shape::Gear { gear, .. } => {
            let gear = Gear {
                tip_thickness: gear.tip_thickness.max(THINNEST),
                base_thickness: gear.base_thickness.max(THINNEST),
                ..*gear
            };
            let root = SharedShape::ball(gear.root_radius);
            let grousers = gear
                .directions()
                .filter_map(|d| polygon(gear.corners(d).to_vec()));
            std::iter::once(root).chain(grousers).collect()
        }
        Shape::Hull { .. } | Shape::Grouser(_) | Shape::Polygon { .. } => Vec::new(),
    }
}

/// A polygon with exactly these corners, however flat; `None` if it is as thin as a rounding error.
fn polygon(mut corners: Vec<Vector>) -> Option<SharedShape> {
    corners.dedup();
    SharedShape::convex_polyline_unmodified(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::finder::OwnContact;
    use crate::contact::penetration::depth;
    use crate::draw::Draw;
    use crate::robot::{BodyKind, Model, Mount};
    use crate::scenario::{Surface, shared};

    /// The nearest contact: its distance [m], position and edge.
    fn nearest(contacts: &[Contact]) -> Option<(f64, Vector, i32)> {
        let least = contacts
            .iter()
            .min_by(|a, b| a.distance.total_cmp(&b.distance));
        least.map(|contact| (contact.distance, contact.point, contact.edge))
    }

    #[test]
    fn both_methods_find_the_same_nearest_place_of_a_robot_above_the_ground() {
        const PREDICTION: f64 = 0.03;
        let scenarios = [
            "engineer_gear3_step",
            "engineer_force_step",
            "engineer_belt_step",
        ];
        let points = [
            [-2.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.1],
            [0.3, 0.15],
            [0.5, -0.1],
            [2.0, -0.1],
        ];
        let lane = Profile::new("terrain", &points, Surface::sharp(0.9), true).expect("a profile");
        let mut draw = Draw(7);
        for name in scenarios {
            let scenario = shared(name);
            let model = Model::new(&scenario.robot).expect("the robot can be built");
            let lanes = std::slice::from_ref(&lane);
            let own = OwnContact::new(&model.parts, lanes);
            let mut reference = ReferenceContact::new(&model.parts, lanes);
            let (mut by_own, mut by_reference) = (Vec::new(), Vec::new());
            let (mut compared, mut none) = (0, 0);
            while compared < 100 || none < 20 {
                let place = Vector::new(draw.between(-0.5, 1.0), draw.between(0.0, 0.3));
                let pose = Pose::new(place, draw.between(-0.5, 0.5));
                let mut running = Running::default();
                let drives = vec![draw.between(0.0, 1.0); model.drives];
                model.set_running(
                    &mut running,
                    drives.into_iter(),
                    [].into_iter(),
                    [].into_iter(),
                );
                let is_in_ground = |part: &Part| {
                    let place = running.mounted(part.mount, pose) * part.place(&running);
                    depth(part, place, &lane) > 0.0
                };
                if model.parts.iter().any(is_in_ground) {
                    continue;
                }
                own.find(pose, &running, PREDICTION, &mut by_own);
                reference.find(pose, &running, PREDICTION, &mut by_reference);
                match (nearest(&by_own), nearest(&by_reference)) {
                    (None, None) => none += 1,
                    (Some((a, at, edge)), Some((b, there, other))) => {
                        assert!((a - b).abs() < 1e-9, "{a} {b} at {at} {there}");
                        assert!(
                            (at - there).length() < 1e-6 && edge == other,
                            "{at} {there}"
                        );
                        compared += 1;
                    }
                    (one, other) => panic!("{one:?} {other:?}"),
                }
            }
        }
    }

    /// The engine refuses polygons without an area.
    #[test]
    fn grousers_without_a_thickness_are_a_nanometre_thick_from_root_to_tip() {
        let gear = Gear {
            radius: 0.06,
            root_radius: 0.05,
            grousers: 6,
            tip_thickness: 0.0,
            base_thickness: 0.0,
            phase: 0.1,
        };
        let part = Part {
            kind: BodyKind::Wheel,
            shape: Shape::Gear {
                center: Vector::ZERO,
                gear,
            },
            drive: Some(0),
            friction_limit: f64::INFINITY,
            lane: 0,
            mount: Mount::Chassis,
        };
        let solids = solids_of(&part);
        assert_eq!(solids.len(), 1 + 6);
        for grouser in &solids[1..] {
            let polygon = grouser.as_convex_polygon().expect("it is one");
            let mut corners = polygon.points().to_vec();
            corners.sort_by(|a, b| a.length().total_cmp(&b.length()));
            assert_eq!(corners.len(), 4);
            for (pair, radius) in corners.chunks(2).zip([0.05, 0.06]) {
                // Coordinates of some centimetres are rounded to 1e-17 m.
                let thickness = (pair[1] - pair[0]).length();
                assert!((thickness - THINNEST).abs() < 1e-15, "{thickness} m");
                assert!((pair[0].length() - radius).abs() < 1e-15);
            }
        }
    }
}
