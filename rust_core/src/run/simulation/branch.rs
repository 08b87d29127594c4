//! Branches: the same instant with another track, friction or command, or with a closed belt.

use std::sync::Arc;

use super::Simulation;
use crate::contact::Dents;
use crate::diagnosis::Counterfactual;
use crate::dynamics::{DriveState, State, flippers_at_rest, idlers_at_rest, shoes_at_rest};
use crate::error::Error;
use crate::limits::Cancel;
use crate::observe::Seen;
use crate::robot::Model;
use crate::run::Checked;
use crate::scenario::{Scenario, ScenarioError};
use crate::terrain::Ground;

impl Simulation {
    /// The robot of `variant` in this pose, with these speeds.
    ///
    /// What is unchanged continues bit by bit. Another robot or track takes over the pose and the speeds; ground
    /// inside it is let out without a push. Outcome, stops and progress count from here.
    #[must_use]
    pub fn branch(&self, variant: &Checked) -> Self {
        let (ground, model) = (Arc::clone(variant.ground()), variant.model().clone());
        let variant = variant.scenario();
        let mut branch = self.with(variant, ground, model);
        branch.command = variant.drive.speed;
        if variant.robot == self.scenario.robot {
            branch.state = self.state.clone();
            branch.dynamics.start_from(self.dynamics.impulses());
            branch.dents = self.dents.clone();
            branch.pace = self.pace;
            (branch.before, branch.free) = (self.before.clone(), self.free);
            branch.seen_ahead = self.seen_ahead;
        }
        branch
    }

    /// Tries a closed belt with the same envelope, force and friction in this pose.
    ///
    /// # Errors
    /// [`Error::Simulation`] if the state has become non-finite, [`Error::Interrupted`] once `cancel` is requested.
    pub fn counterfactual(&self, cancel: &Cancel) -> Result<Counterfactual, Error> {
        self.try_belt(self.with_closed_belt()?, cancel)
    }

    /// The same for a belt with grousers as high as those of the track.
    ///
    /// # Errors
    /// As [`Self::counterfactual`], and [`Error::Scenario`] if the track has none.
    pub fn counterfactual_with_grousers(&self, cancel: &Cancel) -> Result<Counterfactual, Error> {
        self.try_belt(self.with_closed_belt_with_grousers()?, cancel)
    }

    /// The same instant, with such a belt.
    ///
    /// # Errors
    /// [`Error::Scenario`] if the track has no grousers, or the pitch makes more than a belt may have.
    pub fn with_closed_belt_with_grousers(&self) -> Result<Self, Error> {
        let (model, outline) = (self.dynamics.model(), &self.scenario.robot.outline);
        if !model.has_grousers(outline) || outline.grouser_thickness <= 0.0 {
            let rule = "must have grousers to be compared with a belt with grousers";
            let error = ScenarioError::new("robot.track", "this model", rule);
            return Err(error.into());
        }
        let closed = model.closed(Some(outline))?;
        Ok(self.with(&self.scenario, Arc::clone(&self.ground), closed))
    }

    fn try_belt(&self, mut belt: Self, cancel: &Cancel) -> Result<Counterfactual, Error> {
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
    /// [`Error::Scenario`] if there is no such belt.
    pub fn with_closed_belt(&self) -> Result<Self, Error> {
        let model = self.dynamics.model().closed(None)?;
        Ok(self.with(&self.scenario, Arc::clone(&self.ground), model))
    }

    /// Another model in this pose, with its drives at the mean speed of the present ones.
    fn with(&self, scenario: &Scenario, ground: Arc<Ground>, model: Model) -> Self {
        let now = self.reading();
        let center =
            now.position + self.state.pose(self.dynamics.model()).rotation * model.center_of_mass;
        let drive = DriveState {
            spin: now.angular_velocity - now.track_speed / model.drive_radius,
            position: now.track_position,
            ..DriveState::default()
        };
        let now_pose = self.state.pose(self.dynamics.model());
        let mut state = State {
            center,
            angle: now.chassis_angle,
            velocity: self.state.velocity_at(center),
            angular_velocity: now.angular_velocity,
            drives: vec![drive; model.drives],
            shoes: shoes_at_rest(&model, now_pose, now.track_position),
            idlers: idlers_at_rest(&model, now.track_position),
            flippers: if model.flippers.len() == self.state.flippers.len() {
                self.state.flippers.clone()
            } else {
                flippers_at_rest(&model, now.chassis_angle)
            },
        };
        state.run_shoes(&model, now.track_speed);
        let mut branch = Self::of(scenario, ground, model, state);
        (branch.time, branch.began) = (self.time, self.time);
        branch.command = self.command;
        branch.driver = self.driver;
        (branch.set_point, branch.set_point_before) = (self.set_point, self.set_point);
        branch.dynamics.outer_force = self.dynamics.outer_force;
        branch.monitor.seen = Seen::from(branch.time());
        let mut contacts = branch.contacts_now();
        branch.dynamics.take_over(&mut contacts);
        branch.dents = Dents::of(&contacts);
        branch
    }
}
