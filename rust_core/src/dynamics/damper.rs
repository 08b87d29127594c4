//! An impulse that falls with a speed: what every constraint is to a solve.

/// Compliance of the dampers, in units of the contact's own admittance.
pub(super) const DAMPING: f64 = 1e-6;

/// An impulse that falls with the speed along its direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Damper {
    /// [N s] At rest.
    impulse: f64,
    /// [kg]
    pub stiffness: f64,
}

impl Damper {
    pub(super) fn new(impulse: f64, stiffness: f64) -> Self {
        Self { impulse, stiffness }
    }

    /// The same about a speed other than rest [m/s].
    pub(super) fn shifted(self, speed: f64) -> Self {
        Self::new(self.at(-speed), self.stiffness)
    }

    /// One that no speed changes.
    pub(super) fn constant(impulse: f64) -> Self {
        Self {
            impulse,
            stiffness: 0.0,
        }
    }

    /// [N s] Its impulse at a speed.
    pub(super) fn at(self, speed: f64) -> f64 {
        self.impulse - self.stiffness * speed
    }

    /// [m/s] The speed at which it has an impulse.
    pub(super) fn speed_for(self, impulse: f64) -> f64 {
        (self.impulse - impulse) / self.stiffness
    }
}
