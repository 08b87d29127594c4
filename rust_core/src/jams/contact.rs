//! A surface of the robot on a place of the ground, as a condition for the robot's pose.

use super::layout::{Layout, Outline};
use super::places::{Facing, Place};
use crate::geometry::{Disc, Vector, cross, left_of};

/// Sine of the angle below which two lines are parallel.
pub(super) const PARALLEL: f64 = 1e-9;

/// The pose of the robot's chassis frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Posture {
    /// [m] Its origin.
    pub position: Vector,
    /// [rad] Its angle.
    pub angle: f64,
}

/// A rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cosine: f64,
    sine: f64,
}

impl Turn {
    pub(super) fn by(angle: f64) -> Self {
        let (sine, cosine) = libm::sincos(angle);
        Self { cosine, sine }
    }

    pub(super) fn apply(self, v: Vector) -> Vector {
        Vector::new(
            self.cosine * v.x - self.sine * v.y,
            self.sine * v.x + self.cosine * v.y,
        )
    }
}

/// A surface that touches a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Index of the surface.
    pub surface: usize,
    /// Index of the place.
    pub place: usize,
    pub kind: Kind,
}

/// What touches what.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A disc on a face: this unit vector out of the ground, and the height [m] of its plane over the origin.
    OnFace(Disc, Vector, f64),
    /// A disc on a corner with this centre and radius [m].
    OnCorner(Disc, Vector, f64),
    /// A straight run, with this unit vector out of the robot and this distance [m] from its origin, on a corner with
    /// this centre and radius [m].
    Across(Vector, f64, Vector, f64),
}

/// Positions of the robot's origin at one angle: on a line `normal . p = offset`, or on a circle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Locus {
    Line(Vector, f64),
    Circle(Vector, f64),
}

/// A contact in a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// [m] Distance from the ground, negative inside.
    pub gap: f64,
    /// Unit vector from the ground to the robot, where the gap is 0.
    pub normal: Vector,
    /// [m] The point of the ground.
    pub point: Vector,
}

impl Contact {
    /// Every surface on every place of its lane, except points on points, which have no normal and are limits of
    /// contacts with the runs and faces beside them.
    pub(super) fn all(layout: &Layout, places: &[Place]) -> Vec<Self> {
        let mut contacts = Vec::new();
        for (i, surface) in layout.surfaces.iter().enumerate() {
            for (j, place) in places.iter().enumerate() {
                if place.lane != surface.lane {
                    continue;
                }
                let kind = match (surface.shape, place.shape) {
                    (Outline::Round(disc), Facing::Face { ends, normal }) => {
                        Kind::OnFace(disc, normal, normal.dot(ends[0]))
                    }
                    (Outline::Round(disc), Facing::Corner { center, radius, .. }) => {
                        if disc.radius + radius <= 0.0 {
                            continue;
                        }
                        Kind::OnCorner(disc, center, radius)
                    }
                    (Outline::Flat { ends, outward }, Facing::Corner { center, radius, .. }) => {
                        Kind::Across(outward, outward.dot(ends[0]), center, radius)
                    }
                    // Its ends touch the face.
                    (Outline::Flat { .. }, Facing::Face { .. }) => continue,
                };
                contacts.push(Self {
                    surface: i,
                    place: j,
                    kind,
                });
            }
        }
        contacts
    }

    /// The same, relative to another origin of the ground.
    pub(super) fn seen_from(mut self, origin: Vector) -> Self {
        match &mut self.kind {
            Kind::OnFace(_, normal, height) => *height -= normal.dot(origin),
            Kind::OnCorner(_, center, _) | Kind::Across(_, _, center, _) => *center -= origin,
        }
        self
    }

    /// [m] A point of the ground near it.
    pub(super) fn anchor(&self) -> Vector {
        match self.kind {
            Kind::OnFace(_, normal, height) => normal * height,
            Kind::OnCorner(_, center, _) | Kind::Across(_, _, center, _) => center,
        }
    }

    /// Positions of the robot's origin at an orientation.
    pub(super) fn locus(&self, turn: Turn) -> Locus {
        match self.kind {
            Kind::OnFace(disc, normal, height) => {
                let offset = height + disc.radius - normal.dot(turn.apply(disc.center));
                Locus::Line(normal, offset)
            }
            Kind::OnCorner(disc, center, radius) => {
                Locus::Circle(center - turn.apply(disc.center), radius + disc.radius)
            }
            Kind::Across(outward, distance, center, radius) => {
                let normal = turn.apply(outward);
                Locus::Line(normal, normal.dot(center) - distance - radius)
            }
        }
    }

