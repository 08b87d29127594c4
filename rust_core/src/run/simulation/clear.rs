//! The nearest pose in which no ground is inside the robot, at rest.

#[cfg(test)]
mod tests;

use super::Simulation;
use crate::contact::{Contact, Dents};
use crate::dynamics::DriveState;
use crate::geometry::{Vector, cross};
use crate::units::Metres;

/// [m] Contacts farther away than this are ignored in one round.
const REACH: Metres = Metres(0.02);
/// [m] Largest motion in one round: gaps are linear in the pose only to first order.
const FARTHEST: Metres = Metres(5e-3);
/// [m] Smaller overlaps do not count as ground inside, and smaller motions count as none.
const INSIDE: Metres = Metres(1e-6);
const NOTHING: Metres = Metres(1e-8);
const ROUNDS: usize = 200;

/// A displacement of the centre of mass [m], and a turn about it times half the robot's length [m].
pub(super) type Displacement = [f64; 3];

impl Simulation {
    /// The same robot at rest in the nearest pose in which no ground is inside it, where a turn counts by the motion of
    /// the end axles. `None` if there is no such pose nearby.
    pub(in crate::run) fn clear_of_the_ground(mut self) -> Option<Self> {
        self.stand_still();
        let raised = self.raised_clear()?;
        let found = [[0.0; 3], raised].map(|from| self.nearest_clear(from));
        let near = |way: &Displacement| length(*way);
        let nearest = found
            .into_iter()
            .flatten()
            .min_by(|a, b| near(a).total_cmp(&near(b)))?;
        self.displace(nearest);
        let mut contacts = self.contacts_now();
        self.dynamics.take_over(&mut contacts);
        self.dents = Dents::default();
        Some(self)
    }

    /// Stops all motion; the drivetrain starts again.
    fn stand_still(&mut self) {
        let state = &mut self.state;
        (state.velocity, state.angular_velocity) = (Vector::ZERO, 0.0);
        for drive in &mut state.drives {
            *drive = DriveState {
                position: drive.position,
                ..DriveState::default()
            };
        }
        for arm in &mut state.flippers {
            arm.rate = 0.0;
        }
        (self.set_point, self.last.set_point) = (0.0, 0.0);
    }

    /// The displacement normal to its own underside after which it is clear.
    fn raised_clear(&mut self) -> Option<Displacement> {
        /// [m] First distance; it doubles until it exceeds the height of any robot.
        const FIRST: Metres = Metres(0.01);
        const DOUBLINGS: i32 = 10;

        let (sine, cosine) = libm::sincos(self.state.angle);
        let ways = (0..DOUBLINGS).map(|i| {
            let rise = FIRST.value() * f64::from(1 << i);
            [-sine * rise, cosine * rise, 0.0]
        });
        ways.into_iter()
            .find(|way| self.contacts_at(*way).iter().all(|c| c.distance > 0.0))
    }

    /// The smallest displacement after which no ground is inside, searched from a first guess.
    fn nearest_clear(&mut self, from: Displacement) -> Option<Displacement> {
        let half = self.half_length();
        let mut way = from;
        for _ in 0..ROUNDS {
            let contacts = self.contacts_at(way);
            let center = self.state.center + Vector::new(way[0], way[1]);
            let walls: Vec<(Displacement, f64)> = contacts
                .iter()
                .map(|contact| {
                    let normal = contact.normal;
                    let lever = cross(contact.point - center, normal) / half;
                    let along = [normal.x, normal.y, lever];
                    (along, dot(along, way) - contact.distance)
                })
                .collect();
            let aim = nearest_beyond(&walls);
            let step: Displacement = std::array::from_fn(|i| aim[i] - way[i]);
            let share = (FARTHEST.value() / length(step)).min(1.0);
            way = std::array::from_fn(|i| way[i] + share * step[i]);
            if length(step) < NOTHING.value() {
                let contacts = self.contacts_at(way);
                return contacts
                    .iter()
                    .all(|contact| contact.distance > -INSIDE.value())
                    .then_some(way);
            }
        }
        None
    }

    /// Its contacts after a displacement.
    fn contacts_at(&mut self, way: Displacement) -> Vec<Contact> {
        let before = self.state.clone();
        self.displace(way);
        let (mut contacts, running) = (Vec::new(), self.running());
        let pose = self.state.pose(self.dynamics.model());
        self.contact
            .find(pose, &running, REACH.value(), &mut contacts);
        self.state = before;
        contacts
    }

    /// Moves the robot as one body.
    pub(super) fn displace(&mut self, way: Displacement) {
        let turn = way[2] / self.half_length();
        self.state.center += Vector::new(way[0], way[1]);
        self.state.angle += turn;
        for arm in &mut self.state.flippers {
            arm.angle += turn;
        }
    }
}

/// The point nearest to the origin that satisfies all constraints `along . x >= bound`, by Hildreth's method.
pub(super) fn nearest_beyond(walls: &[(Displacement, f64)]) -> Displacement {
    const SWEEPS: usize = 2000;

    let mut point = [0.0; 3];
    let mut pushes = vec![0.0; walls.len()];
    for _ in 0..SWEEPS {
        let mut most: f64 = 0.0;
        for ((along, bound), push) in walls.iter().zip(&mut pushes) {
            let more = (bound - dot(*along, point)) / dot(*along, *along);
            let more = more.max(-*push);
            *push += more;
            most = most.max(more.abs());
            point = std::array::from_fn(|i| point[i] + more * along[i]);
        }
        if most < 1e-3 * NOTHING.value() {
            break;
        }
    }
    point
}

fn dot(a: Displacement, b: Displacement) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn length(way: Displacement) -> f64 {
    dot(way, way).sqrt()
}
