//! Branches: continuations from the same instant as another scenario.

use std::sync::Arc;

use super::Simulation;
use super::commands::{Commands, has_the_same_speeds};
use crate::contact::Dents;
use crate::dynamics::{DriveState, State, flippers_at_rest, idlers_at_rest, shoes_at_rest};
use crate::error::Error;
use crate::observe::Observations;
use crate::robot::Model;
use crate::run::ValidScenario;
use crate::scenario::{Robot, Scenario};
use crate::terrain::Ground;

impl Simulation {
    /// The robot of `variant` in this pose, with these speeds.
    ///
    /// An unchanged robot continues bit by bit, also with another torque limit or without its belly. Another robot or
    /// track, or one that another engine has moved, takes over the pose and the speeds, and ground inside it is let out
    /// without a push. Our own dynamics move the branch. Outcome, stops and progress count from here.
    #[must_use]
    pub fn branch(&self, variant: &ValidScenario) -> Self {
        let (ground, model) = (Arc::clone(variant.ground()), variant.model().clone());
        let variant = variant.scenario();
        let rebuilt = !has_the_same_parts(&self.scenario.robot, &variant.robot);
        self.carried_over(variant, (ground, model), rebuilt)
    }

    /// The same instant of another scenario, rebuilt if requested, if another engine moves this one, or if the robot
    /// has other lanes under it: doubled friction can make the ground of two tracks equal, so that they are simulated
    /// as one.
    fn carried_over(
        &self,
        scenario: &Scenario,
        (ground, model): (Arc<Ground>, Model),
        rebuilt: bool,
    ) -> Self {
        if rebuilt || self.engine.is_some() || !self.ground.has_lanes_of(&ground) {
            self.rebuilt(scenario, ground, model)
        } else {
            self.continued(scenario, ground, model)
        }
    }

    /// The same state for a robot with the same parts, or without its belly.
    fn continued(&self, scenario: &Scenario, ground: Arc<Ground>, model: Model) -> Self {
        let mut branch = Self::of(scenario, ground, model, self.state.clone());
        branch.commanded_like(self);
        branch.dynamics.start_from(self.dynamics.impulses());
        branch.dents = self.dents.clone();
        branch.step_control = self.step_control;
        branch.last.before.copy(&self.last.before);
        (branch.last.free, branch.last.sight) = (self.last.free, self.last.sight);
        branch
    }

    /// Another model in this pose, with its drives at the mean speed of the present ones.
    fn rebuilt(&self, scenario: &Scenario, ground: Arc<Ground>, model: Model) -> Self {
        let (now, pose) = (self.reading(), self.state.pose(self.dynamics.model()));
        let center = now.position + pose.rotation * model.center_of_mass;
        let drive = DriveState {
            spin: now.angular_velocity - now.track_speed / model.drive_radius,
            position: now.track_position,
            ..DriveState::default()
        };
        let mut state = State {
            center,
            angle: now.chassis_angle,
            velocity: self.state.velocity_at(center),
            angular_velocity: now.angular_velocity,
            drives: vec![drive; model.drives],
            shoes: shoes_at_rest(&model, pose, now.track_position),
            idlers: idlers_at_rest(&model, now.track_position),
            flippers: if model.flippers.len() == self.state.flippers.len() {
                self.state.flippers.clone()
            } else {
                flippers_at_rest(&model, now.chassis_angle)
            },
        };
        state.run_shoes(&model, now.track_speed);
        let mut branch = Self::of(scenario, ground, model, state);
        branch.commanded_like(self);
        let mut contacts = branch.contacts_now();
        branch.dynamics.take_over(&mut contacts);
        branch.dents = Dents::of(&contacts);
        branch
    }

    /// A copy in the same engine whose observations begin now, and which continues with its present commands.
    pub(in crate::run) fn copy(&self) -> Self {
        let model = self.dynamics.model().clone();
        let mut copy = self.continued(&self.scenario, Arc::clone(&self.ground), model);
        copy.engine.clone_from(&self.engine);
        copy.commands.follow_scenario = self.commands.follow_scenario;
        let driver = &mut copy.commands.driver;
        driver.ignore_schedules(&self.scenario.drive, self.time);
        copy
    }

    /// The same instant as a variant of the scenario; one that is not rebuilt must have the same parts, or no belly.
    ///
    /// # Errors
    /// [`Error::Scenario`] if its robot or its ground cannot be built.
    pub(in crate::run) fn varied(&self, variant: &Scenario, rebuilt: bool) -> Result<Self, Error> {
        let ground = if variant.terrain == self.scenario.terrain {
            Arc::clone(&self.ground)
        } else {
            Arc::new(Ground::new(&variant.terrain, variant.robot.gauge)?)
        };
        let model = Model::on(&variant.robot, &ground)?;
        Ok(self.carried_over(variant, (ground, model), rebuilt))
    }

    /// Takes over the time and the present commands, unless its scenario has others.
    fn commanded_like(&mut self, other: &Self) {
        (self.time, self.last.began) = (other.time, other.time);
        let (before, now) = (&other.scenario.drive, &self.scenario.drive);
        self.commands = Commands {
            speed: if has_the_same_speeds(before, now) {
                other.commands.speed
            } else {
                now.speed
            },
            driver: other.commands.driver.commanded(before, now),
            push: other.commands.push,
            follow_scenario: false,
            ..self.commands
        };
        (self.set_point, self.last.set_point) = (other.set_point, other.set_point);
        self.monitor.observed = Observations::from(self.time);
        self.observe_from_here();
    }
}

/// Whether two robots differ at most in the torque of their motors and a missing belly.
fn has_the_same_parts(one: &Robot, other: &Robot) -> bool {
    let mut like = one.clone();
    like.drivetrain.max_torque = other.drivetrain.max_torque;
    (like.drivetrain.torque_curve).clone_from(&other.drivetrain.torque_curve);
    like == *other || like.without_belly().is_some_and(|bare| bare == *other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::trials::tests::engineer;

    #[test]
    fn a_robot_with_other_motors_or_without_its_belly_has_the_same_parts() {
        let robot = engineer().robot;
        let with = |change: fn(&mut Robot)| {
            let mut other = robot.clone();
            change(&mut other);
            has_the_same_parts(&robot, &other)
        };
        let bare = robot.without_belly().expect("it has one");
        assert!(with(|_| {}) && with(|r| r.drivetrain.max_torque *= 2.0));
        assert!(with(
            |r| r.drivetrain.torque_curve = Some(vec![[0.0, 6.0], [2.0, 0.0]])
        ));
        assert!(has_the_same_parts(&robot, &bare));
        // A belly that was not there is another part, and mass is no part of the motors.
        assert!(!has_the_same_parts(&bare, &robot));
        assert!(!with(|r| r.mass += 1.0) && !with(|r| r.drivetrain.max_speed *= 2.0));
    }
}
