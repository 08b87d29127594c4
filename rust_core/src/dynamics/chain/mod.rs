//! A chain of shoes on the guide of the chassis: pins, places where shoes rest on the guide, drive.

mod contacts;
mod pin;
mod pull;
mod system;

use rapier2d_f64::math::{Pose, Vector};
use serde::{Deserialize, Serialize};

use super::direct::Damper;
use super::grip::Grip;
use super::row::Row;
use super::state::{Shoe, State, Twist};
use crate::chain::ChainOfShoes;
use pin::Pin;
use pull::{Grasp, Pull, PullImpulses};
use system::ChainSystem;

/// Pitches by which a chain that has jumped off its guide hangs off it at least.
const FAR_OFF: f64 = 2.0;
/// Places at which a shoe can rest on the guide: on either end of it, and with its front pin.
pub(super) const RESTS: usize = 3;

/// One closed chain.
pub(super) struct Chain {
    pub rule: ChainOfShoes,
    pins: Vec<Pin>,
    pull: Pull,
    system: ChainSystem,
    /// Unit vectors along the shoes in this piece.
    alongs: Vec<Vector>,
    /// What the shoes' rests did last.
    pub memory: Vec<[RestMemory; RESTS]>,
    /// Velocities as they are without constraints, and as they come out of a solve.
    pub free: Vec<Twist>,
    pub solved: Vec<Twist>,
    /// [m/s] The same of the idler.
    pub idler_rate: f64,
    /// What holds the idler in this piece.
    idler: Damper,
    /// Whether a shoe was too far off the guide to come back when they were last looked at.
    pub is_off: bool,
}

/// What a rest's next solve starts from.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct RestMemory {
    /// [N]
    pub force: f64,
    pub grip: Grip,
}

/// A place where a shoe bears on the guide, or nearly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// Index in the chain, and which of its rests.
    pub shoe: usize,
    pub place: usize,
    pub point: Vector,
    /// From the guide to the shoe.
    pub normal: Vector,
    /// [m]
    pub gap: f64,
    /// How the place moves over the chassis with the idler, for each metre of its slide.
    pub slides: Vector,
}

/// What a step hands to the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChainImpulses {
    pins: Vec<Pin>,
    pull: PullImpulses,
    memory: Vec<[RestMemory; RESTS]>,
}

