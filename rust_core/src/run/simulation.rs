//! A simulation of one robot on one ground, step by step.

mod branch;
mod command;
mod drive;
mod gait;
mod snapshot;
#[cfg(test)]
mod tests;
mod whole;

use std::sync::Arc;

use self::gait::Driver;
use super::Checked;
use super::record::Columns;
use crate::contact::{Contact, ContactFinder, Dents, Intrusion, TrackEnvelope};
use crate::diagnosis::{self, Diagnosis, Scene};
use crate::dynamics::{ChainReading, DriveState, Dynamics, LoadedContact, Shoe, State};
use crate::error::{Error, SimulationError};
#[cfg(test)]
use crate::geometry::Pose;
use crate::geometry::Vector;
use crate::observe::{Event, Monitor, Outcome, Reading};
use crate::robot::{BodyKind, Model, Running, start_position};
use crate::scenario::Scenario;
use crate::terrain::{Ground, Side};

/// A simulation: what was built from the scenario, and the current state.
pub struct Simulation {
    scenario: Scenario,
    ground: Arc<Ground>,
    contact: ContactFinder,
    dynamics: Dynamics,
    monitor: Monitor,
    state: State,
    step: u64,
    command: f64,
    driver: Driver,
    set_point: f64,
    dents: Dents,
    contacts: Vec<Contact>,
    /// Positions of the moving parts for the search for contacts.
    then: Running,
    /// [m] Distance of the robot's farthest point from its centre of mass.
    reach: f64,
}

impl Simulation {
    /// Places the robot in front of the first edge, at rest.
    pub fn new(checked: &Checked) -> Self {
        let ground = Arc::clone(checked.ground());
        let model = checked.model().clone();
        Self::at_rest(checked.scenario(), ground, model, checked.position())
    }

    /// The same on a ground given by the caller in place of the scenario's.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the robot does not fit on it.
    pub fn on_ground(scenario: &Scenario, ground: Ground) -> Result<Self, Error> {
        let model = Model::on(&scenario.robot, &ground)?;
        let position = start_position(scenario, &model, &ground)?;
        Ok(Self::at_rest(scenario, Arc::new(ground), model, position))
    }

    fn at_rest(scenario: &Scenario, ground: Arc<Ground>, model: Model, position: Vector) -> Self {
        let start = &scenario.start;
        let state = State::at_rest(&model, position, start.angle, start.track_phase);
        Self::of(scenario, ground, model, state)
    }

    /// A robot in a given state on a ground.
    fn of(scenario: &Scenario, ground: Arc<Ground>, model: Model, state: State) -> Self {
        let method = scenario.solver.contact;
        let contact = ContactFinder::new(method, &model.parts, &ground.lanes);
        let reach = model.reach();
        let monitor = Monitor::new(scenario, &ground, &model);
        let dynamics = Dynamics::new(
            model,
            ground.lanes.iter().map(|lane| lane.friction).collect(),
            scenario.gravity,
            scenario.solver.clone(),
        );
        Self {
            command: scenario.drive.speed,
            driver: Driver::default(),
            scenario: scenario.clone(),
            ground,
            contact,
            dynamics,
            monitor,
            state,
            step: 0,
            set_point: 0.0,
            dents: Dents::default(),
            contacts: Vec::new(),
            then: Running::default(),
            reach,
        }
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// [`Error::Simulation`] if the state has become non-finite; the simulation cannot go on then.
    pub fn step(&mut self) -> Result<(), Error> {
        self.step += 1;
        self.command();
        self.find_contacts();
        self.advance()?;
        self.observe();
        Ok(())
    }

    fn find_contacts(&mut self) {
        // A fast body finds a contact one step before it closes.
        let speed = self.state.fastest(self.reach);
        let prediction = self
            .scenario
            .solver
            .prediction_distance
            .max(2.0 * speed * self.time_step());
        // In the middle of the step: with normals from its beginning, the error would be as large as the angle that
        // a wheel turns round an edge in half a step.
        let (half, model) = (0.5 * self.time_step(), self.dynamics.model());
        let middle = self.state.pose_after(half, model);
        self.state.running_after(half, model, &mut self.then);
        self.contact
            .find(middle, &self.then, prediction, &mut self.contacts);
        self.dynamics.recognise(&mut self.contacts);
        let last = self.dynamics.loaded().iter().map(|l| &l.contact);
        self.dents.forgive(&mut self.contacts, &last);
    }

    /// Contacts at the current instant.
    fn contacts_now(&mut self) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let pose = self.state.pose(self.dynamics.model());
        let running = self.running();
        let prediction = self.scenario.solver.prediction_distance;
        self.contact.find(pose, &running, prediction, &mut contacts);
        contacts
    }

