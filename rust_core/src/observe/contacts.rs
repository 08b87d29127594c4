//! Contact forces averaged over a sample interval.

use crate::contact::Contact;
use crate::dynamics::LoadedContact;

/// Contacts since the last sample, each with the sum of its forces.
#[derive(Default)]
pub(crate) struct Readings {
    steps: u32,
    seen: Vec<Reading>,
}

/// One contact during the interval.
#[derive(Clone, Copy)]
pub(crate) struct Reading {
    /// Its last state.
    pub contact: Contact,
    /// [N] Mean over the interval.
    pub normal_force: f64,
    /// [N] Mean over the interval.
    pub friction_force: f64,
    /// [m/s] Last value.
    pub surface_speed: f64,
}

impl Readings {
    /// Adds one step.
    pub(crate) fn add(&mut self, loaded: &[LoadedContact]) {
        self.steps += 1;
        for l in loaded.iter().filter(|l| l.normal_force > 0.0) {
            let mut seen = self.seen.iter_mut();
            match seen.find(|r| r.contact.number == l.contact.number) {
                Some(reading) => {
                    reading.contact = l.contact;
                    reading.normal_force += l.normal_force;
                    reading.friction_force += l.friction_force;
                    reading.surface_speed = l.surface_speed;
                }
                None => self.seen.push(Reading {
                    contact: l.contact,
                    normal_force: l.normal_force,
                    friction_force: l.friction_force,
                    surface_speed: l.surface_speed,
                }),
            }
        }
    }

    /// Number of contacts since the last sample.
    pub(crate) fn count(&self) -> usize {
        self.seen.len()
    }

    /// Returns the means, in the order in which contacts first appeared, and starts a new interval.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Reading> + '_ {
        let share = 1.0 / f64::from(self.steps.max(1));
        self.steps = 0;
        self.seen.drain(..).map(move |r| Reading {
            normal_force: r.normal_force * share,
            friction_force: r.friction_force * share,
            ..r
        })
    }
}