impl Chain {
    pub(super) fn new(rule: ChainOfShoes) -> Self {
        let count = rule.path.count;
        Self {
            pins: vec![Pin::default(); count],
            pull: Pull::default(),
            system: ChainSystem::new(count),
            alongs: Vec::with_capacity(count),
            memory: vec![Default::default(); count],
            free: vec![Twist::default(); count],
            solved: vec![Twist::default(); count],
            idler_rate: 0.0,
            idler: Damper::default(),
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

    pub(super) fn start_from(&mut self, impulses: ChainImpulses) {
        self.pins = impulses.pins;
        self.pull.impulses = impulses.pull;
        self.memory = impulses.memory;
    }

    /// Brings pins and drive to where the shoes are, the pins to close their gaps in `h` [s].
    pub(super) fn follow(&mut self, state: &State, chassis: Pose, h: f64) {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let (pitch, masses) = (self.rule.path.pitch, self.masses());
        self.alongs.clear();
        self.alongs.extend(shoes.iter().map(Shoe::along));
        for (i, pin) in self.pins.iter_mut().enumerate() {
            let pair = [i, (i + 1) % shoes.len()];
            pin.follow(
                pair.map(|i| shoes[i].center),
                pair.map(|i| self.alongs[i]),
                pitch,
            );
            pin.close(h, masses, pitch);
        }
        let axle = chassis.transform_point(self.rule.guide[0].center);
        self.pull
            .follow(&self.rule, (shoes, &self.alongs), state, axle);
        let tensioner = &self.rule.tensioner;
        let travel = state.idlers[self.rule.number].travel;
        let force = tensioner.pre_tension - tensioner.stiffness * travel;
        let stiffness = h * (tensioner.damping + h * tensioner.stiffness);
        self.idler = Damper::new(h * force, stiffness);
    }

    /// Keeps what a rest did.
    pub(super) fn remember_rest(&mut self, shoe: usize, row: &Row) {
        self.memory[shoe][row.place] = RestMemory {
            force: row.normal_guess,
            grip: row.grip,
        };
    }

    fn masses(&self) -> (f64, f64) {
        (self.rule.shoe_mass, self.rule.shoe_inertia)
    }

    /// Calls `found` for every place within `reach` [m] of the guide at which a shoe could rest.
    pub(super) fn rests(
        &mut self,
        chassis: Pose,
        travel: f64,
        place_of: impl Fn(usize) -> Pose,
        reach: f64,
        mut found: impl FnMut(Rest),
    ) {
        let rule = &self.rule;
        let (half, below) = (0.5 * rule.path.pitch, 0.5 * rule.plate_thickness);
        let deepest = -0.5 * rule.guide[0].radius.min(rule.guide[1].radius);
        self.is_off = false;
        for i in 0..rule.path.count {
            let place = place_of(i);
            let on_chassis = chassis.inverse() * place;
            for (k, end) in rule.guide.iter().enumerate() {
                let slides = if k == 1 { Vector::X } else { Vector::ZERO };
                let center = on_chassis.inverse_transform_point(end.center + slides * travel);
                let gap = -below - (center.y + end.radius);
                if center.x.abs() <= half && center.y < 0.0 && gap < reach {
                    found(Rest {
                        shoe: i,
                        place: k,
                        point: place.transform_point(Vector::new(center.x, -below)),
                        normal: place.rotation * Vector::Y,
                        gap,
                        slides: chassis.rotation * slides,
                    });
                }
            }
            let corner = on_chassis.transform_point(Vector::new(half, -below));
            let gap = -rule.hull.depth(corner);
            self.is_off |= gap < deepest || gap > FAR_OFF * rule.path.pitch;
            if gap < reach {
                found(Rest {
                    shoe: i,
                    place: RESTS - 1,
                    point: chassis.transform_point(corner),
                    normal: chassis.rotation * rule.hull.outward_at(corner),
                    gap,
                    slides: Vector::ZERO,
                });
            }
        }
    }

    /// The system of shoes, pins and drive; the drive gives `given` [N s] if it does not hold the speed
    /// `set_point` [m/s].
    pub(super) fn assemble(&mut self, set_point: f64, given: Option<f64>) {
        self.system.start(self.masses(), &self.free, self.idler);
        for (i, pin) in self.pins.iter().enumerate() {
            for (rows, damper) in pin.rows().into_iter().zip(pin.dampers()) {
                self.system.add_pin(i, rows, damper);
            }
        }
        let damper = self.pull.damper().shifted(self.pull.aim(set_point));
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

    /// Adds a rest of a shoe on the guide.
    pub(super) fn add_rest(
        &mut self,
        shoe: usize,
        on_shoe: [[f64; 3]; 2],
        back: [[f64; 4]; 2],
        damper: Damper,
    ) {
        self.system.add_between(shoe, on_shoe, back, damper);
    }

    pub(super) fn eliminate(&mut self, chassis: &mut [[f64; 4]; 3]) -> Option<()> {
        self.system.eliminate(chassis)
    }

    /// Finds the shoes' velocities from that of the chassis.
    pub(super) fn solve(&mut self, chassis: [f64; 3]) {
        self.idler_rate = self.system.follow(chassis, &mut self.solved);
    }

    /// Takes the impulses that belong to the velocities; how far these are from what they should be [m/s].
    pub(super) fn follow_velocities(
        &mut self,
        state: &State,
        set_point: f64,
        given: Option<f64>,
    ) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let mut off: f64 = 0.0;
        for (i, pin) in self.pins.iter_mut().enumerate() {
            let next = shoes[(i + 1) % shoes.len()].twist;
            off = off.max(pin.follow_velocities(shoes[i].twist, next));
        }
        let ahead = self.ahead(state, set_point);
        self.pull.impulses.impulse = given.unwrap_or_else(|| self.pull.damper().at(ahead));
        if given.is_none() {
            off = off.max(ahead.abs());
        }
        off
    }

    /// [m/s] What the drive is ahead of its aim.
    pub(super) fn ahead(&self, state: &State, set_point: f64) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        self.pull.speed(state.twist(), |i| shoes[i].twist) - self.pull.aim(set_point)
    }

    /// [m/s] Speed of the chain: its length for every turn of its shoes over the chassis.
    pub(super) fn speed(&self, state: &State) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let turns = shoes
            .iter()
            .map(|shoe| state.angular_velocity - shoe.twist.turn);
        turns.sum::<f64>() * self.rule.path.pitch / std::f64::consts::TAU
    }

