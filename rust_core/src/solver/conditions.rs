//! The conditions of all contacts and motors, and the switches from one state to another.
//!
//! The equations: docs/physics.md, "Lowering".

use super::Problem;
use super::condition::Switch;
use super::grip::Grip;
use super::motor::Driven;

impl Problem {
    /// Calls `found` with the conditions of the present states and their values, while contacts are lifted by so much
    /// [m/s].
    pub(super) fn conditions(&self, lift: f64, mut found: impl FnMut(Switch, f64)) {
        for (i, contact) in self.contacts.iter().enumerate().filter(|(_, c)| c.bears) {
            contact.conditions(contact.speeds(&self.velocities), lift, |grip, value| {
                found(Switch::Contact(i, grip), value);
            });
        }
        for (k, motor) in self.motors.iter().enumerate() {
            let ahead = self.ahead(motor);
            let speed = ahead + motor.held_speed();
            let mut over = [ahead, speed];
            let mut impulse = self.motor_impulse(motor);
            // The motor of a ring holds softly, so its impulse tells when it may hold again.
            if let (Driven::Ring(ring), None) = (motor.on, motor.correction) {
                let held = over.map(|over| self.rings[ring].drive.damper().at(over));
                let given = motor.given().map_or(0.0, |given| given.at(speed));
                impulse = held[0];
                over = held.map(|held| given - held);
            }
            motor.conditions(speed, impulse, over, |hold, value| {
                found(Switch::Motor(k, hold), value);
            });
        }
    }

    /// Makes switches, one of each contact and motor; returns the one that would take back the first.
    pub(super) fn make_all(&mut self, switches: impl Iterator<Item = Switch>) -> Option<Switch> {
        let mut made: Vec<Switch> = Vec::new();
        for switch in switches {
            if !made.iter().any(|other| other.is_of_the_same(switch)) {
                made.push(self.make(switch));
            }
        }
        made.first().copied()
    }

    /// Makes a switch; returns the one that would take it back.
    pub(super) fn make(&mut self, switch: Switch) -> Switch {
        match switch {
            Switch::Contact(i, next) => {
                let speeds = self.contacts[i].speeds(&self.velocities);
                let contact = &mut self.contacts[i];
                let before = contact.grip;
                contact.grip = match before {
                    Grip::Open => contact.slides(speeds),
                    _ => next,
                };
                // An open contact has one condition, whatever it becomes.
                let back = if next == Grip::Open {
                    Grip::Sticks
                } else {
                    before
                };
                Switch::Contact(i, back)
            }
            Switch::Motor(k, next) => {
                let before = std::mem::replace(&mut self.motors[k].hold, next);
                self.tie();
                Switch::Motor(k, before)
            }
        }
    }
}
