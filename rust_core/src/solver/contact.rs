//! A contact: Coulomb's law with softness, the state of the contact, and the conditions for that state. No other file of
//! the solver knows the limit of friction.
//!
//! The equations: docs/physics.md, "Coulomb's law".

use serde::{Deserialize, Serialize};

use super::AGREEMENT;
use super::damper::{COMPLIANCE, Damper};
use super::row::Row;
use crate::scenario::Friction;

/// The state of a contact in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Grip {
    /// No contact force.
    #[default]
    Open,
    /// It sticks.
    Sticks,
    /// It slides; friction acts along the tangent.
    Forwards,
    /// It slides; friction acts against the tangent.
    Backwards,
}

impl Grip {
    /// The next guess: the direction of slip is not reversed without sticking in between.
    pub(super) fn towards(self, fitting: Self) -> Self {
        match (self, fitting) {
            (Self::Forwards, Self::Backwards) | (Self::Backwards, Self::Forwards) => Self::Sticks,
            _ => fitting,
        }
    }
}

/// [1/kg] Velocity along normal and tangent per unit impulse: of the contact itself, ...
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Admittances {
    pub own: [f64; 2],
    /// ... and of the mass on its springs.
    pub of_springs: [f64; 2],
}

/// [N s] How the law of a contact is relaxed along normal and tangent.
#[derive(Clone, Copy, Debug, Default)]
struct Relaxation {
    /// What is added to the impulses of the dampers before the law is applied, ...
    seen: [f64; 2],
    /// ... and what of that is taken off the resulting impulses, so that the present state leaves them unchanged.
    without: [f64; 2],
}

/// A contact: it can only push along its normal, which limits its friction along the tangent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub normal: Row,
    pub tangent: Row,
    pub friction: Friction,
    /// Whether it can bear a load in this solve.
    pub bears: bool,
    /// [kg] The mass by which its springs are stiff; `None`: its own effective mass.
    pub mass: Option<f64>,
    /// [m/s] Speed at which it may close or, if negative, must open.
    pub bias: f64,
    /// Compliance in units of the admittance of its spring.
    pub compliance: f64,
    /// Compliance of the tangential spring while it sticks, in units of that spring's admittance; the spring acts about its
    /// impulse of the last step. 0 if it is rigid.
    pub give: f64,
    /// The share of a change in friction that stays in that spring; the rest is damping.
    pub spring_share: f64,
    /// [N s] Impulse along the normal.
    pub normal_impulse: f64,
    /// [N s] Impulse along the tangent.
    pub friction_impulse: f64,
    /// The present state.
    pub grip: Grip,
    /// [N s] Impulses about which its dampers act.
    center: [f64; 2],
    /// The state that fits the last velocities.
    pub(super) fitting: Grip,
    /// Normal and tangent as rows with what motors hold tied to the base.
    pub(super) actions: [Row; 2],
    pub(super) admittances: Admittances,
    /// Dampers of normal and tangent in this solve while no limit is reached.
    pub(super) dampers: [Damper; 2],
    /// How its law is relaxed along the path to a solution.
    relaxed: Relaxation,
}

impl Contact {
    /// A contact along these directions, without friction or history.
    pub(crate) fn new([normal, tangent]: [Row; 2]) -> Self {
        Self {
            normal,
            tangent,
            friction: Friction::dry(0.0),
            bears: false,
            mass: None,
            bias: 0.0,
            compliance: 0.0,
            give: 0.0,
            spring_share: 1.0,
            normal_impulse: 0.0,
            friction_impulse: 0.0,
            grip: Grip::Open,
            center: [0.0; 2],
            fitting: Grip::Open,
            actions: [normal, tangent],
            admittances: Admittances::default(),
            dampers: [Damper::default(); 2],
            relaxed: Relaxation::default(),
        }
    }

    /// [m/s] Speeds along normal and tangent in this solve, offsets included.
    pub(super) fn speeds(&self, unknowns: &[f64]) -> [f64; 2] {
        let [n, t] = &self.actions;
        // Without friction the speed of slip makes no difference and need not be computed.
        let slip = if self.friction.resists() {
            t.along(unknowns)
        } else {
            0.0
        };
        [n.speed(unknowns), slip + t.offset]
    }

    /// Gives its grip a compliance, about the friction `last` [N s] of the last step; the spring keeps a share of a change.
    pub(crate) fn give_way(&mut self, compliance: f64, spring_share: f64, last: f64) {
        (self.give, self.spring_share) = (compliance, spring_share);
        self.center[1] = last;
    }

