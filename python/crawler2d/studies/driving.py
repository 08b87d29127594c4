"""Speed, acceleration and braking distance of models, and their limiting factors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import Sampling, campaign
from crawler2d.studies.steady import Halt, RunUp, drive, on_plane
from crawler2d.studies.tables import (
    Dims,
    Measure,
    Models,
    check_study,
    measure_table,
    paths_of,
    read_models,
)
from crawler2d.variation.distributions import Ranges
from crawler2d.variation.draws import fields_at
from crawler2d.variation.variability import of_contact, of_start

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = [
    "FRICTION",
    "TORQUE",
    "UNCHANGED",
    "Change",
    "Figure",
    "acceleration",
    "braking_distance",
    "limiting_changes",
    "max_speed",
]

_FACTOR = 2.0


@dataclass(frozen=True, slots=True)
class Change:
    """A change: some inputs are doubled.

    Attributes
    ----------
    name : str
        Name of the limit, such as "torque".
    paths : tuple of str
        Paths of the doubled numbers.
    meaning : str
        Description, for tables.
    """

    name: str
    paths: tuple[str, ...] = ()
    meaning: str = ""

    @property
    def label(self) -> str:
        """Label such as "torque x 2"."""
        return f"{self.name} x {_FACTOR:g}" if self.paths else self.name

    def factors(self, scenario: Scenario) -> Mapping[str, float]:
        """[-] Factors by path, for `Cell`."""
        return dict.fromkeys([*self.paths, *self._fields(scenario)], _FACTOR)

    def of(self, scenario: Scenario) -> Scenario:
        """Double these numbers of a scenario."""
        fields = self._fields(scenario)
        return scenario.replace({each: _FACTOR * read_path(scenario, each) for each in fields})

    def _fields(self, scenario: Scenario) -> list[str]:
        return [field for path in self.paths for field in fields_at(scenario, path)]


UNCHANGED = Change("unchanged")
TORQUE = Change("torque", ("robot.drivetrain.max_torque",), "robot.drivetrain.max_torque, an input")
FRICTION = Change("friction", ("terrain.friction",), "terrain.friction, an input")


def limiting_changes(
    values: NDArray[np.float64],
    changes: tuple[Change, ...],
    *,
    fraction: float,
    least: float,
    falls: bool = False,
) -> NDArray[np.str_]:
    """Name what limits a figure: doubling it improves the figure by more than chance.

    Parameters
    ----------
    values : ndarray, shape (m, n, s, r)
        Values for m models, n changes, s samples and r repeats; NaN without a figure.
    changes : tuple of n Change
        The changes; the first one changes nothing.
    fraction : float
        [-] Smallest relevant change of the median, as a fraction of the unchanged one.
    least : float
        The same in units of the figure.
    falls : bool
        Whether lower is better, as for a braking distance.

    Returns
    -------
    ndarray of str, shape (m, s)
        Labels such as "torque", "command and friction", or "none of these". A change counts if the
        median over the repeats improves by more than these amounts, and by more than the range of
        the unchanged repeats; if these have no figure, it counts if the changed ones do.
    """
    medians = np.median(values, axis=-1)
    before = medians[:, :1]
    apart = np.ptp(values[:, :1], axis=-1)
    gain = (before - medians) if falls else (medians - before)
    needed = np.maximum(np.maximum(fraction * np.abs(before), apart), least)
    counts = np.where(np.isnan(before), np.isfinite(medians), gain > needed)
    names = np.array([change.name for change in changes])
    limits = np.empty((values.shape[0], values.shape[2]), object)
    for model, sample in np.ndindex(limits.shape):
        own = names[1:][counts[model, 1:, sample]]
        limits[model, sample] = " and ".join(own) or "none of these"
    return limits.astype(str)


_FRACTION = 0.02
"""[-] Smaller improvements do not count as a limit."""
_OWN = ("drive.speed", "drive.schedule", "duration", "goal")
"""Fields that these studies set."""
_COMMANDED = (*_OWN, "robot.drivetrain.max_speed")
"""Fields that must not be drawn, as the largest speed is commanded."""
_PARTS = ("run-up", "one window", "two windows", "stop", "rest")


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of driving.

    Attributes
    ----------
    study, name, units, long_name : str
        Names of study and column, unit, and description.
    command : Change
        The inputs that command it.
    least : float
        [units] Smaller changes are neglected.
    values : callable
        Takes a finished run-up, and a braking course if it `halts`; returns the figure, shape
        (samples, repeats).
    halts : bool
        Whether the robot stops; then less is better.
    """

    study: str
    name: str
    units: str
    long_name: str
    command: Change
    least: float
    values: Callable[[RunUp, Halt | None], NDArray[np.float64]]
    halts: bool = False