    /// Keeps count of what the chain is behind the set-point, as long as the motor holds.
    pub(super) fn count(&mut self, state: &State, set_point: f64, holds: bool, h: f64) {
        if holds {
            self.pull.impulses.behind += (set_point - self.speed(state)) * h;
        }
    }

    /// The slope of the potential of shoes, pins and drive along the change `solved`, a share of it further on.
    pub(super) fn slope(
        &self,
        state: &State,
        chassis: Twist,
        (set_point, given): (f64, Option<f64>),
        share: f64,
    ) -> f64 {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let (mass, inertia) = self.masses();
        let mut slope = 0.0;
        for (i, change) in self.solved.iter().enumerate() {
            let gained = shoes[i].twist.plus(*change, share).less(self.free[i]);
            slope +=
                mass * gained.velocity.dot(change.velocity) + inertia * gained.turn * change.turn;
            let (next, next_change) = ((i + 1) % shoes.len(), self.solved[(i + 1) % shoes.len()]);
            let speed = self.pins[i].speed(shoes[i].twist, shoes[next].twist);
            let of_pin = self.pins[i].speed(*change, next_change);
            slope -= self.pins[i].at(speed + of_pin * share).dot(of_pin);
        }
        let of_drive = self.pull.speed(chassis, |i| self.solved[i]);
        let ahead = self.ahead(state, set_point) + of_drive * share;
        let rate = state.idlers[self.rule.number].rate + self.idler_rate * share;
        slope -= self.idler.at(rate) * self.idler_rate;
        slope - given.unwrap_or_else(|| self.pull.damper().at(ahead)) * of_drive
    }

    /// Whether the drive has anything to act on.
    pub(super) fn has_hold(&self) -> bool {
        self.pull.has_hold()
    }

    /// [N s] What the drive gives in this piece.
    pub(super) fn drive_impulse(&self) -> f64 {
        self.pull.impulses.impulse
    }

    /// [N] Force in each pin, and [m] its gap.
    pub(super) fn pins(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let reading = |pin: &Pin| (pin.force.length(), pin.gap.length());
        self.pins.iter().map(reading)
    }

    pub(super) fn settle(&mut self) {
        self.pins.iter_mut().for_each(Pin::settle);
        self.pull.impulses.center = self.pull.impulses.impulse;
    }

    pub(super) fn unsettle(&mut self) {
        self.pins.iter_mut().for_each(Pin::unsettle);
        self.pull.impulses.impulse = self.pull.impulses.center;
    }

    /// Starts a piece from the forces of the last one, in its time [s].
    pub(super) fn guess(&mut self, h: f64) {
        for pin in &mut self.pins {
            pin.guess(h);
        }
        let pull = &mut self.pull.impulses;
        pull.impulse = pull.force * h;
    }

    /// Keeps the forces of a piece of `h` [s].
    pub(super) fn remember(&mut self, h: f64) {
        for pin in &mut self.pins {
            pin.remember(h);
        }
        self.pull.impulses.force = self.pull.impulses.impulse / h;
    }
}
