//! A simulation that Python advances and commands by itself.

use std::sync::Mutex;

use crawler2d_core::{End, Error, Scenario};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::{convert, diagnosis, errors};

/// One simulation under way; a lock lets any thread use it, one at a time.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct Simulation {
    /// None once a step failed: its state is not to be trusted.
    inner: Mutex<Option<crawler2d_core::Simulation>>,
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, text: &str) -> PyResult<Self> {
        let (scenario, doubts) = errors::guarded(|| Ok(Scenario::examined(text)?))?;
        errors::warn(py, doubts)?;
        let simulation = errors::guarded(|| crawler2d_core::Simulation::new(&scenario))?;
        Ok(Self {
            inner: Mutex::new(Some(simulation)),
        })
    }

    /// The simulation of a snapshot.
    #[staticmethod]
    fn from_snapshot(snapshot: &[u8]) -> PyResult<Self> {
        let simulation = errors::guarded(|| crawler2d_core::Simulation::from_snapshot(snapshot))?;
        Ok(Self {
            inner: Mutex::new(Some(simulation)),
        })
    }

    /// Everything that the future depends on.
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let snapshot = self.with(py, |simulation| Ok(simulation.snapshot()))?;
        Ok(PyBytes::new(py, &snapshot))
    }

    /// The scenario as JSON.
    fn scenario(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |simulation| Ok(simulation.scenario().to_json()))
    }

    /// Why the robot has stopped, if it has.
    fn diagnosis<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let why = self.with(py, |simulation| Ok(simulation.diagnosis()))?;
        why.map(|d| diagnosis::of(py, &d)).transpose()
    }

    /// Advances by a duration, rounded to whole steps.
    fn advance(&self, py: Python<'_>, duration: f64) -> PyResult<()> {
        /// A few milliseconds of computing between two looks for Ctrl-C.
        const STEPS_AT_A_TIME: u64 = 2048;

        if !(0.0..=1e5).contains(&duration) {
            return Err(errors::argument(
                "duration",
                &duration.to_string(),
                "must be >= 0 s and <= 100000 s",
            ));
        }
        let dt = self.with(py, |simulation| Ok(simulation.time_step()))?;
        #[allow(clippy::cast_sign_loss, clippy::cast_possible_truncation)] // bounded above
        let mut left = (duration / dt).round() as u64;
        while left > 0 {
            let now = left.min(STEPS_AT_A_TIME);
            self.with(py, |simulation| {
                (0..now).try_for_each(|_| simulation.step())
            })?;
            left -= now;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Gives the drivetrain a new command, turns the flippers, or pushes the robot.
    #[pyo3(signature = (speed = None, flipper_angle = None, rear_flipper_angle = None, push = None))]
    fn command(
        &self,
        py: Python<'_>,
        speed: Option<f64>,
        flipper_angle: Option<f64>,
        rear_flipper_angle: Option<f64>,
        push: Option<f64>,
    ) -> PyResult<()> {
        self.with(py, |simulation| {
            let ends = [(End::Front, flipper_angle), (End::Rear, rear_flipper_angle)];
            simulation.command_all(speed, ends, push)
        })
    }

    /// The state of this instant.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (reading, contacts, outcome, flippers) = self.with(py, |simulation| {
            Ok((
                simulation.reading(),
                simulation.contact_table(),
                simulation.outcome(),
                simulation.flipper_angles().collect::<Vec<_>>(),
            ))
        })?;
        let state = PyDict::new(py);
        state.set_item("time", reading.time)?;
        state.set_item(
            "position",
            convert::pair(py, reading.position.x, reading.position.y),
        )?;
        state.set_item(
            "velocity",
            convert::pair(py, reading.velocity.x, reading.velocity.y),
        )?;
        state.set_item("chassis_angle", reading.chassis_angle)?;
        state.set_item("angular_velocity", reading.angular_velocity)?;
        state.set_item("commanded_speed", reading.commanded_speed)?;
        state.set_item("track_speed", reading.track_speed)?;
        state.set_item("track_position", reading.track_position)?;
        state.set_item("flipper_angles", flippers.into_pyarray(py))?;
        state.set_item("contacts", convert::contacts(py, contacts)?)?;
        state.set_item("outcome", outcome.map(crawler2d_core::Outcome::name))?;
        Ok(state)
    }

    /// What of the ground is inside the envelope of the track now.
    fn intrusions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = self.with(py, |simulation| Ok(simulation.intrusions()))?;
        convert::intrusions(py, &found)
    }

    /// [s] Simulated time.
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |simulation| Ok(simulation.time()))
    }
}

impl Simulation {
    /// Calls the core detached from the interpreter, one thread at a time.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        call: impl Send + FnOnce(&mut crawler2d_core::Simulation) -> Result<T, Error>,
    ) -> PyResult<T> {
        py.detach(|| {
            let mut inner = self
                .inner
                .lock()
                .map_err(|_| errors::internal("another thread failed in this simulation"))?;
            let Some(simulation) = inner.as_mut() else {
                return Err(errors::internal(
                    "this simulation has failed before and cannot go on",
                ));
            };
            let mut failed = true;
            let result = errors::guarded(|| {
                let result = call(simulation);
                failed = matches!(result, Err(Error::Simulation(_)));
                result
            });
            if failed {
                *inner = None;
            }
            result
        })
    }
}
