"""Ride, odometry error, and real-time factor of models."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.extras import extra
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.record import Row
from crawler2d.runs.dataset import build_attributes
from crawler2d.runs.progress import Progress, reporter
from crawler2d.runs.simulation import Simulation
from crawler2d.studies.campaign import Cell, Sampling, Tally, campaign
from crawler2d.studies.driving import FRICTION, UNCHANGED, Change
from crawler2d.studies.tables import (
    Dims,
    Measure,
    Models,
    check_study,
    measure_table,
    paths_of,
    read_models,
    summary,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["odometry", "real_time_factor", "ride"]

_STANDS = 1e-3
"""[m] A robot that moved less has no odometry error."""


@takes_keywords
def ride(
    scenario: Scenario,
    *,
    models: Models | None = None,
    repeats: int = 10,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Measure the ride of each model on the scenario's ground: vibration and pitching.

    Parameters
    ----------
    scenario : Scenario
        Every run covers it from start to end, including standstill in a stop; `ended` and `speed`
        show what it covers.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    repeats : int
        Runs per model, 1 to 1,000,000.
    **sampling
        See `crawler2d.studies`.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `sample` if there are unknowns, and `repeat`:

        - `vibration` [m/s^2]: vertical acceleration of the chassis frame, averaged over 10 ms, root
          mean square;
        - `rocking` [rad/s]: rate of change of the chassis angle, root mean square;
        - `swing` [rad]: largest minus smallest chassis angle;
        - `speed` [m/s]: distance along the chassis divided by the duration of the run;
        - `ended`: the commonest outcome;
        - and the columns of `sweep`.

        The first four are medians over the repeats. Each has bounds, such as `vibration_low` and
        `vibration_high`, the minimum and maximum of the repeats, and `vibration_each`; with
        unknowns, also the band of the medians over the samples, `vibration_band_low`, `..._median`
        and `..._high`. `found.plot(of="swing")` draws the swing instead of the vibration.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule.

    Examples
    --------
    Grousers shake the chassis, a smooth belt does not:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> models = {"belt": c2d.BeltTrack(), "gears": c2d.LineOfWheels(4, wheel=c2d.GearWheel())}
    >>> found = c2d.studies.ride(base, models=models, repeats=2, progress=False)
    >>> smooth, rough = found["vibration"].values
    >>> bool(smooth < 0.02), bool(rough > 1.0)
    (True, True)
    """
    check_study(scenario)
    measures: Mapping[str, tuple[str, str, Callable[[Row], float]]] = {
        "vibration": (
            "m/s^2",
            "vertical acceleration, root mean square",
            lambda row: row.metrics["vertical_acceleration"],
        ),
        "rocking": (
            "rad/s",
            "rate of the chassis angle, root mean square",
            lambda row: row.metrics["angular_velocity"],
        ),
        "swing": (
            "rad",
            "swing of the chassis angle",
            lambda row: row.metrics["max_angle"] - row.metrics["min_angle"],
        ),
        "speed": (
            "m/s",
            "mean speed",
            lambda row: row.metrics["path_length"] / row.metrics["time"],
        ),
    }
    fields = read_models(scenario, models)
    with campaign(
        scenario, sampling, paths_of(fields), repeats=whole_number(repeats, "repeats", 1, 10**6)
    ) as study:
        cells = [Cell((f"model={label}",), scenario.replace(own)) for label, own in fields.items()]
        tallies = study.repeat(cells)
        table = measure_table(
            study,
            "ride",
            tallies,
            {"model": (list(fields), {})},
            {
                name: Measure(("model",), _figures(tallies, value), unit, text)
                for name, (unit, text, value) in measures.items()
            },
        )
    return _with_ends(table, tallies, "vibration")


