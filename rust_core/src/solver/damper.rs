//! A damper: an impulse that decreases linearly with a speed; every constraint enters a solve as one.
//!
//! The equations: docs/physics.md, "The linear system".

/// Compliance of the dampers, in units of the contact's own admittance.
pub(super) const COMPLIANCE: f64 = 1e-6;

/// An impulse that decreases with the speed along its direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Damper {
    /// [N s] Impulse at zero speed.
    impulse: f64,
    /// [kg] Impulse per speed.
    pub stiffness: f64,
}

impl Damper {
    pub(crate) fn new(impulse: f64, stiffness: f64) -> Self {
        Self { impulse, stiffness }
    }

    /// The same damper about a speed [m/s] other than zero.
    pub(super) fn shifted(self, speed: f64) -> Self {
        Self::new(self.at(-speed), self.stiffness)
    }

    /// A constant impulse, whatever the speed.
    pub(crate) fn constant(impulse: f64) -> Self {
        Self {
            impulse,
            stiffness: 0.0,
        }
    }

    /// [N s] Impulse at a speed.
    pub(crate) fn at(self, speed: f64) -> f64 {
        self.impulse - self.stiffness * speed
    }

    /// A share of it.
    pub(crate) fn times(self, share: f64) -> Self {
        Self::new(self.impulse * share, self.stiffness * share)
    }

    /// Both at one speed.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(
            self.impulse + other.impulse,
            self.stiffness + other.stiffness,
        )
    }

    /// [m/s] Speed at a given impulse.
    pub(super) fn speed_for(self, impulse: f64) -> f64 {
        (self.impulse - impulse) / self.stiffness
    }
}
