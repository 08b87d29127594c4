//! Forces of the ground that carry a robot at rest with its drives running.

use super::contact::{Kind, Posture, Turn};
use super::fixed::solve;
use super::layout::Grip;
use super::setting::Setting;
use crate::geometry::{Vector, cross, right_of};

/// A force that a contact can exert, for a normal force of 1 N.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    /// Index of its contact.
    pub contact: usize,
    /// Friction over normal force.
    pub slope: f64,
}

/// The load of each contact: normal force and friction, in weights.
pub(super) type Loads = Vec<[f64; 2]>;

/// Fraction of the weight below which a pull is a rounding error.
const LEAST: f64 = 1e-9;

impl Setting {
    /// The forces that a contact can exert: one if it slides or rolls, the two edges of its cone if it stands still.
    pub(super) fn pushes(&self, contact: usize) -> impl Iterator<Item = Push> + use<> {
        let surface = &self.layout.surfaces[self.contacts[contact].surface];
        let place = &self.places[self.contacts[contact].place];
        let friction = place.friction.min(surface.friction_limit);
        let slopes = match surface.grip {
            Grip::Driven(sign) => [Some(sign * friction), None],
            Grip::Free => [Some(0.0), None],
            Grip::Still => [Some(friction), Some(-friction)],
        };
        let push = move |slope| Push { contact, slope };
        slopes.into_iter().flatten().map(push)
    }

    /// Force and moment about the centre of mass of a push, over the robot's reach.
    pub(super) fn wrench(&self, push: Push, position: Vector, turn: Turn) -> [f64; 3] {
        let contact = &self.contacts[push.contact];
        let touch = contact.touch_turned(position, turn);
        let center = self.layout.center_of_mass;
        let force = touch.normal + right_of(touch.normal) * push.slope;
        let moment = match contact.kind {
            // About the axle, friction has the radius as its lever, so this is linear in the position, even off the
            // circle.
            Kind::OnCorner(disc, ..) => {
                cross(turn.apply(disc.center - center), force) + disc.radius * push.slope
            }
            Kind::OnFace(..) | Kind::Across(..) => {
                cross(touch.point - position - turn.apply(center), force)
            }
        };
        [force.x, force.y, moment / self.layout.reach]
    }

    /// Loads of contacts that balance the weight in a pose; `None` if none do.
    ///
    /// If several choices do, the result is the mean of those that use at most three pushes; by Carathéodory's theorem,
    /// these span all choices.
    pub(super) fn loads(&self, contacts: &[usize], posture: &Posture) -> Option<Loads> {
        let turn = Turn::by(posture.angle);
        let pushes: Vec<Push> = contacts.iter().flat_map(|i| self.pushes(*i)).collect();
        let wrenches: Vec<[f64; 3]> = pushes
            .iter()
            .map(|push| self.wrench(*push, posture.position, turn))
            .collect();
        let mut sum = vec![0.0; pushes.len()];
        let mut choices = 0.0;
        for_each_choice(&wrenches, &mut |chosen| {
            choices += 1.0;
            for (i, share) in chosen {
                sum[*i] += share;
            }
        });
        if choices == 0.0 {
            return None;
        }
        let mut loads = vec![[0.0; 2]; contacts.len()];
        for (push, share) in pushes.iter().zip(&sum) {
            let place = contacts.iter().position(|i| *i == push.contact)?;
            loads[place][0] += share / choices;
            loads[place][1] += share / choices * push.slope;
        }
        Some(loads)
    }
}

/// Calls a function for every choice of one to three wrenches whose multiples, of at least 0, carry a weight of 1.
pub(super) fn for_each_choice(wrenches: &[[f64; 3]], take: &mut impl FnMut(&[(usize, f64)])) {
    let n = wrenches.len();
    let weight = [0.0, 1.0, 0.0];
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let [a, b, c] = [i, j, k].map(|i| wrenches[i]);
                let rows = [0, 1, 2].map(|axis| [a[axis], b[axis], c[axis]]);
                if let Some(shares) = solve(&rows, &weight)
                    && shares
                        .iter()
                        .all(|share| *share >= -LEAST && *share < 1.0 / LEAST)
                {
                    take(&[(i, shares[0]), (j, shares[1]), (k, shares[2])]);
                }
            }
        }
    }
    // If fewer than three carry it, choices of three with a third one that carries nothing do not count.
    if n < 3 {
        for_each_pair(wrenches, take);
    }
}

/// The same, up to rounding, for one or two wrenches, which carry it only in particular poses.
fn for_each_pair(wrenches: &[[f64; 3]], take: &mut impl FnMut(&[(usize, f64)])) {
    /// Fraction of the weight that may remain.
    const LEFT: f64 = 1e-7;
    for (i, a) in wrenches.iter().enumerate() {
        if a[0].abs() <= LEFT * a[1] && a[2].abs() <= LEFT * a[1] {
            take(&[(i, 1.0 / a[1])]);
        }
        for (j, b) in wrenches.iter().enumerate().skip(i + 1) {
            let determinant = a[0] * b[1] - a[1] * b[0];
            let shares = [-b[0] / determinant, a[0] / determinant];
            let left = shares[0] * a[2] + shares[1] * b[2];
            let most = 1.0 / LEFT;
            if shares.iter().all(|s| *s > LEFT && *s < most) && left.abs() <= LEFT {
                take(&[(i, shares[0]), (j, shares[1])]);
            }
        }
    }
}
