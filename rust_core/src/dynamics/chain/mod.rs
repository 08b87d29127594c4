//! A chain of shoes that runs on a guide or wheels: its pins, rests and drive.
//!
//! The equations: docs/physics.md, "Chains".

mod contacts;
mod motion;
mod pin;
mod pull;
mod rest;
mod rests;
#[cfg(test)]
mod tests;
mod wheels;

use pin::Pin;
use rest::{Rest, of_a_shoe};
use serde::{Deserialize, Serialize};

use super::state::{Shoe, State};
use super::touch::Touch;
use crate::geometry::{Pose, Vector, plausible};
use crate::robot::ChainOfShoes;
use crate::solver::{Grip, Ring, RingSpec};

pub(super) use rest::ChainPose;

/// Stiffness of an idler's stop in units of its tensioner's. Stiffer stops work, too, but a chain that is tightened by an
/// obstacle hits them with kilonewtons.
const STOP_STIFFNESS: f64 = 100.0;

/// One closed chain.
pub(super) struct Chain {
    pub rule: ChainOfShoes,
    pins: Vec<Pin>,
    /// [m] Travel by which it lags behind its sprocket, ...
    behind: f64,
    /// [m] ... and by which it did when the step began.
    lagged: f64,
    /// The shoes in the middle of this step, and unit vectors along them.
    middle: Vec<Shoe>,
    alongs: Vec<Vector>,
    /// [kg m^2] Moments of inertia of the shoes in this solve.
    inertias: Vec<f64>,
    /// Poses of the shoes in the world and in the chassis frame, in the last search for rests.
    places: Vec<[Pose; 2]>,
    /// The last forces and grips of the rests, shoe by shoe.
    memory: Vec<RestMemory>,
    /// Whether a shoe was too far off the guide to come back, in the last search for rests.
    pub is_off: bool,
}

/// What the next solve knows of a rest.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct RestMemory {
    /// [N] Normal force.
    pub force: f64,
    pub grip: Grip,
}

/// What a step passes on to the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChainImpulses {
    pins: Vec<Pin>,
    behind: f64,
    memory: Vec<RestMemory>,
}

impl Chain {
    pub(super) fn new(rule: ChainOfShoes) -> Self {
        let count = rule.path.count;
        Self {
            pins: vec![Pin::default(); count],
            behind: 0.0,
            lagged: 0.0,
            middle: Vec::with_capacity(count),
            alongs: Vec::with_capacity(count),
            inertias: vec![rule.shoe_inertia; count],
            places: Vec::with_capacity(count),
            memory: vec![RestMemory::default(); count * of_a_shoe(&rule)],
            is_off: false,
            rule,
        }
    }

    /// Its shoes as the solver sees them.
    pub(super) fn ring(&self) -> RingSpec {
        let rule = &self.rule;
        RingSpec {
            links: rule.path.count,
            mass: rule.shoe_mass,
            inertia: rule.shoe_inertia,
            spin: rule.sprocket.is_some().then_some(rule.number),
        }
    }

    pub(super) fn impulses(&self) -> ChainImpulses {
        ChainImpulses {
            pins: self.pins.clone(),
            behind: self.behind,
            memory: self.memory.clone(),
        }
    }

    /// Whether a step of this chain can have left these impulses.
    pub(super) fn fits(&self, impulses: &ChainImpulses) -> bool {
        let ChainImpulses {
            pins,
            behind,
            memory,
        } = impulses;
        let counts = pins.len() == self.pins.len() && memory.len() == self.memory.len();
        counts
            && plausible(&[*behind])
            && pins.iter().all(Pin::is_plausible)
            && memory.iter().all(|rest| plausible(&[rest.force]))
    }

    pub(super) fn start_from(&mut self, impulses: ChainImpulses) {
        self.pins = impulses.pins;
        self.behind = impulses.behind;
        self.memory = impulses.memory;
    }

    /// The last force and grip of a rest.
    pub(super) fn recall(&self, rest: &Rest) -> RestMemory {
        self.memory[rest.shoe * of_a_shoe(&self.rule) + rest.index]
    }

    /// Clears the memory of all rests.
    pub(super) fn forget_rests(&mut self) {
        self.memory.fill(RestMemory::default());
    }

    /// Stores the force and grip of a rest of a shoe.
    pub(super) fn remember_rest(&mut self, shoe: usize, rest: &Touch, grip: Grip) {
        let shoe = shoe - self.rule.shoes.start;
        self.memory[shoe * of_a_shoe(&self.rule) + rest.rest_index] = RestMemory {
            force: rest.normal_guess,
            grip,
        };
    }

    /// [m/s] Speed of the chain: its length for each turn of its shoes relative to the chassis.
    fn speed(&self, state: &State) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let turns = shoes
            .iter()
            .map(|shoe| state.angular_velocity - shoe.twist.turn);
        turns.sum::<f64>() * self.rule.path.pitch / std::f64::consts::TAU
    }

    /// Integrates the lag of the chain behind its sprocket; the teeth move at a speed [m/s].
    pub(super) fn count(&mut self, drive_speed: f64, state: &State, h: f64) {
        self.lagged = self.behind;
        if self.has_sprocket() {
            self.behind += (drive_speed - self.speed(state)) * h;
        }
    }

    /// Undoes the last count.
    pub(super) fn rewind(&mut self) {
        self.behind = self.lagged;
    }

    pub(super) fn has_sprocket(&self) -> bool {
        self.rule.sprocket.is_some()
    }

    /// [m] Difference in travel between chain and sprocket.
    pub(super) fn sprocket_slip(&self) -> f64 {
        self.behind.abs()
    }

    /// [N] Force in each pin, and [m] its gap.
    pub(super) fn pins(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let reading = |pin: &Pin| (pin.force.length(), pin.gap.length());
        self.pins.iter().map(reading)
    }

    /// Stores the forces of a step of `h` [s].
    pub(super) fn remember(&mut self, ring: &Ring, h: f64) {
        for (pin, impulse) in self.pins.iter_mut().zip(ring.impulses()) {
            pin.force = impulse / h;
        }
    }
}