    /// The touch in a pose.
    pub(super) fn touch(&self, posture: &Posture) -> Touch {
        self.touch_turned(posture.position, Turn::by(posture.angle))
    }

    /// The same for a position [m] and an orientation.
    pub(super) fn touch_turned(&self, position: Vector, turn: Turn) -> Touch {
        match self.kind {
            Kind::OnFace(disc, normal, height) => {
                let center = position + turn.apply(disc.center);
                let above = normal.dot(center) - height;
                Touch {
                    gap: above - disc.radius,
                    normal,
                    point: center - normal * above,
                }
            }
            Kind::OnCorner(disc, corner, radius) => {
                let spoke = position + turn.apply(disc.center) - corner;
                // A unit vector where they touch, and linear in the position everywhere.
                let normal = spoke / (disc.radius + radius);
                Touch {
                    gap: spoke.length() - disc.radius - radius,
                    normal,
                    point: corner + normal * radius,
                }
            }
            Kind::Across(outward, distance, corner, radius) => {
                let normal = -turn.apply(outward);
                Touch {
                    gap: normal.dot(position - corner) - distance - radius,
                    normal,
                    point: corner + normal * radius,
                }
            }
        }
    }

    /// Derivatives of the gap with respect to position and angle; the latter is the moment about the origin of a force
    /// of 1 N along the normal.
    pub(super) fn gradient(touch: &Touch, position: Vector) -> [f64; 3] {
        let moment = cross(touch.point - position, touch.normal);
        [touch.normal.x, touch.normal.y, moment]
    }

    /// Whether the piece of the outline really touches the place in a pose in which the extended line or circle does.
    pub(super) fn is_real(
        &self,
        layout: &Layout,
        places: &[Place],
        posture: &Posture,
        tolerance: f64,
    ) -> bool {
        let touch = self.touch(posture);
        let facing = &places[self.place].shape;
        if !facing.is_touched(touch.point, touch.normal, tolerance) {
            return false;
        }
        match layout.surfaces[self.surface].shape {
            Outline::Round(_) => true,
            Outline::Flat { ends, .. } => {
                let turn = Turn::by(posture.angle);
                let [from, to] = ends.map(|end| posture.position + turn.apply(end));
                let along = (to - from).normalize_or(Vector::X);
                let here = (touch.point - from).dot(along);
                here >= -tolerance && here <= (to - from).length() + tolerance
            }
        }
    }

    /// Whether both keep the origin on lines that are parallel at every angle.
    pub(super) fn is_parallel_to(&self, other: &Self) -> bool {
        match (self.kind, other.kind) {
            (Kind::OnFace(_, n, _), Kind::OnFace(_, m, _))
            | (Kind::Across(n, ..), Kind::Across(m, ..)) => cross(n, m).abs() < PARALLEL,
            _ => false,
        }
    }

    /// Whether two contacts never occur together, or coincide then, within a tolerance [m]: a disc on a face and on the
    /// corner at its end, a run and the disc at its end on one corner, faces in one plane, a corner between discs that
    /// touch.
    pub(super) fn is_one_with(&self, other: &Self, tolerance: f64) -> bool {
        if self.surface != other.surface && self.place != other.place {
            return false;
        }
        // The relative position of line and circle does not depend on the angle.
        let turn = Turn::by(0.3);
        match [self, other].map(|contact| contact.locus(turn)) {
            [Locus::Line(normal, offset), Locus::Circle(center, radius)]
            | [Locus::Circle(center, radius), Locus::Line(normal, offset)] => {
                ((normal.dot(center) - offset).abs() - radius).abs() < tolerance
            }
            // Two discs can be on one face.
            [Locus::Line(..), Locus::Line(..)] => {
                self.surface == other.surface && self.is_parallel_to(other)
            }
            // A corner can be between wheels that touch only at that point, if it is a needle; if one disc is inside
            // the other and touches it, both have the same normal there.
            [Locus::Circle(one, r), Locus::Circle(other, s)] => {
                let distance = (one - other).length();
                (distance - r - s).abs() < tolerance || distance < (r - s).abs() + tolerance
            }
        }
    }
}

/// The line through both intersections of two circles; without a direction if they are concentric.
pub(super) fn radical(one: (Vector, f64), other: (Vector, f64)) -> (Vector, f64) {
    let between = other.0 - one.0;
    let offset = 0.5
        * (other.0.length_squared() - one.0.length_squared() - other.1 * other.1 + one.1 * one.1);
    (between, offset)
}

