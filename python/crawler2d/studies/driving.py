"""How fast a model drives, how fast it gets there, how soon it stops, and what limits that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

import numpy as np

from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import Sampling
from crawler2d.studies.limited import Asked, Figure, limited
from crawler2d.studies.limits import Change
from crawler2d.studies.models import Models
from crawler2d.studies.steady import Halt, RunUp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.found import Found

__all__ = ["acceleration", "braking_distance", "max_speed"]

_STANDS = 1e-3
"""[m/s] A robot that is slower stands."""


@takes_keywords
def max_speed(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **how: Unpack[Sampling],
) -> Found:
    """Measure the steady speed of each model at full command, and find what limits it.

    Each model stands on the scenario's level ground, or on the slope of its ramp, without end, and
    drives off. Its speed is the mean over two windows, each of 20 grouser pitches or more, after a
    run-up that is made longer until the two windows agree within 3 %, up to eight times as long.
    What limits it is found by doing: the same runs with the commanded speed, the torque or the
    friction doubled, each alone.

    Parameters
    ----------
    scenario : Scenario
        On level ground or a ramp; command, goal and duration are set by the study.
    models : mapping of str to track or fields, optional
        As for `compare`; None takes the scenario's own robot.
    speed : float, optional
        [m/s] What is commanded, above 0; None takes each robot's `max_speed`, which it must not
        exceed.
    repeats : int
        Runs of every cell, 1 to 1,000,000.
    **how
        See `crawler2d.studies`. Without `vary`, repeats draw start and friction, not the commanded
        speed.

    Returns
    -------
    Found
        Dimensions `model`, `change` (what was doubled), `part` (one run for each instant), `sample`
        if there are unknowns, and `repeat`:

        - `speed` [m/s]: median over the repeats; `speed_low`, `speed_high`: the lowest and the
          highest of them; with unknowns, `speed_band_low`, `..._median` and `..._high`: 5, 50 and
          95 % of the medians. All are nan where a repeat has no steady speed, as on a slope down
          which it slides ever faster.
        - `limit`: "command", "torque", "friction", several joined by "and", or "none of these":
          what improves the median by more than 2 % and by more than the repeats lie apart;
        - `speed_with` [m/s]: the median with each change, and its bounds: the evidence;
        - `ended`: how most of the longest runs of each change ended, or "not settled";
        - `speed_each`, `speed_with_each`, and the columns of `sweep`.

    Raises
    ------
    ScenarioError
        If the ground is another, or an argument breaks a rule.

    Examples
    --------
    On level ground, a belt with torque to spare is as fast as it is told to be:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> found = c2d.studies.max_speed(base, repeats=2, progress=False)
    >>> found["speed"].values.round(3).tolist(), found["limit"].values.tolist()
    ([1.39], ['command'])
    """
    return limited(_MAX_SPEED, scenario, Asked(models, speed, repeats), how)


@takes_keywords
def acceleration(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **how: Unpack[Sampling],
) -> Found:
    """Measure the mean acceleration of each model from rest to its speed, and find what limits it.

    While it accelerates, a robot falls behind one that has its steady speed v from the start. If
    that distance is s, the mean acceleration is v^2 / (2 s): the constant one that loses as much.
    The drivetrain's `max_acceleration` is an input of a robot; where the limit is "command", the
    study has measured no more than that.

    Parameters
    ----------
    scenario, models, speed, repeats, **how
        See `max_speed`; here `command` is `robot.drivetrain.max_acceleration`.

    Returns
    -------
    Found
        As of `max_speed`, with `acceleration` [m/s^2] in the place of `speed`, and besides, `speed`
        [m/s]: the steady speed that was reached.

    Examples
    --------
    The Engineer's acceleration is what its drivetrain is told, until that exceeds what its motors
    have beside what their own rotors take:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> models = {"as built": {}, "at once": {"robot.drivetrain.max_acceleration": 1e4}}
    >>> found = c2d.studies.acceleration(base, models=models, repeats=2, progress=False)
    >>> found["acceleration"].sel(model="as built").round(3).item()
    0.2
    >>> found["limit"].values.tolist()
    ['command', 'torque']
    """
    return limited(_ACCELERATION, scenario, Asked(models, speed, repeats), how)


@takes_keywords
def braking_distance(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **how: Unpack[Sampling],
) -> Found:
    """Measure how far each model moves from the command to stop until it rests, and what limits it.

    It brakes from its steady speed. The drivetrain's `max_deceleration` is an input of a robot;
    where the limit is "command", the study has measured no more than that.

    Parameters
    ----------
    scenario, models, speed, repeats, **how
        See `max_speed`; here `command` is `robot.drivetrain.max_deceleration`.

    Returns
    -------
    Found
        As of `max_speed`, with `braking_distance` [m] in the place of `speed`, where less is
        better, and besides, `speed` [m/s]: the steady speed from which it brakes.
        `braking_distance` is nan where a repeat does not come to rest, as on a slope down which it
        slides.

    Notes
    -----
    The 0.3 to 1 m from 0.4 m/s that the paper gives for its models (Table 3) are decelerations of
    0.27 to 0.08 m/s^2: not what friction allows, which with a coefficient of 0.9 is 9 mm.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> found = c2d.studies.braking_distance(base, speed=0.4, repeats=2, progress=False)
    >>> found["braking_distance"].values.round(3).tolist(), 0.4**2 / (2 * 4.0)
    ([0.02], 0.02)
    >>> found["limit"].item()
    'command'
    """
    return limited(_BRAKING, scenario, Asked(models, speed, repeats), how)


def _speed(run_up: RunUp, _halt: Halt | None) -> NDArray[np.float64]:
    return run_up.speed


def _mean_acceleration(run_up: RunUp, _halt: Halt | None) -> NDArray[np.float64]:
    behind = run_up.speed * run_up.time - run_up.ways[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(behind > 0.0, run_up.speed**2 / (2.0 * behind), np.nan)
    return np.where(np.abs(run_up.speed) < _STANDS, 0.0, mean)


def _distance(run_up: RunUp, halt: Halt | None) -> NDArray[np.float64]:
    return np.full_like(run_up.speed, np.nan) if halt is None else halt.distance


_MAX_SPEED = Figure(
    "max_speed",
    "speed",
    "m/s",
    "steady speed",
    Change(
        "command",
        ("robot.drivetrain.max_speed", "drive.speed"),
        "drive.speed within robot.drivetrain.max_speed, inputs",
    ),
    1e-3,
    _speed,
)
_ACCELERATION = Figure(
    "acceleration",
    "acceleration",
    "m/s^2",
    "mean acceleration from rest",
    Change(
        "command",
        ("robot.drivetrain.max_acceleration",),
        "robot.drivetrain.max_acceleration, an input",
    ),
    1e-3,
    _mean_acceleration,
)
_BRAKING = Figure(
    "braking_distance",
    "braking_distance",
    "m",
    "braking distance",
    Change(
        "command",
        ("robot.drivetrain.max_deceleration",),
        "robot.drivetrain.max_deceleration, an input",
    ),
    1e-4,
    _distance,
    halts=True,
)