    /// [N s] Impulse along the tangent without what is damping: the next step starts from it.
    pub(crate) fn friction_kept(&self) -> f64 {
        if self.give == 0.0 || self.grip != Grip::Sticks {
            return self.friction_impulse;
        }
        self.center[1] + (self.friction_impulse - self.center[1]) * self.spring_share
    }

    /// [N s] Its impulses along normal and tangent.
    pub(crate) fn impulses(&self) -> [f64; 2] {
        [self.normal_impulse, self.friction_impulse]
    }

    pub(super) fn set_impulses(&mut self, impulses: [f64; 2]) {
        [self.normal_impulse, self.friction_impulse] = impulses;
    }

    /// Makes its dampers act about its current impulses.
    pub(super) fn center(&mut self) {
        self.center[0] = self.normal_impulse;
        if self.give == 0.0 {
            self.center[1] = self.friction_impulse;
        }
        self.place_dampers();
    }

    /// Extrapolates the impulses by a multiple of their last change, within Coulomb's law.
    pub(super) fn lead(&mut self, times: f64) {
        let [normal, friction] = self.center;
        self.normal_impulse = beyond(normal, self.normal_impulse, times).max(0.0);
        let limit = self.limit(self.normal_impulse);
        self.friction_impulse = beyond(friction, self.friction_impulse, times).clamp(-limit, limit);
    }

    /// Restores the impulses about which its dampers act.
    pub(super) fn uncenter(&mut self) {
        self.set_impulses(self.center);
    }

    /// Sets the dampers about their centres.
    pub(super) fn place_dampers(&mut self) {
        let [normal, friction] = self.center;
        let [spring, grip] = self.admittances.of_springs;
        let proximal = self.proximal();
        let damping = proximal * spring;
        let stiffness = 1.0 / (self.compliance * spring + damping);
        let of_grip = 1.0 / (self.give * grip + proximal * self.admittances.own[1]);
        self.dampers = [
            Damper::new(stiffness * (damping * normal - self.bias), stiffness),
            Damper::new(friction, of_grip),
        ];
    }

    /// Updates impulses and fitting state for the velocities; returns the error of the velocity [m/s].
    pub(super) fn apply_law(&mut self, unknowns: &[f64]) -> f64 {
        let (grip, impulses) = self.law(self.speeds(unknowns));
        self.fitting = grip;
        self.set_impulses(impulses);
        let [of_normal, of_tangent] =
            [0, 1].map(|i| (impulses[i] - self.center[i]).abs() * self.admittances.own[i]);
        let off = match grip {
            Grip::Open => 0.0,
            Grip::Sticks if self.give == 0.0 => of_normal.max(of_tangent),
            _ => of_normal,
        };
        self.proximal() * off
    }

    /// Compliance of its damper about the last impulses; an elastic grip needs none.
    fn proximal(&self) -> f64 {
        if self.give == 0.0 { COMPLIANCE } else { 0.0 }
    }

    /// Its friction, as a share of the limit at its normal impulse.
    pub(crate) fn friction_load(&self) -> f64 {
        self.friction_impulse.abs() / self.limit(self.normal_impulse)
    }

    /// [N s] The limit of friction at a normal impulse.
    fn limit(&self, normal: f64) -> f64 {
        self.friction.coefficient * normal
    }

    /// The state at these speeds, and the impulses along normal and tangent [N s].
    fn law(&self, [approach, slip]: [f64; 2]) -> (Grip, [f64; 2]) {
        let [n, t] = self.dampers;
        let (normal, friction) = (n.at(approach), t.at(slip));
        let limit = self.limit(normal);
        if normal <= 0.0 {
            (Grip::Open, [0.0, 0.0])
        } else if friction > limit || limit == 0.0 {
            // Without friction the direction of slip makes no difference.
            (Grip::Forwards, [normal, limit])
        } else if friction < -limit {
            (Grip::Backwards, [normal, -limit])
        } else {
            (Grip::Sticks, [normal, friction])
        }
    }

    /// [N s] Impulses along normal and tangent at these velocities in the present state, with a share of its relaxation.
    pub(super) fn held(&self, unknowns: &[f64], share: f64) -> [f64; 2] {
        let [normal, friction] = self.seen(unknowns, share);
        let limit = self.limit(normal);
        let impulses = match self.grip {
            Grip::Open => [0.0, 0.0],
            Grip::Sticks => [normal, friction],
            Grip::Forwards => [normal, limit],
            Grip::Backwards => [normal, -limit],
        };
        [0, 1].map(|i| impulses[i] - share * self.relaxed.without[i])
    }

