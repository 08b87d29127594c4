//! The Python module `crawler2d._core`: JSON text in, `NumPy` columns out.

mod convert;
mod diagnosis;
mod errors;
mod pictures;
mod stepwise;

use pyo3::prelude::*;

/// Makes what the core promises hold at the boundary; see `python/crawler2d/_core.pyi`.
#[pymodule]
mod _core {
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;

    use crawler2d_core::{Error, Model, Progress, Record, Run, Scenario};
    use pyo3::prelude::*;
    use pyo3::types::{PyDict, PyList};

    use crate::convert;
    use crate::diagnosis;
    use crate::errors;
    use crate::pictures;

    #[pymodule_export]
    use crate::stepwise::Simulation;

    /// Checks a scenario and returns its canonical JSON.
    #[pyfunction]
    fn canonical(text: &str) -> PyResult<String> {
        errors::guarded(|| Ok(Scenario::from_json(text)?.to_json()))
    }

    /// Checks a scenario, and warns of what is unlikely to be meant.
    #[pyfunction]
    fn validate(py: Python<'_>, text: &str) -> PyResult<()> {
        let (_, doubts) = errors::guarded(|| Ok(Scenario::examined(text)?))?;
        errors::warn(py, doubts)
    }

    /// SHA-256 of the canonical JSON.
    #[pyfunction]
    fn identity(text: &str) -> PyResult<String> {
        errors::guarded(|| Ok(Scenario::from_json(text)?.identity()))
    }

    /// Ground and robot of a scenario as arrays for drawing.
    #[pyfunction]
    fn geometry<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyDict>> {
        let (scenario, model, ground) = errors::guarded(|| {
            let scenario = Scenario::from_json(text)?;
            let ground = crawler2d_core::Ground::new(&scenario.terrain, scenario.robot.gauge)?;
            let model = Model::on(&scenario.robot, &ground)?;
            Ok((scenario, model, ground))
        })?;
        pictures::of(py, &scenario, &model, &ground)
    }

    /// The wheels of a scenario's robot.
    #[pyfunction]
    fn wheels<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyDict>> {
        let model = errors::guarded(|| Ok(Model::new(&Scenario::from_json(text)?.robot)?))?;
        convert::wheels(py, &model)
    }

