//! The chains of shoes in the equations of motion.
//!
//! The equations: docs/physics.md, "Chains".

#[cfg(test)]
mod tests;

use super::Dynamics;
use super::chain::{Chain, ChainPose};
use super::state::State;
use super::touch::{Touch, is_on_ground};
use crate::geometry::Vector;
use crate::solver::{ActsOn, Twist};

/// A shoe that is closer to the guide than so many times the way of the fastest part may come to rest on it within a step.
/// Of 5,200 that did so from more than 50 um, the farthest came from 1.6 times that way at the speed after the step; the
/// rest is for shoes that gain speed within it.
const NEAR_GUIDE: f64 = 4.0;

/// State of the chains in the last step; the worst value of all chains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChainReading {
    /// [N] Largest force in a pin.
    pub tension: f64,
    /// [m] Largest gap of a pin.
    pub pin_gap: f64,
    /// [m] Deepest penetration of guide, wheels or teeth by a shoe.
    pub guide_penetration: f64,
    /// [m] Difference in travel between chain and sprocket.
    pub sprocket_slip: f64,
    /// Whether a shoe has come off the guide, or the chain off its wheels.
    pub is_off: bool,
}

impl Dynamics {
    /// The state of the chains in the last step; zero if there are none.
    pub(crate) fn chain_reading(&self) -> ChainReading {
        let mut reading = ChainReading::default();
        for chain in &self.chains {
            for (force, gap) in chain.pins() {
                reading.tension = reading.tension.max(force);
                reading.pin_gap = reading.pin_gap.max(gap);
            }
            reading.sprocket_slip = reading.sprocket_slip.max(chain.sprocket_slip());
            reading.is_off |= chain.is_off;
        }
        let contacts = self.touches.iter().zip(&self.problem.contacts);
        let on_guide = contacts.filter(|(_, solved)| !is_on_ground(solved));
        let gaps = on_guide.map(|(touch, _)| touch.gap);
        reading.guide_penetration = gaps.fold(0.0, |deepest, gap| deepest.max(-gap));
        reading
    }

    /// [N s] Momentum of chassis, shoes and flippers.
    pub(crate) fn momentum(&self, state: &State) -> Vector {
        let of_chain = |chain: &Chain| {
            let shoes = &state.shoes[chain.rule.shoes.clone()];
            let velocities = shoes.iter().map(|shoe| shoe.twist.velocity);
            velocities.sum::<Vector>() * chain.rule.shoe_mass
        };
        let of_shoes: Vector = self.chains.iter().map(of_chain).sum();
        state.velocity * self.model.mass + of_shoes + self.momentum_of_flippers(state)
    }

    /// Adds a contact for each place where a shoe rests on guide, wheel or tooth, or nearly does, in the middle of
    /// the step, in which nothing moves farther than `travel` [m].
    pub(super) fn rest_on_guides(&mut self, state: &State, half: f64, travel: f64) {
        let pose = state.pose_after(half, &self.model);
        for chain in &mut self.chains {
            let first = chain.rule.shoes.start;
            let place_of = |i: usize| state.shoes[first + i].after(half).pose();
            let idler = &state.idlers[chain.rule.number];
            let number = chain.rule.number;
            let stand = ChainPose {
                chassis: pose,
                travel: idler.travel + idler.rate * half,
                run: state.drives[number].position + state.track_speed(&self.model, number) * half,
            };
            chain.rests(stand, place_of, NEAR_GUIDE * travel, |chain, rest| {
                let of = (first + rest.shoe, number);
                let last = chain.recall(&rest);
                let (touch, solved) = Touch::at_rest(&rest, last, state, of, half);
                self.touches.push(touch);
                self.problem.contacts.push(solved);
            });
        }
    }

    /// Stores the forces of the rests.
    pub(super) fn remember_rests(&mut self) {
        if self.chains.is_empty() {
            return;
        }
        for chain in &mut self.chains {
            chain.forget_rests();
        }
        for (touch, solved) in self.touches.iter().zip(&self.problem.contacts) {
            if let ActsOn::LinkAndSlide(link) | ActsOn::LinkAndSpin { link, .. } = solved.acts {
                self.chains[link.ring].remember_rest(link.number, touch, solved.grip);
            }
        }
    }

    /// Moves shoes and idlers by `h` [s] at their velocities.
    pub(super) fn move_chains(&mut self, state: &mut State, h: f64) {
        for (chain, ring) in self.chains.iter_mut().zip(&self.problem.rings) {
            chain.count(ring.drive_speed(&self.problem.velocities), state, h);
        }
        for shoe in &mut state.shoes {
            *shoe = shoe.after(h);
        }
        for idler in &mut state.idlers {
            idler.travel += idler.rate * h;
        }
    }

    /// Starts a step of `h` [s]: velocities without constraints, and pins in place.
    pub(super) fn start_chains(&mut self, state: &State, h: f64) {
        let weight = self.weight(0.5 * h);
        let pose = state.pose_after(0.5 * h, &self.model);
        let free = &mut self.problem.free.links;
        for (free, shoe) in free.iter_mut().zip(&state.shoes) {
            *free = shoe.twist.plus(weight, 1.0);
        }
        for (chain, ring) in self.chains.iter_mut().zip(&mut self.problem.rings) {
            chain.follow(ring, (state, pose), free, h);
            chain.guess(ring, 0.5 * h);
        }
    }

    /// Continues after the motion of a step of `h` [s]: the other half of the weight, and pins where they are now.
    pub(super) fn hold_chains(&mut self, state: &State, h: f64) {
        let weight = self.weight(0.5 * h);
        let free = &mut self.problem.free.links;
        for free in free.iter_mut() {
            *free = free.plus(weight, 1.0);
        }
        for (chain, ring) in self.chains.iter_mut().zip(&mut self.problem.rings) {
            chain.hold(ring, state, free, h);
            chain.guess_more(ring, 0.5 * h);
        }
    }

    /// Change of a shoe's velocity by its weight in a time [s].
    fn weight(&self, time: f64) -> Twist {
        Twist {
            velocity: Vector::new(0.0, -self.gravity * time),
            turn: 0.0,
        }
    }

    /// Sets the spins of the drives that have no sprocket, from the speeds of their chains.
    pub(super) fn spin_with_chains(&self, state: &mut State) {
        for (k, ring) in self.problem.rings.iter().enumerate() {
            if ring.spin.is_none() {
                let speed = ring.drive_speed(&self.problem.velocities);
                state.drives[k].spin = state.angular_velocity - speed / self.model.drive_radius;
            }
        }
    }
}
