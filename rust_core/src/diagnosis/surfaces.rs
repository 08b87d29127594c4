//! How a drive moves the surface at a contact of a stop.
//!
//! Belts with grousers and chains keep running while a robot is stopped: the part that bore at a place may be
//! elsewhere when the stop is examined. The part that is there now then gives the motion.

use super::scene::Scene;
use crate::geometry::{Motion, Pose, Vector};
use crate::robot::{Mount, Shape};

impl Scene<'_> {
    /// Motion relative to the chassis, per metre that the drive of a part runs; its contact is at `point` [m] in the
    /// chassis frame.
    pub(super) fn motion(&self, part: usize, point: Vector) -> Motion {
        let mount = self.model.parts[part].mount;
        match mount {
            Mount::Shoe(shoe) => self.motion_of_shoe(shoe, point),
            Mount::Chassis => self.motion_over_mount(part, point),
            Mount::Flipper(k) => {
                let pose = self.running.flippers[k].pose;
                let there = pose.inverse_transform_point(point);
                self.motion_over_mount(part, there).seen_from(pose)
            }
        }
    }

    fn motion_over_mount(&self, part: usize, point: Vector) -> Motion {
        let part = &self.model.parts[part];
        let run = part.run(&self.running);
        match &part.shape {
            Shape::Grouser(grouser) => grouser.motion_where(run, point),
            _ => part.motion(run, 0.0),
        }
    }

    /// As the chain runs, each shoe takes the place of the next one. The places of its neighbours give its motion,
    /// including the travel of the tensioner.
    fn motion_of_shoe(&self, shoe: usize, point: Vector) -> Motion {
        /// Distance from its middle, in pitches, within which a contact belongs to the shoe.
        const OWN: f64 = 0.75;

        let places = &self.running.shoes;
        let of_shoe = self.model.chains.iter().find(|c| c.shoes.contains(&shoe));
        let Some(chain) = of_shoe else {
            return Motion::default();
        };
        let distance = |shoe: usize| (places[shoe].translation - point).length();
        let there = if distance(shoe) < OWN * chain.path.pitch {
            shoe
        } else {
            let nearest = chain
                .shoes
                .clone()
                .min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            nearest.unwrap_or(shoe)
        };
        let (first, count) = (chain.shoes.start, chain.shoes.len());
        let beside = |steps: usize| places[first + (there - first + steps) % count];
        between(beside(count - 1), beside(1), 2.0 * chain.path.pitch)
    }
}

/// The motion from one place to another while a chain runs so far [m].
fn between(from: Pose, to: Pose, run: f64) -> Motion {
    let turn = (from.rotation.inverse() * to.rotation).angle();
    let half = 0.5 * turn;
    // Share of the displacement that remains as translation when the turn is about the midpoint.
    let share = if half.abs() < 1e-6 {
        1.0
    } else {
        half / libm::tan(half)
    };
    Motion {
        center: 0.5 * (from.translation + to.translation),
        turn: -turn / run,
        along: (to.translation - from.translation) * (share / run),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation, left_of};

    #[test]
    fn between_two_places_on_a_circle_it_turns_about_its_middle() {
        let (radius, turn) = (0.05, 0.7);
        let place = |angle: f64| {
            let (sine, cosine) = libm::sincos(angle);
            Pose::from_parts(Vector::new(cosine, sine) * radius, Rotation::new(angle))
        };
        // Clockwise, as when a chain drives forwards.
        let motion = between(place(turn), place(-turn), 2.0 * turn * radius);
        for point in [Vector::new(0.05, 0.0), Vector::new(0.06, 0.01)] {
            let expected = -left_of(point) / radius;
            assert!((motion.at(point) - expected).length() < 1e-12);
        }
    }

    #[test]
    fn between_two_places_on_a_line_it_goes_straight() {
        let place = |x: f64| Pose::from_translation(Vector::new(x, 0.0));
        let motion = between(place(0.1), place(0.0), 0.1);
        assert!((motion.at(Vector::new(0.3, 0.2)) - Vector::new(-1.0, 0.0)).length() < 1e-12);
    }
}
