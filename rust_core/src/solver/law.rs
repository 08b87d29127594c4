//! Coulomb's law with softness: the grip and the impulses of a contact at given velocities, the constraints of a grip, and
//! the conditions under which it holds. No other file of the solver knows the limit of friction.
//!
//! The equations: docs/physics.md, "Coulomb's law".

use super::Contact;
use super::damper::{COMPLIANCE, Damper};
use super::direction::Direction;
use super::grip::Grip;
use super::settling::beyond;

impl Contact {
    /// Makes the current impulses the ones about which the contact is damped.
    pub(super) fn settle(&mut self) {
        self.center.0 = self.normal_impulse;
        if self.give == 0.0 {
            self.center.1 = self.friction_impulse;
        }
        self.place_dampers();
    }

    /// Takes the impulses ahead by so many times their change, as far as Coulomb's law lets them.
    pub(super) fn lead(&mut self, times: f64) {
        let (normal, friction) = self.center;
        self.normal_impulse = beyond(normal, self.normal_impulse, times).max(0.0);
        let limit = self.friction.coefficient * self.normal_impulse;
        self.friction_impulse = beyond(friction, self.friction_impulse, times).clamp(-limit, limit);
    }

    /// Goes back to the impulses about which the contact is damped.
    pub(super) fn unsettle(&mut self) {
        (self.normal_impulse, self.friction_impulse) = self.center;
    }

    /// Sets the dampers about their centres.
    pub(super) fn place_dampers(&mut self) {
        let (normal, friction) = self.center;
        let proximal = self.proximal();
        let damping = proximal * self.admittance.spring;
        let stiffness = 1.0 / (self.compliance * self.admittance.spring + damping);
        self.dampers = [
            Damper::new(stiffness * (damping * normal - self.bias), stiffness),
            Damper::new(
                friction,
                1.0 / ((self.give + proximal) * self.admittance.tangent),
            ),
        ];
    }

    /// Updates impulses and fitting grip for speeds along normal and tangent [m/s]; returns the error of the
    /// velocity [m/s].
    pub(super) fn follow_speeds(&mut self, speeds: [f64; 2]) -> f64 {
        let (grip, [normal, friction]) = self.law(speeds);
        self.fitting = grip;
        self.normal_impulse = normal;
        self.friction_impulse = friction;
        let off_normal = (normal - self.center.0).abs() * self.admittance.normal;
        let off_tangent = (friction - self.center.1).abs() * self.admittance.tangent;
        let off = match grip {
            Grip::Open => 0.0,
            Grip::Sticks if self.give == 0.0 => off_normal.max(off_tangent),
            _ => off_normal,
        };
        self.proximal() * off
    }

    /// Compliance of its damper about the last impulses; one that gives way elastically needs none.
    fn proximal(&self) -> f64 {
        if self.give == 0.0 { COMPLIANCE } else { 0.0 }
    }

    /// The grip at these speeds, and the impulses along normal and tangent [N s].
    pub(super) fn law(&self, [approach, slip]: [f64; 2]) -> (Grip, [f64; 2]) {
        let [n, t] = self.dampers;
        let (normal, friction) = (n.at(approach), t.at(slip));
        let limit = self.friction.coefficient * normal;
        let (grip, friction) = if normal <= 0.0 {
            (Grip::Open, 0.0)
        } else if friction > limit || limit == 0.0 {
            // Without friction the direction of slip makes no difference.
            (Grip::Forwards, limit)
        } else if friction < -limit {
            (Grip::Backwards, -limit)
        } else {
            (Grip::Sticks, friction)
        };
        (grip, [normal.max(0.0), friction])
    }

    /// [N s] Impulses along normal and tangent at these speeds for the guessed grip.
    pub(super) fn guessed(&self, [approach, slip]: [f64; 2]) -> [f64; 2] {
        let [n, t] = self.dampers;
        let normal = n.at(approach);
        match self.grip {
            Grip::Open => [0.0, 0.0],
            Grip::Sticks => [normal, t.at(slip)],
            Grip::Forwards => [normal, self.friction.coefficient * normal],
            Grip::Backwards => [normal, -self.friction.coefficient * normal],
        }
    }

    /// [m/s] How far apart the law and the guessed grip are at these speeds, by what their impulses do to the speeds.
    pub(super) fn misfit(&self, speeds: [f64; 2]) -> f64 {
        if self.fitting == self.grip {
            return 0.0;
        }
        let (held, [n, t]) = (self.guessed(speeds), self.impulses());
        let of_normal = (n - held[0]).abs() * self.admittance.normal;
        of_normal.max((t - held[1]).abs() * self.admittance.tangent)
    }

    /// Calls `found` with the constraints of the guessed state: the impulse of each acts along the first of two directions,
    /// with a damper along the second.
    #[inline]
    pub(super) fn constraints(&self, mut found: impl FnMut([&Direction; 2], Damper)) {
        let ([normal, tangent], [n, t]) = (&self.actions, self.dampers);
        let coefficient = self.friction.coefficient;
        match self.grip {
            Grip::Open => {}
            Grip::Sticks => {
                found([normal; 2], n);
                found([tangent; 2], t);
            }
            Grip::Forwards => found([&normal.plus(tangent, coefficient), normal], n),
            Grip::Backwards => found([&normal.plus(tangent, -coefficient), normal], n),
        }
    }

    /// The way in which it starts to slide when it touches.
    pub(super) fn slides(&self, [_, slip]: [f64; 2]) -> Grip {
        if self.friction.resists() && self.dampers[1].at(slip) < 0.0 {
            Grip::Backwards
        } else {
            Grip::Forwards
        }
    }

    /// Calls `found` with the conditions of its state: the state that follows, and the value.
    pub(super) fn conditions(&self, speeds: [f64; 2], lift: f64, mut found: impl FnMut(Grip, f64)) {
        let [approach, slip] = speeds;
        let (normal, friction) = (
            self.dampers[0].at(approach + lift),
            self.dampers[1].at(slip),
        );
        let limit = self.friction.coefficient * normal;
        if self.grip == Grip::Open {
            found(Grip::Sticks, -normal);
            return;
        }
        found(Grip::Open, normal);
        match self.grip {
            Grip::Sticks => {
                found(Grip::Forwards, limit - friction);
                found(Grip::Backwards, limit + friction);
            }
            Grip::Forwards if self.friction.resists() => found(Grip::Sticks, friction - limit),
            Grip::Backwards if self.friction.resists() => found(Grip::Sticks, -friction - limit),
            _ => {}
        }
    }
}
