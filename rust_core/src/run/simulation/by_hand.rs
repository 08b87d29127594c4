//! Commands by hand: a speed holds until the next entry of the schedule; angles and rates of flippers override the gait
//! from then on.

use super::Simulation;
use super::commands::Push;
use crate::dynamics::FlipperCommand;
use crate::error::Error;
use crate::scenario::{Drive, End, Flippers, ScenarioError};

/// [rad] Largest angle that can be commanded.
const FULL_TURN: f64 = 6.3;

/// Commands by hand; `None` leaves a command as it is.
#[derive(Clone, Copy, Debug)]
pub struct ByHand {
    /// [m/s] Speed of the tracks.
    pub speed: Option<f64>,
    /// What the front and rear flippers are to do; they keep no level.
    pub flippers: [Option<FlipperCommand>; 2],
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
        // An entry that is due now does not count as a later one.
        let scheduled = &self.scenario.drive;
        self.commands.driver.speed(scheduled, self.time);
        self.commands.speed = speed;
        self.commands.follow_scenario = false;
        Ok(())
    }

    /// Commands the flippers at the front or at the rear from now on, overriding the gait; they follow within their
    /// limits.
    ///
    /// # Errors
    /// [`Error::Scenario`] if that end has none, an angle is not finite or exceeds a full turn, or a rate their own.
    pub fn command_flippers(&mut self, end: End, command: FlipperCommand) -> Result<(), Error> {
        let (what, unit, most) = match command {
            FlipperCommand::Angle(_) | FlipperCommand::Level(_) => ("angle", "rad", FULL_TURN),
            FlipperCommand::Rate(_) => {
                let flippers = self.scenario.robot.flippers.as_ref();
                ("rate", "rad/s", flippers.map_or(0.0, |f| f.rate_limit))
            }
        };
        let refuse = |rule: &str| {
            let path = match end {
                End::Front => format!("flipper_{what}"),
                End::Rear => format!("rear_flipper_{what}"),
            };
            Err(ScenarioError::new(path, command.value(), rule).into())
        };
        let mut ends = self.scenario.robot.flippers.iter().flat_map(Flippers::ends);
        if !ends.any(|has| has == end) {
            return refuse("must not be given, because the robot has no flippers there");
        }
        if !(-most..=most).contains(&command.value()) {
            return refuse(&format!("must be >= -{most} {unit} and <= {most} {unit}"));
        }
        self.commands
            .driver
            .take(usize::from(end == End::Rear), command);
        self.commands.follow_scenario = false;
        Ok(())
    }

    /// Gives commands of all kinds at once; if one is invalid, none takes effect.
    ///
    /// # Errors
    /// Those of [`Self::set_speed`], [`Self::command_flippers`] and [`Self::set_push`].
    pub fn command_all(&mut self, commands: &ByHand) -> Result<(), Error> {
        let before = self.commands;
        let mut give = || {
            commands.push.map_or(Ok(()), |push| self.set_push(push))?;
            for (end, given) in [End::Front, End::Rear].into_iter().zip(commands.flippers) {
                given.map_or(Ok(()), |command| self.command_flippers(end, command))?;
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

    /// Lets the push rise linearly to a force [N] in a time [s], from now on.
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

#[cfg(test)]
mod tests;
