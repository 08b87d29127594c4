"""Test a policy on track models other than the one it was trained on."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from crawler2d import _core
from crawler2d.common.extras import extra
from crawler2d.common.keywords import takes_keywords
from crawler2d.envs.episodes import Episodes
from crawler2d.envs.task import Task, flipper_ends
from crawler2d.errors import Crawler2dError, ScenarioError, raise_first
from crawler2d.parameters.settings import Climb, Gait
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import Row
from crawler2d.runs.progress import Progress, Reporter, reporter, thread_count
from crawler2d.sweeps.axes import Axis
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.statistics import Interval, newcombe_paired
from crawler2d.sweeps.sweep import Variant, axis_of, variants
from crawler2d.sweeps.tabulate import Tabulation

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["Policy", "audit_policy"]

Policy = Callable[["NDArray[np.float32]"], "ArrayLike"]
"""Maps observations, shape (N, n), to actions, shape (N, m)."""

_POLICY, _BASELINE = "policy", "baseline"


@takes_keywords
def audit_policy(
    policy: Policy,
    env: gymnasium.Env[Any, Any] | gymnasium.vector.VectorEnv[Any, Any, Any],
    *,
    models: Mapping[Any, Variant],
    obstacles: Mapping[Any, Variant],
    baseline: Gait = Climb(),
    repeats: int = 20,
    seed: int = 0,
    vary: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: bool | Progress | None = True,
) -> FigureDataset:
    """Compare a policy with a gait on several track models and obstacles.

    If the policy beats the gait on the model that it was trained on but not on others, it may have
    learned to exploit that model, such as a pocket between two wheels that hooks an edge. All
    models and both drivers get the same draws.

    Parameters
    ----------
    policy : callable
        Maps observations, shape (N, n), to actions, shape (N, m), like those of `env`; rows of
        ended episodes are ignored. With stable-baselines3: ``lambda seen: model.predict(seen,
        deterministic=True)[0]``.
    env : FlipperEnv or FlipperVectorEnv
        The environment of the training: scenario, `dt`, observations and commands. It is not
        changed.
    models : mapping of str to model
        Models to compare, see `compare`; the first is the one that the policy was trained on.
    obstacles : mapping of str or number to Terrain
        Terrains by label; or mappings from paths to values, see `compare`.
    baseline : Climb or Hold
        The gait for comparison, at the speed of the scenario.
    repeats : int
        Runs of each driver per model and obstacle, 1 to 1,000,000.
    seed, vary, progress
        See `sweep`.
    threads : int, optional
        Largest number of threads; None takes one per core.

    Returns
    -------
    FigureDataset
        The table of `sweep` with the dimensions `driver` (policy, baseline), `model`, `obstacle`
        and `repeat`, including where and why each run stopped; ``plot()`` draws the rates. In
        addition, with 95 % intervals:

        - `rate`, `low`, `high`: rate of clearing, Wilson's interval;
        - `gain`, `gain_low`, `gain_high`: the policy's rate minus the baseline's, over pairs of
          runs that both have an outcome, with Newcombe's interval for paired data;
        - `lost`, `lost_low`, `lost_high`: the gain on the first model minus that on this one; the
          interval combines those of both gains by their squares, as if they were independent;
        - `ending`: the commonest ending of the runs that do not clear, with its count.

        The attribute `summary` describes where a gain is lost; `first_model` is the label of the
        first model.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule, or a model has flippers at other ends.
    SimulationDiverged
        If a state became non-finite under the baseline; under the policy the run is `diverged`.
    ImportError
        If xarray is missing; the message names the extra to install.

    References
    ----------
    Zou, G. Y., Donner, A. (2008). Construction of confidence limits about effect measures: a
    general approach. Statistics in Medicine 27, 1693-1702.

    Examples
    --------
    A policy that keeps the front flippers level and pushes with the rear ones as the nose rises:

    >>> import numpy as np
    >>> import crawler2d as c2d
    >>> from crawler2d.envs import FlipperEnv, audit_policy
    >>> def lift(seen):
    ...     pitch, front, rear = seen[:, [0, 3, 4]].T
    ...     rates = [1.2 - 3.0 * (pitch + front), 0.9 - 3.0 * (2.0 * pitch + rear)]
    ...     return np.stack([np.ones(len(seen)), *rates], axis=1)
    >>> robots = {"belt": {}, "public wheels": c2d.robots.absolem(track="public")}
    >>> steps = {0.25: c2d.terrains.step(0.25)}
    >>> found = audit_policy(
    ...     lift, FlipperEnv(), models=robots, obstacles=steps, repeats=5, progress=False
    ... )
    >>> found.rate.sel(obstacle=0.25, driver="baseline").values.tolist()
    [1.0, 0.0]
    >>> found.rate.sel(obstacle=0.25, driver="policy").values.tolist()
    [0.0, 0.4]
    >>> found.attrs["summary"]
    'no gain over the baseline on belt that is certain'
    """
    extra("xarray", "analysis")
    task = _task_of(env)
    if not callable(policy):
        raise ScenarioError("policy", policy, "must be callable")
    if not isinstance(baseline, Gait):
        raise ScenarioError("baseline", baseline, "must be a Climb or a Hold")
    options: Any = {"repeats": repeats, "seed": seed, "vary": vary, "threads": threads}
    options |= {"store": None, "executor": None}
    given = {"model": variants(models), "obstacle": variants(obstacles, "obstacles")}
    axes = [axis_of(name, named) for name, named in given.items()]
    _check_flippers(task, axes[0])
    gait = task.scenario.replace({"drive.gait": baseline})
    driven, compared = (Tabulation(each, axes, **options) for each in (task.scenario, gait))
    for each in (driven, compared):
        raise_first(each.checked)
    scenarios = [each for each in driven.checked if isinstance(each, _core.PreparedScenario)]
    with reporter(progress, 2 * len(scenarios)) as report:
        driven.take(_drive(policy, task, scenarios, thread_count(threads), report))
        compared.simulate(range(len(scenarios)), _Counted(report))
    compared.raise_first()
    return _compared(driven.table(), compared.table())


def _task_of(env: Any) -> Task:
    task = getattr(getattr(env, "unwrapped", None), "task", None)
    if not isinstance(task, Task):
        raise ScenarioError("env", env, "must be a FlipperEnv or a FlipperVectorEnv")
    return replace(task, ends_when_stopped=False)  # the baseline does not end then, either


def _check_flippers(task: Task, models: Axis) -> None:
    """Refuse models with flippers at other ends than the policy commands."""
    for label, values in models.values.items():
        robot = task.scenario.replace(values).robot
        if flipper_ends(robot) != task.ends:
            rule = "must have flippers at the same ends as the robot of the environment"
            raise ScenarioError(f"models[{label!r}]", robot.description, rule)


class _Counted:
    """Reports progress since the last call."""

    def __init__(self, report: Reporter) -> None:
        self._report, self._done = report, 0

    def __call__(self, done: int, _total: int) -> None:
        self._report(done - self._done)
        self._done = done


def _drive(
    policy: Policy,
    task: Task,
    scenarios: Sequence[_core.PreparedScenario],
    threads: int,
    report: Reporter,
) -> list[Row]:
    """Drive all scenarios to the end with the policy, and return their rows."""
    episodes = Episodes(task, scenarios, threads)
    observations = episodes.observe()
    runs = np.ones(len(scenarios), bool)
    while runs.any():
        step = episodes.step(policy(observations), runs)
        observations = step.observations
        report(int((runs & step.ended).sum()))
        runs &= ~step.ended

    def row(index: int) -> Row:
        try:
            return Row.of_record(episodes.run(index, trials=None))
        except Crawler2dError as error:
            return Row.of_error(error, scenarios[index].identity, scenarios[index].text)

    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(row, range(len(scenarios))))


def _compared(driven: xarray.Dataset, compared: xarray.Dataset) -> FigureDataset:
    """Put both drivers into one table, with rates, gains and losses."""
    xr = extra("xarray", "analysis")
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    table = xr.concat(
        [driven, compared],
        xr.IndexVariable("driver", [_POLICY, _BASELINE]),
        combine_attrs="drop_conflicts",
    )
    rates = rates_of(table)
    outcomes = table["outcome"].to_numpy()
    cells = outcomes.shape[1:3]
    gains = np.empty((*cells, 3))
    for cell in np.ndindex(cells):
        gains[cell] = _gain(*outcomes[(slice(None), *cell)])
    losses = np.array([[_lost(*pair) for pair in zip(gains[0], row, strict=True)] for row in gains])
    endings = [_ending(table.isel(driver=0, model=m, obstacle=o)) for m, o in np.ndindex(cells)]
    over = ("model", "obstacle")
    columns: dict[str, Any] = {"ending": (over, np.array(endings, object).reshape(cells))}
    for name, values in (("gain", gains), ("lost", losses)):
        for k, part in enumerate(("", "_low", "_high")):
            attributes = {"units": "1", "long_name": f"{name}{part}".replace("_", " ")}
            columns[name + part] = (over, values[..., k], attributes)
    whole = table.merge(rates[["rate", "low", "high"]]).assign(columns)
    found = FigureDataset(dict(whole.data_vars), coords=whole.coords, attrs=whole.attrs)
    found.attrs |= {"figure": "policy", "interval": "Wilson", "confidence_level": 0.95}
    found.attrs["first_model"] = found["model"].to_numpy().tolist()[0]
    found.attrs["summary"] = _summary(found)
    return found


def _gain(ours: NDArray[np.object_], theirs: NDArray[np.object_]) -> Interval:
    """Compare two drivers over the pairs in which both runs have an outcome."""
    ended = np.isin([ours, theirs], list(map(str, Outcome))).all(axis=0)
    ours, theirs = ours[ended] == Outcome.CLEARED, theirs[ended] == Outcome.CLEARED
    if not ended.any():
        return Interval(math.nan, math.nan, math.nan)
    counts = [(ours & theirs), (ours & ~theirs), (~ours & theirs), ~(ours | theirs)]
    return newcombe_paired(*(int(each.sum()) for each in counts))


def _lost(first: Sequence[float], other: Sequence[float]) -> Interval:
    """Subtract two gains by the method of Zou and Donner."""
    (a, a_low, a_high), (b, b_low, b_high) = first, other
    below, above = math.hypot(a - a_low, b_high - b), math.hypot(a_high - a, b - b_low)
    return Interval(a - b, a - b - below, a - b + above)


def _ending(runs: xarray.Dataset) -> str:
    """Describe the commonest failure, such as ``seized, straddled: 7 of 20``."""
    outcomes, mechanisms = (runs[name].to_numpy() for name in ("outcome", "mechanism"))
    ends = Counter(
        ", ".join(filter(None, pair))
        for pair in zip(outcomes.tolist(), mechanisms.tolist(), strict=True)
        if pair[0] != "cleared"
    )
    if not ends:
        return ""
    ((ending, count),) = ends.most_common(1)
    return f"{ending.replace('_', ' ')}: {count} of {len(outcomes)}"


def _summary(found: xarray.Dataset) -> str:
    """Describe the gain on the first model, and where it is lost."""
    trained, *others = found["model"].to_numpy().tolist()
    lines = []
    for obstacle in found["obstacle"].to_numpy().tolist():
        here = found.sel(obstacle=obstacle)
        own = here.sel(model=trained)
        if not own["gain_low"] > 0.0:
            continue
        rates = [own["rate"].sel(driver=driver).item() for driver in (_POLICY, _BASELINE)]
        text = f"{obstacle}: clears {rates[0]:.0%} on {trained}, the baseline {rates[1]:.0%}"
        lost = [f"{model}" for model in others if here.sel(model=model)["lost_low"] > 0.0]
        if lost:
            text += f"; some of this gain is lost on {', '.join(lost)}"
        lines.append(text)
    return "\n".join(lines) or f"no gain over the baseline on {trained} that is certain"
