//! What a step passes on to the next in addition to the state: where its solves start.
//!
//! The equations: docs/physics.md, "State".

use serde::{Deserialize, Serialize};

use super::Dynamics;
use super::chain::{Chain, ChainImpulses};
use super::identity::Identity;
use crate::contact::Contact;
use crate::geometry::plausible;
use crate::solver::MotorState;
use crate::terrain::Profile;

/// The impulses of one robot; part of a snapshot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Impulses {
    push: Option<f64>,
    motors: Vec<MotorState>,
    pub(super) contacts: Vec<Contact>,
    pub(super) identity: Identity,
    chains: Vec<ChainImpulses>,
}

impl Impulses {
    /// The contacts of the step.
    pub(crate) fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}

impl Dynamics {
    /// The start values of the next step.
    pub(crate) fn impulses(&self) -> Impulses {
        Impulses {
            push: self.push_force,
            motors: self
                .problem
                .motors
                .iter()
                .map(|motor| motor.state)
                .collect(),
            contacts: self.loaded.clone(),
            identity: self.identity.clone(),
            chains: self.chains.iter().map(Chain::impulses).collect(),
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
        } = impulses;
        push.is_some() == self.push_force.is_some()
            && push.is_none_or(|push| plausible(&[push]))
            && motors.len() == self.problem.motors.len()
            && (motors.iter().zip(&self.problem.motors))
                .all(|(hold, motor)| (*hold == MotorState::Absent) == motor.is_none())
            && chains.len() == self.chains.len()
            && chains
                .iter()
                .zip(&self.chains)
                .all(|(i, chain)| chain.fits(i))
            && contacts.iter().all(|l| l.fits(&self.model, lanes))
            && identity.fits(contacts, &self.model, lanes)
    }

    /// Starts from the impulses of a step of the same model, or of the same with a belly.
    pub(crate) fn start_from(&mut self, impulses: Impulses) {
        self.push_force = impulses.push;
        for (motor, hold) in self.problem.motors.iter_mut().zip(impulses.motors) {
            // A branch may have another torque, and so a motor where there was none, or none where there was one.
            if motor.is_none() == (hold == MotorState::Absent) {
                motor.state = hold;
            }
        }
        self.loaded = impulses.contacts;
        self.identity = impulses.identity;
        // The parts of the belly are the last ones (`Model::in_order`).
        let parts = self.model.parts.len();
        self.loaded.retain(|l| l.part < parts);
        self.identity.keep_parts(parts);
        for (chain, impulses) in self.chains.iter_mut().zip(impulses.chains) {
            chain.start_from(impulses);
        }
    }
}
