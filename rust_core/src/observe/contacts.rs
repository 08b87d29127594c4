//! Contact forces averaged over an interval.

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::dynamics::LoadedContact;
use crate::geometry::plausible;
use crate::robot::Model;
use crate::terrain::Profile;

/// The contacts of an interval, each with the sum of its impulses.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Loads {
    /// [s] Length of the interval so far.
    time: f64,
    seen: Vec<Load>,
}

/// One contact during the interval.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Load {
    /// Its last state.
    pub contact: Contact,
    /// [N] Mean over the interval.
    pub normal_force: f64,
    /// [N] Mean over the interval.
    pub friction_force: f64,
    /// [m/s] Last value.
    pub surface_speed: f64,
}

impl Loads {
    /// Adds a part of a step, `dt` [s] long.
    pub(crate) fn add(&mut self, loaded: &[LoadedContact], dt: f64) {
        self.time += dt;
        // Contacts come in the same order in each step.
        let mut next = 0;
        for l in loaded.iter().filter(|l| l.normal_force > 0.0) {
            let mut all = (next..self.seen.len()).chain(0..next);
            let known = all.find(|i| self.seen[*i].contact.number == l.contact.number);
            let new = Load {
                contact: l.contact,
                normal_force: l.normal_force * dt,
                friction_force: l.friction_force * dt,
                surface_speed: l.surface_speed,
            };
            if let Some(i) = known {
                let sum = self.seen[i];
                self.seen[i] = Load {
                    normal_force: sum.normal_force + new.normal_force,
                    friction_force: sum.friction_force + new.friction_force,
                    ..new
                };
                next = i + 1;
            } else {
                self.seen.push(new);
            }
        }
    }

    /// Number of contacts in the interval so far.
    pub(crate) fn count(&self) -> usize {
        self.seen.len()
    }

    /// Returns the means, in the order in which contacts first appeared, and starts a new interval.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Load> + '_ {
        let time = std::mem::take(&mut self.time);
        let share = if time > 0.0 { 1.0 / time } else { 0.0 };
        self.seen.drain(..).map(move |l| Load {
            normal_force: l.normal_force * share,
            friction_force: l.friction_force * share,
            ..l
        })
    }

    /// Whether a robot on these lanes can have produced them.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let fits = |l: &Load| {
            let numbers = [l.normal_force, l.friction_force, l.surface_speed];
            l.contact.fits(model, lanes) && plausible(&numbers)
        };
        plausible(&[self.time]) && self.time >= 0.0 && self.seen.iter().all(fits)
    }
}
