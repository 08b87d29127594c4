"""Runs on an endless plane, extended until the speed is steady or the robot is at rest."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import field_hints
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat, Ground, Points, Ramp
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import Row
from crawler2d.studies.campaign import Campaign, Cell, Tally

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Course", "Halt", "RunUp", "drive", "on_plane"]

_LENGTH = 1e4
"""[m] Length of the plane to either side."""
_LONG = 1e4
"""[s] Longer than any run, so that none reaches the goal."""
_ROUNDS = 4
"""Largest number of times that a course is driven, each time for twice as long."""
_PITCHES = 20.0
"""[-] Grouser pitches in a window: the speed of gear wheels oscillates with every pitch."""
_STEADY = 0.03
"""[-] Relative difference below which the mean speeds of two windows count as equal: gear wheels
differ by 0.01, a robot that keeps accelerating by 0.18, as a window is a fourth of the time
before."""
_SPEED = 1e-3
"""[m/s] Smaller differences of speed are neglected."""
_REST = 1e-4
"""[m] A robot at rest moves less."""


def on_plane(scenario: Scenario, speed: float | None) -> Scenario:
    """Extend the ground to an endless plane with the robot at rest, and command a speed.

    Parameters
    ----------
    scenario : Scenario
        Level ground or a ramp; on a ramp the robot stands on an endless slope.
    speed : float, optional
        [m/s] Speed, above 0; None takes the drivetrain's `max_speed`.

    Raises
    ------
    ScenarioError
        If the ground is neither level nor a ramp.
    """
    terrain = scenario.terrain
    if not isinstance(terrain, (Flat, Ramp)):
        rule = "must be level ground or a ramp: on other ground no speed is steady"
        raise ScenarioError("terrain", terrain, rule)
    angle = terrain.angle if isinstance(terrain, Ramp) else 0.0
    rise = _LENGTH * math.tan(angle)
    ends = ((-_LENGTH, -rise), (_LENGTH, rise))
    surface = {name: getattr(terrain, name) for name in field_hints(Ground)}
    fields = {
        "terrain": Points(ends, goal=0.0, **surface),
        "start.angle": angle,
        "drive.speed": scenario.robot.drivetrain.max_speed if speed is None else speed,
        "drive.schedule": None,
        "goal": 0.0,
        "criteria.clear_time": _LONG,
    }
    return scenario.replace(fields)


class Course(ABC):
    """Runs of one cell with different durations.

    Attributes
    ----------
    tallies : list of list of Tally
        Tallies by duration and sample.
    """

    def __init__(self, names: tuple[str, ...], factors: Mapping[str, float]) -> None:
        self.tallies: list[list[Tally]] = []
        self._names, self._factors = names, factors

    @property
    @abstractmethod
    def scenario(self) -> Scenario:
        """What is simulated, for any duration."""

    @property
    @abstractmethod
    def times(self) -> list[float]:
        """[s] The durations."""

    @property
    @abstractmethod
    def is_settled(self) -> NDArray[np.bool_]:
        """Whether the runs are long enough, shape (samples, repeats); true for runs that ended."""

    @abstractmethod
    def lengthen(self) -> None:
        """Double the time."""

    @property
    def cells(self) -> list[Cell]:
        """One cell for every duration."""
        return [
            Cell(
                (*self._names, f"duration={time:g}"),
                self.scenario.replace({"duration": time}),
                self._factors,
            )
            for time in self.times
        ]

    @property
    def path_lengths(self) -> NDArray[np.float64]:
        """[m] Distance of the robot along its axis, shape (durations, samples, repeats)."""
        return np.array(
            [[[_path_length(row) for row in tally.rows] for tally in own] for own in self.tallies]
        )

    @property
    def ended(self) -> list[str]:
        """Commonest outcome of the longest runs, by sample; "not settled" if one was too short."""
        settled = np.all(self.is_settled, axis=-1).tolist()
        ends = [Counter(row.outcome for row in tally.rows) for tally in self.tallies[-1]]
        return [
            end.most_common(1)[0][0] if enough else "not settled"
            for end, enough in zip(ends, settled, strict=True)
        ]


class RunUp(Course):
    """From rest to a steady speed, plus two windows."""

    def __init__(
        self, names: tuple[str, ...], scenario: Scenario, factors: Mapping[str, float]
    ) -> None:
        super().__init__(names, factors)
        self._scenario = scenario
        speed, drivetrain = scenario.drive.speed, scenario.robot.drivetrain
        self.time = _round_up(1.25 * speed / drivetrain.max_acceleration + 0.5)
        self._least = _PITCHES * scenario.robot.outline.grouser_pitch / speed

    @property
    def scenario(self) -> Scenario:
        """What is simulated, for any duration."""
        return self._scenario

    @property
    def window(self) -> float:
        """[s] Averaging window of a speed."""
        return _round_up(max(0.25 * self.time, self._least))

    @property
    def times(self) -> list[float]:
        """[s] The durations."""
        return [self.time + k * self.window for k in range(3)]

    @property
    def is_settled(self) -> NDArray[np.bool_]:
        """Whether the speed is steady."""
        first, second = np.diff(self.path_lengths, axis=0) / self.window
        allowed = np.maximum(_STEADY * np.abs(second), _SPEED)
        return np.asarray(np.isnan(first + second) | (np.abs(second - first) <= allowed))

    @property
    def speed(self) -> NDArray[np.float64]:
        """[m/s] Steady speed, shape (samples, repeats); NaN if there is none."""
        lengths = self.path_lengths
        speed = (lengths[2] - lengths[0]) / (2.0 * self.window)
        return np.where(self.is_settled, speed, np.nan)

    def lengthen(self) -> None:
        """Double the time."""
        self.time *= 2.0


class Halt(Course):
    """From a steady speed to rest: the command to stop comes at the end of the run-up."""

    def __init__(self, before: RunUp) -> None:
        super().__init__(before._names, before._factors)
        self.before = before
        drivetrain = before.scenario.robot.drivetrain
        self._time = _round_up(
            1.25 * before.scenario.drive.speed / drivetrain.max_deceleration + 0.5
        )

    @property
    def scenario(self) -> Scenario:
        """What is simulated, for any duration."""
        return self.before.scenario.replace({"drive.schedule": [(self.before.time, 0.0)]})

    @property
    def times(self) -> list[float]:
        """[s] The durations."""
        stop = self.before.time
        return [stop + self._time, stop + _round_up(1.25 * self._time)]

    @property
    def is_settled(self) -> NDArray[np.bool_]:
        """Whether the robot is at rest."""
        lengths = self.path_lengths
        moved = np.abs(lengths[1] - lengths[0])
        return np.asarray(np.isnan(moved) | (moved <= _REST))

    @property
    def distance(self) -> NDArray[np.float64]:
        """[m] Distance from command to rest, shape (samples, repeats); NaN if it never stops."""
        distance = self.path_lengths[1] - self.before.path_lengths[0]
        return np.where(self.is_settled & np.isfinite(self.before.speed), distance, np.nan)

    def lengthen(self) -> None:
        """Double the time."""
        self._time *= 2.0


def drive(study: Campaign, courses: Sequence[Course]) -> None:
    """Simulate courses; double the time of those that do not settle, up to three times."""
    due = list(courses)
    if not due:
        return
    for more in reversed(range(_ROUNDS)):
        tallies = iter(study.repeat([cell for course in due for cell in course.cells]))
        for course in due:
            course.tallies = [next(tallies) for _ in course.times]
        due = [course for course in due if not course.is_settled.all()]
        if not due or not more:
            return
        for course in due:
            course.lengthen()


def _round_up(time: float) -> float:
    """[s] Round up to 10 ms, the sampling interval of the core."""
    return math.ceil(100.0 * time) / 100.0


def _path_length(row: Row) -> float:
    """[m] Path length of a run that stopped or lasted to its end, else NaN."""
    if row.error is not None:
        return math.nan
    outcome = Outcome(row.outcome)
    is_whole = outcome == Outcome.TIMED_OUT or outcome.is_stop
    return row.metrics["path_length"] if is_whole else math.nan