def _limiting_study(
    figure: Figure,
    scenario: Scenario,
    sampling: Sampling,
    *,
    models: Models | None,
    speed: float | None,
    repeats: int,
) -> FigureDataset:
    """Drive every model unchanged and with each change, and arrange the results."""
    check_study(scenario)
    given = None if speed is None else real_number(speed, "speed")
    if given is not None and not given > 0.0:
        raise ScenarioError("speed", given, "must be > 0 m/s")
    fields = read_models(scenario, models)
    for label, own in fields.items():
        _check_fields(own, f"models[{label!r}]")
    changes = (UNCHANGED, figure.command, TORQUE, FRICTION)
    plane, swept = on_plane(scenario, given), paths_of(fields)
    count = whole_number(repeats, "repeats", 1, 10**6)
    with campaign(plane, _without_commands(sampling), swept, repeats=count) as study:
        run_ups = [
            RunUp(
                (f"model={label}", f"change={change.label}"),
                change.of(on_plane(scenario.replace(own), given)),
                change.factors(scenario),
            )
            for label, own in fields.items()
            for change in changes
        ]
        drive(study, run_ups)
        halts = [Halt(each) if figure.halts else None for each in run_ups]
        drive(study, [halt for halt in halts if halt is not None])
        driven = list(zip(run_ups, halts, strict=True))
        shape = (len(fields), len(changes), -1, study.until.max_runs)
        values = np.array([figure.values(*both) for both in driven]).reshape(shape)
        speeds = np.array([run_up.speed for run_up in run_ups]).reshape(shape)
        measures = {
            figure.name: Measure(("model",), values[:, 0], figure.units, figure.long_name),
            f"{figure.name}_with": Measure(
                ("model", "change"), values, figure.units, f"{figure.long_name} with each change"
            ),
        }
        if figure.name != "speed":
            measures["speed"] = Measure(("model",), speeds[:, 0], "m/s", "steady speed")
        dims: Dims = {
            "model": (list(fields), {}),
            "change": ([each.label for each in changes], {"long_name": "what is doubled"}),
            "part": (_PARTS[: 3 + 2 * figure.halts], {"long_name": "how far a run goes"}),
        }
        tallies = [part for both in driven for course in both if course for part in course.tallies]
        table = measure_table(study, figure.study, tallies, dims, measures)
    limit = limiting_changes(
        values, changes, fraction=_FRACTION, least=figure.least, falls=figure.halts
    )
    ended = np.array([(halt or run_up).ended for run_up, halt in driven])
    one, every = table[figure.name], table[f"{figure.name}_with"]
    meanings = {change.name: change.meaning for change in changes[1:]}
    text = "what limits it, found by doubling each"
    return table.assign(
        limit=(
            one.dims,
            limit.reshape(one.shape),
            {"long_name": text, "share": _FRACTION, **meanings},
        ),
        ended=(
            every.dims,
            ended.reshape(every.shape),
            {"long_name": "how most of the longest runs ended"},
        ),
    )


def _check_fields(given: object, place: str) -> None:
    """Refuse fields that the study sets."""
    for path in given if isinstance(given, Mapping) else ():
        if path in _OWN:
            rule = f"must not have {path}, which the study sets; give a speed by speed="
            raise ScenarioError(place, path, rule)


def _without_commands(sampling: Sampling) -> Sampling:
    """Drop commands of the study from the default draws, or refuse given draws of them."""
    vary = sampling.get("vary")
    if vary is None:
        vary = of_start() | of_contact()
    if isinstance(vary, Ranges):
        vary = vary.without(vary.optional.intersection(_COMMANDED))
    for name, given in (("vary", vary), ("unknown", sampling.get("unknown"))):
        for path, drawn in given.items() if isinstance(given, Mapping) else ():
            if path in _COMMANDED:
                rule = "must not draw what the study commands: give models for other speeds"
                raise ScenarioError(f"{name}[{path!r}]", drawn, rule)
    return {**sampling, "vary": vary}


_STANDS = 1e-3
"""[m/s] Slower robots count as standing."""


