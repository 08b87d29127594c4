//! A chain of shoes that runs on a guide or wheels: its pins, rests and drive.
//!
//! The equations: docs/physics.md, "Chains".

mod contacts;
mod elimination;
mod motion;
mod pin;
mod pull;
mod rest;
mod rests;
mod system;
mod wheels;

use pin::Pin;
use pull::{Grasp, Pull, PullImpulses};
use rest::{Rest, of_a_shoe};
use serde::{Deserialize, Serialize};
use system::{Beside, ChainSystem};

use super::damper::Damper;
use super::grip::Grip;
use super::row::Row;
use super::state::{Shoe, State, Twist};
use crate::geometry::{Pose, Vector, plausible};
use crate::robot::ChainOfShoes;

pub(super) use rest::Stand;

/// Stiffness of an idler's stop in units of its tensioner's. Harder stops work, but a chain that is tightened
/// by an obstacle hits them with kilonewtons.
const STOP_STIFFNESS: f64 = 100.0;

/// One closed chain.
pub(super) struct Chain {
    pub rule: ChainOfShoes,
    pins: Vec<Pin>,
    pull: Pull,
    system: ChainSystem,
    /// The shoes in the middle of this step, and unit vectors along them.
    middle: Vec<Shoe>,
    alongs: Vec<Vector>,
    /// [kg m^2] Moments of inertia of the shoes in this solve.
    inertias: Vec<f64>,
    /// Poses of the shoes, in the world and in the chassis frame, when rests were last searched for.
    places: Vec<[Pose; 2]>,
    /// The last forces and grips of the rests, shoe by shoe.
    memory: Vec<RestMemory>,
    /// Velocities of the shoes without constraints; `solved` holds those of the last solve.
    pub free: Vec<Twist>,
    pub solved: Vec<Twist>,
    /// [m/s] Rate of the idler in the last solve.
    pub idler_rate: f64,
    /// [rad/s] Spin of the sprocket in the last solve.
    pub spin: f64,
    free_spin: f64,
    /// The spring and damper of the idler in this step.
    idler: Damper,
    /// [m] How far it lagged behind its drive when the step began.
    lagged: f64,
    /// Whether a shoe was too far off the guide to come back when last checked.
    pub is_off: bool,
}

/// Initial guess for the next solve of a rest.
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
    pull: PullImpulses,
    memory: Vec<RestMemory>,
}

impl Chain {
    pub(super) fn new(rule: ChainOfShoes) -> Self {
        let count = rule.path.count;
        Self {
            pins: vec![Pin::default(); count],
            pull: Pull::default(),
            system: ChainSystem::new(count),
            middle: Vec::with_capacity(count),
            alongs: Vec::with_capacity(count),
            inertias: vec![rule.shoe_inertia; count],
            places: Vec::with_capacity(count),
            memory: vec![RestMemory::default(); count * of_a_shoe(&rule)],
            free: vec![Twist::default(); count],
            solved: vec![Twist::default(); count],
            idler_rate: 0.0,
            spin: 0.0,
            free_spin: 0.0,
            idler: Damper::default(),
            lagged: 0.0,
            is_off: false,
            rule,
        }
    }

    pub(super) fn impulses(&self) -> ChainImpulses {
        ChainImpulses {
            pins: self.pins.clone(),
            pull: self.pull.impulses,
            memory: self.memory.clone(),
        }
    }

    /// Whether a step of this chain can have left these impulses.
    pub(super) fn fits(&self, impulses: &ChainImpulses) -> bool {
        let ChainImpulses { pins, pull, memory } = impulses;
        let counts = pins.len() == self.pins.len() && memory.len() == self.memory.len();
        counts
            && pull.is_plausible()
            && pins.iter().all(Pin::is_plausible)
            && memory.iter().all(|rest| plausible(&[rest.force]))
    }

    pub(super) fn start_from(&mut self, impulses: ChainImpulses) {
        self.pins = impulses.pins;
        self.pull.impulses = impulses.pull;
        self.memory = impulses.memory;
    }

    /// The last force and grip of a rest.
    pub(super) fn recall(&self, rest: &Rest) -> RestMemory {
        self.memory[rest.shoe * of_a_shoe(&self.rule) + rest.place]
    }

    /// Clears the memory of all rests.
    pub(super) fn forget_rests(&mut self) {
        self.memory.fill(RestMemory::default());
    }

    /// Stores the force and grip of a rest.
    pub(super) fn remember_rest(&mut self, shoe: usize, row: &Row) {
        let place = shoe * of_a_shoe(&self.rule) + row.place;
        self.memory[place] = RestMemory {
            force: row.normal_guess,
            grip: row.grip,
        };
    }

    /// Assembles the system of shoes, pins and drive; the drive gives the impulse `given` [N s] if it does not
    /// hold the speed `set_point` [m/s].
    pub(super) fn assemble(&mut self, set_point: f64, given: Option<f64>) {
        self.system.start(self.idler);
        let damper = self.pull.damper().shifted(set_point);
        if let (Some(sprocket), Some(lever)) = (&self.rule.sprocket, self.pull.lever) {
            self.system.add_sprocket(sprocket.inertia, self.free_spin);
            let damper = given.map_or(damper, Damper::constant);
            self.system.turn_sprocket(lever, damper);
            return;
        }
        for Grasp {
            shoe,
            on_shoe,
            on_chassis,
        } in &self.pull.shoes
        {
            if let Some(impulse) = given {
                self.system.push(*shoe, *on_shoe, *on_chassis, impulse);
            } else {
                self.system.add_drive(*shoe, *on_shoe, *on_chassis);
            }
        }
        if given.is_none() {
            self.system.set_drive(damper);
        }
    }

