//! Finds the contacts of a robot, either by our own exact method, with outlines of parts against faces and corners of
//! the lane, or by the reference method.
//!
//! Contacts depend only on the current pose: nothing is stored, and only the list of contacts is allocated.
//!
//! The equations: docs/physics.md, "Contacts".

use super::Contact;
use super::gear::GearContact;
use super::hull::HullContact;
use super::lane::{Lane, SHALLOW};
use super::redundant::{thin_out, without_redundant};
use super::reference::ReferenceContact;
use crate::geometry::{Disc, Grouser, Pose};
use crate::robot::{Mount, Part, Running, Shape};
use crate::scenario::ContactMethod;
use crate::terrain::Profile;

#[cfg(test)]
mod tests;

/// The outlines of one robot and the lanes of one ground.
pub(crate) struct OwnContact {
    lanes: Vec<Lane>,
    /// Outlines, each with the index of its lane and its mount.
    outlines: Vec<(usize, Mount, Outline)>,
}

/// The outline of a part for contacts.
enum Outline {
    Disc(usize, Disc),
    Gear {
        drive: usize,
        gear: GearContact,
    },
    Grouser {
        drive: usize,
        grouser: Grouser,
        /// The hull in its own frame.
        hull: HullContact,
    },
    Hull(HullContact),
}

impl OwnContact {
    /// Prepares the outlines of a robot's parts and the lanes under them.
    pub(crate) fn new(parts: &[Part], lanes: &[Profile]) -> Self {
        let outline = |i: usize, part: &Part| match (&part.shape, part.drive) {
            (Shape::Gear { center, gear }, Some(drive)) => Outline::Gear {
                drive,
                gear: GearContact::new(i, *center, *gear),
            },
            (Shape::Grouser(grouser), Some(drive)) => Outline::Grouser {
                drive,
                grouser: grouser.clone(),
                hull: HullContact::new(i, part),
            },
            (&Shape::Disc { center, radius }, _) => Outline::Disc(i, Disc { center, radius }),
            _ => Outline::Hull(HullContact::new(i, part)),
        };
        Self {
            lanes: lanes.iter().map(Lane::new).collect(),
            outlines: parts
                .iter()
                .enumerate()
                .map(|(i, part)| (part.lane, part.mount, outline(i, part)))
                .collect(),
        }
    }

    /// Adds every contact with a gap below `prediction` to `contacts`.
    pub(crate) fn find(
        &self,
        pose: Pose,
        running: &Running,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        for (lane, mount, outline) in &self.outlines {
            let (lane, pose) = (&self.lanes[*lane], running.mounted(*mount, pose));
            match outline {
                Outline::Disc(part, disc) => {
                    let (center, radius) = (pose.transform_point(disc.center), disc.radius);
                    let (reach, first) = ((prediction, SHALLOW.value()), contacts.len());
                    let far = radius + prediction;
                    let region = lane.region(center.x - far, center.x + far);
                    lane.touches_of_disc(&region, center, radius, reach, |touch| {
                        contacts.push(touch.contact(*part));
                    });
                    thin_out(contacts, first, lane, &Disc { center, radius }, prediction);
                }
                Outline::Gear { drive, gear } => {
                    let run = running.run(*mount, *drive);
                    gear.find(lane, pose, run, prediction, contacts);
                }
                Outline::Grouser {
                    drive,
                    grouser,
                    hull,
                } => {
                    let place = pose * grouser.place(running.run(*mount, *drive));
                    hull.find(lane, place, prediction, contacts);
                }
                Outline::Hull(hull) => hull.find(lane, pose, prediction, contacts),
            }
        }
        without_redundant(contacts);
    }
}

/// Finds the contacts of one robot on one ground.
pub(crate) enum ContactFinder {
    Own(OwnContact),
    Reference(Box<ReferenceContact>),
}

impl ContactFinder {
    pub(crate) fn new(method: ContactMethod, parts: &[Part], lanes: &[Profile]) -> Self {
        match method {
            ContactMethod::Own => Self::Own(OwnContact::new(parts, lanes)),
            ContactMethod::Reference => {
                Self::Reference(Box::new(ReferenceContact::new(parts, lanes)))
            }
        }
    }

    /// Writes every contact with a gap below `prediction` [m] into `contacts`, in a stable order.
    pub(crate) fn find(
        &mut self,
        pose: Pose,
        running: &Running,
        prediction: f64,
        contacts: &mut Vec<Contact>,
    ) {
        match self {
            Self::Own(own) => own.find(pose, running, prediction, contacts),
            Self::Reference(reference) => reference.find(pose, running, prediction, contacts),
        }
    }
}
