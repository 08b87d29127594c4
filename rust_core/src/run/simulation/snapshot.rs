//! Snapshots: a simulation as bytes and back; it is rebuilt from its scenario, then given its state.

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Simulation;
use super::attempt::LastStep;
use super::commands::Commands;
use crate::contact::Dents;
use crate::dynamics::{Impulses, State};
use crate::error::Error;
use crate::observe::Observations;
use crate::run::ValidScenario;
use crate::run::step_length::StepControl;
use crate::scenario::ScenarioError;
use crate::version::BUILD_ID;

/// First bytes of every snapshot; the number is the version of the layout around the state.
const MAGIC: &[u8] = b"crawler2d snapshot 1\n";
/// Bytes of the digest at the end.
const DIGEST: usize = 32;

/// The contents of a snapshot.
#[derive(Serialize, Deserialize)]
struct Payload {
    /// Build that wrote it; the layout of the rest depends on the build.
    build: String,
    rest: Vec<u8>,
}

/// Everything that changes between steps.
#[derive(Serialize, Deserialize)]
struct SavedState {
    scenario: String,
    time: f64,
    steps: u64,
    step_control: StepControl,
    last: LastStep,
    commands: Commands,
    set_point: f64,
    state: State,
    impulses: Impulses,
    dents: Dents,
    observed: Observations,
}

impl Simulation {
    /// The complete state, as bytes.
    ///
    /// # Errors
    /// [`Error::Scenario`] if another engine moves the robot, whose worlds change from version to version.
    pub fn snapshot(&self) -> Result<Vec<u8>, Error> {
        if self.is_in_an_engine() {
            let rule =
                "must be own for a snapshot: what rapier keeps changes from version to version";
            return Err(ScenarioError::new("solver.engine", "rapier", rule).into());
        }
        let saved = SavedState {
            scenario: self.scenario.to_json(),
            time: self.time,
            steps: self.steps,
            step_control: self.step_control,
            last: self.last.clone(),
            commands: self.commands,
            set_point: self.set_point,
            state: self.state.clone(),
            impulses: self.dynamics.impulses(),
            dents: self.dents.clone(),
            observed: self.monitor.observed.clone(),
        };
        let payload = Payload {
            build: BUILD_ID.to_owned(),
            rest: bytes(&saved),
        };
        let mut snapshot = MAGIC.to_vec();
        snapshot.extend(bytes(&payload));
        let digest = Sha256::digest(&snapshot);
        snapshot.extend_from_slice(&digest);
        Ok(snapshot)
    }

    /// Restores the simulation of a snapshot; it continues bit by bit the same.
    ///
    /// # Errors
    /// [`Error::Scenario`] at `snapshot` if the bytes are not a snapshot, damaged, or from another build.
    pub fn from_snapshot(snapshot: &[u8]) -> Result<Self, Error> {
        let Some(body) = snapshot.strip_prefix(MAGIC) else {
            return Err(refused(
                "bytes without its header",
                "must be a snapshot of crawler2d",
            ));
        };
        let damaged = || refused("damaged bytes", "must be complete and unchanged");
        let length = body.len().checked_sub(DIGEST).ok_or_else(damaged)?;
        let (body, digest) = body.split_at(length);
        if Sha256::digest(&snapshot[..MAGIC.len() + length])[..] != *digest {
            return Err(damaged());
        }
        let payload: Payload = postcard::from_bytes(body).map_err(|_| damaged())?;
        if payload.build != BUILD_ID {
            let rule = format!(
                "must be from this build, {BUILD_ID}, because the layout differs between builds"
            );
            return Err(refused(
                &format!("a snapshot of build {}", payload.build),
                &rule,
            ));
        }
        let saved: SavedState = postcard::from_bytes(&payload.rest).map_err(|_| damaged())?;
        let simulation = Self::new(&ValidScenario::from_json(&saved.scenario)?);
        if !simulation.fits(&saved) {
            let rule = "must hold a state that its own robot and ground can reach";
            return Err(refused("an impossible state", rule));
        }
        let mut simulation = Self {
            time: saved.time,
            steps: saved.steps,
            step_control: saved.step_control,
            last: saved.last,
            commands: saved.commands,
            set_point: saved.set_point,
            state: saved.state,
            dents: saved.dents,
            ..simulation
        };
        simulation.dynamics.start_from(saved.impulses);
        simulation.monitor.observed = saved.observed;
        Ok(simulation)
    }
}

impl Simulation {
    /// Whether the simulation can have reached a moment; a snapshot may come from an untrusted source.
    fn fits(&self, saved: &SavedState) -> bool {
        /// [s] Longer than any run.
        const LATEST: f64 = 1e9;
        /// More steps than any run has.
        const MOST_STEPS: u64 = 1 << 50;
        /// [m] Largest distance beyond the ground and above it; a falling robot may be anywhere below.
        const FAR: f64 = 1e6;

        let (model, lanes) = (self.dynamics.model(), &self.ground.lanes);
        let time = saved.time;
        let (low, high) = self.ground.extent();
        let (x, y) = (saved.state.center.x, saved.state.center.y);
        let fastest = self.scenario.robot.drivetrain.max_speed;
        (0.0..LATEST).contains(&time)
            && saved.steps <= MOST_STEPS
            && saved.step_control.fits()
            && (0.0..LATEST).contains(&saved.last.free)
            && saved.last.before.fits(model)
            && (0.0..FAR).contains(&saved.last.sight)
            && (low - FAR..=high + FAR).contains(&x)
            && y < FAR + self.ground.highest()
            && saved.commands.speed.abs() <= fastest
            && saved.set_point.abs() <= fastest
            && saved.commands.push.fits()
            && saved.commands.driver.fits(&self.scenario.drive, time)
            && saved.state.fits(model)
            && self.dynamics.fits(&saved.impulses, lanes)
            && saved.dents.fits(saved.impulses.contacts())
            && saved.observed.fits(time, model, lanes)
    }
}

fn bytes(value: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap_or_else(|e| unreachable!("plain data serialises: {e}"))
}

fn refused(value: &str, rule: &str) -> Error {
    ScenarioError::new("snapshot", value, rule).into()
}
