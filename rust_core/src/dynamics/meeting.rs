//! How the speed at which a gap opens changes as robot and normal turn, while a step keeps both as they are in its
//! middle.
//!
//! The equations: docs/physics.md, "Contacts".

use crate::contact::Contact;
use crate::geometry::{Disc, Vector};
use crate::robot::{Part, Shape};

/// Cosine of the angle within which a normal leads to the centre of an arc.
const TO_CENTER: f64 = 1.0 - 1e-9;

/// What of the part meets what of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Meeting {
    /// A point of the part a face.
    #[default]
    Point,
    /// An arc, with its centre at this distance [m], a face.
    Arc(f64),
    /// The same a corner.
    ArcOnCorner(f64),
    /// A straight side a corner.
    SideOnCorner,
}

/// The motion of a part, seen from the contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    /// [rad/s] Its angular velocity.
    pub turn: f64,
    /// [m] How high its centre of rotation is above the contact along the normal.
    pub height: f64,
    /// [m/s] Velocity of its point at the contact along the tangent.
    pub slip: f64,
}

impl Meeting {
    /// That of a contact of a part, whose carrier's points `place` puts into the world.
    pub(super) fn of(contact: &Contact, part: &Part, place: impl Fn(Vector) -> Vector) -> Self {
        let on_corner = contact.edge >= 0;
        let arc = |center: Vector| {
            let spoke = place(center) - contact.point;
            let far = spoke.dot(contact.normal);
            (far > TO_CENTER * spoke.length()).then_some(if on_corner {
                Self::ArcOnCorner(far)
            } else {
                Self::Arc(far)
            })
        };
        let straight = if on_corner {
            Self::SideOnCorner
        } else {
            Self::Point
        };
        match &part.shape {
            Shape::Disc { center, .. } => arc(*center).unwrap_or(straight),
            Shape::Hull { discs, .. } => {
                let mut arcs = discs.iter().map(|Disc { center, .. }| arc(*center));
                arcs.find_map(|arc| arc).unwrap_or(straight)
            }
            Shape::Polygon { .. } | Shape::Gear { .. } | Shape::Grouser(_) => straight,
        }
    }

    /// [m/s^2] How fast the speed at which the gap opens grows at constant velocities.
    pub(super) fn opens(self, swing: Swing) -> f64 {
        let Swing { turn, height, slip } = swing;
        match self {
            Self::Point => turn * turn * height,
            Self::Arc(far) => turn * turn * (height - far),
            Self::ArcOnCorner(far) => {
                let of_center = slip - far * turn;
                of_center * of_center / far + turn * turn * (height - far)
            }
            Self::SideOnCorner => turn * (turn * height - 2.0 * slip),
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::geometry::{Rotation, left_of, right_of};

    const TIME: f64 = 1e-3;

    /// A contact at the origin of a part that turns about a centre.
    struct Scene {
        normal: Vector,
        center: Vector,
        velocity: Vector,
        turn: f64,
    }

    impl Scene {
        fn new() -> Self {
            Self {
                normal: Rotation::new(0.4) * Vector::Y,
                center: Vector::new(-0.03, 0.12),
                velocity: Vector::new(0.3, -0.2),
                turn: 1.5,
            }
        }

        fn swing(&self) -> Swing {
            let at_contact = self.velocity - left_of(self.center) * self.turn;
            Swing {
                turn: self.turn,
                height: self.center.dot(self.normal),
                slip: right_of(self.normal).dot(at_contact),
            }
        }

        /// A point of the part after a time.
        fn moved(&self, point: Vector, time: f64) -> Vector {
            let arm = Rotation::new(self.turn * time) * (point - self.center);
            self.center + self.velocity * time + arm
        }

        /// The second derivative of a gap.
        fn bend(gap: impl Fn(f64) -> f64) -> f64 {
            (gap(TIME) + gap(-TIME) - 2.0 * gap(0.0)) / (TIME * TIME)
        }
    }

    #[test]
    fn a_point_that_turns_leaves_a_face() {
        let scene = Scene::new();
        let gap = |time| scene.moved(Vector::ZERO, time).dot(scene.normal);
        let opens = Meeting::Point.opens(scene.swing());
        assert_relative_eq!(opens, Scene::bend(gap), max_relative = 1e-5);
    }

    #[test]
    fn an_arc_leaves_a_face_or_a_corner_as_its_centre_does() {
        let (scene, far) = (Scene::new(), 0.1);
        let axle = scene.normal * far;
        let on_face = |time| scene.moved(axle, time).dot(scene.normal);
        let on_corner = |time| scene.moved(axle, time).length();
        let of = |meeting: Meeting| meeting.opens(scene.swing());
        assert_relative_eq!(
            of(Meeting::Arc(far)),
            Scene::bend(on_face),
            max_relative = 1e-5
        );
        let expected = Scene::bend(on_corner);
        assert_relative_eq!(of(Meeting::ArcOnCorner(far)), expected, max_relative = 1e-5);
    }

    #[test]
    fn a_side_leaves_a_corner_as_it_turns_over_it() {
        let scene = Scene::new();
        let gap = |time: f64| {
            let normal = Rotation::new(scene.turn * time) * scene.normal;
            scene.moved(Vector::ZERO, time).dot(normal)
        };
        let opens = Meeting::SideOnCorner.opens(scene.swing());
        assert_relative_eq!(opens, Scene::bend(gap), max_relative = 1e-5);
    }
}
