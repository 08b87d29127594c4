//! A simulation of one robot on one ground, step by step.

mod attempt;
mod branch;
mod by_hand;
mod clear;
mod commands;
mod observation;
mod snapshot;
mod standing;
mod step;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use self::attempt::{Attempt, LastStep, Scratch};
pub use self::by_hand::ByHand;
use self::commands::{Commands, DriverView, ramp_time, set_point};
use super::ValidScenario;
use super::step_length::{SAME_TIME, StepControl, StepRule};
use crate::contact::{Contact, ContactFinder, Dents, Intrusion, TrackEnvelope};
use crate::diagnosis::{self, Balance, Diagnosis, Scene};
use crate::dynamics::{ChainReading, DriveState, Dynamics, Shoe, State};
use crate::engine::EngineWorld;
use crate::error::Error;
use crate::geometry::{Pose, Vector, direction};
use crate::limits::Cancel;
use crate::observe::{Event, Monitor, Outcome, Reading};
use crate::robot::{BodyKind, Model, Mount, Running, start_position};
use crate::scenario::{End, Engine, Gait, Scenario};
use crate::terrain::{Ground, Side};

/// A simulation: what was built from the scenario, and the current state.
pub struct Simulation {
    scenario: Scenario,
    ground: Arc<Ground>,
    contact: ContactFinder,
    dynamics: Dynamics,
    /// Another engine that moves the robot instead of our dynamics, if the scenario says so.
    engine: Option<EngineWorld>,
    step_rule: StepRule,
    /// [m] Distance of the robot's farthest point from its centre of mass.
    reach: f64,
    monitor: Monitor,
    commands: Commands,
    state: State,
    /// [s] Simulated time.
    time: f64,
    steps: u64,
    /// [m/s] Set-point of the drivetrain.
    set_point: f64,
    dents: Dents,
    step_control: StepControl,
    last: LastStep,
    attempt: Attempt,
    scratch: Scratch,
}

impl Simulation {
    /// Places the robot in front of the first edge, at rest.
    pub fn new(checked: &ValidScenario) -> Self {
        let ground = Arc::clone(checked.ground());
        let model = checked.model().clone();
        Self::at_rest(checked.scenario(), ground, model, checked.position())
    }

    /// The simulation of a scenario at the end of its first step that reaches a time [s].
    pub(super) fn replayed(
        scenario: &ValidScenario,
        at: f64,
        cancel: &Cancel,
    ) -> Result<Self, Error> {
        let mut simulation = Self::new(scenario);
        let end = scenario.scenario().duration.max(at);
        while simulation.time < at - SAME_TIME.value() {
            simulation.step_until(end)?;
            cancel.check()?;
        }
        Ok(simulation)
    }