    /// [N s] The impulses along normal and tangent to which the law is applied at these velocities: those of the dampers, with
    /// a share of its relaxation.
    fn seen(&self, unknowns: &[f64], share: f64) -> [f64; 2] {
        let speeds = self.speeds(unknowns);
        [0, 1].map(|i| self.dampers[i].at(speeds[i]) + share * self.relaxed.seen[i])
    }

    /// Whether the present state fits its law at these velocities, or differs from the right one by too little to matter.
    pub(super) fn fits(&self, unknowns: &[f64]) -> bool {
        if self.fitting == self.grip {
            return true;
        }
        let (held, law) = (self.held(unknowns, 0.0), self.impulses());
        let off = |i: usize| (law[i] - held[i]).abs() * self.admittances.own[i];
        off(0).max(off(1)) < AGREEMENT.value()
    }

    /// Calls `each` with the constraints of the present state: each impulse acts along the first of two rows, and is that of a
    /// damper at the speed along the second.
    #[inline]
    pub(super) fn constraints(&self, mut each: impl FnMut([&Row; 2], Damper)) {
        let ([normal, tangent], [n, t]) = (&self.actions, self.dampers);
        let coefficient = match self.grip {
            Grip::Open => return,
            Grip::Sticks => {
                each([tangent; 2], t);
                0.0
            }
            Grip::Forwards => self.friction.coefficient,
            Grip::Backwards => -self.friction.coefficient,
        };
        if coefficient == 0.0 {
            each([normal; 2], n);
        } else {
            each([&normal.plus(tangent, coefficient), normal], n);
        }
    }

    /// The direction in which it starts to slide when it touches.
    pub(super) fn slides(&self, unknowns: &[f64], share: f64) -> Grip {
        if self.friction.resists() && self.seen(unknowns, share)[1] < 0.0 {
            Grip::Backwards
        } else {
            Grip::Forwards
        }
    }

    /// Calls `each` with the conditions for its state, with a share of its relaxation: the state that follows where the
    /// condition fails, and the value, which must be above 0.
    pub(super) fn conditions(&self, unknowns: &[f64], share: f64, mut each: impl FnMut(Grip, f64)) {
        let [normal, friction] = self.seen(unknowns, share);
        let limit = self.limit(normal);
        if self.grip == Grip::Open {
            each(Grip::Sticks, -normal);
            return;
        }
        each(Grip::Open, normal);
        match self.grip {
            Grip::Sticks => {
                each(Grip::Forwards, limit - friction);
                each(Grip::Backwards, limit + friction);
            }
            Grip::Forwards if self.friction.resists() => each(Grip::Sticks, friction - limit),
            Grip::Backwards if self.friction.resists() => each(Grip::Sticks, -friction - limit),
            _ => {}
        }
    }

    /// [m/s] By how much its state fails to fit these velocities, as the change of speed that would make it fit; 0 if it fits.
    pub(super) fn violation(&self, unknowns: &[f64]) -> f64 {
        let mut most: f64 = 0.0;
        self.conditions(unknowns, 0.0, |next, value| {
            let is_normal = next == Grip::Open || self.grip == Grip::Open;
            let damper = self.dampers[usize::from(!is_normal)];
            most = most.max(-value / damper.damping);
        });
        most
    }

    /// Relaxes its law so that its state fits these velocities, by at least as much as a speed `least` [m/s] stands for.
    pub(super) fn relax(&mut self, unknowns: &[f64], least: f64) {
        let [normal, friction] = self.seen(unknowns, 0.0);
        let [of_normal, of_friction] = self.dampers.map(|damper| least * damper.damping);
        let (mut seen, mut without) = ([0.0; 2], [0.0; 2]);
        if self.grip == Grip::Open {
            seen[0] = -of_normal;
        } else if normal < 0.0 {
            (seen[0], without[0]) = (of_normal, of_normal);
        }
        let limit = self.limit(normal + seen[0]);
        match self.grip {
            Grip::Open => {}
            Grip::Sticks => {
                let excess = friction.abs() - limit;
                if excess > 0.0 {
                    seen[1] = -friction.signum() * of_friction.max(excess).min(friction.abs());
                }
                without[1] = seen[1];
            }
            Grip::Forwards | Grip::Backwards => {
                let direction = if self.grip == Grip::Forwards {
                    1.0
                } else {
                    -1.0
                };
                without[1] = direction * self.limit(seen[0]);
                let short = limit - direction * friction;
                if short > 0.0 && self.friction.resists() {
                    seen[1] = direction * of_friction.max(short);
                }
            }
        }
        self.relaxed = Relaxation { seen, without };
    }
}

/// Extrapolates from two values by a multiple of their difference.
pub(super) fn beyond(from: f64, to: f64, times: f64) -> f64 {
    to + times * (to - from)
}
