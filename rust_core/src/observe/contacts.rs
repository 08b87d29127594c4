//! Contact forces averaged over an interval.

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::geometry::plausible;
use crate::robot::Model;
use crate::terrain::Profile;

/// The contacts of an interval, each with the sum of its impulses.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Loads {
    /// [s] Length of the interval so far.
    time: f64,
    /// Each with its last state and with the sums over the interval as its forces.
    seen: Vec<Contact>,
}

impl Loads {
    /// Adds a part of a step, `dt` [s] long.
    pub(crate) fn add(&mut self, loaded: &[Contact], dt: f64) {
        self.time += dt;
        // Contacts come in the same order in each step.
        let mut next = 0;
        for l in loaded.iter().filter(|l| l.normal_force > 0.0) {
            let mut all = (next..self.seen.len()).chain(0..next);
            let known = all.find(|i| self.seen[*i].number == l.number);
            let new = Contact {
                normal_force: l.normal_force * dt,
                friction_force: l.friction_force * dt,
                ..*l
            };
            if let Some(i) = known {
                let sum = self.seen[i];
                self.seen[i] = Contact {
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
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Contact> + '_ {
        let time = std::mem::take(&mut self.time);
        let share = if time > 0.0 { 1.0 / time } else { 0.0 };
        self.seen.drain(..).map(move |l| Contact {
            normal_force: l.normal_force * share,
            friction_force: l.friction_force * share,
            ..l
        })
    }

    /// Whether a robot on these lanes can have produced them.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        plausible(&[self.time])
            && self.time >= 0.0
            && self.seen.iter().all(|l| l.fits(model, lanes))
    }
}
