"""Run until a verdict is certain, and repeat under other assumptions on motors and impacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from crawler2d.audits.candidates import Pocket
from crawler2d.audits.runs import Course, RunCounter, Runs
from crawler2d.audits.verdicts import (
    BELT,
    CLEARS,
    OWN,
    SEIZES,
    ObstacleRuns,
    Verdict,
    is_certain,
    verdict_of,
)
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.terrain import Gap, Ridge, Terrain
from crawler2d.presets.unknowns import of_restitution, of_robot
from crawler2d.sweeps.statistics import wilson
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    import xarray

__all__ = [
    "Assumption",
    "assumptions_of",
    "check_assumptions",
    "look_counts",
    "order_by_risk",
    "verdict_on",
]

_LOOK = 9
"""Samples between two checks: equally many at each of the three speeds."""

_SAMPLES = 18
"""Samples for an assumption, equally many at each of the three speeds: if a sixth of them seize,
the lower bound is above 5 %, the limit of a seizure."""

_ROTOR = "rotor_inertia"


def look_counts(samples: int) -> Iterator[int]:
    """Count the samples at each check.

    Examples
    --------
    >>> list(look_counts(40))
    [9, 18, 27, 36, 40]
    """
    yield from range(_LOOK, samples, _LOOK)
    yield samples


def verdict_on(course: Course, obstacle: str, count: RunCounter) -> tuple[Verdict, xarray.Dataset]:
    """Drive over an obstacle until the verdict on it is certain, or all samples are made.

    The belt drives the same samples as soon as the robot seizes or clears less than 95 % of them.

    Parameters
    ----------
    course : Course
        Course of the models "model" and "belt".
    obstacle : str
        Its label.
    count : RunCounter
        Counter of the runs.

    Returns
    -------
    Verdict, xarray.Dataset
        The verdict and the runs behind it.
    """
    for target in look_counts(course.samples):
        course.drive(OWN, target, count.next_batch())
        table = course.table()
        verdict = verdict_of(table, obstacle)
        if verdict.seized.rate > 0.0 or not verdict.cleared.rate >= CLEARS:
            course.drive(BELT, target, count.next_batch())
            table = course.table()
            verdict = verdict_of(table, obstacle)
        if is_certain(table, verdict):
            break
    return verdict, table


def order_by_risk(grounds: Mapping[str, Terrain], pockets: Sequence[Pocket]) -> list[str]:
    """Order obstacles: sharp edges first, and of these the deepest first.

    An edge seizes in a pocket that it fills. Rounded or blunt edges and gaps rarely seize, and
    height beyond the depth of the deepest pocket makes no difference. Ties keep their order.

    Parameters
    ----------
    grounds : mapping of str to terrain
        The obstacles.
    pockets : sequence of Pocket
        Pockets of the robot; with slots, edges of any height can enter.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    >>> low, high = c2d.terrains.step(0.002), c2d.terrains.step(0.05)
    >>> kerb = c2d.terrains.step(0.05, edge_radius=0.02)
    >>> from crawler2d.audits.candidates import pockets
    >>> order_by_risk({"kerb": kerb, "low": low, "high": high}, pockets(robot))
    ['high', 'low', 'kerb']
    """
    deepest = max((each.depth for each in pockets), default=0.0)

    def rank(name: str) -> tuple[bool, float]:
        ground = grounds[name]
        is_blunt = isinstance(ground, Gap | Ridge) or getattr(ground, "edge_radius", 0.0) > 0.0
        height = float(getattr(ground, "height", getattr(ground, "rise", 0.0)))
        return is_blunt, -min(height, deepest)

    return sorted(grounds, key=rank)


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumption:
    """Rate of a seizure under another assumption.

    Parameters
    ----------
    obstacle : str
        Its label.
    assumption : {"rotor", "restitution"}
        What is drawn in addition to the unknowns: motor rotors, or restitution.
    drawn : Ranges
        Ranges of the draws.
    seized, runs : int
        Number of seized runs, and of runs with a result, among the first runs of the verdict.
    """

    obstacle: str
    assumption: str
    drawn: Ranges
    seized: int
    runs: int

    @property
    def seizes(self) -> bool:
        """Whether the robot still seizes: the lower bound of the rate is above 5 %."""
        return wilson(self.seized, self.runs).low > SEIZES


def assumptions_of(robot: Robot, unknown: Mapping[str, object]) -> dict[str, Ranges]:
    """Return assumptions that verdicts may depend on and that are not drawn anyway.

    Rotors are those of a real drive, which files for simulators do not state; with them motors hold
    their speed. Chains have no restitution.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    >>> list(assumptions_of(robot, {})), list(assumptions_of(robot, c2d.unknowns.of_robot(robot)))
    (['rotor', 'restitution'], ['restitution'])
    """
    own = of_robot(robot)
    others = [path for path in own if not path.endswith(_ROTOR) or path in unknown]
    found = {"rotor": own.without(others), "restitution": of_restitution(robot)}
    return {name: ranges for name, ranges in found.items() if ranges}


def check_assumptions(
    assumed: Mapping[str, Ranges],
    runs: Runs,
    robot: Robot,
    at: tuple[str, Terrain],
    count: RunCounter,
) -> tuple[Assumption, ...]:
    """Drive over an obstacle that seizes, under each assumption in turn.

    Parameters
    ----------
    assumed : mapping of str to Ranges
        Result of `assumptions_of`.
    runs : Runs
        Settings of the verdict's runs, with the same draws.
    robot : Robot
        The robot.
    at : tuple of str, Terrain
        Label and obstacle.
    count : RunCounter
        Counter of the runs.
    """
    obstacle, ground = at
    found = []
    for name, ranges in assumed.items():
        unknown = Ranges(runs.unknown) | ranges
        others = replace(runs, unknown=unknown, repeats=1, trials=())
        driven = robot
        if name == "rotor":
            # Real drives hold their speed; servo gains are settings of simulators.
            driven = replace(robot, drivetrain=replace(robot.drivetrain, controller=None))
        course = others.course({OWN: driven}, obstacle, ground)
        course.drive(OWN, min(_SAMPLES, course.samples), count.next_batch())
        results = ObstacleRuns(course.table(), OWN, obstacle)
        found.append(
            Assumption(
                obstacle=obstacle,
                assumption=name,
                drawn=ranges,
                seized=int(results.seized.sum()),
                runs=int(results.has_result.sum()),
            )
        )
    return tuple(found)
