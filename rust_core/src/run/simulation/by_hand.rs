//! Commands by hand, which override those of the scenario from now on.

use super::Simulation;
use super::commands::Push;
use crate::error::Error;
use crate::scenario::{Drive, End, Flippers, ScenarioError};

/// Commands by hand; what is `None` remains.
#[derive(Clone, Copy, Debug)]
pub struct ByHand {
    /// [m/s] Speed of the tracks.
    pub speed: Option<f64>,
    /// [rad] Angles of the flippers.
    pub flipper_angles: [(End, Option<f64>); 2],
    /// [N] Push at the centre of mass.
    pub push: Option<f64>,
}

impl Simulation {
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
    pub fn command_all(&mut self, commands: &ByHand) -> Result<(), Error> {
        let before = self.commands;
        let mut give = || {
            commands.push.map_or(Ok(()), |push| self.set_push(push))?;
            for (end, angle) in commands.flipper_angles {
                angle.map_or(Ok(()), |angle| self.set_flipper_angle(end, angle))?;
            }
            commands.speed.map_or(Ok(()), |speed| self.set_speed(speed))
        };
        let given = give();
        if given.is_err() {
            self.commands = before;
        }
        given
    }

    /// Checks commands without giving them.
    ///
    /// # Errors
    /// As [`Self::command_all`].
    pub fn check_commands(&mut self, commands: &ByHand) -> Result<(), Error> {
        let before = self.commands;
        let given = self.command_all(commands);
        self.commands = before;
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
