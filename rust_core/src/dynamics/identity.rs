//! Identity of contacts: each has a number for as long as it lasts, by which everything refers to it.
//!
//! Contacts are paired with those of the last step, nearest first, and keep their numbers. A contact that opens wider than
//! the search distance and closes again at the same place is still the same contact, but its forces are lost. Otherwise
//! each contact of a rattling robot would be counted many times.
//!
//! The equations: docs/physics.md, "Contacts".

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use crate::contact::Contact;
use crate::geometry::{Vector, plausible};
use crate::robot::Model;
use crate::terrain::Profile;
use crate::units::{Metres, Seconds};

/// [m] A contact may continue one that is no farther away than this.
const SAME_PLACE: Metres = Metres(5e-3);
/// Least cosine between the normals of a contact in two steps: a normal turns by less than 26 degrees in one.
const SAME_NORMAL: f64 = 0.9;
/// [s] How long a lost contact is remembered: the default window of a stop, over which forces are averaged.
const REMEMBERED: Seconds = Seconds(1.0);
/// Maximum number of lost contacts. Runs have about ten, those with 24 gear wheels up to 240; there are more only if
/// everything moves so fast that no contact is at the place of another.
const MOST_LOST: usize = 256;
/// A number that no run reaches, with room for more above it.
const MOST_GIVEN: u64 = 1 << 60;

/// Remembered contacts, in addition to those of the last step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Identity {
    /// The last number given; the first is 1.
    given: u64,
    /// [s] Duration of all steps.
    time: f64,
    /// Contacts that have opened, the oldest first.
    lost: Vec<Lost>,
    /// The contacts that a step has recognised; adopted once the step is kept.
    #[serde(skip)]
    found: Found,
}

/// The contacts that were recognised in a step.
#[derive(Clone, Debug, Default)]
struct Found {
    /// The last number given.
    given: u64,
    /// Which contacts of the last step are still there.
    taken: Vec<bool>,
    /// Which lost contacts have closed again.
    again: Vec<bool>,
    /// [m] Distances between contacts and those of the last step, with the indices of both.
    pairs: Vec<(f64, usize, usize)>,
}

/// A contact that has opened.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Lost {
    /// Its last state.
    contact: Contact,
    /// [s] When it opened.
    opened: f64,
}

impl Found {
    /// The contacts of the `last` step that are gone.
    fn gone<'a>(&'a self, last: &'a [Contact]) -> impl Iterator<Item = &'a Contact> {
        let both = last.iter().zip(&self.taken);
        both.filter_map(|(l, taken)| (!taken).then_some(l))
    }
}

impl Identity {
    /// Numbers the contacts of a step in which nothing moves farther than `travel` [m] after the `last` one; both are
    /// sorted by part and x.
    pub(super) fn recognise(&mut self, last: &[Contact], contacts: &mut [Contact], travel: f64) {
        let near = SAME_PLACE.value().max(2.0 * travel);
        let found = &mut self.found;
        found.given = self.given;
        found.taken.clear();
        found.taken.resize(last.len(), false);
        found.again.clear();
        found.again.resize(self.lost.len(), false);
        self.pair(last, contacts, near);
        for contact in contacts.iter_mut().filter(|c| c.number == 0) {
            contact.number = self.find_again(contact).unwrap_or_else(|| {
                self.found.given += 1;
                self.found.given
            });
        }
    }

    /// The contacts of the `last` step that were not recognised.
    pub(super) fn gone<'a>(&'a self, last: &'a [Contact]) -> impl Iterator<Item = &'a Contact> {
        self.found.gone(last)
    }

    /// Keeps what was recognised in a step of `h` [s] after the `last` one.
    pub(super) fn keep(&mut self, last: &[Contact], h: f64) {
        let found = &self.found;
        self.given = found.given;
        self.time += h;
        let now = self.time;
        if found.again.contains(&true) {
            let mut again = found.again.iter();
            self.lost.retain(|_| again.next() != Some(&true));
        }
        let forgotten = |lost: &Lost| now - lost.opened >= REMEMBERED.value();
        let too_old = self.lost.iter().take_while(|lost| forgotten(lost)).count();
        self.lost.drain(..too_old);
        let gone = found.gone(last);
        self.lost.extend(gone.map(|l| Lost {
            contact: *l,
            opened: now,
        }));
        let too_many = self.lost.len().saturating_sub(MOST_LOST);
        self.lost.drain(..too_many);
    }

