//! Branches: the same instant as another scenario.

use std::sync::Arc;

use super::Simulation;
use super::gait::Driver;
use crate::contact::Dents;
use crate::diagnosis::Counterfactual;
use crate::dynamics::{DriveState, State, flippers_at_rest, idlers_at_rest, shoes_at_rest};
use crate::error::Error;
use crate::limits::Cancel;
use crate::observe::Seen;
use crate::robot::Model;
use crate::run::Checked;
use crate::scenario::{ClosedSurface, ClosedTrack, Robot, Scenario, ScenarioError, Track};
use crate::terrain::Ground;

impl Simulation {
    /// The robot of `variant` in this pose, with these speeds.
    ///
    /// What is unchanged continues bit by bit, also with another torque limit or without its belly. Another robot or
    /// track takes over the pose and the speeds; ground inside it is let out without a push. Outcome, stops and
    /// progress count from here.
    #[must_use]
    pub fn branch(&self, variant: &Checked) -> Self {
        let (ground, model) = (Arc::clone(variant.ground()), variant.model().clone());
        let variant = variant.scenario();
        if has_the_same_parts(&self.scenario.robot, &variant.robot) {
            self.continued(variant, ground, model)
        } else {
            self.rebuilt(variant, ground, model)
        }
    }

    /// The same state of a robot with the same parts, or without its belly.
    fn continued(&self, scenario: &Scenario, ground: Arc<Ground>, model: Model) -> Self {
        let mut branch = Self::of(scenario, ground, model, self.state.clone());
        branch.commanded_like(self);
        branch.dynamics.start_from(self.dynamics.impulses());
        branch.dents = self.dents.clone();
        branch.pace = self.pace;
        (branch.before, branch.free) = (self.before.clone(), self.free);
        branch.seen_ahead = self.seen_ahead;
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

    /// Tries a closed belt in this pose: smooth, or with the grousers of the track.
    ///
    /// # Errors
    /// [`Error::Simulation`] if the state has become non-finite, [`Error::Interrupted`] once `cancel` is requested,
    /// [`Error::Scenario`] as [`Self::with_closed_track`].
    pub fn counterfactual(
        &self,
        surface: ClosedSurface,
        cancel: &Cancel,
    ) -> Result<Counterfactual, Error> {
        let mut belt = self.with_closed_track(surface)?;
        let criteria = &self.scenario.criteria;
        let direction = if self.command < 0.0 { -1.0 } else { 1.0 };
        let start = belt.reading().position.x;
        let (mut distance, mut time): (f64, f64) = (0.0, f64::INFINITY);
        while belt.time() - self.time() < criteria.escape_time && !belt.is_over() {
            belt.step()?;
            cancel.check()?;
            distance = distance.max(direction * (belt.reading().position.x - start));
            if distance > criteria.escape_distance {
                time = time.min(belt.time() - self.time());
            }
        }
        Ok(Counterfactual {
            freed: time.is_finite(),
            distance,
            time,
            outcome: belt.outcome_now(),
        })
    }

    /// The same instant with a closed belt round the bodies of the track.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the belt is to have grousers and the track has none, or the outline's pitch makes more than
    /// a belt may have.
    pub fn with_closed_track(&self, surface: ClosedSurface) -> Result<Self, Error> {
        let mut scenario = self.scenario.clone();
        let robot = &mut scenario.robot;
        let has_grousers = || self.dynamics.model().has_grousers(&robot.outline);
        if surface == ClosedSurface::Own && !has_grousers() {
            let rule = "must have grousers to be compared with a belt with grousers";
            let error = ScenarioError::new("robot.track", "this model", rule);
            return Err(error.into());
        }
        robot.track = Track::Closed(ClosedTrack {
            of: Box::new(robot.track.open().clone()),
            surface,
        });
        let model = Model::on(robot, &self.ground)?;
        Ok(self.rebuilt(&scenario, Arc::clone(&self.ground), model))
    }

    /// Takes over the time and what is commanded then, unless its scenario has another command.
    fn commanded_like(&mut self, other: &Self) {
        (self.time, self.began) = (other.time, other.time);
        if self.scenario.drive == other.scenario.drive {
            (self.command, self.driver) = (other.command, other.driver);
        } else {
            (self.command, self.driver) = (self.scenario.drive.speed, Driver::default());
        }
        (self.set_point, self.set_point_before) = (other.set_point, other.set_point);
        self.push = other.push;
        self.monitor.seen = Seen::from(self.time);
    }
}

/// Whether two robots differ in their torque limit and a missing belly at most.
fn has_the_same_parts(one: &Robot, other: &Robot) -> bool {
    let mut like = one.clone();
    like.drivetrain.max_torque = other.drivetrain.max_torque;
    if other.belly.is_none() {
        like.belly = None;
    }
    like == *other
}
