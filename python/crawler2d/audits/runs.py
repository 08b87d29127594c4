"""The runs of an audit, of the model and the same robot on belts, and their progress."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive, Start
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import (
    BeltTrack,
    ClosedTrack,
    GrouserBeltTrack,
    HybridWheels,
    LineOfWheels,
)
from crawler2d.runs.progress import Progress
from crawler2d.sweeps.axes import Axis, Label
from crawler2d.sweeps.tabulate import Tabulation
from crawler2d.variation.distributions import Levels

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = [
    "TRIED",
    "Belt",
    "Course",
    "LivePrinter",
    "RunCounter",
    "Runs",
    "belt_of",
    "raise_flippers",
    "read_progress",
    "scenario_of",
]

TRIED = ("torque x 2", "friction x 2")
"""Trials at every stop, in addition to the closed track of jammed robots."""

_GRAVITY = 9.81

_FROUDE = 0.2

_LENGTHS = 15.0

_FRESH = 2**63  # added to a seed


class LivePrinter:
    """Prints the parts of an audit as they become ready; on a terminal also counts runs.

    Parameters
    ----------
    out : text stream or None
        Output for the parts; None if it was closed before Python started. Runs are counted on the
        standard error, if that is a terminal.
    spell : callable
        Converts the text of parts.
    """

    def __init__(self, out: TextIO | None, spell: Callable[[str], str] = str) -> None:
        self._out, self._spell = out, spell
        self._begin = time.monotonic()

    def print(self, text: str) -> None:
        """Print a part."""
        if self._out is None:  # print would use the standard output
            return
        self._write("\r\x1b[K")
        try:
            print(self._spell(text), file=self._out, flush=True)
        except OSError:
            if self._out is not sys.stderr:  # it only shows progress: do not lose the runs
                raise

    def __call__(self, done: int, total: int) -> None:
        """Count runs."""
        passed = time.monotonic() - self._begin
        self._write(f"\r\x1b[K{done} of at most {total} runs, {passed:.0f} s\r")

    def _write(self, text: str) -> None:
        if sys.stderr is not None and sys.stderr.isatty():
            sys.stderr.write(text)
            sys.stderr.flush()


class RunCounter:
    """Counts the runs of an audit over all batches.

    Parameters
    ----------
    show : Progress, optional
        Called with the numbers of finished runs and of all that may be needed.
    total : int
        Number of all runs that may be needed.
    """

    def __init__(self, show: Progress | None, total: int) -> None:
        self._show, self._total, self._done = show, total, 0

    def next_batch(self) -> Progress | None:
        """Return the counter of the next batch."""
        before = self._done

        def show(done: int, _: int) -> None:
            self._done = before + done
            self._total = max(self._total, self._done)
            if self._show is not None:
                self._show(self._done, self._total)

        return show


def read_progress(progress: object) -> tuple[Callable[[str], None], Progress | None]:
    """Read the argument `progress` of `audit`: return printer of parts and counter of runs.

    Raises
    ------
    ScenarioError
        If it is not True, False, None or a callable.
    """
    if progress is True:
        progress = LivePrinter(sys.stderr)
    if isinstance(progress, LivePrinter):
        return progress.print, progress
    if progress is None or progress is False:
        return lambda _: None, None
    if not callable(progress):
        raise ScenarioError("progress", progress, "must be True, False or a callable")
    return lambda _: None, progress


class Belt(NamedTuple):
    """A robot on belts.

    Parameters
    ----------
    robot : Robot
        The robot on belts.
    reason : str
        The kind of belt, and why.
    """

    robot: Robot
    reason: str


def belt_of(robot: Robot) -> Belt:
    """Replace a robot's tracks by belts.

    The belts follow the outlines of chassis and flippers, `BeltTrack`, if these fit the model. If
    wheels are placed one by one, or do not model a track, the outline does not show where a belt
    would run; then it is taut round the model's own wheels, `ClosedTrack`.

    Parameters
    ----------
    robot : Robot
        Any robot.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> belt = belt_of(c2d.robots.engineer(track=c2d.LineOfWheels(4), flippers=None))
    >>> belt.robot.track, belt.reason
    (BeltTrack(), 'BeltTrack, along the outline')
    >>> belt_of(c2d.robots.marv(track="public")).reason
    'ClosedTrack, round the wheels that there are: no track runs between those of the chassis'
    """
    arms = robot.flippers
    tracks = [robot.track] if arms is None else [robot.track, arms.track or robot.track]
    if all(isinstance(each, BeltTrack | GrouserBeltTrack | ClosedTrack) for each in tracks):
        return Belt(robot, "the robot itself, which is on belts")
    if isinstance(robot.track, LineOfWheels) and not robot.track.as_track:
        why = "no track runs between those of the chassis"
    elif any(isinstance(each, HybridWheels) for each in tracks):
        why = "some are placed one by one, which no outline follows"
    else:
        belted = robot.with_track(BeltTrack())
        if arms is not None:
            belted = replace(belted, flippers=replace(arms, track=BeltTrack()))
            return Belt(belted, "BeltTrack, along the outlines of chassis and flippers")
        return Belt(belted, "BeltTrack, along the outline")
    closed = robot.track
    if isinstance(closed, ClosedTrack):
        return Belt(robot, "the robot itself, whose track is closed")
    return Belt(
        robot.with_track(ClosedTrack(closed)),
        f"ClosedTrack, round the wheels that there are: {why}",
    )


def scenario_of(
    robot: Robot, ground: Terrain, drive: Drive | None, duration: float | None
) -> Scenario:
    """Return the scenario that all runs of an audit share.

    Unless `drive` is given, the robot drives at 0.2 sqrt(g L), with L its axle distance (0.4 m/s
    for 0.41 m), so that large and small robots are dynamically similar, or at its largest speed if
    that is lower; flippers `Climb`. The duration is the time to drive fifteen times its length,
    without flippers, and it starts a fifth of its axle distance before the obstacle.
    """
    outline = robot.outline
    if drive is None:
        speed = _FROUDE * math.sqrt(_GRAVITY * outline.axle_distance)
        gait = None if robot.flippers is None else Climb()
        most = robot.drivetrain.max_speed
        drive = Drive(speed=min(round(min(speed, most), 3) or most, most), gait=gait)
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    if duration is None:
        duration = round(max(_LENGTHS * length / max(abs(drive.speed), 1e-3), 1.0), 1)
    start = Start(approach=0.2 * outline.axle_distance)
    ready = raise_flippers(robot, drive)
    return Scenario(ready, ground, drive=drive, start=start, duration=duration)


def round_speeds(speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m/s] Round speeds to a millimetre per second, or to two digits of the slowest one.

    Examples
    --------
    >>> round_speeds(np.array([0.0392, 0.1307, 0.392])).tolist()
    [0.039, 0.131, 0.392]
    >>> round_speeds(np.array([0.0001, 0.000333, 0.001])).tolist()
    [0.0001, 0.00033, 0.001]
    """
    slowest = np.abs(speeds[speeds != 0.0]).min(initial=1.0)
    return np.round(speeds, max(3, 1 - math.floor(math.log10(slowest))))


