"""Tables of runs as xarray data sets: sweeps by cell, batches and stores by run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from crawler2d._core import PreparedScenario
from crawler2d.common.arrays import is_iterable, read_bool, whole_number
from crawler2d.common.extras import extra
from crawler2d.common.keywords import read_choice
from crawler2d.common.units import METRICS
from crawler2d.errors import ScenarioError, raise_first
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.results.record import Row
from crawler2d.runs.branch import Trials, trial_names
from crawler2d.runs.dataset import build_attributes
from crawler2d.runs.progress import Progress, reporter, thread_count
from crawler2d.runs.run import Run
from crawler2d.sweeps.axes import Axis, coordinates, field_attributes, short_names, stop_columns
from crawler2d.sweeps.collect import Collector, RowsInterrupted
from crawler2d.sweeps.plan import Planner, plan_runs
from crawler2d.sweeps.store import stored_rows
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = [
    "Column",
    "OnError",
    "Tabulation",
    "dataset_of",
    "draw_columns",
    "row_columns",
    "table",
    "tabulate",
]

Column = tuple["NDArray[Any]", dict[str, str]]
"""Values of all runs, shape (n,), and attributes."""


def row_columns(
    rows: Sequence[Row | None], *, trials: Sequence[str], with_times: bool
) -> dict[str, Column]:
    """Write rows as columns by name; a missing run, None, leaves them empty.

    Every value depends only on its own run, so tables can be joined.
    """
    columns: dict[str, Column] = {}
    columns["outcome"] = (np.array(["" if row is None else row.outcome for row in rows], str), {})
    diagnoses = [None if row is None else row.read_diagnosis() for row in rows]
    for name, (kind, unit, values) in stop_columns(diagnoses, trials).items():
        columns[name] = (np.array(values, kind), {"units": unit} if unit else {})
    for name in next((row.metrics for row in rows if row is not None and row.metrics), {}):
        figures = [math.nan if row is None else row.metrics.get(name, math.nan) for row in rows]
        columns[name] = (np.array(figures, float), {"units": METRICS.get(name, "")})
    if with_times:
        times = [math.nan if row is None else row.wall_time for row in rows]
        columns["wall_time"] = (np.array(times, float), {"units": "s"})
    # Python strings, as each string in a NumPy array takes the space of the longest.
    texts = {
        "error": ["" if row is None else str(row.error or "") for row in rows],
        "identity": ["" if row is None else row.identity for row in rows],
        "scenario": ["" if row is None else row.scenario for row in rows],
    }
    return columns | {name: (np.array(values, object), {}) for name, values in texts.items()}


def draw_columns(
    kind: str, variation: Variation, values: Callable[[str], NDArray[np.float64]]
) -> dict[str, Column]:
    """Write the draws of every path as columns: `drawn_...` or `unknown_...`."""
    names = short_names(list(variation.distributions))
    return {f"{kind}_{n}": (values(path), field_attributes([path])) for path, n in names.items()}


def dataset_of(
    columns: Mapping[str, Column], dims: Mapping[str, int], coordinates: Mapping[str, Any]
) -> xarray.Dataset:
    """Add dimensions to columns; the last one changes fastest."""
    xr = extra("xarray", "analysis")
    names, shape = list(dims), list(dims.values())
    variables = {
        name: (names, values.reshape(shape), attributes)
        for name, (values, attributes) in columns.items()
    }
    dataset: xarray.Dataset = xr.Dataset(variables, coords=coordinates)
    for key, variable in dataset.variables.items():
        variable.attrs.setdefault("long_name", str(key).replace("_", " "))
    return dataset


def table(runs: Iterable[Run] | str | PathLike[str]) -> xarray.Dataset:
    """Arrange runs in a table, one row each.

    Parameters
    ----------
    runs : iterable of Run, str or path-like
        Result of `simulate_many`, `runs` of a `BatchInterrupted`, or the path of a store, even
        while a sweep writes to it.

    Returns
    -------
    xarray.Dataset
        The dimension `run`, and the columns of `sweep`. An unfinished run is `failed`, and `error`
        says so. For a store, `build` and `trials` are the build and requested trials of each run.

    Raises
    ------
    ScenarioError
        If an element is not a Run.
    StoreError
        If the path is not a store, or the store is damaged.
    ImportError
        If xarray is missing; the message names the extra to install.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.03))
    >>> runs = c2d.simulate_many([base, base.replace({"terrain.height": 0.2})], record="summary")
    >>> found = c2d.table(runs)
    >>> found.outcome.values.tolist(), dict(found.sizes)
    (['cleared', 'tipped_over'], {'run': 2})
    >>> c2d.rate(found, dim="run")["rate"].item()
    0.5
    """
    extra("xarray", "analysis")
    origin: dict[str, list[str]] = {}
    if isinstance(runs, (str, PathLike)):
        stored = list(stored_rows(runs))
        rows = [row for row, _, _ in stored]
        tried = [trial for _, _, trials in stored for trial in trials]
        origin["build"] = [build for _, build, _ in stored]
        origin["trials"] = [", ".join(trials) for _, _, trials in stored]
    else:
        if not is_iterable(runs):
            raise ScenarioError("runs", runs, "must be several: give them in a list")
        rows, tried = [], []
        for index, run in enumerate(runs):
            if not isinstance(run, Run):
                raise ScenarioError(f"runs[{index}]", run, "must be a Run")
            rows.append(Row.of_record(run))
            if run.diagnosis is not None:
                tried += [trial.name for trial in run.diagnosis.trials]
    columns = row_columns(rows, trials=tuple(dict.fromkeys(tried)), with_times=True)
    columns |= {name: (np.array(texts, object), {}) for name, texts in origin.items()}
    dataset = dataset_of(columns, {"run": len(rows)}, {"run": np.arange(len(rows))})
    return dataset.assign_attrs(build_attributes())


def _notes(error: Exception) -> list[str]:
    return getattr(error, "__notes__", [])


OnError = Literal["raise", "record"]


class Tabulation:
    """A planned sweep; its runs can be simulated in any order; see `sweep`.

    Parameters
    ----------
    scenario, axes, repeats, seed, vary, unknown, samples, trials, store, executor, wall_time
        See `sweep`; axes replace values of scenarios.
    threads
        See `sweep`.

    Attributes
    ----------
    checked : list of Checked
        Scenario of every run, or its error: cell by cell, sample by sample, repeat by repeat.
    """

    def __init__(
        self,
        scenario: Scenario,
        axes: Sequence[Axis],
        *,
        repeats: int,
        seed: int,
        vary: Mapping[str, Any] | None,
        store: str | PathLike[str] | None,
        executor: Executor | None,
        threads: int | None,
        unknown: Mapping[str, Any] | None = None,
        samples: int = 1,
        trials: Trials = None,
        wall_time: bool = False,
    ) -> None:
        extra("xarray", "analysis")  # fail before the runs if it is missing
        check_scenario(scenario)
        if executor is not None and not isinstance(executor, Executor):
            raise ScenarioError("executor", executor, "must be a concurrent.futures.Executor")
        self._with_times = read_bool(wall_time, "wall_time")
        self._tried = trial_names(trials)
        self._store, self._executor, self._threads = store, executor, thread_count(threads)
        self._repeats = whole_number(repeats, "repeats", 1, 10**6)
        base = PreparedScenario(scenario.to_json())
        swept = [path for axis in axes for path in axis.paths]
        self._scenario, self._axes = scenario, axes
        self._planner = Planner.read(
            scenario, swept, vary=vary, unknown=unknown, seed=seed, samples=samples
        )
        self._plans = plan_runs(scenario, axes, self._planner, repeats=self._repeats, like=base)
        self.checked = [each for plan in self._plans for each in plan.checked]
        self._rows: list[Row | None] = [None] * len(self.checked)

    def simulate(self, indices: Sequence[int], progress: bool | Progress | None) -> None:
        """Simulate some of the runs, by index in `checked`.

        Raises
        ------
        BatchInterrupted
            On Ctrl-C.
        """
        some = [self.checked[index] for index in indices]
        try:
            with Collector(
                self._tried, store=self._store, executor=self._executor, threads=self._threads
            ) as collector:
                batch = collector.batch(some)
                with reporter(progress, len(some), batch.done) as report:
                    rows = collector.rows(batch, report)
        except RowsInterrupted as interrupt:
            raise interrupt.as_batch(self._store) from None
        for index, row in zip(indices, rows, strict=True):
            self._rows[index] = row
            # Equal scenarios share a row and its error.
            if row.error is not None and row.identity and not _notes(row.error):
                plan, repeat = self._plans[index // self._repeats], index % self._repeats
                row.error.add_note(f"in {plan.path(repeat)}")

    def take(self, rows: Sequence[Row]) -> None:
        """Take rows of runs simulated elsewhere, in the order of `checked`."""
        self._rows = list(rows)

    def raise_first(self) -> None:
        """Raise the first error of a run."""
        raise_first(None if row is None else row.error for row in self._rows)

    def table(self) -> xarray.Dataset:
        """Arrange the runs in a table; missing ones have the outcome ""."""
        columns = row_columns(self._rows, trials=self._tried, with_times=self._with_times)
        plans, repeats, planner = self._plans, self._repeats, self._planner
        missing = np.full(repeats, np.nan)
        columns |= draw_columns(
            "drawn",
            planner.variation,
            lambda path: np.concatenate([plan.drawn.get(path, missing) for plan in plans]),
        )
        columns |= draw_columns(
            "unknown",
            planner.unknowns,
            lambda path: np.repeat([p.world.sampled.get(path, np.nan) for p in plans], repeats),
        )
        kind = np.int64 if planner.seed < 2**63 else np.uint64
        columns["seed"] = (np.full(len(self._rows), planner.seed, kind), {})
        dims = {axis.name: len(axis.values) for axis in self._axes}
        labels: dict[str, Any] = coordinates(self._axes)
        if planner.unknowns.distributions:
            dims["sample"] = planner.samples
            labels["sample"] = np.arange(planner.samples)
        dims["repeat"] = repeats
        labels["repeat"] = np.arange(repeats)
        dataset = dataset_of(columns, dims, labels)
        return dataset.assign_attrs(
            scenario=self._scenario.to_json(),
            vary=planner.variation.text,
            unknown=planner.unknowns.text,
            **build_attributes(),
        )


def tabulate(
    scenario: Scenario,
    axes: Sequence[Axis],
    *,
    progress: bool | Progress | None,
    on_error: OnError,
    **options: Any,
) -> xarray.Dataset:
    """Run a sweep over the given axes; see `sweep` and `Tabulation`."""
    read_choice(on_error, "on_error", ("raise", "record"))
    planned = Tabulation(scenario, axes, **options)
    if on_error == "raise":
        raise_first(planned.checked)
    planned.simulate(range(len(planned.checked)), progress)
    if on_error == "raise":
        planned.raise_first()
    return planned.table()
