//! The bodies: their inertia, and whether they turn with the base.
//!
//! The equations: docs/physics.md, "The problem".

use super::damper::Damper;
use super::direction::Direction;
use super::velocities::{ActsOn, Velocities};

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
    /// [kg m^2] Moment of inertia of the motor that turns it, which turns over the base alone.
    pub rotor: f64,
    /// [rad/s] Rate over the base at which a motor holds it.
    pub(super) held: Option<f64>,
}

impl Spin {
    pub(crate) fn new(inertia: f64, rotor: f64) -> Self {
        Self {
            inertia,
            rotor,
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

/// Inertia along one direction: of a body that is hinged to the base, or of a motor's rotor, which turns over the base.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inertia {
    pub acts: ActsOn,
    pub along: Direction,
    /// The impulse that it takes to give it a speed along that.
    pub damper: Damper,
}

impl Inertia {
    /// One of `inertia` [kg] along a direction, with a speed there without constraints [m/s].
    pub(crate) fn new(acts: ActsOn, along: Direction, inertia: f64, free: f64) -> Self {
        Self {
            acts,
            along,
            damper: Damper::new(inertia * free, inertia),
        }
    }

    /// That of a rotor [kg m^2], with its rate over the base without constraints [rad/s].
    pub(crate) fn of_rotor(on: ActsOn, inertia: f64, free: f64) -> Self {
        Self::new(on, on.over_base(1.0), inertia, free)
    }

    /// The impulse that has changed its speed.
    pub(super) fn gained(&self, velocities: &Velocities) -> f64 {
        -self.damper.at(self.acts.speed(&self.along, velocities))
    }
}
