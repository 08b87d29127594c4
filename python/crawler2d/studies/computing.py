"""How fast a model is simulated: simulated time by the time of one processor."""

from __future__ import annotations

import math
import platform
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.labelled import build_attributes
from crawler2d.runs.progress import Progress, reporter
from crawler2d.runs.simulation import Simulation
from crawler2d.studies.models import Models, read_models
from crawler2d.studies.tables import summary

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found

__all__ = ["real_time_factor"]

_LEAST = 0.05
"""[s] Processor time that is measured at once: many ticks of any clock."""
_STANDING = {"drive.speed": 0.0, "drive.schedule": None}


def real_time_factor(
    scenario: Scenario,
    *,
    models: Models | None = None,
    duration: float = 5.0,
    repeats: int = 10,
    progress: bool | Progress | None = True,
    **others: object,
) -> Found:
    """Measure how many seconds are simulated in a second of processor time, on one thread.

    It is a figure of this machine, this build and this hour: so there is no store, no executor and
    no number of threads, and nothing varies from repeat to repeat but the machine. The clock is
    that of the processor, which does not run while others have it; models take turns, so that a
    machine that slows down slows all of them.

    Parameters
    ----------
    scenario : Scenario
        What is simulated, from its start.
    models : mapping of str to track or fields, optional
        As for `compare`; None takes the scenario's own robot.
    duration : float
        [s] Simulated time, above 0, up to 1000; whatever the outcome, the simulation goes on.
    repeats : int
        Measurements of every model, 1 to 1000. A quick one simulates the same several times, for
        50 ms of processor time.
    progress : bool or callable
        See `simulate_many`.
    **others
        The other keywords of studies are refused.

    Returns
    -------
    Found
        Dimensions `model`, `motion` ("standing" without a command, "driving" as the scenario
        commands) and `repeat`:

        - `factor` [-]: the real-time factor, median over the repeats; `factor_low`, `factor_high`:
          the lowest and the highest of them; `factor_each`;
        - `moved` [m]: how far the robot came, along x.

        The attributes name the processor, as far as it tells, and the build.

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
        rule = (
            "must not be given: the time of this processor is measured, here and now, on one thread"
        )
        raise ScenarioError(name, value, rule)
    if not isinstance(scenario, Scenario):
        raise ScenarioError("scenario", scenario, "must be a Scenario")
    span = real_number(duration, "duration")
    if not 0.0 < span <= 1000.0:
        raise ScenarioError("duration", span, "must be above 0 and at most 1000 s")
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
        for job in jobs:  # what is used for the first time costs more
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
    from crawler2d.sweeps.found import Found  # noqa: PLC0415 - needs xarray

    found = Found(summary("factor", each))
    told = {"units": "m", "long_name": "way along x"}
    return found.assign(moved=(dims, np.reshape(moved, shape), told)).assign_attrs(
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
    """Simulate, and return the processor time [s] that it took and the way [m] along x."""
    simulation = Simulation(scenario)
    start = float(simulation.state().position[0])
    begin = time.thread_time()
    simulation.advance(duration)
    spent = time.thread_time() - begin
    return spent, float(simulation.state().position[0]) - start
