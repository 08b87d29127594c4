"""Track models compared in pairs: the same scenario, the same draws, one model against another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d._axes import Axis
from crawler2d._labels import Label, labelled
from crawler2d._progress import Progress
from crawler2d._units import METRICS
from crawler2d.draws import Distribution
from crawler2d.errors import ScenarioError
from crawler2d.rates import rate
from crawler2d.scenario import Scenario
from crawler2d.statistics import bootstrap_mean, mcnemar, newcombe_paired
from crawler2d.sweep import tabulate
from crawler2d.track import Track

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["compare"]

_COSTS = ("time_to_clear", "drive_work")
"""Metrics that are compared where both models cleared."""


def compare(
    scenario: Scenario,
    models: Mapping[Any, Track] | Sequence[Track],
    *,
    repeats: int = 20,
    seed: int = 0,
    vary: Mapping[str, Distribution] | None = None,
    reference: Label | None = None,
    threads: int | None = None,
    progress: bool | Progress | None = True,
) -> xarray.Dataset:
    """Compare models of a track with one of them, run by run under the same draws.

    Parameters
    ----------
    scenario : Scenario
        What all runs share; its own track is replaced.
    models : mapping of str to track, or sequence of tracks
        At least two models; in a sequence their short texts are their labels.
    repeats : int
        Runs a model, 1 to 1,000,000.
    seed, vary, threads, progress
        See `sweep`.
    reference : str, optional
        Label of the model that the others are compared with; None takes the first.

    Returns
    -------
    xarray.Dataset
        The table of `sweep` with the dimensions `model` and `repeat`, and for each model, all
        intervals of 95 %:

        - `rate`, `rate_low`, `rate_high`: how often it cleared, Wilson's interval;
        - `difference`, `difference_low`, `difference_high`: that rate less the reference's,
          Newcombe's interval for pairs;
        - `both`, `only_model`, `only_reference`, `neither`: the numbers of pairs that cleared;
        - `p_value` of equal rates, McNemar's exact test;
        - `time_to_clear_difference` [s] and `drive_work_difference` [J], `..._low`, `..._high`: the
          mean of model less reference over the pairs that `both` cleared, its bootstrap interval.

        The reference differs from itself by exactly 0.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule.
    LimitError
        If `threads` is out of range.
    SimulationDiverged
        If a state became non-finite; a note names the run.
    BatchInterrupted
        On Ctrl-C; its `runs` keeps what was finished.
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
    """
    tracks = labelled(models, "models")
    if len(tracks) < 2:
        raise ScenarioError("models", models, "must be at least two")
    labels = list(tracks)
    if reference is not None and reference not in labels:
        names = ", ".join(map(str, labels))
        raise ScenarioError("reference", reference, f"must be a label of the models: {names}")
    axis = Axis("model", ("robot.track",), {label: (track,) for label, track in tracks.items()})
    table = tabulate(
        scenario,
        [axis],
        repeats=repeats,
        seed=seed,
        vary=vary,
        counterfactual=False,
        threads=threads,
        progress=progress,
        on_error="raise",
    )
    base = 0 if reference is None else labels.index(reference)
    rates = rate(table).rename(low="rate_low", high="rate_high").drop_vars("count")
    rows = [_against(table, index, base) for index in range(len(labels))]
    columns = {name: ("model", [row[name] for row in rows], _attributes(name)) for name in rows[0]}
    return table.merge(rates).assign(columns).assign_attrs(reference=labels[base])


def _against(table: xarray.Dataset, model: int, base: int) -> dict[str, float]:
    """Compare one model with the reference."""
    cleared = table["outcome"].to_numpy() == "cleared"
    ours, theirs = cleared[model], cleared[base]
    both, only_ours = _count(ours & theirs), _count(ours & ~theirs)
    only_theirs, neither = _count(~ours & theirs), _count(~ours & ~theirs)
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
