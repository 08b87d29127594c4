"""Sweeps over the fields of a scenario, and paired comparisons of models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import read_scalar
from crawler2d.common.keywords import takes_keywords
from crawler2d.common.units import METRICS
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.branch import Trials
from crawler2d.runs.progress import Progress
from crawler2d.sweeps.axes import Axis, Label, read_axes, read_labels
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.statistics import bootstrap_mean, mcnemar, newcombe_paired
from crawler2d.sweeps.tabulate import OnError, tabulate

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["Variant", "axis_of", "compare", "sweep", "variants"]


@takes_keywords
def sweep(
    scenario: Scenario,
    over: Mapping[Any, Any],
    *,
    repeats: int = 20,
    seed: int = 0,
    vary: Mapping[str, Any] | None = None,
    unknown: Mapping[str, Any] | None = None,
    samples: int = 20,
    trials: Trials = None,
    store: str | PathLike[str] | None = None,
    executor: Executor | None = None,
    wall_time: bool = False,
    threads: int | None = None,
    progress: bool | Progress | None = True,
    on_error: OnError = "raise",
) -> xarray.Dataset:
    """Simulate every combination of values, each several times with small variations.

    A repeat draws the same random numbers in every cell, so cells can be compared in pairs. The
    scenario of each run contains its draws, so every run can be replayed alone.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    over : mapping
        Maps each dotted path to its values, in the order in which they are set:
        ``{"terrain.height": [0.05, 0.1]}``. A mapping of values gives them labels:
        ``{"robot.track": {"belt": BeltTrack()}}``; objects without labels are labelled by their
        short text. A tuple of paths sweeps them together, with tuples of values. ``{}`` just
        repeats the scenario. Whole robots are swept as ``{"robot": {"name": robot}}``. To compare a
        robot with and without flippers, sweep whole robots and use `Robot.without_flippers`:
        setting ``robot.flippers`` to None leaves their mass on the robot.
    repeats : int
        Runs per cell, and per sample of the unknowns, 1 to 1,000,000.
    seed : int
        Seed of the draws, 0 to 2^64 - 1.
    vary : mapping of str to distribution, optional
        Distributions of what varies from run to run, by path; rates are taken over these. None
        takes ``variability.of_start() | variability.of_contact()``, ``{}`` nothing. `uniform` and,
        for whole numbers, `uniform_int` replace a value, `scaled` multiplies it, `shifted` adds to
        it; a frozen distribution of SciPy replaces it. ``[*]`` in a path means every element, all
        with the same draw: ``robot.belly[*][1]`` moves the belly up or down.
    unknown : mapping of str to distribution, optional
        Distributions of what is constant but not known, in the same form: see `unknowns`. Each cell
        is repeated for every sample, so that `rate` gives a band of rates.
    samples : int
        Number of samples of the unknowns, 1 to 100,000.
    trials : {"auto", "all"} or sequence of str, optional
        Trials to make in every run that ends in a stop; see `simulate`.
    store : str or path-like, optional
        File that keeps every run, created if missing: runs in it are not simulated again, so after
        any interruption the same call continues. It can be shared by any number of sweeps.
    executor : concurrent.futures.Executor, optional
        Where to simulate instead: ``ProcessPoolExecutor()``, or ``client.get_executor()`` of Dask.
        Its workers need the same build of crawler2d; each takes some runs at a time, on one thread.
        Rows do not depend on it. Runs of a lost worker are submitted again, each alone; a run that
        is lost three times ends as an `InternalError`. There is no time limit: the cluster must
        detect hanging workers, and after Ctrl-C the same call continues.
    wall_time : bool
        Whether to add the computing time. It is not reproducible, so tables with it cannot be
        merged if they overlap.
    threads : int, optional
        See `simulate_many`; ignored with an executor.
    progress : bool or callable
        See `simulate_many`.
    on_error : {"raise", "record"}
        What to do about a run without a result: raise its error (before the first run if a scenario
        breaks a rule), or record it in the table. A path that a variant lacks always raises.

    Returns
    -------
    xarray.Dataset
        Dimensions: one per entry of `over`, `sample` if there are unknowns, and `repeat`. A
        dimension is named after the last part of its path, or after the whole path with underscores
        if that name is taken by another path or a column of the table or of `rate`:
        ``robot.track.count`` is `robot_track_count`. The name for a tuple joins the last parts of
        its paths; numbers become additional coordinates. Every column has every dimension.

        - `outcome`; without a result `diverged`, `refused` (broken rule) or `failed` (out of
          memory, lost workers, or a bug), and `error` says why;
        - about a stop, else "", False, NaN or -1: `symptom`, `transient`, `mechanism`, `jammed` and
          `belly_side` as in `Diagnosis`; its pose, `stop_x` [m] and `stop_angle` [rad]; and the
          ground inside a track: `stop_edge`, `stop_side`, `stop_carrier`, `stop_bodies`, such as
          "1-2";
        - for each of `trials`, and for the closed track of jammed robots: whether it was made,
          whether it freed the robot, and how it ended, as in `Trial`: `tried_torque_x2`,
          `freed_by_torque_x2` and `then_torque_x2`, and so on;
        - every metric of `Run.metrics`; with `wall_time`, the computing time [s] on one thread;
        - `scenario`, the JSON text of each run, and its `identity`;
        - `drawn_...` and `unknown_...`, the value drawn for each path of `vary` and `unknown` (the
          first, if the path has several elements), and the `seed`.

        Its attributes contain the scenario, `vary` and `unknown`.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule; the path begins with the cell and the repeat.
    LimitError
        If `threads` is out of range.
    SimulationDiverged
        If a state became non-finite; a note names the run.
    StoreError
        If the file is not a store, is damaged, is written by another process, or cannot grow. Its
        content is kept, and `runs` of the error has the runs simulated since.
    InternalError
        If the executor accepts no more tasks; if a worker has another build of crawler2d, named by
        the message; or if workers are lost whenever they simulate a run, named by a note. Finished
        runs are in the store.
    BatchInterrupted
        On Ctrl-C; its `runs`, cell by cell, holds the finished runs and the other scenarios;
        `table` arranges them.
    ImportError
        If xarray is missing; the message names the extra to install.

    Warns
    -----
    ScenarioWarning
        If a cell removes the flippers of a robot but leaves their mass on it.

    Notes
    -----
    By default the repeats draw:

    - `start.approach`: uniform over a quarter of the axle distance, which is the wheel spacing of a
      line of five, around the scenario's value, and never below 0;
    - `start.track_phase`: uniform over one grouser pitch;
    - `drive.speed` and `terrain.friction`: the cell's own value times 0.98 to 1.02. The friction of
      every lane is multiplied by the same factor.

    These vary how the same robot meets the same obstacle, so their rates do not cover other robots
    or floors. Distances are those of `scenario`, the same for every cell. Approach and phase are
    not drawn if they are swept. A draw that breaks a rule, such as a speed above the drivetrain's
    maximum, is dropped, and the run keeps the cell's value.

    The number drawn for a path depends only on seed, repeat (or sample) and path. Other paths, more
    repeats or other cells do not change it, and equal runs have equal rows. So xarray can join
    tables of one design: `xarray.merge` joins tables with other cells or more repeats;
    `xarray.concat` along `repeat` joins tables with another seed, where `seed` and `repeat`
    together identify a draw. Runs in neither table are missing in the joined one, and `rate` does
    not count them.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> models = {"belt": c2d.BeltTrack(), "skids": c2d.ForceTrack()}
    >>> table = c2d.sweep(base, {"robot.track": models}, repeats=2, progress=False)
    >>> table.outcome.values.tolist()
    [['cleared', 'cleared'], ['stalled', 'stalled']]

    Any run can be replayed alone, with its history:

    >>> text = table.scenario.sel(track="belt", repeat=1).item()
    >>> run = c2d.simulate(c2d.Scenario.from_json(text))
    >>> run.metrics["final_x"] == table.final_x.sel(track="belt", repeat=1).item()
    True

    More repeats of the belt, then more with another seed:

    >>> import xarray as xr
    >>> belt = {"robot.track": {"belt": c2d.BeltTrack()}}
    >>> more = c2d.sweep(base, belt, repeats=3, progress=False)
    >>> merged = xr.merge([table, more], join="outer", compat="no_conflicts")
    >>> c2d.rate(merged)["count"].values.tolist()
    [3, 2]
    >>> other = c2d.sweep(base, belt, repeats=2, seed=1, progress=False)
    >>> joined = xr.concat([more, other], "repeat")
    >>> joined.seed.values.tolist(), c2d.rate(joined)["count"].item()
    ([[0, 0, 0, 1, 1]], 5)
    """
    return tabulate(
        scenario,
        read_axes(over),
        repeats=repeats,
        seed=seed,
        vary=vary,
        unknown=unknown,
        samples=samples,
        trials=trials,
        store=store,
        executor=executor,
        wall_time=wall_time,
        threads=threads,
        progress=progress,
        on_error=on_error,
    )


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
) -> FigureDataset:
    """Compare track models, or any variants, with a reference model under the same draws.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    models : mapping of str to model, or sequence of models
        At least two; in a sequence, their short texts become labels. A model is either a track, a
        robot or another part of a scenario, such as a `Solver`, which replaces the scenario's own;
        or a mapping from dotted paths to values, as in `Scenario.replace`, where ``{}`` leaves the
        scenario unchanged.
    repeats : int
        Runs per model, 1 to 1,000,000.
    seed, vary, store, executor, threads, progress
        See `sweep`.
    reference : str, optional
        Label of the model that the others are compared with; None takes the first.

    Returns
    -------
    FigureDataset
        An `xarray.Dataset` whose `plot` draws the differences: the table of `sweep` with the
        dimensions `model` and `repeat`. In addition, for each model, with 95 % intervals:

        - `rate`, `rate_low`, `rate_high`: rate of clearing, Wilson's interval; and `distinct`, as
          of `rate`;
        - `difference`, `difference_low`, `difference_high`: that rate minus the reference's,
          Newcombe's interval for paired data;
        - `both`, `only_model`, `only_reference`, `neither`: the number of pairs that cleared so;
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

    The same robot with its centre of mass unchanged and further back:

    >>> steep = base.replace({"terrain": c2d.terrains.ramp(0.6)})
    >>> robots = {"as it is": {}, "tail heavy": {"robot.center_of_mass[0]": -0.15}}
    >>> found = c2d.compare(steep, robots, repeats=5, progress=False)
    >>> found.rate.values.tolist()
    [1.0, 0.0]
    """
    check_scenario(scenario)
    named = variants(models)
    if len(named) < 2:
        raise ScenarioError("models", models, "must hold at least two models")
    labels = list(named)
    reference = read_scalar(reference, whole=True)
    is_label = type(reference) in (str, int, float) and reference in labels
    if reference is not None and not is_label:
        names = ", ".join(map(str, labels))
        raise ScenarioError("reference", reference, f"must be a label of the models: {names}")
    table = tabulate(
        scenario,
        [axis_of("model", named)],
        repeats=repeats,
        seed=seed,
        vary=vary,
        store=store,
        executor=executor,
        threads=threads,
        progress=progress,
        on_error="raise",
    )
    base = 0 if reference is None else labels.index(reference)
    rates = rates_of(table).rename(low="rate_low", high="rate_high").drop_vars("count")
    rows = [_compare_pair(table, index, base) for index in range(len(labels))]
    columns = {name: ("model", [row[name] for row in rows], _attributes(name)) for name in rows[0]}
    whole = table.merge(rates).assign(columns)
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    about = {**table.attrs, "figure": "comparison", "reference": labels[base]}
    return FigureDataset(whole.data_vars, whole.coords, about)


def variants(models: object, place: str = "models") -> dict[Label, Mapping[str, Any]]:
    """Read an argument such as `models`: the replaced values by label, then by path."""
    labels = read_labels(models, place)
    return {label: _fields(model, f"{place}[{label!r}]") for label, model in labels.items()}


def axis_of(name: str, named: Mapping[Label, Mapping[str, Any]]) -> Axis:
    """Return the axis for the result of `variants`."""
    paths = dict.fromkeys(path for fields in named.values() for path in fields)
    return Axis(name, tuple(paths), named)


def _fields(model: object, place: str) -> Mapping[str, Any]:
    """Return the values that a model replaces, by path."""
    if isinstance(model, Mapping):
        return model
    if isinstance(model, Parameters) and model.default_path:
        return {model.default_path: model}
    rule = (
        "must be a track, a robot or another part of a scenario, or a mapping from paths to values"
    )
    raise ScenarioError(place, model, rule)


def _compare_pair(table: xarray.Dataset, model: int, base: int) -> dict[str, float]:
    """Compare one model with the reference."""
    outcomes = table["outcome"].to_numpy()
    valid = np.isin(outcomes[[model, base]], [str(each) for each in Outcome]).all(axis=0)
    ours, theirs = outcomes[model] == "cleared", outcomes[base] == "cleared"
    both, only_ours = _count(valid & ours & theirs), _count(valid & ours & ~theirs)
    only_theirs, neither = _count(valid & ~ours & theirs), _count(valid & ~ours & ~theirs)
    columns: dict[str, float] = {
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
        columns |= dict(zip((name, f"{name}_low", f"{name}_high"), bounds, strict=True))
    return columns


def _count(chosen: NDArray[np.bool_]) -> int:
    return int(chosen.sum())


def _attributes(name: str) -> dict[str, str]:
    unit = next((METRICS[cost] for cost in _COSTS if name.startswith(cost)), "1")
    return {"units": unit, "long_name": name.replace("_", " ")}
