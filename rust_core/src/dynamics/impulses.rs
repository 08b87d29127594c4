//! What a step passes on to the next besides the state: the start values of its solves.
//!
//! The equations: docs/physics.md, "State".

use serde::{Deserialize, Serialize};

use super::Dynamics;
use super::LoadedContact;
use super::chain::{Chain, ChainImpulses};
use super::identity::Identity;
use super::motor::Motor;
use crate::contact::Contact;
use crate::geometry::plausible;
use crate::terrain::Profile;

/// The impulses of one robot; part of a snapshot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Impulses {
    push: Option<f64>,
    motors: Vec<Motor>,
    pub(super) contacts: Vec<LoadedContact>,
    pub(super) identity: Identity,
    chains: Vec<ChainImpulses>,
    flippers: Vec<Motor>,
}

impl Impulses {
    /// The contacts of the step.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.contacts.iter().map(|l| &l.contact)
    }
}

impl Dynamics {
    /// The start values of the next step.
    pub(crate) fn impulses(&self) -> Impulses {
        Impulses {
            push: self.push.as_ref().map(|push| push.force),
            motors: self.motors.clone(),
            contacts: self.loaded.clone(),
            identity: self.identity.clone(),
            chains: self.chains.iter().map(Chain::impulses).collect(),
            flippers: self.flippers.iter().map(|arm| arm.motor).collect(),
        }
    }

    /// Whether a step of this model can have left these impulses.
    pub(crate) fn fits(&self, impulses: &Impulses, lanes: &[Profile]) -> bool {
        let Impulses {
            push,
            motors,
            contacts,
            identity,
            chains,
            flippers,
        } = impulses;
        push.is_some() == self.push.is_some()
            && push.is_none_or(|push| plausible(&[push]))
            && motors.len() == self.motors.len()
            && flippers.len() == self.flippers.len()
            && chains.len() == self.chains.len()
            && chains
                .iter()
                .zip(&self.chains)
                .all(|(i, chain)| chain.fits(i))
            && contacts.iter().all(|l| l.fits(&self.model, lanes))
            && identity.fits(contacts, &self.model, lanes)
    }

    /// Starts from the impulses that a step left of the same model, or of one that had a belly besides.
    pub(crate) fn start_from(&mut self, impulses: Impulses) {
        if let (Some(push), Some(force)) = (&mut self.push, impulses.push) {
            push.force = force;
        }
        self.motors = impulses.motors;
        self.loaded = impulses.contacts;
        self.identity = impulses.identity;
        // The belly is the last part.
        let parts = self.model.parts.len();
        self.loaded.retain(|l| l.contact.part < parts);
        self.identity.keep_parts(parts);
        for (chain, impulses) in self.chains.iter_mut().zip(impulses.chains) {
            chain.start_from(impulses);
        }
        for (arm, motor) in self.flippers.iter_mut().zip(impulses.flippers) {
            arm.motor = motor;
        }
    }
}
