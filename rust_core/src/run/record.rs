//! The record of a run: the history of its state and contacts as columns, and the memory that this takes.

#[cfg(test)]
mod tests;

use std::collections::TryReserveError;

use super::step_length::SAME_TIME;
use super::valid_scenario::{BYTES_A_CORNER, corners};
use super::{Simulation, ValidScenario};
use crate::diagnosis::Wanted;
use crate::dynamics::State;
use crate::error::LimitError;
use crate::limits::memory::{Budget, Rows, reserve};
use crate::observe::Loads;
use crate::robot::Model;
use crate::scenario::Scenario;
use crate::units::MetresPerSecond;

/// What to keep of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// [s] Time between two samples.
    pub sample_interval: f64,
    /// Keep the trace and the contact table; without it only outcome, metrics and events.
    pub history: bool,
    /// Trials to make if the run ends in a stop, in addition to those that decide its outcome.
    pub trials: Wanted,
}

impl Default for Record {
    fn default() -> Self {
        Self {
            sample_interval: 0.01,
            history: true,
            trials: Wanted::default(),
        }
    }
}

impl Record {
    /// Only outcome, metrics and events.
    pub fn summary() -> Self {
        Self {
            history: false,
            ..Self::default()
        }
    }

    /// Number of samples of a run of full duration.
    pub(crate) fn samples(&self, scenario: &Scenario) -> u64 {
        ((scenario.duration / self.sample_interval).ceil() as u64).saturating_add(2)
    }
}

/// Numbers of the recorded things that a robot has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns {
    pub parts: usize,
    pub drives: usize,
    pub shoes: usize,
    pub flippers: usize,
}

impl Columns {
    pub(crate) fn of(model: &Model) -> Self {
        Self {
            parts: model.parts.len(),
            drives: model.drives,
            shoes: model.shoes(),
            flippers: model.flippers.len(),
        }
    }
}

