//! The face of the ground on which an arc rolls, and how far the ground is below an arc that has rolled past its end.
//!
//! Within a step the normal stays that of the face and forces are constant, so the velocities at both ends of the step do
//! not show that the face has ended.
//!
//! The equations: docs/physics.md, "Length of a step".

use super::Dynamics;
use super::meeting::Meeting;
use crate::contact::Contact;
use crate::geometry::{Vector, right_of};
use crate::terrain::Profile;

impl Dynamics {
    /// [m] How far the ground is, at the end of the step with these contacts, below an arc that has rolled past the end of
    /// its face.
    pub(crate) fn overrun(&self, contacts: &[Contact], lanes: &[Profile]) -> f64 {
        let touches = self.touches.iter().zip(contacts);
        let gaps = touches.filter_map(|(touch, contact)| match touch.meeting {
            Meeting::Arc(far) if touch.rolled != 0.0 => {
                let radius = far - 0.5 * contact.distance;
                let lane = &lanes[self.model.parts[contact.part].lane];
                Some(gap_below(contact, lane, radius, touch.rolled))
            }
            _ => None,
        });
        gaps.fold(0.0, f64::max)
    }
}

/// [m] The gap below an arc that has rolled by `way` [m] along the tangent, at the height of the face of its contact.
fn gap_below(contact: &Contact, lane: &Profile, radius: f64, way: f64) -> f64 {
    let bends = lane.bends();
    let face = bends.partition_point(|&bend| bend as usize <= contact.facet) - 1;
    // Bends and faces are counted from this face on, in the direction in which the arc rolls.
    let bend = |k: usize| {
        let i = if way > 0.0 { face + k } else { face + 1 - k };
        lane.points[bends[i] as usize]
    };
    let count = if way > 0.0 {
        bends.len() - 1 - face
    } else {
        face + 1
    };
    let along = right_of(contact.normal);
    let foot = contact.point - contact.normal * (0.5 * contact.distance);
    let center = foot + contact.normal * radius + along * way;
    let ahead = |k: usize| (bend(k) - center).dot(along) * way.signum();
    let below = face_below(count, ahead);
    let gap = |k: usize| distance(center, [bend(k), bend(k + 1)]) - radius;
    // Ground that is no higher than the face and farther along it than this has a larger gap.
    let reach = |gap: f64| (gap.max(0.0) * (2.0 * radius + gap)).sqrt();
    let mut least = gap(below);
    for k in (0..below).rev() {
        if -ahead(k + 1) > reach(least) {
            break;
        }
        least = least.min(gap(k));
    }
    for k in below + 1..count {
        if ahead(k) > reach(least) {
            break;
        }
        least = least.min(gap(k));
    }
    least
}

/// The face below the centre of an arc, of so many in a row: the first that ends ahead of it, or the last. `ahead` is
/// how far the beginning of a face is ahead [m].
fn face_below(count: usize, ahead: impl Fn(usize) -> f64) -> usize {
    let found = (0..count).find(|&face| ahead(face + 1) > 0.0);
    found.unwrap_or(count - 1)
}

