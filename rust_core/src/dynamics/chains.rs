//! The chains of shoes in the equations of motion.
//!
//! The equations: docs/physics.md, "Chains".

#[cfg(test)]
mod tests;

use super::Dynamics;
use super::chain::{Chain, ChainPose};
use super::state::State;
use super::touch::{On, Start, Touch};
use crate::geometry::Vector;

/// A shoe may come to rest on the guide within a step if it is closer than so many times the travel of the fastest part.
/// Of 5,200 that did so from more than 50 um, the farthest came from 1.6 times that travel at the speed after the step;
/// the margin is for shoes that gain speed within the step.
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
        let on_guide = self.touches.iter().filter(|touch| !touch.is_on_ground());
        let gaps = on_guide.map(|touch| touch.gap);
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

    /// Adds a contact for each place where a shoe rests on the guide, a wheel or a tooth, or nearly does, in the middle of a
    /// step in which nothing moves farther than `travel` [m].
    pub(super) fn rest_on_guides(&mut self, state: &State, half: f64, travel: f64) {
        let pose = state.pose_after(half, &self.model);
        let problem = &mut self.problem;
        let velocities = (problem.layout, problem.unknowns.as_slice());
        let start = Start::new((state, &self.model), velocities, half);
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
                let (touch, solved) = Touch::at_rest(&rest, chain.recall(&rest), of, &start);
                self.touches.push(touch);
                problem.contacts.push(solved);
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
            if let On::Guide { chain, shoe } = touch.on {
                self.chains[chain].remember_rest(shoe, touch, solved.grip);
            }
        }
    }

    /// Moves shoes and idlers by `h` [s] at their velocities.
    pub(super) fn move_chains(&mut self, state: &mut State, h: f64) {
        for chain in &mut self.chains {
            chain.count(state.track_speed(&self.model, chain.rule.number), state, h);
        }
        for shoe in &mut state.shoes {
            *shoe = shoe.after(h);
        }
        for idler in &mut state.idlers {
            idler.travel += idler.rate * h;
        }
    }

    /// Prepares chains for the first solve of a step of `h` [s]: velocities without constraints, and pins in mid-step.
    pub(super) fn start_chains(&mut self, state: &State, h: f64) {
        self.fall_with_shoes(0.5 * h);
        let pose = state.pose_after(0.5 * h, &self.model);
        let free = &self.problem.free;
        for (chain, ring) in self.chains.iter_mut().zip(&mut self.problem.rings) {
            chain.follow(ring, (state, pose), free, h);
        }
    }

    /// Prepares chains for the second solve, after the motion: the other half of the weight, and pins where they are now.
    pub(super) fn hold_chains(&mut self, state: &State, h: f64) {
        self.fall_with_shoes(0.5 * h);
        let free = &self.problem.free;
        for (chain, ring) in self.chains.iter_mut().zip(&mut self.problem.rings) {
            chain.hold(ring, state, free, h);
        }
    }

    /// Lets the weight of the shoes act on their velocities for a time [s].
    fn fall_with_shoes(&mut self, time: f64) {
        let problem = &mut self.problem;
        for link in problem.free[problem.layout.link(0)..].chunks_exact_mut(3) {
            link[1] -= self.gravity * time;
        }
    }

    /// Sets the spins of the drives that have no sprocket, from the speeds of their chains.
    pub(super) fn spin_with_chains(&self, state: &mut State) {
        for (k, (chain, ring)) in self.chains.iter().zip(&self.problem.rings).enumerate() {
            if !chain.has_sprocket() {
                let speed = ring.drive_speed(&self.problem.unknowns);
                state.drives[k].spin = state.angular_velocity - speed / self.model.drive_radius;
            }
        }
    }
}
