//! Classes of the module: simulations that Python advances and commands step by step, and validated scenarios for
//! batches.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crawler2d_core::{ByHand, Cancel, ContactTable, Error, Log, Outcome, ValidScenario};
use numpy::{IntoPyArray, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::{PyBackedBytes, PyBackedStr};
use pyo3::types::{PyBytes, PyDict, PyList};

use crate::calls::{build_interruptible, may_be_slow, run_interruptible, until_a_look};
use crate::turns::{Turn, Turns};
use crate::{calls, convert};

/// A running simulation; a lock lets any thread use it, one at a time.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct Simulation {
    inner: Arc<Inner>,
    /// Log of its commands, held by the thread that advances it: one of two at once would count the other's steps as
    /// its own.
    turn: Turns<Log>,
    /// Whether recent steps took so long that Ctrl-C must not wait for the next one.
    is_slow: AtomicBool,
    /// Whether any step may take that long, judged by its size.
    may_be_slow: bool,
    /// Its outcome, once certain. It is kept because it takes trials, and later commands do not change it.
    outcome: Mutex<Option<Outcome>>,
}

/// Contacts at an instant, whose columns are made on request.
#[pyclass(frozen, module = "crawler2d._core")]
struct Contacts(ContactTable);

#[pymethods]
impl Contacts {
    /// All columns.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        convert::contacts(py, self.0.clone())
    }
}

/// After a longer step, Ctrl-C does not wait for the next one.
const SLOW: Duration = Duration::from_millis(20);

/// `None` after a step has failed, because its state cannot be trusted.
type Inner = Turns<Option<crawler2d_core::Simulation>>;

#[pymethods]
impl Simulation {
    #[new]
    fn new(py: Python<'_>, text: PyBackedStr) -> PyResult<Self> {
        let (simulation, warnings) = build_interruptible(py, text, |text| {
            let checked = ValidScenario::from_json(text)?;
            let simulation = crawler2d_core::Simulation::new(&checked);
            Ok((simulation, checked.warnings().to_vec()))
        })?;
        calls::warn(py, &warnings)?;
        Ok(Self::of(simulation, Log::default()))
    }

    /// Restores a simulation from a snapshot.
    #[staticmethod]
    fn from_snapshot(py: Python<'_>, snapshot: PyBackedBytes) -> PyResult<Self> {
        let (simulation, log) = run_interruptible(py, move |_| {
            let simulation = crawler2d_core::Simulation::from_snapshot(&snapshot)?;
            Ok((simulation, Log::after(snapshot.to_vec())))
        })?;
        Ok(Self::of(simulation, log))
    }