@takes_keywords
def odometry(
    scenario: Scenario,
    *,
    models: Models | None = None,
    repeats: int = 10,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Measure the odometry error: travel of the track compared with travel of the robot.

    Odometry with the circumscribed radius reads the travel of the track surface. On level ground it
    reads too much if the track slides, or if it rolls on less than that radius, like a gear wheel
    between its tips. To separate the two, the same runs are repeated with the friction doubled: the
    remaining error is not sliding. On uneven ground the two distances differ even without either.

    Parameters
    ----------
    scenario, models, repeats, **sampling
        See `ride`.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `change` (unchanged, and the friction doubled), `sample` if there are
        unknowns, and `repeat`:

        - `odometry_error` [-]: odometry distance / travelled distance - 1;
        - `slip` [-]: mean slip ratio, 1 - travelled distance / odometry distance;
        - `rolling_radius` [m]: the radius for which odometry would be correct; NaN unless all
          wheels of the chassis have the same radius;
        - `odometry_error_with` [-]: the error without change, and with the friction doubled;
        - `ended`: the commonest outcome for each change;
        - and the columns of `sweep`.

        The first four are medians over the repeats, with bounds and bands as in `ride`; NaN if a
        repeat has not moved.

    Examples
    --------
    Round wheels roll on their radius, gear wheels on less than their tip radius:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> models = {"round": c2d.LineOfWheels(4), "gears": c2d.LineOfWheels(4, wheel=c2d.GearWheel())}
    >>> found = c2d.studies.odometry(base, models=models, repeats=2, progress=False)
    >>> found["rolling_radius"].sel(model="round").round(4).item()
    0.064
    >>> 0.055 < found["rolling_radius"].sel(model="gears").item() < 0.064
    True
    """
    check_study(scenario)
    changes: tuple[Change, ...] = (UNCHANGED, FRICTION)
    fields = read_models(scenario, models)
    with campaign(
        scenario, sampling, paths_of(fields), repeats=whole_number(repeats, "repeats", 1, 10**6)
    ) as study:
        cells = [
            Cell(
                (f"model={label}", f"change={change.label}"),
                change.of(scenario.replace(own)),
                change.factors(scenario.replace(own)),
            )
            for label, own in fields.items()
            for change in changes
        ]
        tallies = study.repeat(cells)
        shape = (len(fields), len(changes), -1, study.until.max_runs)
        ratios = _figures(tallies, _ratio).reshape(shape)  # travelled to odometry distance
        radii = _figures(tallies[:: len(changes)], _radius).reshape(ratios[:, 0].shape)
        dims: Dims = {
            "model": (list(fields), {}),
            "change": ([each.label for each in changes], {"long_name": "what is doubled"}),
        }
        text = "error of odometry"
        one, both = ("model",), ("model", "change")
        measures = {
            "odometry_error": Measure(one, 1.0 / ratios[:, 0] - 1.0, "1", text),
            "slip": Measure(one, 1.0 - ratios[:, 0], "1", "mean slip ratio"),
            "rolling_radius": Measure(one, radii * ratios[:, 0], "m", "effective rolling radius"),
            "odometry_error_with": Measure(
                both, 1.0 / ratios - 1.0, "1", f"{text} with each change"
            ),
        }
        table = measure_table(study, "odometry", tallies, dims, measures)
    return _with_ends(table, tallies, "odometry_error_with")


def _figures(tallies: list[list[Tally]], value: Callable[[Row], float]) -> NDArray[np.float64]:
    """Return a figure for every run, shape (cells, samples, repeats); NaN without a result."""
    return np.array(
        [
            [
                [math.nan if row.error is not None else value(row) for row in tally.rows]
                for tally in each
            ]
            for each in tallies
        ]
    )


def _with_ends(table: FigureDataset, tallies: list[list[Tally]], name: str) -> FigureDataset:
    """Add the commonest outcome, in the dimensions of a column."""
    ends = np.array([tally.commonest_outcome for each in tallies for tally in each])
    attributes = {"long_name": "how most runs ended"}
    return table.assign(ended=(table[name].dims, ends.reshape(table[name].shape), attributes))


def _ratio(row: Row) -> float:
    """[-] Distance moved by the robot divided by the travel of the track."""
    moved, run = row.metrics["path_length"], row.metrics["track_distance"]
    return moved / run if min(abs(moved), abs(run)) > _STANDS else math.nan


def _radius(row: Row) -> float:
    """[m] Circumscribed radius of the chassis wheels; NaN unless all are equal."""
    wheels = Scenario.from_json(row.scenario).robot.wheels()
    on_chassis = wheels["carrier"] == "chassis"
    radii = set(wheels["radius"][on_chassis].tolist())
    return radii.pop() if len(radii) == 1 else math.nan


_LEAST = 0.05
"""[s] Processor time of one measurement: many ticks of any clock."""
_STANDING = {"drive.speed": 0.0, "drive.schedule": None}


def real_time_factor(
    scenario: Scenario,
    *,
    models: Models | None = None,
    duration: float = 5.0,
    repeats: int = 10,
    progress: bool | Progress | None = True,
    **others: object,
) -> FigureDataset:
    """Measure the simulated seconds per second of processor time, on one thread.

    The result depends on the machine, the build and the moment, so there is no store, executor or
    number of threads, and repeats vary only by the machine. The clock counts processor time of this
    process only; models take turns, so a machine that slows down affects all of them.

    Parameters
    ----------
    scenario : Scenario
        The scenario, simulated from its start.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    duration : float
        [s] Simulated time, above 0, up to 1000; the simulation continues after an outcome.
    repeats : int
        Measurements per model, 1 to 1000. Short simulations are repeated until they take 50 ms of
        processor time.
    progress : bool or callable
        See `simulate_many`.
    **others
        Refused: other keywords of studies.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `motion` ("standing" without a command, "driving" as commanded by the
        scenario) and `repeat`:

        - `factor` [-]: the real-time factor, median over the repeats; `factor_low`, `factor_high`:
          minimum and maximum; `factor_each`;
        - `moved` [m]: distance of the robot along x.

        The attributes name the processor, if known, and the build.

    Raises
    ------
    ScenarioError
        If an argument or a scenario breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.03))
    >>> found = c2d.studies.real_time_factor(base, repeats=2, progress=False)
    >>> dict(found["factor"].sizes), bool((found["factor"] > 1).all())
    ({'model': 1, 'motion': 2}, True)
    """
    for name, value in others.items():
        rule = "must not be given: the time of this processor is measured, now, on one thread"
        raise ScenarioError(name, value, rule)
    check_study(scenario)
    span = real_number(duration, "duration")
    if not 0.0 < span <= 1000.0:
        raise ScenarioError("duration", span, "must be > 0 s and at most 1000 s")
    count = whole_number(repeats, "repeats", 1, 1000)
    xr = extra("xarray", "analysis")
    fields = read_models(scenario, models)
    motions: dict[str, dict[str, Any]] = {"standing": _STANDING, "driving": {}}
    jobs = [
        scenario.replace({**own, **also}) for own in fields.values() for also in motions.values()
    ]
    for job in jobs:
        job.validate()
    moved, passes = [], []
    factors = np.empty((len(jobs), count))
    with reporter(progress, len(jobs) * (count + 1)) as report:
        for job in jobs:  # first use costs more
            spent, way = _simulated(job, span)
            moved.append(way)
            passes.append(math.ceil(_LEAST / max(spent, 1e-4)))
            report(1)
        for repeat in range(count):
            for index, job in enumerate(jobs):
                spent = sum(_simulated(job, span)[0] for _ in range(passes[index]))
                factors[index, repeat] = passes[index] * span / spent
                report(1)
    dims, shape = ("model", "motion"), (len(fields), len(motions))
    each = xr.DataArray(
        factors.reshape(*shape, count),
        coords={"model": list(fields), "motion": list(motions), "repeat": np.arange(count)},
        dims=(*dims, "repeat"),
        attrs={"units": "1", "long_name": "real-time factor"},
    )
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    table = FigureDataset(summary("factor", each))
    attributes = {"units": "m", "long_name": "way along x"}
    return table.assign(moved=(dims, np.reshape(moved, shape), attributes)).assign_attrs(
        figure="real_time_factor",
        scenario=scenario.to_json(),
        duration=span,
        repeats=count,
        measure="factor",
        clock="processor time of one thread",
        processor=platform.processor() or platform.machine(),
        **build_attributes(),
    )


def _simulated(scenario: Scenario, duration: float) -> tuple[float, float]:
    """Simulate, and return processor time [s] and distance [m] along x."""
    simulation = Simulation(scenario)
    start = float(simulation.state().position[0])
    begin = time.thread_time()
    simulation.advance(duration)
    spent = time.thread_time() - begin
    return spent, float(simulation.state().position[0]) - start
