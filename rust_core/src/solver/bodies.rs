//! The bodies: their inertia, and whether they turn with the base.
//!
//! The equations: docs/physics.md, "The problem".

use super::damper::Damper;
use super::direction::Direction;
use super::velocities::Acts;

/// The base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Base {
    /// [kg]
    pub mass: f64,
    /// [kg m^2] Moment of inertia, without what turns with it.
    pub inertia: f64,
}

/// A body that spins on the base, or on what is hinged to it: its mass counts there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spin {
    /// [kg m^2]
    pub inertia: f64,
    /// [rad/s] Rate over the base at which a motor holds it.
    pub(super) held: Option<f64>,
}

impl Spin {
    pub(crate) fn new(inertia: f64) -> Self {
        Self {
            inertia,
            held: None,
        }
    }
}

/// What is hinged to the base, as contacts on it feel it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// [kg m^2] Moment of inertia about the hinge, ...
    pub inertia: f64,
    /// [kg] ... and mass; infinite where the other alone counts.
    pub mass: f64,
    /// [rad/s] Rate over the base at which a motor holds it.
    pub(super) held: Option<f64>,
}

impl Joint {
    pub(crate) fn new(inertia: f64, mass: f64) -> Self {
        Self {
            inertia,
            mass,
            held: None,
        }
    }
}

/// One degree of freedom of the inertia of a body that is hinged to the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hung {
    pub joint: usize,
    pub along: Direction,
    /// The impulse that it takes to give it a speed along that.
    pub inertia: Damper,
}

impl Hung {
    pub(super) fn acts(&self) -> Acts {
        on_joint(self.joint)
    }
}

/// What acts on the base and a body hinged to it.
pub(super) fn on_joint(joint: usize) -> Acts {
    Acts::Base {
        joint: Some(joint),
        spin: None,
    }
}
