//! Means of contacts: over an interval, and with drives and pose over the last stop windows.
//!
//! While a robot rattles, its forces do not balance at any instant, but their means over a time without
//! progress do.

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use super::Reading;
use crate::contact::Contact;
use crate::dynamics::DriveState;
use crate::geometry::{Pose, Vector, plausible};
use crate::robot::Model;
use crate::terrain::Profile;
use crate::units::Metres;

/// [m] Surfaces closer than this could carry a load, even if they do not.
const TOUCHES: Metres = Metres(1e-6);

/// Sums over the last complete window and the current one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Signals {
    older: WindowSums,
    newer: WindowSums,
}

/// Sums over one window.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct WindowSums {
    start: f64,
    /// [s] Time that it covers.
    time: f64,
    contacts: Vec<ContactSums>,
    drives: Vec<DriveMean>,
    place: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    /// The most by which a coordinate has risen above an earlier value, and fallen below one.
    rise: [f64; 3],
    fall: [f64; 3],
}

/// Sums of one contact.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct ContactSums {
    last: Contact,
    normal_force: f64,
    friction_force: f64,
    point: Vector,
    normal: Vector,
    slip: f64,
    weight: f64,
    loaded: f64,
}

/// Means of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bearing {
    /// The contact, with mean point, normal, forces and surface speed.
    pub contact: Contact,
    /// Share of the time during which it carried a load.
    pub duration: f64,
}

/// Means of a drive.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct DriveMean {
    /// [N] Force of its motor at the surface.
    pub force: f64,
    /// [m/s] Surface speed.
    pub speed: f64,
}

/// Means of a stop.
#[derive(Clone, Debug)]
pub(crate) struct Stance {
    /// [m] Position of the chassis frame.
    pub position: Vector,
    /// [rad] Chassis angle.
    pub angle: f64,
    /// Range of motion of the chassis frame in x [m], y [m] and angle [rad].
    pub range: [f64; 3],
    /// The same there and back again: 0 while it moves one way.
    pub swing: [f64; 3],
    /// Contacts that carry or could carry a load.
    pub bearings: Vec<Bearing>,
    /// One for each drive.
    pub drives: Vec<DriveMean>,
}

impl Stance {
    /// Pose of the chassis frame.
    pub(crate) fn pose(&self) -> Pose {
        Pose::new(self.position, self.angle)
    }

    /// Contacts that carry a load.
    pub(crate) fn loaded(&self) -> impl Iterator<Item = &Bearing> {
        self.bearings
            .iter()
            .filter(|b| b.contact.normal_force > 0.0)
    }
}

impl Signals {
    /// Adds a part of a step, `dt` [s] long; `window` [s] is the stop window.
    pub(crate) fn add(
        &mut self,
        (now, dt): (&Reading, f64),
        loaded: &[Contact],
        drives: impl Iterator<Item = (DriveState, f64)>,
        window: f64,
    ) {
        if now.time - self.newer.start >= window {
            self.older = std::mem::take(&mut self.newer);
            self.newer.start = now.time;
        }
        self.newer.add((now, dt), loaded, drives);
    }

    /// Whether they can come from a robot on these lanes.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        [&self.older, &self.newer].into_iter().all(|block| {
            let numbers = [block.place, block.low, block.high, block.rise, block.fall].concat();
            block.drives.len() <= model.drives
                && block.start.is_finite()
                && (0.0..1e15).contains(&block.time)
                && numbers.iter().all(|number| number.is_finite())
                && block.contacts.iter().all(|c| c.fits(model, lanes))
                && block.numbers_differ()
        })
    }

    /// The means over both windows.
    pub(crate) fn stance(&self) -> Stance {
        let mut sum = self.older.clone();
        sum.absorb(&self.newer);
        let share = if sum.time > 0.0 { 1.0 / sum.time } else { 0.0 };
        Stance {
            position: Vector::new(sum.place[0], sum.place[1]) * share,
            angle: sum.place[2] * share,
            range: std::array::from_fn(|i| sum.high[i] - sum.low[i]),
            swing: std::array::from_fn(|i| sum.rise[i].min(sum.fall[i])),
            bearings: sum.contacts.iter().map(|c| c.mean(share)).collect(),
            drives: sum
                .drives
                .iter()
                .map(|d| DriveMean {
                    force: d.force * share,
                    speed: d.speed * share,
                })
                .collect(),
        }
    }
}

impl WindowSums {
    fn numbers_differ(&self) -> bool {
        let mut seen = HashSet::new();
        let mut numbers = self.contacts.iter().map(|c| c.last.number);
        numbers.all(|number| seen.insert(number))
    }

    fn add(
        &mut self,
        (now, dt): (&Reading, f64),
        loaded: &[Contact],
        drives: impl Iterator<Item = (DriveState, f64)>,
    ) {
        let here = [now.position.x, now.position.y, now.chassis_angle];
        if self.time == 0.0 {
            (self.low, self.high) = (here, here);
        }
        self.time += dt;
        for (i, value) in here.into_iter().enumerate() {
            self.place[i] += value * dt;
            self.low[i] = self.low[i].min(value);
            self.high[i] = self.high[i].max(value);
            self.rise[i] = self.rise[i].max(value - self.low[i]);
            self.fall[i] = self.fall[i].max(self.high[i] - value);
        }
        for (k, (drive, speed)) in drives.enumerate() {
            if k == self.drives.len() {
                self.drives.push(DriveMean::default());
            }
            self.drives[k].force += drive.force * dt;
            self.drives[k].speed += speed * dt;
        }
        let bears = |l: &&Contact| l.normal_force > 0.0 || l.distance < TOUCHES.value();
        for l in loaded.iter().filter(bears) {
            self.gather(&ContactSums::new(l, dt));
        }
    }

