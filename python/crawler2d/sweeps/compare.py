"""Paired comparison of variants: same scenario, same draws, one variant against another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.keywords import takes_keywords
from crawler2d.common.units import METRICS
from crawler2d.errors import ScenarioError
from crawler2d.parameters.plain import Parameters
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.progress import Progress
from crawler2d.sweeps.axes import Axis
from crawler2d.sweeps.labels import Label, labelled
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.statistics import bootstrap_mean, mcnemar, newcombe_paired
from crawler2d.sweeps.tabulate import tabulate

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["Variant", "compare", "variants"]

Variant = Parameters | Mapping[str, Any]
"""A part of a scenario, such as a track, or new values by dotted path."""

_COSTS = ("time_to_clear", "drive_work")
"""Metrics that are compared if both models cleared."""


@takes_keywords
def compare(
    scenario: Scenario,
    models: Mapping[Any, Variant] | Sequence[Variant],
    *,
    repeats: int = 20,
    seed: int = 0,
    vary: Mapping[str, Any] | None = None,
    reference: Label | None = None,
    store: str | PathLike[str] | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool | Progress | None = True,
) -> xarray.Dataset:
    """Compare track models, or any variants, with a reference model under the same draws.

    Parameters
    ----------
    scenario : Scenario
        What all runs share.
    models : mapping of str to model, or sequence of models
        At least two; in a sequence, their short texts become their labels. A model is either a
        track, a robot or another part of a scenario, such as a `Solver`, which replaces the
        scenario's own; or a mapping from dotted paths to values, as in `Scenario.replace`, where
        ``{}`` leaves the scenario unchanged.
    repeats : int
        Runs per model, 1 to 1,000,000.
    seed, vary, store, executor, threads, progress
        See `sweep`.
    reference : str, optional
        Label of the model that the others are compared with; None takes the first.

    Returns
    -------
    xarray.Dataset
        The table of `sweep` with the dimensions `model` and `repeat`. In addition, for each model,
        with 95 % intervals:

        - `rate`, `rate_low`, `rate_high`: rate of clearing, Wilson's interval;
        - `difference`, `difference_low`, `difference_high`: that rate minus the reference's,
          Newcombe's interval for paired data;
        - `both`, `only_model`, `only_reference`, `neither`: how many pairs cleared in this way;
        - `p_value` of the hypothesis of equal rates, McNemar's exact test;
        - `time_to_clear_difference` [s] and `drive_work_difference` [J], `..._low`, `..._high`: the
          mean of model minus reference over the pairs that `both` cleared, bootstrap interval.

        For the reference itself, all differences are exactly 0.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule.
    LimitError
        If `threads` is out of range.
    SimulationDiverged
        If a state became non-finite; a note names the run.
    BatchInterrupted
        On Ctrl-C; its `runs`, model by model, holds the finished runs and the other scenarios.
    ImportError
        If xarray is missing; the message names the extra to install.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> models = {"belt": c2d.BeltTrack(), "skids": c2d.ForceTrack()}
    >>> found = c2d.compare(base, models, repeats=5, progress=False).sel(model="skids")
    >>> found.difference.item(), found.only_reference.item(), found.p_value.item()
    (-1.0, 5, 0.0625)

    One robot, with its centre of mass as it is and further back:

    >>> steep = base.replace({"terrain": c2d.terrains.ramp(0.6)})
    >>> robots = {"as it is": {}, "tail heavy": {"robot.center_of_mass[0]": -0.15}}
    >>> found = c2d.compare(steep, robots, repeats=5, progress=False)
    >>> found.rate.values.tolist()
    [1.0, 0.0]
    """
    named = variants(models)
    if len(named) < 2:
        raise ScenarioError("models", models, "must hold at least two models")
    labels = list(named)
    if reference is not None and reference not in labels:
        names = ", ".join(map(str, labels))
        raise ScenarioError("reference", reference, f"must be a label of the models: {names}")
    paths = dict.fromkeys(path for fields in named.values() for path in fields)
    table = tabulate(
        scenario,
        [Axis("model", tuple(paths), named)],
        repeats=repeats,
        seed=seed,
        vary=vary,
        unknown=None,
        samples=1,
        trials=None,
        store=store,
        executor=executor,
        wall_time=False,
        threads=threads,
        progress=progress,
        on_error="raise",
    )
    base = 0 if reference is None else labels.index(reference)
    rates = rates_of(table).rename(low="rate_low", high="rate_high").drop_vars("count")
    rows = [_against(table, index, base) for index in range(len(labels))]
    columns = {name: ("model", [row[name] for row in rows], _attributes(name)) for name in rows[0]}
    return table.merge(rates).assign(columns).assign_attrs(reference=labels[base])


def variants(models: object) -> dict[Label, Mapping[str, Any]]:
    """Read the argument `models`: what each replaces, by path, by its label."""
    return {label: _fields(model, label) for label, model in labelled(models, "models").items()}


def _fields(model: object, label: Label) -> Mapping[str, Any]:
    """Return what a model replaces, by path."""
    if isinstance(model, Mapping):
        return model
    if isinstance(model, Parameters) and model.place:
        return {model.place: model}
    rule = (
        "must be a track, a robot or another part of a scenario, or a mapping from paths to values"
    )
    raise ScenarioError(f"models[{label!r}]", model, rule)


def _against(table: xarray.Dataset, model: int, base: int) -> dict[str, float]:
    """Compare one model with the reference."""
    outcomes = table["outcome"].to_numpy()
    made = np.isin(outcomes[[model, base]], [str(each) for each in Outcome]).all(axis=0)
    ours, theirs = outcomes[model] == "cleared", outcomes[base] == "cleared"
    both, only_ours = _count(made & ours & theirs), _count(made & ours & ~theirs)
    only_theirs, neither = _count(made & ~ours & theirs), _count(made & ~ours & ~theirs)
    found: dict[str, float] = {
        "both": both,
        "only_model": only_ours,
        "only_reference": only_theirs,
        "neither": neither,
        "p_value": mcnemar(only_ours, only_theirs),
    }
    intervals = {"difference": newcombe_paired(both, only_ours, only_theirs, neither)}
    for name in _COSTS:
        figures = table[name].to_numpy()
        intervals[f"{name}_difference"] = bootstrap_mean(
            figures[model, ours & theirs] - figures[base, ours & theirs]
        )
    for name, interval in intervals.items():
        bounds = (0.0, 0.0, 0.0) if model == base else interval
        found |= dict(zip((name, f"{name}_low", f"{name}_high"), bounds, strict=True))
    return found


def _count(chosen: NDArray[np.bool_]) -> int:
    return int(chosen.sum())


def _attributes(name: str) -> dict[str, str]:
    unit = next((METRICS[cost] for cost in _COSTS if name.startswith(cost)), "1")
    return {"units": unit, "long_name": name.replace("_", " ")}
