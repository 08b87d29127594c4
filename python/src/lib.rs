//! The Python module `crawler2d._core`: JSON text in, `NumPy` columns out.

mod calls;
mod classes;
mod convert;
mod pictures;
mod turns;
mod worlds;

use pyo3::prelude::*;

/// The compiled module; its signatures are in `python/crawler2d/_core.pyi`.
#[pymodule]
mod _core {
    use std::collections::HashMap;

    use crawler2d_core::{Finished, Progress, Record, SearchEffort, ValidScenario};
    use pyo3::prelude::*;
    use pyo3::pybacked::PyBackedStr;
    use pyo3::types::{PyDict, PyList};

    use crate::calls;
    use crate::calls::{build_interruptible, run_interruptible};
    use crate::convert;
    use crate::pictures;

    #[pymodule_export]
    use crate::classes::Simulation;

    #[pymodule_export]
    use crate::classes::PreparedScenario;

    #[pymodule_export]
    use crate::worlds::Worlds;

    /// Validates a scenario and returns its canonical JSON.
    #[pyfunction]
    fn canonical(py: Python<'_>, text: PyBackedStr) -> PyResult<String> {
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        Ok(checked.scenario().to_json())
    }

    /// Validates a scenario, and warns of values that are unlikely to be meant.
    #[pyfunction]
    fn validate(py: Python<'_>, text: PyBackedStr) -> PyResult<()> {
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        calls::warn(py, checked.warnings())
    }

    /// SHA-256 of the canonical JSON.
    #[pyfunction]
    fn identity(py: Python<'_>, text: PyBackedStr) -> PyResult<String> {
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        Ok(checked.scenario().identity())
    }