/// The intersection of two lines, multiplied by the last number.
pub(super) fn meeting(one: (Vector, f64), other: (Vector, f64)) -> (Vector, f64) {
    let point = left_of(one.0) * other.1 - left_of(other.0) * one.1;
    (point, cross(one.0, other.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_meet_where_both_hold() {
        let one = (Vector::new(0.6, 0.8), 0.3);
        let other = (Vector::new(-1.0, 2.0), -0.7);
        let (point, scale) = meeting(one, other);
        for (normal, offset) in [one, other] {
            assert!((normal.dot(point / scale) - offset).abs() < 1e-15);
        }
    }

    fn contact(kind: Kind) -> Contact {
        Contact {
            surface: 0,
            place: 0,
            kind,
        }
    }

    fn kinds() -> [Kind; 3] {
        let disc = Disc {
            center: Vector::new(0.3, -0.1),
            radius: 0.05,
        };
        let corner = Vector::new(0.1, 0.2);
        [
            Kind::OnFace(disc, Vector::new(0.6, 0.8), 0.1),
            Kind::OnCorner(disc, corner, 0.01),
            Kind::Across(Vector::new(0.6, -0.8), 0.3, corner, 0.01),
        ]
    }

    #[test]
    fn a_gap_is_the_same_from_another_origin_and_the_ground_near_an_anchor() {
        let posture = |position| Posture {
            position,
            angle: 0.4,
        };
        let (here, origin) = (Vector::new(0.2, 0.7), Vector::new(5.0, -3.0));
        for kind in kinds() {
            let contact = contact(kind);
            let gap = contact.touch(&posture(here)).gap;
            let moved = contact.seen_from(origin);
            let seen = moved.touch(&posture(here - origin)).gap;
            assert!((gap - seen).abs() < 1e-14, "{kind:?}: {gap} {seen}");
            // Seen from its anchor, it is at the origin.
            let anchor = contact.anchor();
            assert!(contact.seen_from(anchor).anchor().length() < 1e-15);
            assert!(
                (moved.anchor() + origin - anchor)
                    .dot(Vector::new(0.6, 0.8))
                    .abs()
                    < 1e-14
            );
        }
    }

    /// A disc turns about nothing that a face keeps, and a run turns with the robot.
    #[test]
    fn two_faces_are_parallel_or_two_runs_up_to_a_nanoradian() {
        let [face, corner, run] = kinds();
        let turned = |kind: Kind, angle: f64| {
            let turn = Turn::by(angle);
            contact(match kind {
                Kind::OnFace(disc, normal, height) => {
                    Kind::OnFace(disc, turn.apply(normal), height)
                }
                Kind::Across(outward, distance, center, radius) => {
                    Kind::Across(turn.apply(outward), distance, center, radius)
                }
                Kind::OnCorner(..) => kind,
            })
        };
        for kind in [face, run] {
            for (angle, is_parallel) in [
                (0.0, true),
                (0.5e-9, true),
                (-0.5e-9, true),
                (2e-9, false),
                (-2e-9, false),
                (std::f64::consts::PI, true),
                (0.5, false),
            ] {
                let found = contact(kind).is_parallel_to(&turned(kind, angle));
                assert_eq!(found, is_parallel, "{kind:?} {angle}");
            }
        }
        assert!(!contact(corner).is_parallel_to(&contact(corner)));
        let same = Kind::Across(Vector::new(0.6, 0.8), 0.3, Vector::ZERO, 0.0);
        assert!(!contact(face).is_parallel_to(&contact(same)));
    }

    #[test]
    fn on_its_locus_a_gap_is_0_and_changes_by_its_gradient() {
        for kind in kinds() {
            let contact = contact(kind);
            let gap = |p: Vector, angle: f64| contact.touch_turned(p, Turn::by(angle)).gap;
            let position = match contact.locus(Turn::by(0.2)) {
                Locus::Line(normal, offset) => normal * (offset / normal.length_squared()),
                Locus::Circle(center, radius) => center + Vector::new(0.6, -0.8) * radius,
            };
            assert!(gap(position, 0.2).abs() < 1e-15);
            let touch = contact.touch_turned(position, Turn::by(0.2));
            let expected = Contact::gradient(&touch, position);
            let h = 1e-6;
            let slope = |dp: Vector, da: f64| {
                (gap(position + dp, 0.2 + da) - gap(position - dp, 0.2 - da)) / (2.0 * h)
            };
            let found = [
                slope(Vector::X * h, 0.0),
                slope(Vector::Y * h, 0.0),
                slope(Vector::ZERO, h),
            ];
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-8, "{kind:?}: {found:?} {expected:?}");
            }
        }
    }
}
