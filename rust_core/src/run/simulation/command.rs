//! Commands: from the schedule, from a gait, or by hand.

use super::Simulation;
use super::drive;
use super::gait::{Driver, Sight, Target};
use super::push::Push;
use crate::error::Error;
use crate::geometry::direction;
use crate::robot::Mount;
use crate::run::step_length::SAME_TIME;
use crate::scenario::{Drive, End, Flippers, Gait, ScenarioError};

/// What the robot is to do.
#[derive(Clone, Copy)]
pub(super) struct Commands {
    /// [m/s] Speed of the drives.
    pub speed: f64,
    pub driver: Driver,
    /// Where the driver wants the front and rear flippers.
    pub targets: [Target; 2],
    /// The push at the centre of mass, along x.
    pub push: Push,
    /// Whether they have been the scenario's from time 0 on: no branch, no command by hand, no push.
    pub follow_scenario: bool,
}

impl Commands {
    /// Those of a scenario at time 0.
    pub(super) fn of(drive: &Drive) -> Self {
        Self {
            speed: drive.speed,
            driver: Driver::default(),
            targets: Default::default(),
            push: Push::default(),
            follow_scenario: true,
        }
    }
}

impl Simulation {
    /// Decides what the drives and the flippers are to do from now on.
    pub(super) fn decide(&mut self) {
        let (drive, time) = (&self.scenario.drive, self.time);
        if let Some(speed) = self.commands.driver.speed(drive, time) {
            self.commands.speed = speed;
        }
        if let Some(flippers) = &self.scenario.robot.flippers {
            let sight = Sight {
                time,
                chassis_angle: self.state.angle,
                touches: [End::Front, End::Rear].map(|end| self.flipper_touches(end)),
            };
            self.commands.targets = self.commands.driver.targets(drive, flippers.angle, sight);
        }
    }

    /// [s] When a command changes next, or the set-point reaches its command; infinite if neither does.
    pub(super) fn next_change(&self) -> f64 {
        let drive = &self.scenario.drive;
        let of_flippers = match &drive.gait {
            Some(Gait::Hold(hold)) => hold.schedule.as_deref(),
            _ => None,
        };
        let entries = [drive.schedule.as_deref(), of_flippers];
        let next = |entries: &[[f64; 2]]| {
            let past = entries.partition_point(|[from, _]| *from <= self.time);
            entries.get(past).map(|[from, _]| *from)
        };
        let next = entries.into_iter().flatten().filter_map(next);
        let limits = &self.scenario.robot.drivetrain;
        let ramp = drive::ramp_time(self.set_point, self.commands.speed, limits);
        // A remainder that is only rounding is no ramp.
        let ramp = if ramp > SAME_TIME.value() {
            ramp
        } else {
            f64::INFINITY
        };
        let risen = Some(self.commands.push.end()).filter(|end| *end > self.time);
        next.chain(risen).fold(self.time + ramp, f64::min)
    }

    /// [m/s] The set-point of the drivetrain after a time [s].
    pub(super) fn set_point_after(&self, time: f64) -> f64 {
        let limits = &self.scenario.robot.drivetrain;
        drive::set_point(self.set_point, self.commands.speed, limits, time)
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

    /// Gives the drivetrain a new speed [m/s]; it follows within its limits.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the speed exceeds the drivetrain's.
    pub fn set_speed(&mut self, speed: f64) -> Result<(), Error> {
        let drive = Drive {
            speed,
            schedule: None,
            gait: None,
        };
        drive.check(&self.scenario.robot.drivetrain)?;
        self.commands.speed = speed;
        self.commands.follow_scenario = false;
        Ok(())
    }

    /// Turns the flippers at the front or at the rear to an angle [rad], upwards > 0, from now on, overriding the
    /// gait; they follow within their limits.
    ///
    /// # Errors
    /// [`Error::Scenario`] if that end has none, or the angle is not finite or exceeds a full turn.
    pub fn set_flipper_angle(&mut self, end: End, angle: f64) -> Result<(), Error> {
        let path = match end {
            End::Front => "flipper_angle",
            End::Rear => "rear_flipper_angle",
        };
        let mut ends = self.scenario.robot.flippers.iter().flat_map(Flippers::ends);
        if !ends.any(|has| has == end) {
            let rule = "must not be given, because the robot has no flippers there";
            return Err(ScenarioError::new(path, angle, rule).into());
        }
        if !(-6.3..=6.3).contains(&angle) {
            let rule = "must be >= -6.3 rad and <= 6.3 rad";
            return Err(ScenarioError::new(path, angle, rule).into());
        }
        self.commands
            .driver
            .hold(usize::from(end == End::Rear), angle);
        self.commands.follow_scenario = false;
        Ok(())
    }

    /// Gives commands of all kinds at once; if one is invalid, none takes effect.
    ///
    /// # Errors
    /// Those of [`Self::set_speed`], [`Self::set_flipper_angle`] and [`Self::set_push`].
    pub fn command_all(
        &mut self,
        speed: Option<f64>,
        flipper_angles: [(End, Option<f64>); 2],
        push: Option<f64>,
    ) -> Result<(), Error> {
        let before = self.commands;
        let mut give = || {
            push.map_or(Ok(()), |push| self.set_push(push))?;
            for (end, angle) in flipper_angles {
                angle.map_or(Ok(()), |angle| self.set_flipper_angle(end, angle))?;
            }
            speed.map_or(Ok(()), |speed| self.set_speed(speed))
        };
        let given = give();
        if given.is_err() {
            self.commands = before;
        }
        given
    }

    /// [N] The push at the centre of mass, along x.
    pub fn push(&self) -> f64 {
        self.commands.push.at(self.time)
    }

    /// Sets the push at the centre of mass to a force [N] along x, from now on.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the force is not finite or exceeds 1e15 N.
    pub fn set_push(&mut self, force: f64) -> Result<(), Error> {
        self.raise_push(force, 0.0)
    }

    /// Lets the push rise evenly to a force [N] in a time [s], from now on.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the force is not finite or exceeds 1e15 N, or the time is negative or exceeds 1e5 s.
    pub fn raise_push(&mut self, force: f64, rise_time: f64) -> Result<(), Error> {
        if !Push::may_be(force) {
            let rule = "must be >= -1e15 N and <= 1e15 N";
            return Err(ScenarioError::new("push", force, rule).into());
        }
        if !(0.0..=1e5).contains(&rise_time) {
            let rule = "must be >= 0 s and <= 100000 s";
            return Err(ScenarioError::new("push.rise_time", rise_time, rule).into());
        }
        self.commands.push = self.commands.push.raised(force, self.time, rise_time);
        self.commands.follow_scenario = false;
        Ok(())
    }
}