@takes_keywords
def max_speed(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Measure the steady speed of each model at full command, and what limits it.

    Each model starts from rest on the scenario's level ground, or the slope of its ramp, extended
    to an endless plane. Its speed is the mean over two windows of at least 20 grouser pitches each,
    after a run-up that is doubled, up to three times, until the two windows agree within 3 %. To
    find the limit, the runs are repeated with the commanded speed, the torque or the friction
    doubled, one at a time.

    Parameters
    ----------
    scenario : Scenario
        Level ground or a ramp; the study sets command, goal and duration.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    speed : float, optional
        [m/s] Commanded speed, above 0, at most the robot's `max_speed`, which None takes.
    repeats : int
        Runs of every cell, 1 to 1,000,000.
    **sampling
        See `crawler2d.studies`. Without `vary`, repeats draw start and friction, not the commanded
        speed.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `change` (what was doubled), `part` (one run per instant), `sample` if
        there are unknowns, and `repeat`:

        - `speed` [m/s]: median over the repeats; `speed_low`, `speed_high`: their minimum and
          maximum; with unknowns, `speed_band_low`, `..._median` and `..._high`: 5, 50 and 95 %
          quantiles of the medians. All are NaN if a repeat has no steady speed, such as sliding
          ever faster down a slope.
        - `limit`: "command", "torque", "friction", several joined by "and", or "none of these":
          what improves the median by more than 2 % and by more than the range of the repeats;
        - `speed_with` [m/s]: the median with each change, and its bounds, as evidence;
        - `ended`: commonest outcome of the longest runs of each change, or "not settled";
        - `speed_each`, `speed_with_each`, and the columns of `sweep`.

    Raises
    ------
    ScenarioError
        If the ground is neither level nor a ramp, or an argument breaks a rule.

    Examples
    --------
    On level ground, a belt with enough torque reaches the commanded speed:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> found = c2d.studies.max_speed(base, repeats=2, progress=False)
    >>> found["speed"].values.round(3).tolist(), found["limit"].values.tolist()
    ([1.39], ['command'])
    """
    return _limiting_study(
        _MAX_SPEED, scenario, sampling, models=models, speed=speed, repeats=repeats
    )


@takes_keywords
def acceleration(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Measure the mean acceleration of each model from rest to its speed, and what limits it.

    While accelerating, a robot falls behind one that has the steady speed v from the start. If that
    distance is s, the mean acceleration is v^2 / (2 s): the constant one that loses as much. The
    drivetrain's `max_acceleration` is an input; if the limit is "command", the study has only
    measured that.

    Parameters
    ----------
    scenario, models, speed, repeats, **sampling
        See `max_speed`; here `command` is `robot.drivetrain.max_acceleration`.

    Returns
    -------
    FigureDataset
        Like `max_speed`, with `acceleration` [m/s^2] instead of `speed`, and `speed` [m/s], the
        steady speed reached.

    Examples
    --------
    The Engineer's acceleration is that of its drivetrain, up to the torque of its motors minus the
    part that accelerates their rotors:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> models = {"as built": {}, "at once": {"robot.drivetrain.max_acceleration": 1e4}}
    >>> found = c2d.studies.acceleration(base, models=models, repeats=2, progress=False)
    >>> found["acceleration"].sel(model="as built").round(3).item()
    0.2
    >>> found["limit"].values.tolist()
    ['command', 'torque']
    """
    return _limiting_study(
        _ACCELERATION, scenario, sampling, models=models, speed=speed, repeats=repeats
    )


@takes_keywords
def braking_distance(
    scenario: Scenario,
    *,
    models: Models | None = None,
    speed: float | None = None,
    repeats: int = 10,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Measure the distance of each model from the command to stop until rest, and what limits it.

    It brakes from its steady speed. The drivetrain's `max_deceleration` is an input; if the limit
    is "command", the study has only measured that.

    Parameters
    ----------
    scenario, models, speed, repeats, **sampling
        See `max_speed`; here `command` is `robot.drivetrain.max_deceleration`.

    Returns
    -------
    FigureDataset
        Like `max_speed`, with `braking_distance` [m] instead of `speed`, for which less is better,
        and `speed` [m/s], the steady speed from which it brakes. `braking_distance` is NaN if a
        repeat never stops, such as sliding down a slope.

    Notes
    -----
    The 0.3 to 1 m from 0.4 m/s that the paper gives for its models (Table 3) are decelerations of
    0.27 to 0.08 m/s^2. Friction with a coefficient of 0.9 would allow 9 mm.

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
    return _limiting_study(
        _BRAKING, scenario, sampling, models=models, speed=speed, repeats=repeats
    )


def _speed(run_up: RunUp, _halt: Halt | None) -> NDArray[np.float64]:
    return run_up.speed


def _mean_acceleration(run_up: RunUp, _halt: Halt | None) -> NDArray[np.float64]:
    behind = run_up.speed * run_up.time - run_up.path_lengths[0]
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
