//! How the normal of a contact turns while the robot moves on: a step keeps it as it is in the middle.
//!
//! The equations: docs/physics.md, "Contacts".

use crate::contact::Contact;
use crate::geometry::{Disc, Vector};
use crate::robot::{Part, Shape};

/// Cosine of the angle within which a normal leads to the centre of an arc.
const TO_CENTER: f64 = 1.0 - 1e-9;

/// What turns the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Turning {
    /// Nothing: the ground is a face, or the part moves with its drive.
    #[default]
    Fixed,
    /// [m] The centre of an arc goes round a corner of the ground at this distance.
    About(f64),
    /// The part, a straight side of which bears on a corner.
    WithPart,
}

impl Turning {
    /// That of a contact of a part, whose carrier's points `place` puts into the world.
    pub(super) fn of(contact: &Contact, part: &Part, place: impl Fn(Vector) -> Vector) -> Self {
        if contact.edge < 0 || part.is_carried() {
            return Self::Fixed;
        }
        let about = |center: Vector| {
            let spoke = place(center) - contact.point;
            let far = spoke.dot(contact.normal);
            (far > TO_CENTER * spoke.length()).then_some(Self::About(far))
        };
        match &part.shape {
            Shape::Disc { center, .. } => about(*center).unwrap_or_default(),
            Shape::Hull { discs, .. } => {
                let mut arcs = discs.iter().map(|Disc { center, .. }| about(*center));
                arcs.find_map(|arc| arc).unwrap_or(Self::WithPart)
            }
            Shape::Polygon { .. } => Self::WithPart,
            Shape::Gear { .. } | Shape::Grouser(_) => Self::Fixed,
        }
    }

    /// [m/s] What the normal's turn in a time [s] adds to the speed at which the gap opens; `slip` is the velocity of
    /// the part's point along the tangent [m/s], `turn` its angular velocity [rad/s].
    pub(super) fn opens(self, slip: f64, turn: f64, time: f64) -> f64 {
        match self {
            Self::Fixed => 0.0,
            Self::About(far) => {
                let of_center = slip - far * turn;
                of_center * of_center * time / far
            }
            Self::WithPart => -turn * time * slip,
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::geometry::{Rotation, left_of, right_of};

    const TIME: f64 = 1e-5;

    #[test]
    fn an_arc_leaves_a_corner_as_its_centre_moves_past() {
        let (far, velocity, turn) = (0.1, Vector::new(0.3, -0.2), 1.5);
        let center = Rotation::new(0.4) * Vector::new(0.0, far);
        let normal = center / far;
        // The speed at which the centre, and so the arc, leaves the corner at the origin.
        let after = (center + velocity * TIME).normalize().dot(velocity);
        let slip = right_of(normal).dot(velocity + left_of(-center) * turn);
        let opens = Turning::About(far).opens(slip, turn, TIME);
        assert_relative_eq!(after - normal.dot(velocity), opens, max_relative = 1e-3);
    }

    #[test]
    fn a_side_leaves_a_corner_as_it_turns_over_it() {
        let (velocity, turn) = (Vector::new(0.3, -0.2), 1.5);
        let normal = Rotation::new(0.4) * Vector::Y;
        let after = (Rotation::new(turn * TIME) * normal).dot(velocity);
        let opens = Turning::WithPart.opens(right_of(normal).dot(velocity), turn, TIME);
        assert_relative_eq!(after - normal.dot(velocity), opens, max_relative = 1e-3);
    }
}
