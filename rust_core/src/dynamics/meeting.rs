//! How the gap and the speeds of a contact change as the robot and the normal turn: the rows of a step have the normal in
//! its middle.
//!
//! The equations: docs/physics.md, "Contacts".

use crate::contact::Contact;
use crate::geometry::{Disc, Rotation, Vector};
use crate::robot::{Part, Shape};

/// Cosine of the largest angle between the normal and the direction to the centre of an arc.
const TO_CENTER: f64 = 1.0 - 1e-9;

/// Which feature of the part meets which feature of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Meeting {
    /// A point of the part on a face.
    #[default]
    Point,
    /// An arc on a face; [m] from the contact to the centre of the arc.
    Arc(f64),
    /// An arc on a corner; the same.
    ArcOnCorner(f64),
    /// A straight side of the part on a corner.
    SideOnCorner,
}

/// The motion of a part as seen from the contact; pairs are along normal and tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    /// [rad/s] Its angular velocity.
    pub turn: f64,
    /// [m] From the contact to the centre of rotation.
    pub center: [f64; 2],
    /// [m/s^2] Acceleration of the centre of rotation.
    pub pull: [f64; 2],
    /// [m/s] Velocity of the part's point at the contact along the tangent.
    pub slip: f64,
}

impl Meeting {
    /// The features that meet at a contact of a part; `place` takes points of the part's carrier to the world.
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

    /// [m] By how much the gap has grown after the part's point has moved by `way` [m] along normal and tangent and the part
    /// has turned, from a pose with this normal.
    pub(super) fn opened(self, way: [f64; 2], turned: Rotation) -> f64 {
        // Components of the normal as it has turned with the part.
        let [along, across] = [turned.cos(), -turned.sin()];
        match self {
            Self::Point => way[0],
            Self::Arc(far) => way[0] - far * (1.0 - along),
            Self::ArcOnCorner(far) => {
                libm::hypot(way[0] + far * along, way[1] + far * across) - far
            }
            Self::SideOnCorner => way[0] * along + way[1] * across,
        }
    }

    /// [m/s^2] The rates at which the opening speed of the gap and the sliding speed grow at constant velocities, while the gap
    /// stays as it is.
    pub(super) fn gains(self, swing: Swing) -> [f64; 2] {
        let Swing { turn, slip, .. } = swing;
        let [height, side] = swing.center;
        let opens = match self {
            Self::Point => turn * turn * height,
            Self::Arc(far) => turn * turn * (height - far),
            Self::ArcOnCorner(far) => {
                let of_center = slip - far * turn;
                of_center * of_center / far + turn * turn * (height - far)
            }
            Self::SideOnCorner => turn * (turn * height - 2.0 * slip),
        };
        [swing.pull[0] + opens, swing.pull[1] + turn * turn * side]
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::geometry::{cross, left_of, right_of};

    const TIME: f64 = 1e-3;
    /// [m] From the contact to the centre of an arc.
    const FAR: f64 = 0.1;

    /// A contact at the origin of a part that turns about a centre.
    struct Scene {
        normal: Vector,
        center: Vector,
        velocity: Vector,
        turn: f64,
    }

    impl Scene {
        /// A meeting with a constant gap.
        fn new() -> Self {
            let (normal, center, turn) = (
                Rotation::new(0.4) * Vector::Y,
                Vector::new(-0.03, 0.12),
                1.5,
            );
            Self {
                normal,
                center,
                velocity: right_of(normal) * 0.36 + normal * cross(center, normal) * turn,
                turn,
            }
        }

        fn tangent(&self) -> Vector {
            right_of(self.normal)
        }

        fn swing(&self) -> Swing {
            Swing {
                turn: self.turn,
                center: self.along(self.center),
                pull: [0.0; 2],
                slip: self.velocity_at(Vector::ZERO, 0.0).dot(self.tangent()),
            }
        }

        fn along(&self, v: Vector) -> [f64; 2] {
            [self.normal, self.tangent()].map(|unit| unit.dot(v))
        }

        fn turned(&self, time: f64) -> Rotation {
            Rotation::new(self.turn * time)
        }

        /// A point of the part after a time.
        fn moved(&self, point: Vector, time: f64) -> Vector {
            let arm = self.turned(time) * (point - self.center);
            self.center + self.velocity * time + arm
        }

        /// The velocity of what is at a place of the world after a time.
        fn velocity_at(&self, place: Vector, time: f64) -> Vector {
            let arm = place - self.center - self.velocity * time;
            self.velocity + left_of(arm) * self.turn
        }

        /// Checks a meeting against its exact gap and slip.
        fn check(&self, meeting: Meeting, gap: impl Fn(f64) -> f64, slip: impl Fn(f64) -> f64) {
            let opened = |time: f64| {
                let way = self.along(self.moved(Vector::ZERO, time));
                meeting.opened(way, self.turned(time))
            };
            for time in [-0.2, TIME, 0.3] {
                assert_relative_eq!(opened(time), gap(time), epsilon = 1e-14);
            }
            let [opens, slides] = meeting.gains(self.swing());
            let bend = (gap(TIME) + gap(-TIME)) / (TIME * TIME);
            let grows = (slip(TIME) - slip(-TIME)) / (2.0 * TIME);
            assert_relative_eq!(slip(0.0), self.swing().slip, max_relative = 1e-12);
            assert_relative_eq!(opens, bend, max_relative = 1e-4);
            assert_relative_eq!(slides, grows, max_relative = 1e-4);
        }
    }

    #[test]
    fn a_point_on_a_face() {
        let scene = Scene::new();
        let point = |time| scene.moved(Vector::ZERO, time);
        scene.check(
            Meeting::Point,
            |time| point(time).dot(scene.normal),
            |time| scene.velocity_at(point(time), time).dot(scene.tangent()),
        );
    }

    #[test]
    fn an_arc_on_a_face() {
        let scene = Scene::new();
        let center = |time| scene.moved(scene.normal * FAR, time);
        let foot = |time| center(time) - scene.normal * FAR;
        scene.check(
            Meeting::Arc(FAR),
            |time| foot(time).dot(scene.normal),
            |time| scene.velocity_at(foot(time), time).dot(scene.tangent()),
        );
    }

    #[test]
    fn an_arc_on_a_corner() {
        let scene = Scene::new();
        let center = |time| scene.moved(scene.normal * FAR, time);
        let slip = |time| {
            let normal = center(time).normalize();
            let foot = center(time) - normal * FAR;
            scene.velocity_at(foot, time).dot(right_of(normal))
        };
        scene.check(
            Meeting::ArcOnCorner(FAR),
            |time| center(time).length() - FAR,
            slip,
        );
    }

    #[test]
    fn a_side_on_a_corner() {
        let scene = Scene::new();
        let normal = |time| scene.turned(time) * scene.normal;
        scene.check(
            Meeting::SideOnCorner,
            |time| scene.moved(Vector::ZERO, time).dot(normal(time)),
            |time| {
                let at_corner = scene.velocity_at(Vector::ZERO, time);
                at_corner.dot(right_of(normal(time)))
            },
        );
    }
}