/// [m] From a point to the segment between two others.
fn distance(point: Vector, [a, b]: [Vector; 2]) -> f64 {
    let (side, to_point) = (b - a, point - a);
    let share = to_point.dot(side) / side.dot(side);
    (to_point - side * share.clamp(0.0, 1.0)).length()
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::draw::Draw;
    use crate::scenario::Surface;

    const RADIUS: f64 = 0.05;

    /// [m] The gap below an arc that has rolled by `way` on a level face after one that falls by 0.2 rad, from 3 mm before
    /// one that falls by `bend` [rad].
    fn below(bend: f64, way: f64) -> f64 {
        let slope = |angle: f64| Vector::new(angle.cos(), angle.sin());
        let middle = Vector::new(0.1, 0.0);
        let points = [-slope(-0.2), Vector::ZERO, middle, middle + slope(-bend)];
        let points = points.map(|point| [point.x, point.y]);
        let lane = Profile::new("terrain", &points, Surface::sharp(0.5), true).expect("a profile");
        let point = middle - Vector::new(0.003, 0.0);
        let contact = Contact::new(0, (1, -1), (point, Vector::Y), 0.0);
        gap_below(&contact, &lane, RADIUS, way)
    }

    #[test]
    fn a_wheel_on_its_face_is_on_the_ground() {
        for way in [-0.09, 0.0, 0.0029] {
            assert_relative_eq!(below(0.7, way), 0.0, epsilon = 1e-15);
        }
    }

    #[test]
    fn past_its_end_the_ground_is_a_corner_and_then_the_next_face() {
        let (bend, past) = (0.1_f64, [0.001, 0.02]);
        let [corner, slope] = past.map(|past| below(bend, 0.003 + past));
        assert_relative_eq!(
            corner,
            (0.001_f64.powi(2) + RADIUS * RADIUS).sqrt() - RADIUS,
            max_relative = 1e-9
        );
        let center = Vector::new(0.02, RADIUS);
        let normal = Vector::new(bend.sin(), bend.cos());
        assert_relative_eq!(slope, center.dot(normal) - RADIUS, max_relative = 1e-9);
    }

    /// An arc that left one fine piece behind would hang over the next that falls.
    #[test]
    fn ground_in_fine_pieces_is_straight() {
        let points: Vec<[f64; 2]> = (0..=2000)
            .map(|i| [1e-4 * f64::from(i), 1e-7 * f64::from(i % 2)])
            .collect();
        let lane = Profile::new("terrain", &points, Surface::sharp(0.5), true).expect("a profile");
        for way in [-0.02, 0.02] {
            let contact = Contact::new(0, (1001, -1), (Vector::new(0.1, 0.0), Vector::Y), 0.0);
            assert!(gap_below(&contact, &lane, RADIUS, way) < 2e-7);
        }
    }

    /// Ground of short faces that is nowhere higher than the middle one, with so many faces to the left and right of it.
    fn falling(draw: &mut Draw, counts: [usize; 2]) -> Profile {
        let mut points = vec![[-1e-3, 0.0], [1e-3, 0.0]];
        for (side, count) in [-1.0, 1.0].into_iter().zip(counts) {
            let (mut x, mut y): (f64, f64) = (1e-3, 0.0);
            for _ in 0..count {
                x += 2e-3 + 4e-3 * draw.between(0.0, 1.0);
                y = (y - 1e-3 + 1.5e-3 * draw.between(0.0, 1.0)).min(0.0);
                points.push([side * x, y]);
            }
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Profile::new("terrain", &points, Surface::sharp(0.5), true).expect("a profile")
    }

    #[test]
    fn no_face_is_nearer_than_the_one_that_is_found() {
        let mut draw = Draw(1);
        for case in 0..300 {
            let counts = [[30, 30], [1, 30], [30, 1]][case % 3];
            let lane = falling(&mut draw, counts);
            let middle = lane
                .points
                .iter()
                .position(|point| point.x > 0.0)
                .expect("it is there")
                - 1;
            let contact = Contact::new(0, (middle, -1), (Vector::ZERO, Vector::Y), 0.0);
            let way = match counts {
                [30, 30] => 0.06 * (draw.between(0.0, 1.0) - 0.5),
                [1, _] => 0.03 * draw.between(0.0, 1.0),
                _ => -0.03 * draw.between(0.0, 1.0),
            };
            let center = Vector::new(way, RADIUS);
            let faces = if way > 0.0 {
                middle..lane.points.len() - 1
            } else {
                0..middle + 1
            };
            let gaps =
                faces.map(|i| distance(center, [lane.points[i], lane.points[i + 1]]) - RADIUS);
            let least = gaps.fold(f64::INFINITY, f64::min);
            assert_relative_eq!(
                gap_below(&contact, &lane, RADIUS, way),
                least,
                epsilon = 1e-12
            );
        }
    }

    #[test]
    fn an_arc_is_over_the_first_face_that_ends_ahead_of_it() {
        let ends = [-3.0, -1.0, 2.0, 5.0, 6.0];
        for (center, face) in [(-2.0, 0), (-1.0, 1), (1.9, 1), (2.0, 2), (5.5, 3), (9.0, 3)] {
            let found = face_below(4, |k| ends[k] - center);
            assert_eq!(found, face, "{center} m");
        }
    }

    #[test]
    fn ground_that_rises_does_not_fall_away() {
        assert!(below(-0.3, 0.02) <= 0.0);
        assert!(below(0.7, -0.2) <= 0.0);
    }
}
