//! A robot put in a pose with its drives running.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::clear::{Displacement, nearest_beyond};
use super::{LastStep, Simulation};
use crate::geometry::{Vector, cross};
use crate::jams::Jam;
use crate::run::ValidScenario;

impl Simulation {
    /// The robot of a scenario at rest, its chassis frame at a position [m] and an angle [rad], its surfaces at the
    /// speed that the scenario commands first.
    pub(in crate::run) fn driven_at(checked: &ValidScenario, position: Vector, angle: f64) -> Self {
        let mut scenario = checked.scenario().clone();
        scenario.start.angle = angle;
        let ground = Arc::clone(checked.ground());
        let model = checked.model().clone();
        let mut robot = Self::at_rest(&scenario, ground, model, position);
        let speed = robot.commands.speed;
        let model = robot.dynamics.model();
        let spin = -speed / model.drive_radius;
        for drive in model.driven() {
            robot.state.drives[drive].spin = spin;
        }
        robot.last = LastStep::none(&robot.state);
        (robot.set_point, robot.last.set_point) = (speed, speed);
        robot
    }

    /// The same in a jam, pressed onto its contacts at least so deep that they carry it at rest. If they only touched, rounding
    /// would decide which of them carries first, and some robots could slip out of the jam.
    pub(in crate::run) fn pressed(mut self, jam: &Jam) -> Self {
        let omega = TAU * self.scenario.solver.contact_frequency;
        let deepest = self.scenario.gravity / (omega * omega);
        let (center, half) = (self.state.center, self.half_length());
        let walls: Vec<(Displacement, f64)> = jam
            .contacts
            .iter()
            .map(|contact| {
                let into = -contact.normal;
                let lever = cross(contact.point - center, into) / half;
                ([into.x, into.y, lever], deepest * contact.load)
            })
            .collect();
        self.displace(nearest_beyond(&walls));
        self.last = LastStep::none(&self.state);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::left_of;
    use crate::jams::JamContact;
    use crate::limits::Cancel;
    use crate::run::find_jams;
    use crate::run::trials::tests::wheels;

    /// The Engineer on four round wheels before a step, in which it can jam.
    fn checked() -> ValidScenario {
        ValidScenario::new(&wheels(4, 0.08)).expect("it is valid")
    }

    #[test]
    fn a_robot_that_is_put_somewhere_is_there_and_drives_at_the_command() {
        let checked = checked();
        let robot = Simulation::driven_at(&checked, Vector::new(-1.0, 0.3), 0.2);
        let now = robot.reading();
        assert!((now.position - Vector::new(-1.0, 0.3)).length() < 1e-15);
        assert!((now.chassis_angle - 0.2).abs() < 1e-15);
        let speed = checked.scenario().drive.speed;
        assert!((now.track_speed - speed).abs() < 1e-15 && speed > 0.1);
    }

    /// Where a contact carries a share of the weight it gives way by that share of g over the square of its rate. It cannot be
    /// less deep in any, and moves no farther than that takes, so in one it is no deeper.
    #[test]
    fn a_robot_is_pressed_onto_its_contacts_until_each_is_as_deep_as_it_carries() {
        let checked = checked();
        let jams = find_jams(&checked, &Cancel::default()).expect("there are few contacts");
        let rate = TAU * checked.scenario().solver.contact_frequency;
        let deepest = checked.scenario().gravity / (rate * rate);
        let mut tried = 0;
        for jam in jams.iter().map(|found| &found.jam) {
            let touching = Simulation::driven_at(&checked, jam.position, jam.angle);
            let before = touching.state.clone();
            let after = touching.pressed(jam).state;
            let (moved, turned) = (after.center - before.center, after.angle - before.angle);
            let spare = |contact: &JamContact| {
                let lever = left_of(contact.point - before.center);
                let depth = -contact.normal.dot(moved + lever * turned);
                depth - deepest * contact.load
            };
            let least = jam.contacts.iter().map(spare).fold(f64::INFINITY, f64::min);
            // It is known to 1e-11 m; the depths are some 2e-7 m.
            assert!(least.abs() < 1e-4 * deepest, "{least} m, {jam:?}");
            tried += 1;
        }
        assert!(tried > 2, "{tried}");
    }
}