/// Makes a table from its columns, each with a type and a number of entries per row of a robot.
macro_rules! table {
    ($(#[$about:meta])* pub struct $Table:ident for $robot:ident {
        $($(#[$meaning:meta])* $column:ident: $Number:ty [$entries:expr],)*
    }) => {
        $(#[$about])*
        #[derive(Clone, Debug, Default)]
        pub struct $Table {
            $($(#[$meaning])* pub $column: Vec<$Number>,)*
        }

        impl $Table {
            /// Bytes of a row.
            fn bytes($robot: Columns) -> u64 {
                let entries: usize = [$($entries),*].iter().sum();
                8 * entries as u64
            }

            /// Reserves room in every column for a total number of rows.
            fn reserve(&mut self, $robot: Columns, rows: usize) -> Result<(), TryReserveError> {
                $(reserve(&mut self.$column, $entries * rows)?;)*
                Ok(())
            }

            /// Releases room that no row uses.
            fn shrink(&mut self) {
                $(self.$column.shrink_to_fit();)*
            }
        }
    };
}

table! {
    /// Samples of the state; every column has one entry per sample (two for x, y pairs).
    pub struct Trace for robot {
        /// [s] Time of the sample.
        time: f64 [1],
        /// [m] Origin of the chassis frame, x and y.
        position: f64 [2],
        /// [m/s] Velocity of that point, x and y.
        velocity: f64 [2],
        /// [rad] Nose up > 0.
        chassis_angle: f64 [1],
        /// [rad/s] Its rate of change.
        angular_velocity: f64 [1],
        /// [m/s] Set-point of the drivetrain.
        commanded_speed: f64 [1],
        /// [m/s] Surface speed of the track, mean over the drives.
        track_speed: f64 [1],
        /// [m] Travel of the track surface, mean over the drives.
        track_position: f64 [1],
        /// 1 - v / track speed; 0 where the track stands still.
        slip_ratio: f64 [1],
        /// [N] Force of the ground on the robot along its driven surfaces, mean of the interval.
        tractive_effort: f64 [1],
        /// [N] Force of all motors at the surface, mean of the interval.
        drive_force: f64 [1],
        /// [m/s] Surface speed of each drive.
        drive_speeds: f64 [robot.drives],
        /// [m] Travel of the surface of each drive.
        drive_positions: f64 [robot.drives],
        /// [N] Force of each motor, mean of the interval.
        drive_forces: f64 [robot.drives],
        /// [N] Largest force in a pin of a chain; 0 without chains.
        track_tension: f64 [1],
        /// [m, m, rad] Middle between the pins and direction of travel of each shoe.
        shoe_poses: f64 [3 * robot.shoes],
        /// [rad] Angle of the flippers at each end relative to the chassis, upwards > 0.
        flipper_angles: f64 [robot.flippers],
        /// [N m] Torque of their motors, mean of the interval.
        flipper_torques: f64 [robot.flippers],
    }
}

/// Collects samples during a run.
pub(crate) struct Recorder<'a> {
    /// [s] Time between two samples.
    every: f64,
    /// Number of the last multiple of `every` that has been sampled; 0 is time 0.
    taken: u64,
    /// [s] Time up to which forces have been added.
    until: f64,
    sums: Sums,
    columns: Columns,
    trace: Trace,
    samples: Rows<'a>,
    contacts: ContactTable,
    contact_rows: Rows<'a>,
    /// A state within a step.
    state: State,
}

/// Integrals of forces over an interval between two samples.
struct Sums {
    /// [s] Its length so far.
    time: f64,
    loads: Loads,
    /// [N s] Of each motor.
    forces: Vec<f64>,
    /// [N s] Of the ground along the driven surfaces.
    traction: f64,
    /// [N m s] Of the motors of the flippers.
    torques: Vec<f64>,
}

/// [m/s] Below this, the track counts as standing and has no slip.
const STANDS: MetresPerSecond = MetresPerSecond(1e-3);

impl Sums {
    /// Adds a part of the last step, `dt` [s] long.
    fn add(&mut self, simulation: &Simulation, dt: f64) {
        self.time += dt;
        self.loads.add(simulation.loaded(), dt);
        for (sum, drive) in self.forces.iter_mut().zip(simulation.drive_states()) {
            *sum += drive.force * dt;
            self.traction += drive.traction * dt;
        }
        for (sum, torque) in self.torques.iter_mut().zip(simulation.flipper_torques()) {
            *sum += torque * dt;
        }
    }
}

impl<'a> Recorder<'a> {
    pub(crate) fn new(
        simulation: &Simulation,
        record: Record,
        budget: &'a Budget,
    ) -> Result<Self, LimitError> {
        let columns = Columns::of(simulation.model());
        let mut recorder = Self {
            every: record.sample_interval,
            taken: 0,
            until: simulation.time(),
            sums: Sums {
                time: 0.0,
                loads: Loads::default(),
                forces: vec![0.0; columns.drives],
                traction: 0.0,
                torques: vec![0.0; columns.flippers],
            },
            columns,
            trace: Trace::default(),
            samples: Rows::new(budget, Trace::bytes(columns)),
            contacts: ContactTable::default(),
            contact_rows: Rows::new(budget, ContactTable::bytes(columns)),
            state: simulation.now().state.clone(),
        };
        // A beginning that misses its multiple by rounding is that sample.
        recorder.taken = ((recorder.until + SAME_TIME.value()) / recorder.every).floor() as u64;
        recorder.sample(simulation, simulation.time())?;
        Ok(recorder)
    }

    /// Takes in the last step and writes the samples that fall into it.
    pub(crate) fn step(&mut self, simulation: &Simulation) -> Result<(), LimitError> {
        loop {
            let next = (self.taken + 1) as f64 * self.every;
            let end = next.min(simulation.time());
            self.sums.add(simulation, end - self.until);
            self.until = end;
            if end < next {
                return Ok(());
            }
            self.taken += 1;
            self.sample(simulation, next)?;
        }
    }

    /// The record, including the interval that the end of the run cut short.
    pub(crate) fn finish(
        mut self,
        simulation: &Simulation,
    ) -> Result<(Trace, ContactTable), LimitError> {
        let end = simulation.time();
        let is_taken = |last: &f64| end - last < SAME_TIME.value();
        if !self.trace.time.last().is_some_and(is_taken) {
            self.sample(simulation, end)?;
        }
        self.trace.shrink();
        self.samples.shrink(self.trace.time.len());
        self.contacts.shrink();
        self.contact_rows.shrink(self.contacts.time.len());
        Ok((self.trace, self.contacts))
    }

    fn make_room(&mut self) -> Result<(), LimitError> {
        let (trace, contacts, columns) = (&mut self.trace, &mut self.contacts, self.columns);
        let rows = trace.time.len() + 1;
        self.samples
            .make_room(rows, |room| trace.reserve(columns, room))?;
        let rows = contacts.time.len() + self.sums.loads.count();
        self.contact_rows
            .make_room(rows, |room| contacts.reserve(columns, room))
    }

    fn sample(&mut self, simulation: &Simulation, time: f64) -> Result<(), LimitError> {
        self.make_room()?;
        let now = simulation.at(time, &mut self.state);
        let reading = now.reading();
        let length = std::mem::take(&mut self.sums.time);
        let share = if length > 0.0 { 1.0 / length } else { 0.0 };
        let t = &mut self.trace;
        t.time.push(time);
        t.position.extend([reading.position.x, reading.position.y]);
        t.velocity.extend([reading.velocity.x, reading.velocity.y]);
        t.chassis_angle.push(reading.chassis_angle);
        t.angular_velocity.push(reading.angular_velocity);
        t.commanded_speed.push(reading.commanded_speed);
        t.track_speed.push(reading.track_speed);
        t.track_position.push(reading.track_position);
        let forward = reading.forward_speed();
        let slip = if reading.track_speed.abs() < STANDS.value() {
            0.0
        } else {
            1.0 - forward / reading.track_speed
        };
        t.slip_ratio.push(slip);
        t.tractive_effort.push(self.sums.traction * share);
        t.drive_force
            .push(self.sums.forces.iter().sum::<f64>() * share);
        for (k, force) in self.sums.forces.iter_mut().enumerate() {
            t.drive_speeds.push(now.drive_speed(k));
            t.drive_positions.push(now.state.drives[k].position);
            t.drive_forces.push(*force * share);
            *force = 0.0;
        }
        t.track_tension.push(simulation.chain().tension);
        for shoe in &now.state.shoes {
            t.shoe_poses
                .extend([shoe.center.x, shoe.center.y, shoe.angle]);
        }
        t.flipper_angles.extend(now.flipper_angles());
        for torque in &mut self.sums.torques {
            t.flipper_torques.push(*torque * share);
            *torque = 0.0;
        }
        self.sums.traction = 0.0;
        self.contacts.append(simulation, time, &mut self.sums.loads);
        Ok(())
    }
}

table! {
    /// Contacts of all samples.
    #[allow(missing_docs)] // the columns are described in docs/conventions.md
    pub struct ContactTable for _robot {
        time: f64 [1],
        contact: i64 [1],
        lane: i64 [1],
        body: i64 [1],
        body_kind: i64 [1],
        segment: i64 [1],
        edge: i64 [1],
        x: f64 [1],
        y: f64 [1],
        normal_x: f64 [1],
        normal_y: f64 [1],
        normal_force: f64 [1],
        friction_force: f64 [1],
        surface_speed: f64 [1],
        penetration: f64 [1],
    }
}

impl Simulation {
    /// Contacts of the last step.
    pub fn contact_table(&self) -> ContactTable {
        let mut loads = Loads::default();
        loads.add(self.loaded(), 1.0);
        let mut table = ContactTable::default();
        table.append(self, self.time(), &mut loads);
        table
    }
}

impl ContactTable {
    /// Appends the loads of the interval that ends at `time` [s].
    pub(crate) fn append(&mut self, simulation: &Simulation, time: f64, loads: &mut Loads) {
        for r in loads.drain() {
            self.time.push(time);
            self.contact.push(r.number as i64);
            self.lane.push(simulation.side(r.part) as i64);
            self.body.push(r.part as i64);
            self.body_kind.push(simulation.part_kind(r.part) as i64);
            self.segment.push(r.facet as i64);
            self.edge.push(i64::from(r.edge));
            self.x.push(r.point.x);
            self.y.push(r.point.y);
            self.normal_x.push(r.normal.x);
            self.normal_y.push(r.normal.y);
            self.normal_force.push(r.normal_force);
            self.friction_force.push(r.friction_force);
            self.surface_speed.push(r.surface_speed);
            self.penetration.push((-r.distance).max(0.0));
        }
    }
}

/// Bytes of the stack of a thread.
pub(crate) const STACK: usize = 2 << 20;
/// Bytes per corner that the edges of a run take, including their copy as table columns.
const BYTES_AN_EDGE: u64 = 128;
/// Bytes of everything else that a run builds and returns.
pub(super) const BYTES_A_RUN: u64 = 64 << 10;

/// Checks that the memory for a batch is available, and returns the budget for its records.
///
/// # Errors
/// The batch needs more than it may have; the message says what would need less.
pub(crate) fn batch_budget(
    scenarios: &[ValidScenario],
    record: Record,
    threads: usize,
) -> Result<Budget, LimitError> {
    let terrain_of = |checked: &ValidScenario| corners(&checked.scenario().terrain);
    let kept = bytes_besides(scenarios.iter().map(terrain_of), threads);
    let mut recorded: u64 = 0;
    if record.history {
        for checked in scenarios {
            let bytes = bytes_of_sample(checked.model());
            let of_run = record.samples(checked.scenario()).saturating_mul(bytes);
            recorded = recorded.saturating_add(of_run);
        }
    }
    let budget = Budget::new()?;
    budget.check(&described(scenarios, record), kept.saturating_add(recorded))?;
    budget.take("a batch", kept)?;
    Ok(budget)
}

/// Bytes of a batch on grounds with these numbers of corners, without records: each thread builds one ground at a time.
fn bytes_besides(corners: impl Iterator<Item = u64> + Clone, threads: usize) -> u64 {
    let largest = corners.clone().max().unwrap_or(0);
    let built = threads as u64 * (STACK as u64 + largest * BYTES_A_CORNER);
    let given_back = corners.map(|corners| BYTES_A_RUN + corners * BYTES_AN_EDGE);
    built + given_back.sum::<u64>()
}

fn described(scenarios: &[ValidScenario], record: Record) -> String {
    let runs = match scenarios.len() {
        1 => "a run".to_owned(),
        n => format!("a batch of {n} runs"),
    };
    if record.history {
        let every = record.sample_interval;
        format!(
            "{runs} sampled every {every} s (a longer sample_interval, or \"summary\", takes less)"
        )
    } else {
        runs
    }
}

/// Bytes of a sample with half of the robot's parts in contact.
fn bytes_of_sample(model: &Model) -> u64 {
    let columns = Columns::of(model);
    let touching = (columns.parts / 2).max(2);
    Trace::bytes(columns) + touching as u64 * ContactTable::bytes(columns)
}
