"""Simulate many variants of one scenario, repeated with small variations, into one table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from crawler2d._core import Passed, build_info
from crawler2d.common.arrays import frozen_scalar
from crawler2d.common.extras import extra
from crawler2d.errors import Crawler2dError, ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.batch import simulate_passed
from crawler2d.runs.progress import Progress
from crawler2d.runs.recording import recording, yes_or_no
from crawler2d.runs.threads import thread_count
from crawler2d.runs.trials import Trials, trial_names
from crawler2d.sweeps.axes import Axis, read_axes
from crawler2d.sweeps.dataset import to_table
from crawler2d.sweeps.draws import Distribution, Variation
from crawler2d.sweeps.plan import plan_runs

if TYPE_CHECKING:
    import xarray

__all__ = ["sweep"]

OnError = Literal["raise", "record"]


def sweep(
    scenario: Scenario,
    over: Mapping[Any, Any],
    *,
    repeats: int = 20,
    seed: int = 0,
    vary: Mapping[str, Distribution] | None = None,
    trials: Trials = None,
    wall_time: bool = False,
    threads: int | None = None,
    progress: bool | Progress | None = True,
    on_error: OnError = "raise",
) -> xarray.Dataset:
    """Simulate every combination of some values, each several times with small variations.

    A repeat draws the same random numbers in every cell, so that cells can be compared in pairs.
    The draws are written into the scenario of each run, so that every run can be replayed alone.

    Parameters
    ----------
    scenario : Scenario
        What all runs share.
    over : mapping
        Maps each dotted path to its values, in the order in which they are set:
        ``{"terrain.height": [0.05, 0.1]}``. A mapping of values gives them labels:
        ``{"robot.track": {"belt": BeltTrack()}}``; objects without labels are labelled by their
        short text. A tuple of paths sweeps them together, and takes tuples of values. ``{}`` only
        repeats the scenario. Whole robots are swept as ``{"robot": {"name": robot}}``. To compare a
        robot with and without flippers, sweep it so with `Robot.without_flippers`: setting
        ``robot.flippers`` to None leaves their mass on the robot.
    repeats : int
        Runs per cell, 1 to 1,000,000.
    seed : int
        Seed of the draws, 0 to 2^64 - 1.
    vary : mapping of str to distribution, optional
        What the repeats draw, by path: `uniform` and, for whole numbers, `uniform_int` replace a
        value, `scaled` multiplies it. None takes the variations below, ``{}`` none at all.
    trials : {"auto", "all"} or sequence of str, optional
        What to try in every run that ends in a stop; see `simulate`.
    wall_time : bool
        Whether to add the computing time. It differs from run to run, so that tables with it cannot
        be merged where they overlap.
    threads : int, optional
        See `simulate_many`.
    progress : bool or callable
        See `simulate_many`.
    on_error : {"raise", "record"}
        What to do about a run without a result: raise its error, before the first run if a scenario
        breaks a rule; or record it in the table. A path that a variant lacks always raises.

    Returns
    -------
    xarray.Dataset
        Dimensions: one per entry of `over`, and `repeat`. A dimension is named after the last part
        of its path, or after the whole path with underscores if that name is taken by another path
        or a column of the table or of `rate`: ``robot.track.count`` is `robot_track_count`. The
        name for a tuple joins the last parts of its paths, whose numbers are further coordinates.
        Every column has every dimension.

        - `outcome`; without a result it is `diverged`, `refused` (broken rule) or `failed` (out of
          memory, or a fault of the program), and `error` says why;
        - of a stop, else "", False, nan or -1: `symptom`, `passing`, `mechanism`, `jammed` and
          `belly_side` as in `Diagnosis`; where it is: `stop_x` [m], `stop_angle` [rad]; and where
          ground is inside a track: `stop_edge`, `stop_side`, `stop_carrier`, `stop_bodies`, such as
          "1-2";
        - for each trial of `trials`, and for the closed track of jammed robots: whether it was
          made, whether it freed the robot and how it ended, as in `Tried`: `tried_torque_x2`,
          `freed_by_torque_x2` and `then_torque_x2`, and so on;
        - every metric of `Run.metrics`; with `wall_time`, the computing time [s] on one thread;
        - `scenario`, the JSON text of each run, and its `identity`;
        - `drawn_...`, the value drawn for each path of `vary`, and the `seed`.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule; the path begins with the cell and the repeat.
    LimitError
        If `threads` is out of range.
    SimulationDiverged
        If a state became non-finite; a note names the run.
    BatchInterrupted
        On Ctrl-C; its `runs`, cell by cell, holds the finished runs and the other scenarios.
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
      line of five, about the scenario's own value, and never below 0;
    - `start.track_phase`: uniform over one grouser pitch;
    - `drive.speed` and `terrain.friction`: the cell's own value times 0.98 to 1.02. Terrains of
      lanes have a friction per lane, which is not varied.

    Distances are those of `scenario`, the same for every cell. Approach and phase are not drawn if
    they are swept. A draw that breaks a rule, such as a speed above the drivetrain's maximum, is
    dropped: the run keeps the cell's own value.

    The number drawn for a path depends only on seed, repeat and path. Other paths in `vary`, more
    repeats or other cells do not change it, and equal runs have equal rows. So xarray can join the
    tables of one design: `xarray.merge` joins tables with other cells or more repeats;
    `xarray.concat` along `repeat` joins tables with another seed, where `seed` and `repeat`
    together identify a draw. Runs that are in neither table are missing in the joined one, and
    `rate` does not count them.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> models = {"belt": c2d.BeltTrack(), "skids": c2d.ForceTrack()}
    >>> table = c2d.sweep(base, {"robot.track": models}, repeats=2, progress=False)
    >>> table.outcome.values.tolist()
    [['cleared', 'cleared'], ['stalled', 'stalled']]

    Any run can be replayed alone, with its history.

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
        trials=trials,
        wall_time=wall_time,
        threads=threads,
        progress=progress,
        on_error=on_error,
    )