    /// Arrays of the ground and robot of a scenario, for drawing.
    #[pyfunction]
    fn geometry(py: Python<'_>, text: PyBackedStr) -> PyResult<Bound<'_, PyDict>> {
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        pictures::of(py, &checked)
    }

    /// Poses of a robot's bodies at every sample of a run, from columns of its trace.
    #[pyfunction]
    fn poses<'py>(
        py: Python<'py>,
        text: PyBackedStr,
        columns: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let trace = convert::moved(columns)?;
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::poses(&checked, &trace, cancel)
        })?;
        pictures::poses(py, found)
    }

    /// Name, unit and meaning of every metric of a run, in the order of the tables.
    #[pyfunction]
    fn metrics() -> Vec<(&'static str, &'static str, &'static str)> {
        let all = crawler2d_core::Metrics::ALL.iter();
        all.map(|each| (each.name, each.unit, each.meaning))
            .collect()
    }

    /// Former names of metrics, with the present ones.
    #[pyfunction]
    fn renamed_metrics() -> HashMap<&'static str, &'static str> {
        crawler2d_core::Metrics::RENAMED.into()
    }

    /// Settings of the core's own contacts that do not exist in rapier, with their defaults.
    #[pyfunction]
    fn own_settings() -> HashMap<&'static str, f64> {
        crawler2d_core::OWN_SETTINGS.into()
    }

    /// Names that tables use as text or as codes.
    #[pyfunction]
    fn kinds(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        convert::kinds(py)
    }

    /// The wheels of a scenario's robot.
    #[pyfunction]
    fn wheels<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyDict>> {
        let checked = calls::guarded(|| ValidScenario::from_json(text))?;
        convert::wheels(py, checked.model())
    }

    /// Simulates one scenario.
    #[pyfunction]
    fn simulate<'py>(
        py: Python<'py>,
        text: PyBackedStr,
        sample_interval: f64,
        record: &str,
        trials: Vec<String>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, record, &trials)?;
        let checked = build_interruptible(py, text, ValidScenario::from_json)?;
        calls::warn(py, checked.warnings())?;
        let mut result = None;
        let interrupted = run_all(py, vec![checked], 1, record, |_, finished| {
            result = finished.into_iter().next().or(result.take());
            Ok(())
        })?;
        if let Some(signal) = interrupted {
            return Err(signal);
        }
        match result {
            Some((_, Ok(run))) => {
                calls::warn(py, &run.warnings)?;
                convert::run(py, run)
            }
            Some((_, Err(error))) => Err(calls::to_python(error)),
            None => Err(calls::failure(
                "InternalError",
                "the run ended without a result",
            )),
        }
    }

    /// Warns of values in a batch that are unlikely to be meant, once for each field.
    #[pyfunction]
    fn warn(py: Python<'_>, scenarios: Vec<PyRef<'_, PreparedScenario>>) -> PyResult<()> {
        calls::warn(
            py,
            scenarios.iter().flat_map(|each| each.checked.warnings()),
        )
    }

    /// Simulates many scenarios on several threads; an error affects only its own run.
    ///
    /// `take` is called about 50 times per second with finished runs, as pairs of index and result. The record "row"
    /// has the values in tables of sweeps. Returns whether Ctrl-C ended the batch.
    #[pyfunction]
    fn simulate_many(
        py: Python<'_>,
        scenarios: Vec<PyRef<'_, PreparedScenario>>,
        threads: usize,
        sample_interval: f64,
        record: &str,
        trials: Vec<String>,
        take: Py<PyAny>,
    ) -> PyResult<bool> {
        let with_tables = record != "row";
        let record = if with_tables { record } else { "summary" };
        let record = convert::record(sample_interval, record, &trials)?;
        let scenarios = scenarios.iter().map(|each| each.checked.clone()).collect();
        let mut warnings = Vec::new();
        let interrupted = run_all(py, scenarios, threads, record, |py, finished| {
            if finished.is_empty() {
                return Ok(());
            }
            let runs = finished.iter().filter_map(|(_, run)| run.as_ref().ok());
            warnings.extend(runs.flat_map(|run| run.warnings.iter().cloned()));
            let list = PyList::empty(py);
            for (place, result) in finished {
                let converted = match result {
                    Ok(run) if with_tables => convert::run(py, run),
                    Ok(run) => convert::row(py, &run),
                    Err(error) => Err(calls::to_python(error)),
                };
                let kept = converted.or_else(|error| convert::failure(py, error))?;
                list.append((place, kept))?;
            }
            take.call1(py, (list,)).map(|_| ())
        })?;
        calls::warn(py, &warnings)?;
        match interrupted {
            // After Ctrl-C, finished runs are kept; any other exception of a callback is raised unchanged.
            Some(signal) if !signal.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) => {
                Err(signal)
            }
            signal => Ok(signal.is_some()),
        }
    }

    /// Simulates up to a time, and a number of starts later if that is given, then continues as another scenario.
    #[pyfunction]
    fn branch<'py>(
        py: Python<'py>,
        text: PyBackedStr,
        at: (f64, Option<usize>),
        variant: PyBackedStr,
        push: (f64, f64),
        sample_interval: f64,
        record: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, record, &[])?;
        let run = run_interruptible(py, move |cancel| {
            let scenario = ValidScenario::from_json(&text)?;
            let variant = ValidScenario::from_json_like(&variant, Some(&scenario))?;
            crawler2d_core::branch(&scenario, at, (&variant, push), record, cancel)
        })?;
        convert::run(py, run)
    }

    /// Simulates up to the time of a stop, and makes trials there.
    #[pyfunction]
    fn trials(
        py: Python<'_>,
        text: PyBackedStr,
        at: f64,
        names: Vec<String>,
    ) -> PyResult<Bound<'_, PyList>> {
        let wanted = convert::wanted(&names)?;
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::make_trials(&ValidScenario::from_json(&text)?, at, wanted, cancel)
        })?;
        let found = found.iter().map(|trial| convert::trial(py, trial));
        PyList::new(py, found.collect::<PyResult<Vec<_>>>()?)
    }

    /// Simulates up to the time of a stop, and tries to continue as another scenario with a push; also returns how many
    /// starts after the stop the reported run began.
    #[pyfunction]
    fn what_if(
        py: Python<'_>,
        text: PyBackedStr,
        at: f64,
        variant: PyBackedStr,
        push: (f64, f64),
    ) -> PyResult<Option<(Bound<'_, PyDict>, usize)>> {
        let found = run_interruptible(py, move |cancel| {
            let scenario = ValidScenario::from_json(&text)?;
            let variant = ValidScenario::from_json_like(&variant, Some(&scenario))?;
            crawler2d_core::what_if(&scenario, at, (&variant, push), cancel)
        })?;
        found
            .map(|(trial, later)| Ok((convert::trial(py, &trial)?, later)))
            .transpose()
    }

    /// The scenario of a trial, and its run.
    #[pyfunction]
    fn run_of_trial<'py>(
        py: Python<'py>,
        text: PyBackedStr,
        at: f64,
        name: &str,
        sample_interval: f64,
        record: &str,
    ) -> PyResult<Option<(String, Bound<'py, PyDict>)>> {
        let record = convert::record(sample_interval, record, &[])?;
        let change = convert::change(name)?;
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::run_of_trial(
                &ValidScenario::from_json(&text)?,
                at,
                change,
                record,
                cancel,
            )
        })?;
        found
            .map(|(variant, run)| Ok((variant.to_json(), convert::run(py, run)?)))
            .transpose()
    }

    /// Simulates up to the time of a stop, and measures the push that frees the robot.
    #[pyfunction]
    fn escape_force(py: Python<'_>, text: PyBackedStr, at: f64) -> PyResult<(f64, f64, bool)> {
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::escape_force(&ValidScenario::from_json(&text)?, at, cancel)
        })?;
        Ok((found.low, found.high, found.tips))
    }

    /// How a robot tipped over; None if it did not.
    #[pyfunction]
    fn tip_over(py: Python<'_>, text: PyBackedStr) -> PyResult<Option<Bound<'_, PyDict>>> {
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::tip_over(&ValidScenario::from_json(&text)?, cancel)
        })?;
        found.map(|found| convert::tip_over(py, &found)).transpose()
    }

    /// Whether forces can hold a stop: the least imbalance, its tolerance, the range of friction factors, and the pull
    /// that contacts would need.
    #[pyfunction]
    fn balance(py: Python<'_>, text: PyBackedStr, at: f64) -> PyResult<Option<Bound<'_, PyDict>>> {
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::balance(&ValidScenario::from_json(&text)?, at, cancel)
        })?;
        found.map(|found| convert::balance(py, &found)).transpose()
    }

    /// All poses in which the robot can stand still with its drives running: columns of poses and of their contacts.
    #[pyfunction]
    fn jams(py: Python<'_>, text: PyBackedStr) -> PyResult<Bound<'_, PyDict>> {
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::find_jams(&ValidScenario::from_json(&text)?, cancel)
        })?;
        convert::jams(py, &found)
    }

    /// The jams on three contacts of several scenarios, at any friction up to a limit: columns of poses, of the
    /// smallest and largest friction, and of the ground inside the track, for each scenario.
    #[pyfunction]
    fn jam_ranges(
        py: Python<'_>,
        texts: Vec<PyBackedStr>,
        most: f64,
    ) -> PyResult<Vec<Bound<'_, PyDict>>> {
        let found = run_interruptible(py, move |cancel| {
            crawler2d_core::jam_ranges(&calls::read(&texts)?, most, cancel)
        })?;
        found
            .iter()
            .map(|ranges| convert::jam_ranges(py, ranges))
            .collect()
    }

    /// Regions of the ranges of parameters without jams, with the proof. The scenarios have the smallest values of all
    /// parameters, the largest of each alone and of all, and the middle of all; `belts` are the same with a belt.
    ///
    /// The effort is the depth, the smallest region, the cells of each region, and whether to return these.
    #[pyfunction]
    #[pyo3(signature = (texts, belts, names, *, effort))]
    fn certify(
        py: Python<'_>,
        texts: Vec<PyBackedStr>,
        belts: Vec<PyBackedStr>,
        names: Vec<String>,
        effort: (f64, f64, usize, bool),
    ) -> PyResult<Bound<'_, PyDict>> {
        let (depth, smallest, cells, keeps_cells) = effort;
        let effort = SearchEffort {
            depth,
            smallest,
            cells,
            keeps_cells,
        };
        let found = run_interruptible(py, move |cancel| {
            let (wheels, belts) = (calls::read(&texts)?, calls::read(&belts)?);
            crawler2d_core::certify(&wheels, &belts, &names, effort, cancel)
        })?;
        convert::certificate(py, &found)
    }

    /// Version and build of the compiled core.
    #[pyfunction]
    fn build_info(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        convert::build_info(py)
    }

    /// Runs everything detached from the interpreter, and passes finished runs to `take`.
    ///
    /// Returns what interrupted the batch: a signal or an exception of `take`.
    fn run_all(
        py: Python<'_>,
        scenarios: Vec<ValidScenario>,
        threads: usize,
        record: Record,
        mut take: impl Send + FnMut(Python<'_>, Vec<Finished>) -> PyResult<()>,
    ) -> PyResult<Option<PyErr>> {
        let mut interrupted: Option<PyErr> = None;
        py.detach(|| {
            calls::guarded(|| {
                crawler2d_core::simulate_many(scenarios, threads, record, |finished| {
                    let taken = Python::attach(|py| {
                        // Finished runs are kept, even if Ctrl-C comes now.
                        let signal = py.check_signals();
                        take(py, finished).and(signal)
                    });
                    let Err(error) = taken else {
                        return Progress::Continue;
                    };
                    interrupted.get_or_insert(error);
                    Progress::Stop
                })?;
                Ok(())
            })
        })?;
        Ok(interrupted)
    }
}