    /// Adds a contact to its sums.
    fn gather(&mut self, new: &ContactSums) {
        let number = new.last.number;
        let mut known = self.contacts.iter_mut();
        match known.find(|c| c.last.number == number) {
            Some(known) => known.absorb(new),
            None => self.contacts.push(*new),
        }
    }

    fn absorb(&mut self, later: &Self) {
        if later.time == 0.0 {
            return;
        }
        if self.time == 0.0 {
            *self = later.clone();
            return;
        }
        self.time += later.time;
        for i in 0..3 {
            self.place[i] += later.place[i];
            let (rise, fall) = (later.high[i] - self.low[i], self.high[i] - later.low[i]);
            self.rise[i] = self.rise[i].max(later.rise[i]).max(rise);
            self.fall[i] = self.fall[i].max(later.fall[i]).max(fall);
            self.low[i] = self.low[i].min(later.low[i]);
            self.high[i] = self.high[i].max(later.high[i]);
        }
        for (sum, more) in self.drives.iter_mut().zip(&later.drives) {
            sum.force += more.force;
            sum.speed += more.speed;
        }
        for new in &later.contacts {
            self.gather(new);
        }
    }
}

impl ContactSums {
    fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let sums = [
            self.normal_force,
            self.friction_force,
            self.slip,
            self.loaded,
        ];
        self.last.fits(model, lanes)
            && self.weight > 0.0
            && self.point.is_finite()
            && self.normal.is_finite()
            && sums.iter().all(|sum| sum.is_finite())
    }

    fn new(l: &Contact, dt: f64) -> Self {
        /// [N] Less than any force that counts, so that contacts without force have a mean position, too.
        const FAINT: f64 = 1e-30;

        let weight = l.normal_force.max(FAINT) * dt;
        Self {
            last: *l,
            normal_force: l.normal_force * dt,
            friction_force: l.friction_force * dt,
            point: l.point * weight,
            normal: l.normal * weight,
            slip: l.surface_speed * weight,
            weight,
            loaded: if l.normal_force > 0.0 { dt } else { 0.0 },
        }
    }

    fn absorb(&mut self, later: &Self) {
        self.last = later.last;
        self.normal_force += later.normal_force;
        self.friction_force += later.friction_force;
        self.point += later.point;
        self.normal += later.normal;
        self.slip += later.slip;
        self.weight += later.weight;
        self.loaded += later.loaded;
    }

    fn mean(&self, share: f64) -> Bearing {
        Bearing {
            contact: Contact {
                point: self.point / self.weight,
                normal: self.normal.normalize(),
                normal_force: self.normal_force * share,
                friction_force: self.friction_force * share,
                surface_speed: self.slip / self.weight,
                ..self.last
            },
            duration: self.loaded * share,
        }
    }
}

/// The contacts of an interval, each with the sum of its impulses.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Loads {
    /// [s] Length of the interval so far.
    time: f64,
    /// Contacts, each with its last state and with sums over the interval as its forces.
    contacts: Vec<Contact>,
}

impl Loads {
    /// Adds a part of a step, `dt` [s] long.
    pub(crate) fn add(&mut self, loaded: &[Contact], dt: f64) {
        self.time += dt;
        // Contacts come in the same order in each step.
        let mut next = 0;
        for l in loaded.iter().filter(|l| l.normal_force > 0.0) {
            let mut all = (next..self.contacts.len()).chain(0..next);
            let known = all.find(|i| self.contacts[*i].number == l.number);
            let new = Contact {
                normal_force: l.normal_force * dt,
                friction_force: l.friction_force * dt,
                ..*l
            };
            if let Some(i) = known {
                let sum = self.contacts[i];
                self.contacts[i] = Contact {
                    normal_force: sum.normal_force + new.normal_force,
                    friction_force: sum.friction_force + new.friction_force,
                    ..new
                };
                next = i + 1;
            } else {
                self.contacts.push(new);
            }
        }
    }

    /// Number of contacts in the interval so far.
    pub(crate) fn count(&self) -> usize {
        self.contacts.len()
    }

    /// Returns the means, in the order in which contacts first appeared, and starts a new interval.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Contact> + '_ {
        let time = std::mem::take(&mut self.time);
        let share = if time > 0.0 { 1.0 / time } else { 0.0 };
        self.contacts.drain(..).map(move |l| Contact {
            normal_force: l.normal_force * share,
            friction_force: l.friction_force * share,
            ..l
        })
    }

    /// Whether they can come from a robot on these lanes.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        plausible(&[self.time])
            && self.time >= 0.0
            && self.contacts.iter().all(|l| l.fits(model, lanes))
    }
}

#[cfg(test)]
mod tests;
