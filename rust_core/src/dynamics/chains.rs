//! The chains of shoes in the equations of motion.
//!
//! The equations: docs/physics.md, "Chains".

#[cfg(test)]
mod tests;

use super::Dynamics;
use super::chain::{Chain, Stand};
use super::phase::Phase;
use super::row::{Link, Row};
use super::state::{State, Twist};
use crate::geometry::Vector;

/// [m] A shoe this close to the guide may come to rest on it within a step.
const NEAR_GUIDE: f64 = 2e-3;

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
        let on_guide = |row: &&Row| matches!(row.link, Link::Guide { .. } | Link::Tooth { .. });
        let gaps = self.rows.iter().filter(on_guide).map(|row| row.gap);
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

    /// Adds a row for each place where a shoe rests on guide, wheel or tooth, or nearly does, in the middle of
    /// the step.
    pub(super) fn rest_on_guides(&mut self, state: &State, half: f64) {
        let pose = state.pose_after(half, &self.model);
        for chain in &mut self.chains {
            let first = chain.rule.shoes.start;
            let place_of = |i: usize| state.shoes[first + i].after(half).pose();
            let idler = &state.idlers[chain.rule.number];
            let number = chain.rule.number;
            let stand = Stand {
                chassis: pose,
                travel: idler.travel + idler.rate * half,
                run: state.drives[number].position + state.track_speed(&self.model, number) * half,
            };
            chain.rests(stand, place_of, NEAR_GUIDE, |chain, rest| {
                let of = (first + rest.shoe, number);
                let last = chain.recall(&rest);
                self.rows.push(Row::at_rest(&rest, last, state, of, half));
            });
        }
    }

    /// Stores the forces of the rests, whose rows come after those of the contacts with the ground.
    pub(super) fn remember_rests(&mut self, contacts: usize) {
        for chain in &mut self.chains {
            chain.forget_rests();
        }
        for row in &self.rows[contacts..] {
            if let Link::Guide { shoe, chain } | Link::Tooth { shoe, chain } = row.link {
                self.chains[chain].remember_rest(shoe % self.shoes_a_chain, row);
            }
        }
    }

    /// Moves shoes and idlers by `h` [s] at their velocities.
    pub(super) fn move_chains(&mut self, state: &mut State, h: f64) {
        for chain in &mut self.chains {
            chain.count(state, h);
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
        for chain in &mut self.chains {
            let shoes = &state.shoes[chain.rule.shoes.clone()];
            for (free, shoe) in chain.free.iter_mut().zip(shoes) {
                *free = shoe.twist.plus(weight, 1.0);
            }
            chain.follow(state, pose, h);
            chain.guess(0.5 * h);
        }
    }

    /// Continues after the motion of a step of `h` [s]: the other half of the weight, and pins where they are now.
    pub(super) fn hold_chains(&mut self, state: &State, h: f64) {
        let weight = self.weight(0.5 * h);
        for chain in &mut self.chains {
            for free in &mut chain.free {
                *free = free.plus(weight, 1.0);
            }
            chain.hold(state, h);
            chain.guess_more(0.5 * h);
        }
    }

    /// Change of a shoe's velocity by its weight in a time [s].
    fn weight(&self, time: f64) -> Twist {
        Twist {
            velocity: Vector::new(0.0, -self.gravity * time),
            turn: 0.0,
        }
    }

    /// [N s] Impulse of a chain's drive, if its motor does not hold the speed.
    fn given(&self, k: usize, phase: &Phase) -> Option<f64> {
        if !self.chains[k].has_hold() {
            return Some(0.0);
        }
        let share = self.motors[k].share()?;
        Some(phase.motor_impulse(share, &self.model))
    }

    pub(super) fn assemble_chains(&mut self, phase: &Phase) {
        for k in 0..self.chains.len() {
            let given = self.given(k, phase);
            self.chains[k].assemble(phase.set_point, given);
        }
    }

    /// Velocity and angular velocity of the chassis, chains included; none if the constraints contradict
    /// each other.
    pub(super) fn solve_system(&mut self) -> Option<(Vector, f64)> {
        if !self.chains.is_empty() {
            let mut rows = self.system.of_chassis();
            for chain in &mut self.chains {
                chain.eliminate(&mut rows)?;
            }
            self.system.set_of_chassis(rows);
        }
        let (velocity, turn) = self.system.solve()?;
        for (chain, spin) in self.chains.iter_mut().zip(&mut self.system.spins) {
            chain.solve([velocity.x, velocity.y, turn]);
            if chain.has_sprocket() {
                spin.value = chain.spin;
            }
        }
        Some((velocity, turn))
    }

    /// Converts the velocities of the last solve into changes.
    pub(super) fn change_shoes(&mut self, state: &State) {
        let solved = self.chains.iter_mut().flat_map(|chain| &mut chain.solved);
        for (twist, shoe) in solved.zip(&state.shoes) {
            *twist = twist.less(shoe.twist);
        }
        for (chain, idler) in self.chains.iter_mut().zip(&state.idlers) {
            chain.idler_rate -= idler.rate;
        }
    }

    /// Changes the shoes' velocities by a share of the change.
    pub(super) fn move_shoes(&self, state: &mut State, share: f64) {
        let changes = self.chains.iter().flat_map(|chain| &chain.solved);
        for (shoe, change) in state.shoes.iter_mut().zip(changes) {
            shoe.twist = shoe.twist.plus(*change, share);
        }
        for (idler, chain) in state.idlers.iter_mut().zip(&self.chains) {
            idler.rate += chain.idler_rate * share;
        }
    }

    /// Updates the impulses of pins and drives, and the speeds of the drives, to match the velocities; returns
    /// the largest error of a velocity [m/s].
    pub(super) fn chains_follow_velocities(&mut self, state: &mut State, phase: &Phase) -> f64 {
        let mut off: f64 = 0.0;
        for k in 0..self.chains.len() {
            let given = self.given(k, phase);
            let chain = &mut self.chains[k];
            let speed = chain.drive_speed(state);
            off = off.max(chain.follow_drive(speed - phase.set_point, given));
            if !chain.has_sprocket() {
                state.drives[k].spin = state.angular_velocity - speed / self.model.drive_radius;
            }
        }
        off
    }
}
