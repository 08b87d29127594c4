//! What is seen of a simulation at an instant: at the end of a step, or within the last one.

use super::Simulation;
use crate::dynamics::State;
use crate::geometry::Pose;
use crate::observe::Reading;
use crate::robot::{Model, Running};
use crate::solver::Effort;

/// A simulation at an instant.
#[derive(Clone, Copy)]
pub(crate) struct Moment<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    /// [s] Simulated time.
    pub time: f64,
    /// [m/s] Set-point of the drivetrain.
    pub set_point: f64,
}

/// Buffers of [`Simulation::observe`].
#[derive(Default)]
pub(super) struct Scratch {
    /// A state within a step.
    state: State,
    running: Running,
    drive_speeds: Vec<f64>,
}

impl<'a> Moment<'a> {
    /// Pose of the chassis frame.
    pub(crate) fn pose(&self) -> Pose {
        self.state.pose(self.model)
    }

    /// The state as users see it.
    pub(crate) fn reading(&self) -> Reading {
        let (state, pose) = (self.state, self.pose());
        let driven = self.model.driven();
        let motors = driven.len() as f64;
        Reading {
            time: self.time,
            position: pose.translation,
            velocity: state.velocity_at(pose.translation),
            chassis_angle: state.angle,
            angular_velocity: state.angular_velocity,
            commanded_speed: self.set_point,
            track_speed: driven.clone().map(|k| self.drive_speed(k)).sum::<f64>() / motors,
            track_position: driven.map(|k| state.drives[k].position).sum::<f64>() / motors,
        }
    }

    /// Positions of the moving parts.
    pub(crate) fn running(&self, running: &mut Running) {
        self.state.running_after(0.0, self.model, running);
    }

    /// [m/s] Surface speed of one drive.
    pub(crate) fn drive_speed(&self, drive: usize) -> f64 {
        self.state.track_speed(self.model, drive)
    }

    /// [rad] Angles of the flippers relative to the chassis, the front first, upwards > 0.
    pub(crate) fn flipper_angles(self) -> impl Iterator<Item = f64> + 'a {
        let flippers = self.model.flippers.iter().enumerate();
        flippers.map(move |(k, flipper)| flipper.sign() * self.state.over_chassis(k))
    }

    /// [rad/s] Rates of these angles.
    pub(crate) fn flipper_rates(self) -> impl Iterator<Item = f64> + 'a {
        let turns = self.model.flippers.iter().zip(&self.state.flippers);
        turns.map(move |(flipper, turn)| flipper.sign() * (turn.rate - self.state.angular_velocity))
    }

    /// [N m] Torques of the flipper motors, means over the last step, upwards > 0.
    pub(crate) fn flipper_torques(self) -> impl Iterator<Item = f64> + 'a {
        let turns = self.model.flippers.iter().zip(&self.state.flippers);
        turns.map(move |(flipper, turn)| flipper.sign() * turn.torque)
    }
}

impl Simulation {
    /// The present instant.
    pub(crate) fn now(&self) -> Moment<'_> {
        Moment {
            model: self.dynamics.model(),
            state: &self.state,
            time: self.time,
            set_point: self.set_point,
        }
    }

    /// An instant of the last step, whose state is written to `state`.
    pub(crate) fn at<'a>(&'a self, time: f64, state: &'a mut State) -> Moment<'a> {
        if time >= self.time {
            return self.now();
        }
        let last = &self.last;
        let h = self.time - last.began;
        let share = (time - last.began) / h;
        let model = self.dynamics.model();
        state.set_between([&last.before, &self.state], model, (h, share));
        Moment {
            model,
            state,
            time,
            set_point: last.set_point + (self.set_point - last.set_point) * share,
        }
    }

    /// Shows the last step, and the solver's work in it, to the monitor, in parts that end when it looks.
    pub(super) fn observe(&mut self, effort: Effort) {
        // First, because a chain that has come off takes precedence over all other outcomes of the same step.
        if !self.dynamics.model().chains.is_empty() {
            self.monitor.observe_chains(self.dynamics.chain_reading());
        }
        self.monitor.observe_effort(effort);
        let mut scratch = std::mem::take(&mut self.scratch);
        let mut from = self.last.began;
        while from < self.time {
            let look = self.monitor.next_look();
            let to = if look > from {
                look.min(self.time)
            } else {
                self.time
            };
            self.observe_part(from, to, &mut scratch);
            from = to;
        }
        self.scratch = scratch;
    }

    fn observe_part(&mut self, from: f64, to: f64, scratch: &mut Scratch) {
        let middle = self.at(0.5 * (from + to), &mut scratch.state);
        let speeds = &mut scratch.drive_speeds;
        speeds.clear();
        speeds.extend((0..middle.state.drives.len()).map(|k| middle.drive_speed(k)));
        let forward_speed = middle.reading().forward_speed();
        let end = self.at(to, &mut scratch.state);
        let reading = end.reading();
        if !end.model.flippers.is_empty() {
            end.running(&mut scratch.running);
        }
        let drives = self.state.drives.iter().copied();
        self.monitor.observe(
            (&reading, forward_speed),
            self.commands.speed,
            self.dynamics.loaded(),
            drives.zip(speeds.iter().copied()),
            &scratch.running,
        );
    }
}
