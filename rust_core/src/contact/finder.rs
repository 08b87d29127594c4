//! The choice between the methods that find contacts.
//!
//! The equations: docs/physics.md, "Contacts".

use super::Contact;
use super::own::OwnContact;
use super::reference::ReferenceContact;
use crate::geometry::Pose;
use crate::robot::{Part, Running};
use crate::scenario::ContactMethod;
use crate::terrain::Profile;

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