    /// Forgets the contacts of all but the first parts.
    pub(super) fn keep_parts(&mut self, parts: usize) {
        self.lost.retain(|lost| lost.contact.part < parts);
    }

    /// Pairs contacts with those of the last step that are near enough, the nearest first; each is in one pair.
    fn pair(&mut self, last: &[Contact], contacts: &mut [Contact], near: f64) {
        let Found { taken, pairs, .. } = &mut self.found;
        pairs.clear();
        let mut from = 0;
        for (i, contact) in contacts.iter().enumerate() {
            let place = (contact.part, contact.point.x);
            // What is too far left for this contact is so for all that follow.
            let behind = |l: &Contact| (l.part, l.point.x + near) < place;
            from += last[from..].iter().take_while(|l| behind(l)).count();
            let within = |l: &&Contact| (l.part, l.point.x - near) <= place;
            for (k, known) in (from..).zip(last[from..].iter().take_while(within)) {
                let apart = distance(contact, (known.point, known.normal));
                pairs.extend(
                    apart
                        .filter(|apart| *apart < near)
                        .map(|apart| (apart, i, k)),
                );
            }
        }
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for &(_, i, k) in pairs.iter() {
            let (contact, known) = (&mut contacts[i], &last[k]);
            if contact.number == 0 && !taken[k] {
                taken[k] = true;
                (contact.number, contact.began) = (known.number, known.began);
            }
        }
    }

    /// The number of the nearest lost contact, if it is near enough.
    fn find_again(&mut self, contact: &Contact) -> Option<u64> {
        let of_part = (self.lost.iter().enumerate())
            .filter(|(i, lost)| lost.contact.part == contact.part && !self.found.again[*i]);
        let places = of_part.flat_map(|(i, lost)| {
            let lost = &lost.contact;
            [lost.point, lost.began].map(|place| (i, place, lost.normal))
        });
        let apart =
            places.filter_map(|(i, place, normal)| Some((distance(contact, (place, normal))?, i)));
        let (_, nearest) = apart
            .filter(|(apart, _)| *apart < SAME_PLACE.value())
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.found.again[nearest] = true;
        Some(self.lost[nearest].contact.number)
    }

    /// Whether these can be the contacts of a step; no two known contacts may share a number.
    pub(super) fn fits(&self, last: &[Contact], model: &Model, lanes: &[Profile]) -> bool {
        let fits = |lost: &Lost| {
            let age = self.time - lost.opened;
            lost.contact.fits(model, lanes) && (0.0..REMEMBERED.value()).contains(&age)
        };
        let last = last.iter().map(|l| l.number);
        let lost = self.lost.iter().map(|lost| lost.contact.number);
        let mut numbers: Vec<u64> = last.chain(lost).collect();
        numbers.sort_unstable();
        self.given <= MOST_GIVEN
            && plausible(&[self.time])
            && self.lost.len() <= MOST_LOST
            && self.lost.iter().all(fits)
            && self.lost.is_sorted_by(|a, b| a.opened <= b.opened)
            && numbers
                .iter()
                .all(|number| (1..=self.given).contains(number))
            && numbers.windows(2).all(|pair| pair[0] < pair[1])
    }
}

/// [m] Distance of a contact from a known place, if their normals are nearly the same.
fn distance(contact: &Contact, (place, normal): (Vector, Vector)) -> Option<f64> {
    (normal.dot(contact.normal) > SAME_NORMAL).then(|| (place - contact.point).length())
}

/// The contacts of the last step, looked up by number.
pub(super) struct Numbered<'a> {
    contacts: &'a [Contact],
    /// Likely index of the next one, as contacts come in the same order as in the last step.
    next: usize,
}

impl<'a> Numbered<'a> {
    pub(super) fn new(contacts: &'a [Contact]) -> Self {
        Self { contacts, next: 0 }
    }

    /// The contact with a number, if the last step had it.
    pub(super) fn get(&mut self, number: u64) -> Option<Contact> {
        let mut all = (self.next..self.contacts.len()).chain(0..self.next);
        let found = all.find(|i| self.contacts[*i].number == number)?;
        self.next = found + 1;
        Some(self.contacts[found])
    }
}