def tabulate(
    scenario: Scenario,
    axes: Sequence[Axis],
    *,
    repeats: int,
    seed: int,
    vary: Mapping[str, Distribution] | None,
    trials: Trials,
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
    with_times = yes_or_no(wall_time, "wall_time")
    tried = trial_names(trials)
    recorded = (*recording(0.01, "summary"), list(tried))
    count = thread_count(threads)
    repeats = _whole(repeats, "repeats", 1, 10**6)
    seed = _whole(seed, "seed", 0, 2**64 - 1)
    base = Passed(scenario.to_json())
    variation = Variation.of(scenario, vary, [path for axis in axes for path in axis.paths])
    plans = plan_runs(scenario, axes, variation, repeats=repeats, seed=seed, like=base)
    if on_error == "raise":
        _raise_first(plan.refused for plan in plans)
    runs = simulate_passed(
        [plan.scenario for plan in plans],
        [plan.checked for plan in plans],
        recorded,
        threads=count,
        progress=progress,
    )
    for plan, run in zip(plans, runs, strict=True):
        if run.error is not None and plan.refused is None:
            run.error.add_note(f"in {plan.place}")
    if on_error == "raise":
        _raise_first(run.error for run in runs)
    dataset = to_table(
        axes,
        variation.distributions,
        plans,
        runs,
        seed=seed,
        trials=tried,
        with_times=with_times,
    )
    provenance = {"scenario": scenario.to_json(), "vary": str(variation.distributions)}
    builds = {f"build_{name}": value for name, value in build_info().items()}
    return dataset.assign_attrs(provenance, **builds)


def _raise_first(errors: Iterable[Crawler2dError | None]) -> None:
    for error in errors:
        if error is not None:
            raise error


def _whole(value: object, path: str, least: int, most: int) -> int:
    number = frozen_scalar(value, whole=True)
    if type(number) is not int or not least <= number <= most:
        raise ScenarioError(path, value, f"must be a whole number from {least} to {most}")
    return number