    /// The same on a given ground instead of the scenario's.
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
        let engine = (scenario.solver.engine == Engine::Rapier)
            .then(|| EngineWorld::new(scenario, &model, &ground, &state));
        Self {
            engine,
            ..Self::of(scenario, ground, model, state)
        }
    }

    /// A robot in a given state on a ground, moved by our own dynamics.
    fn of(scenario: &Scenario, ground: Arc<Ground>, model: Model, state: State) -> Self {
        let method = scenario.solver.contact;
        let contact = ContactFinder::new(method, &model.parts, &ground.lanes);
        let reach = model.reach();
        let monitor = Monitor::new(scenario, &ground, &model);
        let step_rule = StepRule::of(scenario, &model.parts);
        let dynamics = Dynamics::new(
            model,
            ground
                .lanes
                .iter()
                .map(|lane| lane.friction.clone())
                .collect(),
            scenario.gravity,
            scenario.solver.clone(),
        );
        let mut simulation = Self {
            commands: Commands::of(&scenario.drive),
            scenario: scenario.clone(),
            ground,
            contact,
            dynamics,
            engine: None,
            step_rule,
            reach,
            monitor,
            last: LastStep::none(&state),
            state,
            time: 0.0,
            steps: 0,
            set_point: 0.0,
            dents: Dents::default(),
            step_control: StepControl::default(),
            attempt: Attempt::default(),
            scratch: Scratch::default(),
        };
        simulation.observe_from_here();
        simulation
    }

    /// Restarts the observations in the current pose.
    fn observe_from_here(&mut self) {
        let now = self.reading();
        let observed = &mut self.monitor.observed;
        observed.start = [now.position.x, now.track_position];
        (observed.min_angle, observed.max_angle) = (now.chassis_angle, now.chassis_angle);
    }

    /// Whether another engine instead of our own dynamics moves it.
    pub(crate) fn is_in_an_engine(&self) -> bool {
        self.engine.is_some()
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

    /// The robot as it is simulated.
    pub(crate) fn model(&self) -> &Model {
        self.dynamics.model()
    }

    /// The robot, the current positions of its moving parts, and the pose of its chassis.
    pub(crate) fn placed(&self) -> (&Model, Running, Pose) {
        let model = self.dynamics.model();
        (model, self.running(), self.state.pose(model))
    }

    /// The current state.
    pub fn reading(&self) -> Reading {
        self.now().reading()
    }

    /// [rad] Angles of the flippers relative to the chassis, the front first, upwards > 0.
    pub fn flipper_angles(&self) -> impl Iterator<Item = f64> + '_ {
        self.now().flipper_angles()
    }

    /// [rad/s] Rates of these angles.
    pub fn flipper_rates(&self) -> impl Iterator<Item = f64> + '_ {
        self.now().flipper_rates()
    }

    /// [N m] Torques of the flipper motors, means over the last step, upwards > 0.
    pub fn flipper_torques(&self) -> impl Iterator<Item = f64> + '_ {
        self.now().flipper_torques()
    }

    /// [s] Simulated time.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.steps
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
        // A robot at rest may still leave under a push that has just risen.
        let may_leave = || {
            let windows = f64::from(self.scenario.criteria.stationary_windows);
            self.time < self.commands.push.end() + windows * self.stop_window()
        };
        self.monitor.is_over() && (self.monitor.ended_as().is_some() || !may_leave())
    }

    /// How it ended, if neither in a stop nor by time; no trials are made.
    pub fn ended_as(&self) -> Option<Outcome> {
        self.monitor.ended_as()
    }

    /// [s] When the robot stopped under the present command, if it has; the command may have changed since the last
    /// check.
    fn stop_since(&self) -> Option<f64> {
        let is_of_it = self.monitor.direction() * self.commands.speed > 0.0;
        self.monitor.stop_since().filter(|_| is_of_it)
    }

    /// Whether the robot is stopped; no trials are made.
    pub fn is_stopped(&self) -> bool {
        self.stop_since().is_some()
    }

    /// Diagnosis of a stop before any trials; `None` if the robot is not stopped.
    pub(crate) fn examine(&self) -> Option<Diagnosis> {
        let since = self.stop_since()?;
        if self.monitor.ended_as().is_some() {
            return None;
        }
        let observed = diagnosis::StopTimes {
            time: self.time(),
            since,
            progress: self.monitor.progress(),
        };
        Some(self.with_scene(|scene| diagnosis::examine(scene, &self.monitor.stance(), &observed)))
    }

    /// Whether forces could hold the present stop; `None` if the robot is not stopped, or has no weight.
    pub(crate) fn balance(&self) -> Option<Balance> {
        let stationary = self.examine()?.stationary;
        let tolerance = diagnosis::tolerance(&self.scenario.criteria, stationary);
        self.with_scene(|scene| diagnosis::balance(scene, &self.monitor.stance(), tolerance))
    }

    /// Input of a diagnosis in addition to the stop.
    fn with_scene<T>(&self, of: impl FnOnce(&Scene) -> T) -> T {
        let running = self.running();
        let model = self.dynamics.model().as_one_body(&running);
        of(&Scene {
            model: &model,
            lanes: &self.ground.lanes,
            envelopes: self.monitor.envelopes(),
            criteria: &self.scenario.criteria,
            gravity: self.scenario.gravity,
            direction: self.direction(),
            set_point: self.set_point,
            half_length: self.half_length(),
            running,
        })
    }

    /// Whether it has followed the scenario from time 0 on: no branch, no command by hand, no push.
    pub(crate) fn follows_scenario(&self) -> bool {
        self.commands.follow_scenario
    }

    /// [s] Time without progress that counts as a stop.
    pub(crate) fn stop_window(&self) -> f64 {
        self.monitor.window(self.commands.speed)
    }

    /// [m/s] Commanded speed.
    pub(crate) fn command(&self) -> f64 {
        self.commands.speed
    }

    /// 1 or -1 as commanded.
    pub(crate) fn direction(&self) -> f64 {
        if self.commands.speed < 0.0 { -1.0 } else { 1.0 }
    }

    /// [m] Half the distance between the end axles.
    fn half_length(&self) -> f64 {
        0.5 * self.scenario.robot.outline.axle_distance()
    }

    /// [N] Weight of the whole robot.
    pub(crate) fn weight(&self) -> f64 {
        self.dynamics.model().total_mass() * self.scenario.gravity
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

    /// [m, m, rad] Middle between the pins and direction of travel of each shoe.
    pub fn shoe_poses(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let pose = |shoe: &Shoe| [shoe.center.x, shoe.center.y, shoe.angle];
        self.state.shoes.iter().map(pose)
    }

    /// [m] Travel of the surface of each drive.
    pub fn drive_positions(&self) -> impl Iterator<Item = f64> + '_ {
        self.state.drives.iter().map(|drive| drive.position)
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

    pub(crate) fn loaded(&self) -> &[Contact] {
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

impl Simulation {
    /// Decides the commands of drives and flippers from now on.
    pub(super) fn decide(&mut self) {
        let (drive, time) = (&self.scenario.drive, self.time);
        if let Some(speed) = self.commands.driver.speed(drive, time) {
            self.commands.speed = speed;
        }
        if let Some(flippers) = &self.scenario.robot.flippers {
            let sight = self.sight();
            self.commands.flippers = self.commands.driver.flippers(drive, flippers.angle, sight);
        }
    }

    /// What the driver sees.
    fn sight(&self) -> DriverView {
        DriverView {
            time: self.time,
            chassis_angle: self.state.angle,
            chassis_rate: self.state.angular_velocity,
            touches: [End::Front, End::Rear].map(|end| self.flipper_touches(end)),
        }
    }

    /// [s] When a command may change next, or the set-point reaches its command; infinite if neither does.
    pub(super) fn next_change(&self) -> f64 {
        let drive = &self.scenario.drive;
        let Commands { push, driver, .. } = &self.commands;
        let (of_flippers, look) = match &drive.gait {
            None => (None, f64::INFINITY),
            Some(Gait::Hold(hold)) => (hold.schedule.as_deref(), f64::INFINITY),
            Some(Gait::Climb(climb)) => (None, driver.next_change(climb, self.sight())),
        };
        let entries = [drive.schedule.as_deref(), of_flippers];
        let next = |entries: &[[f64; 2]]| {
            let past = entries.partition_point(|[from, _]| *from <= self.time);
            entries.get(past).map(|[from, _]| *from)
        };
        let next = entries.into_iter().flatten().filter_map(next);
        let limits = &self.scenario.robot.drivetrain;
        let ramp = ramp_time(self.set_point, self.commands.speed, limits);
        let ends = [push.end(), look].into_iter();
        let ends = ends.filter(|end| *end > self.time);
        next.chain(ends).fold(self.time + ramp, f64::min)
    }

    /// [m/s] The set-point of the drivetrain after a time [s].
    pub(super) fn set_point_after(&self, time: f64) -> f64 {
        let limits = &self.scenario.robot.drivetrain;
        set_point(self.set_point, self.commands.speed, limits, time)
    }

    /// Whether the flipper at an end bears on something beyond its root.
    fn flipper_touches(&self, end: End) -> bool {
        let model = self.dynamics.model();
        let Some(k) = model.flippers.iter().position(|f| f.end == end) else {
            return false;
        };
        let flipper = &model.flippers[k];
        let pivot = self.state.pose(model).transform_point(flipper.pivot);
        let along = end.sign() * direction(self.state.flippers[k].angle);
        self.loaded().iter().any(|l| {
            let beyond = (l.point - pivot).dot(along) > flipper.root_radius;
            let mount = model.parts[l.part].mount;
            beyond && l.normal_force > 0.0 && mount == Mount::Flipper(k)
        })
    }
}
