"""From the arguments of a sweep to its table: plan the runs, collect their rows, arrange them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from crawler2d._core import Passed
from crawler2d.common.arrays import whole_number
from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError, raise_first
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.interrupted import BatchInterrupted
from crawler2d.runs.labelled import build_attributes
from crawler2d.runs.progress import Progress, reporter
from crawler2d.runs.recording import yes_or_no
from crawler2d.runs.threads import thread_count
from crawler2d.runs.trials import Trials, trial_names
from crawler2d.sweeps.axes import Axis, coordinates, field_attributes, short_names
from crawler2d.sweeps.collect import Collector, RowsInterrupted, runs_of
from crawler2d.sweeps.dataset import Column, dataset_of, row_columns
from crawler2d.sweeps.plan import Plan, Planner, plan_runs
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    import xarray

__all__ = ["OnError", "tabulate"]

OnError = Literal["raise", "record"]


def tabulate(
    scenario: Scenario,
    axes: Sequence[Axis],
    *,
    repeats: int,
    seed: int,
    vary: Mapping[str, Any] | None,
    unknown: Mapping[str, Any] | None,
    samples: int,
    trials: Trials,
    store: str | PathLike[str] | None,
    executor: Executor | None,
    wall_time: bool,
    threads: int | None,
    progress: bool | Progress | None,
    on_error: OnError,
) -> xarray.Dataset:
    """Run a sweep over the given axes; see `sweep`."""
    extra("xarray", "analysis")  # fail before the runs if it is missing
    if not isinstance(scenario, Scenario):
        raise ScenarioError("scenario", scenario, "must be a Scenario")
    if on_error not in ("raise", "record"):
        raise ScenarioError("on_error", on_error, "must be one of raise, record")
    if executor is not None and not isinstance(executor, Executor):
        raise ScenarioError("executor", executor, "must be a concurrent.futures.Executor")
    with_times = yes_or_no(wall_time, "wall_time")
    tried = trial_names(trials)
    count = thread_count(threads)
    repeats = whole_number(repeats, "repeats", 1, 10**6)
    samples = whole_number(samples, "samples", 1, 10**5)
    seed = whole_number(seed, "seed", 0, 2**64 - 1)
    base = Passed(scenario.to_json())
    swept = [path for axis in axes for path in axis.paths]
    unknowns = Variation.of(scenario, unknown or {}, swept, "unknown")
    variation = Variation.of(scenario, vary, [*swept, *unknowns.distributions])
    samples = samples if unknowns.distributions else 1
    planner = Planner(variation, unknowns, seed, samples)
    plans = plan_runs(scenario, axes, planner, repeats=repeats, like=base)
    checked = [each for plan in plans for each in plan.checked]
    if on_error == "raise":
        raise_first(checked)
    try:
        with Collector(tried, store=store, executor=executor, threads=count) as collector:
            batch = collector.batch(checked)
            with reporter(progress, len(checked), batch.done) as report:
                rows = collector.rows(batch, report)
    except RowsInterrupted as interrupt:
        kept = "" if store is None else str(store)
        raise BatchInterrupted(runs_of(interrupt.rows), kept) from None
    for index, row in enumerate(rows):
        if row.error is not None and row.identity:
            row.error.add_note(f"in {plans[index // repeats].place(index % repeats)}")
    if on_error == "raise":
        raise_first(row.error for row in rows)
    columns = row_columns(rows, trials=tried, with_times=with_times)
    columns |= _drawn(plans, variation, unknowns, repeats)
    kind = np.int64 if seed < 2**63 else np.uint64
    columns["seed"] = (np.full(len(rows), seed, kind), {})
    dims = {axis.name: len(axis.values) for axis in axes}
    labels: dict[str, Any] = coordinates(axes)
    if unknowns.distributions:
        dims["sample"] = samples
        labels["sample"] = np.arange(samples)
    dims["repeat"] = repeats
    labels["repeat"] = np.arange(repeats)
    dataset = dataset_of(columns, dims, labels)
    return dataset.assign_attrs(
        scenario=scenario.to_json(),
        vary=variation.text,
        unknown=unknowns.text,
        **build_attributes(),
    )


def _drawn(
    plans: Sequence[Plan], variation: Variation, unknowns: Variation, repeats: int
) -> dict[str, Column]:
    """List what was drawn for each run: `drawn_...` in its repeat, `unknown_...` in its sample."""
    columns: dict[str, Column] = {}
    missing = np.full(repeats, np.nan)
    for path, name in short_names(list(variation.distributions)).items():
        values = np.concatenate([plan.drawn.get(path, missing) for plan in plans])
        columns[f"drawn_{name}"] = (values, field_attributes([path]))
    for path, name in short_names(list(unknowns.distributions)).items():
        values = np.repeat([plan.world.sampled.get(path, np.nan) for plan in plans], repeats)
        columns[f"unknown_{name}"] = (values, field_attributes([path]))
    return columns