    /// Writes the complete state.
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let snapshot = self.with(py, |simulation| simulation.snapshot())?;
        Ok(PyBytes::new(py, &snapshot))
    }

    /// The scenario as JSON.
    fn scenario(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |simulation| Ok(simulation.scenario().to_json()))
    }

    /// The diagnosis, if the robot is stopped.
    fn diagnosis<'py>(
        &self,
        py: Python<'py>,
        trials: Vec<String>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let wanted = convert::wanted(&trials)?;
        let inner = Arc::clone(&self.inner);
        let why = run_interruptible(py, move |cancel| {
            call(&inner, |simulation| {
                crawler2d_core::diagnose(simulation, wanted, cancel)
            })
        })?;
        why.map(|d| convert::diagnosis(py, &d)).transpose()
    }

    /// Advances by a duration; the last step ends with it.
    fn advance(&self, py: Python<'_>, duration: f64) -> PyResult<()> {
        if !(0.0..=1e5).contains(&duration) {
            return Err(calls::argument(
                "duration",
                &duration.to_string(),
                "must be >= 0 s and <= 100000 s",
            ));
        }
        let mut log = self.turn(py)?;
        let end = self.with(py, |simulation| Ok(simulation.time()))? + duration;
        log.note_steps(end);
        self.advance_to(py, end)
    }

    /// Commands a new speed, pushes the robot, or has its flippers, front and rear, turn to angles or at rates.
    fn command(
        &self,
        py: Python<'_>,
        speed: Option<f64>,
        push: Option<f64>,
        angles: (Option<f64>, Option<f64>),
        rates: (Option<f64>, Option<f64>),
    ) -> PyResult<()> {
        let mut log = self.turn(py)?;
        self.outcome(py)?;
        let commands = ByHand {
            speed,
            flippers: [
                calls::flipper_command(angles.0, rates.0),
                calls::flipper_command(angles.1, rates.1),
            ],
            push,
        };
        self.with(py, |simulation| simulation.command_all(&commands))?;
        log.note_commands(commands);
        Ok(())
    }

    /// The run so far, simulated again with its history.
    fn to_run<'py>(
        &self,
        py: Python<'py>,
        sample_interval: f64,
        trials: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, "full", &trials)?;
        let log = self.turn(py)?.clone();
        let scenario = self.with(py, |simulation| Ok(simulation.scenario().clone()))?;
        let run = run_interruptible(py, move |cancel| log.replay(&scenario, record, cancel))?;
        convert::run(py, run)
    }

    /// The current state.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (reading, contacts, flippers, drives, shoes) = self.with(py, |simulation| {
            Ok((
                simulation.reading(),
                simulation.contact_table(),
                simulation.flipper_angles().collect::<Vec<_>>(),
                simulation.drive_positions().collect::<Vec<_>>(),
                simulation.shoe_poses().collect::<Vec<_>>(),
            ))
        })?;
        let outcome = self.outcome(py)?;
        let state = PyDict::new(py);
        state.set_item("position", convert::pair(py, reading.position))?;
        state.set_item("velocity", convert::pair(py, reading.velocity))?;
        convert::put! {
            state, reading:
            time chassis_angle angular_velocity commanded_speed track_speed track_position
        }
        state.set_item("flipper_angles", flippers.into_pyarray(py))?;
        state.set_item("drive_positions", drives.into_pyarray(py))?;
        state.set_item("shoe_poses", convert::rows(py, &shoes))?;
        state.set_item("contacts", Bound::new(py, Contacts(contacts))?)?;
        state.set_item("outcome", outcome.map(Outcome::name))?;
        Ok(state)
    }

    /// The current ground inside the envelope of the track.
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
    fn of(simulation: crawler2d_core::Simulation, log: Log) -> Self {
        Self {
            is_slow: AtomicBool::new(false),
            may_be_slow: may_be_slow(simulation.size()),
            inner: Arc::new(Turns::new(Some(simulation))),
            turn: Turns::new(log),
            outcome: Mutex::new(None),
        }
    }

    /// The outcome, if it is certain.
    fn outcome(&self, py: Python<'_>) -> PyResult<Option<Outcome>> {
        let known = || self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        let found = *known();
        if found.is_some() || !self.with(py, |simulation| Ok(simulation.is_over()))? {
            return Ok(found);
        }
        let inner = Arc::clone(&self.inner);
        let outcome = run_interruptible(py, move |cancel| {
            call(&inner, |simulation| {
                crawler2d_core::outcome_of(simulation, cancel)
            })
        })?;
        Ok(Some(*known().get_or_insert(outcome)))
    }

    /// Waits until no other thread advances it; Ctrl-C is answered meanwhile. The log has the time reached.
    fn turn(&self, py: Python<'_>) -> PyResult<Turn<'_, Log>> {
        let mut turn = self.turn.take(py)?;
        // Ctrl-C may have ended the last advance early, in the middle of a step that nobody waited for.
        let time = self.with(py, |simulation| Ok(simulation.time()))?;
        turn.has_reached(time);
        Ok(turn)
    }

    /// Takes steps up to the time `end` [s]; Ctrl-C is answered meanwhile.
    fn advance_to(&self, py: Python<'_>, end: f64) -> PyResult<()> {
        while !self.may_be_slow && !self.is_slow.load(Ordering::Relaxed) {
            let (time, slowest) = self.with(py, |simulation| {
                let slowest = take_steps(simulation, end, &until_a_look())?;
                Ok((simulation.time(), slowest))
            })?;
            if time >= end {
                return Ok(());
            }
            py.check_signals()?;
            self.is_slow.store(slowest > SLOW, Ordering::Relaxed);
        }
        let inner = Arc::clone(&self.inner);
        let slowest = run_interruptible(py, move |cancel| {
            call(&inner, |simulation| take_steps(simulation, end, cancel))
        })?;
        // It may have seemed slow because of other load on the machine.
        self.is_slow.store(slowest > SLOW, Ordering::Relaxed);
        Ok(())
    }

    /// Calls the core detached from the interpreter, one thread at a time.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        change: impl Send + FnOnce(&mut crawler2d_core::Simulation) -> Result<T, Error>,
    ) -> PyResult<T> {
        self.inner.with(py, |inner| changed(inner, change))
    }
}

