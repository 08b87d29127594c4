//! The drive of a ring: a motor that pulls at some of its links, or spins a body that they run on.
//!
//! The equations: docs/physics.md, "Chains".

use crate::solver::damper::Damper;

/// Compliance of the drive's damper, in units of its admittance.
const DRIVE_COMPLIANCE: f64 = 1e-8;

/// The drive of one ring.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drive {
    /// The links at which it pulls, if it spins nothing.
    pub grasps: Vec<Grasp>,
    /// [m] The lever at which it turns what spins.
    pub lever: Option<f64>,
    /// [1/kg] Its speed per unit impulse, without hinges.
    pub admittance: f64,
    /// [N s] Its impulse.
    pub impulse: f64,
    /// [N s] Impulse about which a solve damps it.
    pub center: f64,
    /// The impulse that its motor's rotor takes to give it a speed.
    pub rotor: Damper,
}

/// How the drive acts on one link and on the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grasp {
    /// Index in the ring.
    pub link: usize,
    pub on_link: [f64; 3],
    pub on_base: [f64; 3],
}

impl Drive {
    /// Whether there is anything to act on.
    pub(super) fn has_hold(&self) -> bool {
        self.lever.is_some() || !self.grasps.is_empty()
    }

    pub(in crate::solver) fn damper(&self) -> Damper {
        Damper::new(self.center, 1.0 / (DRIVE_COMPLIANCE * self.admittance))
    }

    /// Updates the impulse to match a drive that is so much faster [m/s] than it aims to be; returns the error of its
    /// speed [m/s].
    pub(in crate::solver) fn follow(&mut self, ahead: f64, given: Option<f64>) -> f64 {
        self.impulse = given.unwrap_or_else(|| self.damper().at(ahead));
        if given.is_none() { ahead.abs() } else { 0.0 }
    }
}