    /// Adds a contact of a shoe with the ground.
    pub(super) fn add(&mut self, shoe: usize, rows: [[f64; 3]; 2], damper: Damper) {
        self.system.add(shoe, rows, damper);
    }

    /// Adds a rest of a shoe on the guide or a wheel.
    pub(super) fn add_rest(
        &mut self,
        shoe: usize,
        on_shoe: [[f64; 3]; 2],
        back: [[f64; 4]; 2],
        damper: Damper,
    ) {
        let back = (back, Beside::Idler);
        self.system.add_between(shoe, on_shoe, back, damper);
    }

    /// Adds a rest of a pin on a tooth of the sprocket.
    pub(super) fn add_tooth(
        &mut self,
        shoe: usize,
        on_shoe: [[f64; 3]; 2],
        back: [[f64; 4]; 2],
        damper: Damper,
    ) {
        let back = (back, Beside::Sprocket);
        self.system.add_between(shoe, on_shoe, back, damper);
    }

    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        self.system.eliminate(chassis)
    }

    /// Finds the velocities of the shoes from that of the chassis.
    pub(super) fn solve(&mut self, chassis: [f64; 3]) {
        [self.idler_rate, self.spin] = self.system.follow(chassis, &mut self.solved);
    }

    /// [N s] Impulse of a drive that holds, and is so much faster [m/s] than it aims to be.
    pub(super) fn held(&self, ahead: f64) -> f64 {
        self.pull.damper().at(ahead)
    }

    /// Updates the drive's impulse to match a drive that is so much faster [m/s] than it aims to be; returns the error
    /// of its speed [m/s].
    pub(super) fn follow_drive(&mut self, ahead: f64, given: Option<f64>) -> f64 {
        self.pull.impulses.impulse = given.unwrap_or_else(|| self.held(ahead));
        if given.is_none() { ahead.abs() } else { 0.0 }
    }

    /// [m/s] Rate of the motor's travel.
    pub(super) fn drive_speed(&self, state: &State) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let spin = state.drives[self.rule.number].spin;
        self.pull.speed(state.twist(), spin, |i| shoes[i].twist)
    }

    /// [m/s] Speed of the chain: one chain length per turn of its shoes relative to the chassis.
    fn speed(&self, state: &State) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let turns = shoes
            .iter()
            .map(|shoe| state.angular_velocity - shoe.twist.turn);
        turns.sum::<f64>() * self.rule.path.pitch / std::f64::consts::TAU
    }

    /// Integrates how far the chain lags behind its sprocket.
    pub(super) fn count(&mut self, state: &State, h: f64) {
        self.lagged = self.pull.impulses.behind;
        if self.has_sprocket() {
            self.pull.impulses.behind += (self.drive_speed(state) - self.speed(state)) * h;
        }
    }

    /// Forgets the last count.
    pub(super) fn rewind(&mut self) {
        self.pull.impulses.behind = self.lagged;
    }

    pub(super) fn has_sprocket(&self) -> bool {
        self.rule.sprocket.is_some()
    }

    /// [m] Difference in travel between chain and sprocket.
    pub(super) fn sprocket_slip(&self) -> f64 {
        self.pull.impulses.behind.abs()
    }

    /// [1/kg] Admittance of the sprocket at a lever [m].
    pub(super) fn admittance(&self, lever: f64) -> f64 {
        let sprocket = self.rule.sprocket.as_ref();
        sprocket.map_or(0.0, |sprocket| lever * lever / sprocket.inertia)
    }

    /// Whether the drive has anything to act on.
    pub(super) fn has_hold(&self) -> bool {
        self.pull.has_hold()
    }

    /// [N s] Impulse of the drive in this step.
    pub(super) fn drive_impulse(&self) -> f64 {
        self.pull.impulses.impulse
    }

    /// [N] Force in each pin, and [m] its gap.
    pub(super) fn pins(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let reading = |pin: &Pin| (pin.force.length(), pin.gap.length());
        self.pins.iter().map(reading)
    }

    pub(super) fn settle(&mut self) {
        self.pull.impulses.center = self.pull.impulses.impulse;
    }

    /// Starts a step of `h` [s] from the forces of the last one.
    pub(super) fn guess(&mut self, h: f64) {
        let pull = &mut self.pull.impulses;
        pull.impulse = pull.force * h;
    }

    /// The same for the rest of the step, another `h` [s].
    pub(super) fn guess_more(&mut self, h: f64) {
        let pull = &mut self.pull.impulses;
        pull.impulse += pull.force * h;
    }

    /// Stores the forces of a step of `h` [s].
    pub(super) fn remember(&mut self, h: f64) {
        for (pin, impulse) in self.pins.iter_mut().zip(self.system.impulses()) {
            pin.force = impulse / h;
        }
        self.pull.impulses.force = self.pull.impulses.impulse / h;
    }
}
