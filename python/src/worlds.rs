//! Many simulations that Python commands and advances together.

use std::sync::Arc;

use crawler2d_core::{ByHand, Outcome, ValidScenario, WorldState};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::calls::{self, may_be_slow, run_interruptible, until_a_look};
use crate::classes::PreparedScenario;
use crate::convert;
use crate::turns::Turns;

/// Simulations side by side, which one thread at a time may use.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct Worlds {
    inner: Arc<Turns<crawler2d_core::Worlds>>,
    /// Held by the thread that changes them.
    turn: Turns<()>,
}

#[pymethods]
impl Worlds {
    #[new]
    fn new(py: Python<'_>, scenarios: Vec<PyRef<'_, PreparedScenario>>) -> PyResult<Self> {
        let scenarios = checked(&scenarios);
        let worlds = run_interruptible(py, move |cancel| {
            crawler2d_core::Worlds::new(scenarios, cancel)
        })?;
        Ok(Self {
            inner: Arc::new(Turns::new(worlds)),
            turn: Turns::new(()),
        })
    }

    /// Restarts some of them, with other scenarios if these are given.
    fn reset(
        &self,
        py: Python<'_>,
        which: Vec<usize>,
        scenarios: Option<Vec<PyRef<'_, PreparedScenario>>>,
    ) -> PyResult<()> {
        let _turn = self.turn.take(py)?;
        let mut scenarios = scenarios.map(|given| checked(&given).into_iter());
        for index in which {
            let next = scenarios.as_mut().and_then(Iterator::next);
            self.inner.with(py, |worlds| {
                worlds.reset(index, next);
                Ok(())
            })?;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Commands speeds, shape (n,), and angles and rates of flippers, shape (n, 2); NaN leaves a command as it is.
    fn command(
        &self,
        py: Python<'_>,
        speeds: PyReadonlyArray1<'_, f64>,
        angles: PyReadonlyArray2<'_, f64>,
        rates: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let _turn = self.turn.take(py)?;
        let (speeds, angles, rates) = (speeds.to_vec()?, angles.to_vec()?, rates.to_vec()?);
        self.inner.with(py, |worlds| {
            let of = |index: usize| {
                let given = |column: &[f64], k: usize| Some(column[k]).filter(|x| !x.is_nan());
                let flippers = [0, 1].map(|end| {
                    let k = 2 * index + end;
                    calls::flipper_command(given(&angles, k), given(&rates, k))
                });
                ByHand {
                    speed: given(&speeds, index),
                    flippers,
                    push: None,
                }
            };
            let commands: Vec<ByHand> = (0..worlds.count()).map(of).collect();
            worlds.command(&commands)
        })
    }

    /// Advances some of them by a duration on several threads.
    fn advance(
        &self,
        py: Python<'_>,
        which: Vec<usize>,
        duration: f64,
        threads: usize,
    ) -> PyResult<()> {
        let _turn = self.turn.take(py)?;
        if let [one] = which[..]
            && !self
                .inner
                .with(py, |worlds| Ok(may_be_slow(worlds.size(one))))?
        {
            let end = self
                .inner
                .with(py, |worlds| Ok(worlds.set_out(one, duration)))?;
            while !self
                .inner
                .with(py, |worlds| Ok(worlds.go_on(one, end, &until_a_look())))?
            {
                py.check_signals()?;
            }
            return Ok(());
        }
        let inner = Arc::clone(&self.inner);
        run_interruptible(py, move |cancel| {
            let worlds = inner.wait()?;
            worlds.advance(&which, duration, threads, cancel)
        })
    }

    /// The state of each as columns.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let states = self.inner.with(py, |worlds| Ok(worlds.states()))?;
        columns(py, &states)
    }

    /// Heights of the ground at distances from each robot, one row per robot.
    fn heights<'py>(
        &self,
        py: Python<'py>,
        offsets: Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (count, flat) = self
            .inner
            .with(py, |worlds| Ok((worlds.count(), worlds.heights(&offsets)?)))?;
        rows(py, (count, offsets.len()), flat)
    }

    /// The run of one of them since its start, simulated again with its history.
    fn to_run<'py>(
        &self,
        py: Python<'py>,
        index: usize,
        sample_interval: f64,
        trials: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, "full", &trials)?;
        let (log, scenario) = self
            .inner
            .with(py, |worlds| Ok((worlds.log(index), worlds.scenario(index))))?;
        let run = run_interruptible(py, move |cancel| {
            log.replay(scenario.scenario(), record, cancel)
        })?;
        convert::run(py, run)
    }

    /// The scenario of one.
    fn scenario(&self, py: Python<'_>, index: usize) -> PyResult<PreparedScenario> {
        let checked = self.inner.with(py, |worlds| Ok(worlds.scenario(index)))?;
        Ok(PreparedScenario { checked })
    }

    /// A snapshot of one.
    fn snapshot(&self, py: Python<'_>, index: usize) -> PyResult<Vec<u8>> {
        self.inner.with(py, |worlds| worlds.snapshot(index))
    }
}

fn checked(scenarios: &[PyRef<'_, PreparedScenario>]) -> Vec<ValidScenario> {
    scenarios.iter().map(|each| each.checked.clone()).collect()
}

fn rows(
    py: Python<'_>,
    shape: (usize, usize),
    flat: Vec<f64>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let rows = Array2::from_shape_vec(shape, flat);
    rows.map(|rows| rows.into_pyarray(py))
        .map_err(|error| calls::failure("InternalError", &error.to_string()))
}

fn columns<'py>(py: Python<'py>, states: &[WorldState]) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let one = |of: fn(&WorldState) -> f64| -> Bound<'py, _> {
        states.iter().map(of).collect::<Vec<f64>>().into_pyarray(py)
    };
    let two = |of: fn(&WorldState) -> [f64; 2]| {
        rows(py, (states.len(), 2), states.iter().flat_map(of).collect())
    };
    result.set_item("time", one(|s| s.reading.time))?;
    result.set_item("position", two(|s| s.reading.position.into())?)?;
    result.set_item("velocity", two(|s| s.reading.velocity.into())?)?;
    result.set_item("chassis_angle", one(|s| s.reading.chassis_angle))?;
    result.set_item("angular_velocity", one(|s| s.reading.angular_velocity))?;
    result.set_item("track_speed", one(|s| s.reading.track_speed))?;
    result.set_item("flipper_angles", two(|s| s.flipper_angles)?)?;
    result.set_item("flipper_rates", two(|s| s.flipper_rates)?)?;
    result.set_item("flipper_torques", two(|s| s.flipper_torques)?)?;
    result.set_item("to_goal", one(|s| s.to_goal))?;
    result.set_item("drive_work", one(|s| s.drive_work))?;
    let stopped: Vec<bool> = states.iter().map(|state| state.is_stopped).collect();
    result.set_item("stopped", stopped.into_pyarray(py))?;
    let ended = states.iter().map(|state| state.ended.map(Outcome::name));
    result.set_item("outcome", ended.collect::<Vec<_>>())?;
    let errors = states.iter().map(|state| state.error.as_deref());
    result.set_item("error", errors.collect::<Vec<_>>())?;
    Ok(result)
}
