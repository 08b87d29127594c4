//! A damper: an impulse that decreases linearly with a speed; every constraint enters a solve as one.
//!
//! The equations: docs/physics.md, "The linear system".

use super::row::Row;

/// Compliance of the dampers of a contact: along the normal in units of the admittance of its spring, along the tangent of
/// its own.
pub(super) const COMPLIANCE: f64 = 1e-6;

/// An impulse that decreases with the speed along its direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Damper {
    /// [N s] Impulse at zero speed.
    impulse: f64,
    /// [kg] Loss of impulse per speed.
    pub damping: f64,
}

impl Damper {
    pub(crate) fn new(impulse: f64, damping: f64) -> Self {
        Self { impulse, damping }
    }

    /// A constant impulse, whatever the speed.
    pub(crate) fn constant(impulse: f64) -> Self {
        Self::new(impulse, 0.0)
    }

    /// [N s] Impulse at a speed.
    pub(crate) fn at(self, speed: f64) -> f64 {
        self.impulse - self.damping * speed
    }

    /// A share of it.
    pub(crate) fn times(self, share: f64) -> Self {
        Self::new(self.impulse * share, self.damping * share)
    }

    /// The sum of both at the same speed.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(self.impulse + other.impulse, self.damping + other.damping)
    }
}

/// Inertia along a direction, of a body that is hinged to the base or of a motor's rotor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inertia {
    pub row: Row,
    /// The impulse with which it acts at a speed along that row.
    pub damper: Damper,
    /// The row with what motors hold tied to the base.
    pub(super) action: Row,
}

impl Inertia {
    /// One of `inertia` [kg] along a row, with a speed there without constraints [m/s].
    pub(crate) fn new(row: Row, inertia: f64, free: f64) -> Self {
        Self {
            row,
            damper: Damper::new(inertia * free, inertia),
            action: row,
        }
    }

    /// [J] Its kinetic energy without constraints.
    pub(super) fn energy(&self) -> f64 {
        let momentum = self.damper.at(0.0);
        0.5 * momentum * momentum / self.damper.damping
    }

    /// [N s] Its impulse at these velocities.
    pub(super) fn impulse(&self, unknowns: &[f64]) -> f64 {
        self.damper.at(self.row.along(unknowns))
    }
}

/// A direction in which nothing moves, whatever impulse that takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bilateral {
    pub row: Row,
    /// [N s] Impulse along it.
    pub impulse: f64,
    /// [N s] Impulse about which its damper acts.
    pub(super) center: f64,
    /// The row with what motors hold tied to the base.
    pub(super) action: Row,
    /// [1/kg] Velocity per unit impulse along it.
    pub(super) admittance: f64,
}

impl Bilateral {
    pub(crate) fn new(row: Row) -> Self {
        Self {
            row,
            impulse: 0.0,
            center: 0.0,
            action: row,
            admittance: 0.0,
        }
    }

    pub(super) fn damper(&self) -> Damper {
        Damper::new(self.center, 1.0 / (COMPLIANCE * self.admittance))
    }

    /// Updates the impulse to match the velocities; returns the error of the velocity [m/s].
    pub(super) fn apply_law(&mut self, unknowns: &[f64]) -> f64 {
        let slip = self.action.speed(unknowns);
        self.impulse = self.damper().at(slip);
        slip.abs()
    }
}