    /// Current positions of the moving parts.
    fn running(&self) -> Running {
        let mut running = Running::default();
        self.state
            .running_after(0.0, self.dynamics.model(), &mut running);
        running
    }

    /// The robot, the current positions of its moving parts, and the pose of its chassis.
    #[cfg(test)]
    pub(crate) fn placed(&self) -> (&Model, Running, Pose) {
        let model = self.dynamics.model();
        (model, self.running(), self.state.pose(model))
    }

    fn advance(&mut self) -> Result<(), SimulationError> {
        self.dynamics
            .advance(&mut self.state, &self.contacts, self.set_point, self.step)?;
        let contacts = self.dynamics.loaded().iter().map(|l| &l.contact);
        self.dents.heal(contacts);
        Ok(())
    }

    fn observe(&mut self) {
        let reading = self.reading();
        let model = self.dynamics.model();
        if !model.flippers.is_empty() {
            self.state.running_after(0.0, model, &mut self.then);
        }
        // First, because a chain that has come off takes precedence over all other outcomes of the same step.
        if !model.chains.is_empty() {
            self.monitor.observe_chains(self.dynamics.chain_reading());
        }
        self.monitor.observe_effort(self.dynamics.effort());
        let speeds = (0..self.state.drives.len()).map(|k| self.state.track_speed(model, k));
        let drives = self.state.drives.iter().copied().zip(speeds);
        self.monitor.observe(
            &reading,
            self.command,
            self.dynamics.loaded(),
            drives,
            &self.then,
        );
    }

    /// The current state.
    pub fn reading(&self) -> Reading {
        let pose = self.state.pose(self.dynamics.model());
        let model = self.dynamics.model();
        let driven = 0..model.motors;
        let motors = model.motors as f64;
        Reading {
            time: self.time(),
            position: pose.translation,
            velocity: self.state.velocity_at(pose.translation),
            chassis_angle: self.state.angle,
            angular_velocity: self.state.angular_velocity,
            commanded_speed: self.set_point,
            track_speed: driven.clone().map(|k| self.drive_speed(k)).sum::<f64>() / motors,
            track_position: driven.map(|k| self.state.drives[k].position).sum::<f64>() / motors,
        }
    }