    /// One run.
    #[pyfunction]
    fn simulate<'py>(
        py: Python<'py>,
        text: &str,
        sample_interval: f64,
        record: &str,
        counterfactual: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, record, counterfactual)?;
        let (results, interrupted) = run_all(py, &[text], 1, record, None)?;
        if let Some(signal) = interrupted {
            return Err(signal);
        }
        match results.into_iter().next().flatten() {
            Some(Ok(run)) => convert::run(py, run),
            Some(Err(error)) => Err(errors::to_python(error)),
            None => Err(errors::internal("the run ended without a result")),
        }
    }

    /// Many runs on several threads, results in order.
    #[pyfunction]
    fn simulate_many<'py>(
        py: Python<'py>,
        texts: Vec<String>,
        threads: usize,
        sample_interval: f64,
        record: &str,
        counterfactual: bool,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyList>, bool)> {
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let record = convert::record(sample_interval, record, counterfactual)?;
        let (results, interrupted) = run_all(py, &texts, threads, record, progress)?;
        let list = PyList::empty(py);
        for result in results {
            match result {
                Some(Ok(run)) => list.append(convert::run(py, run)?)?,
                Some(Err(Error::Simulation(error))) => {
                    list.append(convert::failure(py, &error)?)?;
                }
                Some(Err(error)) => return Err(errors::to_python(error)),
                None => list.append(py.None())?,
            }
        }
        match interrupted {
            // Ctrl-C keeps what is finished; anything else a callback raised goes on unchanged.
            Some(signal) if !signal.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) => {
                Err(signal)
            }
            signal => Ok((list, signal.is_some())),
        }
    }

    /// A run up to a time, and on from there as another scenario.
    #[pyfunction]
    fn branch<'py>(
        py: Python<'py>,
        text: &str,
        at: f64,
        variant: &str,
        sample_interval: f64,
        record: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = convert::record(sample_interval, record, false)?;
        let run = interruptible(py, |cancel| {
            let (scenario, variant) = (Scenario::from_json(text)?, Scenario::from_json(variant)?);
            crawler2d_core::branch(&scenario, at, &variant, record, cancel)
        })?;
        convert::run(py, run)
    }

    /// A run up to a time, and a closed belt from there.
    #[pyfunction]
    fn counterfactual<'py>(
        py: Python<'py>,
        text: &str,
        at: f64,
        grousers: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let found = interruptible(py, |cancel| {
            crawler2d_core::counterfactual(&Scenario::from_json(text)?, at, grousers, cancel)
        })?;
        diagnosis::counterfactual(py, &found)
    }

    /// Runs the core beside the interpreter, which looks for Ctrl-C meanwhile.
    fn interruptible<T: Send>(
        py: Python<'_>,
        call: impl Send + FnOnce(&AtomicBool) -> Result<T, Error>,
    ) -> PyResult<T> {
        /// Between two looks.
        const PAUSE: Duration = Duration::from_millis(10);

        let cancel = AtomicBool::new(false);
        let mut signal = None;
        let result = py.detach(|| {
            std::thread::scope(|scope| {
                let work = scope.spawn(|| errors::guarded(|| call(&cancel)));
                while !work.is_finished() {
                    std::thread::sleep(PAUSE);
                    #[allow(clippy::redundant_closure_for_method_calls)]
                    // its lifetime is not general
                    let looked = Python::attach(|py| py.check_signals());
                    if let Err(error) = looked {
                        cancel.store(true, Ordering::Relaxed);
                        signal = Some(error);
                    }
                }
                work.join()
            })
        });
        if let Some(signal) = signal {
            return Err(signal);
        }
        result.unwrap_or_else(|_| Err(errors::internal("a thread of the core failed")))
    }

    /// Version and build of the compiled core.
    #[pyfunction]
    fn build_info(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        convert::build_info(py)
    }

    type Results = Vec<Option<Result<Run, Error>>>;

    /// Reads all scenarios, then runs them detached from the interpreter.
    ///
    /// The second item is what interrupted the batch: a signal, or an exception of the callback.
    fn run_all(
        py: Python<'_>,
        texts: &[&str],
        threads: usize,
        record: Record,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(Results, Option<PyErr>)> {
        let examined = errors::guarded(|| {
            texts
                .iter()
                .map(|text| Ok(Scenario::examined(text)?))
                .collect::<Result<Vec<_>, Error>>()
        })?;
        let (scenarios, doubts): (Vec<_>, Vec<_>) = examined.into_iter().unzip();
        for scenario in &scenarios {
            convert::check_size(scenario, record)?;
        }
        errors::warn(py, doubts.into_iter().flatten())?;
        let progress = progress.map(Bound::unbind);
        let total = scenarios.len();
        let interrupted: Mutex<Option<PyErr>> = Mutex::new(None);
        let mut reported = usize::MAX;
        let results = errors::guarded(|| {
            Ok(py.detach(|| {
                crawler2d_core::simulate_many(&scenarios, threads, record, |done| {
                    let stop = Python::attach(|py| {
                        py.check_signals()?;
                        match &progress {
                            Some(callback) if done != reported => {
                                reported = done;
                                callback.call1(py, (done, total)).map(|_| ())
                            }
                            _ => Ok(()),
                        }
                    });
                    let Err(error) = stop else {
                        return Progress::Continue;
                    };
                    if let Ok(mut first) = interrupted.lock() {
                        first.get_or_insert(error);
                    }
                    Progress::Stop
                })
            }))
        })?;
        Ok((results, interrupted.into_inner().unwrap_or_default()))
    }
}