def raise_flippers(robot: Robot, drive: Drive) -> Robot:
    """Raise the flippers of a climbing robot, as its driver does before the obstacle."""
    if robot.flippers is None or not isinstance(drive.gait, Climb):
        return robot
    return replace(robot, flippers=replace(robot.flippers, angle=drive.gait.reach_angle))


@dataclass(frozen=True, slots=True, kw_only=True)
class Runs:
    """Settings of the runs of an audit; the fields are arguments of `audit`."""

    scenario: Scenario
    vary: Mapping[str, Any]
    unknown: Mapping[str, Any]
    samples: int
    repeats: int
    seed: int
    store: str | PathLike[str] | None
    executor: Executor | None
    threads: int | None
    trials: Sequence[str] = TRIED

    def course(
        self,
        robots: Mapping[str, Robot],
        name: str,
        ground: Terrain,
        *,
        is_confirming: bool = False,
    ) -> Course:
        """Plan the runs of several robots over one obstacle.

        A confirmation has half the samples, one run each, with fresh draws.
        """
        samples, repeats, seed = self.samples, self.repeats, self.seed
        if is_confirming:
            samples, seed = -(-samples // 2), (seed + _FRESH) % 2**64
            repeats = 1 if self.unknown else repeats
        models: dict[Label, Mapping[str, Any]] = {
            label: {"robot": raise_flippers(robot, self.scenario.drive)}
            for label, robot in robots.items()
        }
        for model in models.values():
            # A broken rule is an error here; a run invalid only by its draws is recorded.
            self.scenario.replace({**model, "terrain": ground}).validate()
        planned = Tabulation(
            self.scenario,
            [
                Axis("model", ("robot",), models),
                Axis("terrain", ("terrain",), {name: {"terrain": ground}}),
            ],
            repeats=repeats,
            seed=seed,
            vary=self.vary,
            unknown=self.unknown,
            samples=samples,
            trials=self.trials,
            store=self.store,
            executor=self.executor,
            wall_time=True,
            threads=self.threads,
        )
        levels = self.vary.get("drive.speed")
        factors = np.array(levels.factors if isinstance(levels, Levels) else (1.0,))
        speeds = round_speeds(self.scenario.drive.speed * factors)
        return Course(planned, list(robots), samples if self.unknown else repeats, speeds)


class Course:
    """The runs of several robots over one obstacle, made step by step.

    Parameters
    ----------
    planned : Tabulation
        All runs.
    robots : sequence of str
        Names of the robots.
    samples : int
        Largest number for each robot.
    speeds : ndarray
        [m/s] Levels that runs take in turn, without scatter.
    """

    def __init__(
        self,
        planned: Tabulation,
        robots: Sequence[str],
        samples: int,
        speeds: NDArray[np.float64],
    ) -> None:
        self.samples = samples
        self._planned, self._speeds = planned, speeds
        self._made = dict.fromkeys(robots, 0)

    def drive(self, robot: str, samples: int, progress: Progress | None = None) -> None:
        """Make the runs of one robot up to a number of samples."""
        each = len(self._planned.checked) // len(self._made) // self.samples
        begin = list(self._made).index(robot) * self.samples
        places = range((begin + self._made[robot]) * each, (begin + samples) * each)
        self._planned.simulate(places, progress)
        self._made[robot] = samples

    def table(self) -> xarray.Dataset:
        """Return the finished runs by `model`, `terrain`, `sample`, `repeat`.

        Without unknowns the repeats are in `sample`. The coordinate `speed` [m/s] is the level of
        the speed. A missing run has the outcome "".
        """
        table = self._planned.table()
        if "sample" not in table.dims:
            table = table.rename(repeat="sample").expand_dims("repeat", -1)
        # Levels are taken in turn, sample by sample and repeat by repeat: `Variation.numbers`.
        turn = np.add.outer(np.arange(self.samples), np.arange(table.sizes["repeat"]))
        speeds = self._speeds[turn % self._speeds.size]
        return table.assign_coords(speed=(("sample", "repeat"), speeds))