/// Takes steps up to the time `end` [s], or until `cancel` is asked; returns the duration of the slowest.
fn take_steps(
    simulation: &mut crawler2d_core::Simulation,
    end: f64,
    cancel: &Cancel,
) -> Result<Duration, Error> {
    let mut slowest = Duration::ZERO;
    let mut begin = Instant::now();
    while simulation.time() < end && !cancel.is_asked() {
        simulation.step_until(end)?;
        let now = Instant::now();
        slowest = slowest.max(now - begin);
        begin = now;
    }
    Ok(slowest)
}

/// Calls the core with the simulation when it is the turn of this thread, which Python does not know.
fn call<T>(
    inner: &Inner,
    change: impl FnOnce(&mut crawler2d_core::Simulation) -> Result<T, Error>,
) -> Result<T, Error> {
    changed(&mut *inner.wait()?, change)
}

/// Calls the core with the simulation; after a failure the simulation is closed.
fn changed<T>(
    inner: &mut Option<crawler2d_core::Simulation>,
    change: impl FnOnce(&mut crawler2d_core::Simulation) -> Result<T, Error>,
) -> Result<T, Error> {
    let closed = || {
        let message = "this simulation has failed before and cannot continue";
        Error::Internal(message.to_owned())
    };
    let simulation = inner.as_mut().ok_or_else(closed)?;
    let result = crawler2d_core::caught(|| change(simulation));
    if matches!(result, Err(Error::Simulation(_) | Error::Internal(_))) {
        *inner = None;
    }
    result
}

/// A valid scenario, with the robot and ground that were built to check it.
#[pyclass(frozen, module = "crawler2d._core")]
pub(crate) struct PreparedScenario {
    pub checked: ValidScenario,
}

#[pymethods]
impl PreparedScenario {
    /// Validates a scenario; a robot or ground equal to that of `like` is not built again.
    #[new]
    #[pyo3(signature = (text, like = None))]
    fn new(py: Python<'_>, text: PyBackedStr, like: Option<PyRef<'_, Self>>) -> PyResult<Self> {
        let like = like.map(|like| like.checked.clone());
        let checked = build_interruptible(py, text, move |text| {
            ValidScenario::from_json_like(text, like.as_ref())
        })?;
        Ok(Self { checked })
    }

    /// Scenarios that differ from this one in some numbers, one per row; or an error instead of an invalid one.
    ///
    /// `fields` has pairs of a JSON pointer and whether its values are integers; `rows` has shape (n, fields).
    fn varied<'py>(
        &self,
        py: Python<'py>,
        fields: Vec<(String, bool)>,
        rows: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Bound<'py, PyList>> {
        let numbers = rows.as_slice()?.to_vec();
        let (count, width) = (rows.shape()[0], rows.shape()[1]);
        let own = self.checked.clone();
        let found = calls::run_interruptible(py, move |cancel| {
            let rows = (0..count).map(|row| &numbers[row * width..(row + 1) * width]);
            own.varied(&fields, rows, cancel)
        })?;
        let list = PyList::empty(py);
        for each in found {
            match each {
                Ok(checked) => list.append(Bound::new(py, Self { checked })?)?,
                Err(error) => list.append(calls::to_python(error).into_value(py))?,
            }
        }
        Ok(list)
    }

    /// The canonical JSON.
    #[getter]
    fn text(&self) -> String {
        self.checked.scenario().to_json()
    }

    /// \[m/s\] The commanded speed.
    #[getter]
    fn speed(&self) -> f64 {
        self.checked.scenario().drive.speed
    }

    /// SHA-256 of the canonical JSON.
    #[getter]
    fn identity(&self) -> String {
        self.checked.scenario().identity()
    }
}