    /// [rad] Angles of the flippers relative to the chassis, the front first, upwards > 0.
    pub fn flipper_angles(&self) -> impl Iterator<Item = f64> + '_ {
        let flippers = self.dynamics.model().flippers.iter().enumerate();
        flippers.map(|(k, flipper)| flipper.sign() * self.state.over_chassis(k))
    }

    /// [rad/s] Rates of these angles.
    pub fn flipper_rates(&self) -> impl Iterator<Item = f64> + '_ {
        let flippers = self.dynamics.model().flippers.iter();
        let turns = flippers.zip(&self.state.flippers);
        turns.map(|(flipper, turn)| flipper.sign() * (turn.rate - self.state.angular_velocity))
    }

    /// [N m] Torques of the flipper motors, means over the last step, upwards > 0.
    pub fn flipper_torques(&self) -> impl Iterator<Item = f64> + '_ {
        let flippers = self.dynamics.model().flippers.iter();
        let turns = flippers.zip(&self.state.flippers);
        turns.map(|(flipper, turn)| flipper.sign() * turn.torque)
    }

    /// [s] Simulated time.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.time_step()
    }

    /// [s] Length of one step.
    pub fn time_step(&self) -> f64 {
        self.scenario.solver.time_step
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The ground.
    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    /// Whether the outcome is certain, so that a run may end.
    pub fn is_over(&self) -> bool {
        self.monitor.is_over()
    }

    /// The outcome, as soon as it is certain.
    pub fn outcome(&self) -> Option<Outcome> {
        self.is_over().then(|| self.outcome_now())
    }

    /// The outcome if the run ended now.
    pub fn outcome_now(&self) -> Outcome {
        let ended = self.monitor.ended_as();
        let stopped = || self.diagnosis().map(|d| d.outcome);
        ended.or_else(stopped).unwrap_or(Outcome::TimedOut)
    }

    /// The diagnosis, if the robot is stopped.
    pub fn diagnosis(&self) -> Option<Diagnosis> {
        let since = self.monitor.stop_since()?;
        if self.monitor.ended_as().is_some() {
            return None;
        }
        let seen = diagnosis::Seen {
            time: self.time(),
            since,
            progress: self.monitor.progress(),
        };
        let running = self.running();
        let model = self.dynamics.model().as_one_body(&running);
        let scene = Scene {
            model: &model,
            lanes: &self.ground.lanes,
            envelopes: self.monitor.envelopes(),
            contact: self.scenario.solver.contact,
            criteria: &self.scenario.criteria,
            gravity: self.scenario.gravity,
            command: self.command,
            set_point: self.set_point,
            half_length: 0.5 * self.scenario.robot.outline.axle_distance,
            running,
        };
        Some(diagnosis::diagnose(&scene, &self.monitor.stance(), &seen))
    }

    /// The current intrusions into the envelope of each track, from the left.
    pub fn intrusions(&self) -> Vec<Intrusion> {
        let pose = self.state.pose(self.dynamics.model());
        let running = self.running();
        let of_track = |envelope: &TrackEnvelope| {
            let pose = running.mounted(envelope.mount, pose);
            envelope.intrusions(&self.ground.lanes[envelope.lane], pose)
        };
        self.monitor.envelopes().iter().flat_map(of_track).collect()
    }

    /// Stops and intrusions so far.
    pub fn events(&self) -> Vec<Event> {
        self.monitor.events(self.time())
    }

    /// State of the chains of shoes in the last step; zero if there are none.
    pub fn chain(&self) -> ChainReading {
        self.dynamics.chain_reading()
    }

    /// [N s] Momentum of the whole robot.
    pub fn momentum(&self) -> Vector {
        self.dynamics.momentum(&self.state)
    }

    /// The shoes of all chains.
    pub(crate) fn shoes(&self) -> &[Shoe] {
        &self.state.shoes
    }

    /// Number of points of the ground, and of parts of the robot.
    pub fn size(&self) -> (usize, usize) {
        let points = self.ground.lanes.iter().map(|lane| lane.points.len());
        (points.sum(), self.dynamics.model().parts.len())
    }

    /// The columns that are recorded.
    pub(crate) fn columns(&self) -> Columns {
        Columns::of(self.dynamics.model())
    }

    /// Number of drives.
    pub fn drives(&self) -> usize {
        self.state.drives.len()
    }

    /// [m/s] Surface speed of one drive.
    pub fn drive_speed(&self, drive: usize) -> f64 {
        self.state.track_speed(self.dynamics.model(), drive)
    }

    /// [N] Force of all motors at the surface, mean over the last step.
    pub fn drive_force(&self) -> f64 {
        self.state.drives.iter().map(|drive| drive.force).sum()
    }

    /// [N] The same of each drive.
    pub fn drive_forces(&self) -> impl Iterator<Item = f64> + '_ {
        self.state.drives.iter().map(|drive| drive.force)
    }

    pub(crate) fn drive_states(&self) -> &[DriveState] {
        &self.state.drives
    }

    pub(crate) fn loaded(&self) -> &[LoadedContact] {
        self.dynamics.loaded()
    }

    /// The lane of a part.
    pub(crate) fn side(&self, part: usize) -> Side {
        let part = &self.dynamics.model().parts[part];
        self.ground.lanes[part.lane].side
    }

    pub(crate) fn part_kind(&self, part: usize) -> BodyKind {
        self.dynamics.model().parts[part].kind
    }

    pub(crate) fn monitor(&self) -> &Monitor {
        &self.monitor
    }
}
