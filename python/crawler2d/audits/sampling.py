"""Runs until a verdict is certain, and again under other assumptions on motors and impacts."""

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
"""Samples between two looks: as many at each of the three speeds."""

_SAMPLES = 18
"""As many at each of the three speeds: of a seizure that holds in a sixth of them, the lower bound
is above the 5 % from which it is one."""

_ROTOR = "rotor_inertia"


def look_counts(samples: int) -> Iterator[int]:
    """Count the samples that are made at each look.

    Examples
    --------
    >>> list(look_counts(40))
    [9, 18, 27, 36, 40]
    """
    yield from range(_LOOK, samples, _LOOK)
    yield samples


def verdict_on(course: Course, obstacle: str, count: RunCounter) -> tuple[Verdict, xarray.Dataset]:
    """Drive over an obstacle until the verdict on it is certain, or all samples are made.

    The belt drives the same samples, as soon as the robot seizes or clears less than 95 % of them.

    Parameters
    ----------
    course : Course
        Of the models "model" and "belt".
    obstacle : str
        Its label.
    count : RunCounter
        Of the runs.

    Returns
    -------
    Verdict, xarray.Dataset
        And the runs behind it.
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
    """Order obstacles: first those with sharp edges, and of these the ones that reach deepest.

    An edge seizes in a pocket that it fills. What is rounded, blunt or open below seldom does;
    beyond the depth of the deepest pocket, more height makes no difference. Equals keep their
    order.

    Parameters
    ----------
    grounds : mapping of str to terrain
        The obstacles.
    pockets : sequence of Pocket
        Of the robot; with slots every height may get in.

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
    """How often a robot that seizes on an obstacle does so under another assumption.

    Parameters
    ----------
    obstacle : str
        Its label.
    assumption : {"rotor", "restitution"}
        What is drawn besides the unknowns: rotors of motors, or restitution.
    drawn : Ranges
        From which ranges.
    seized, made : int
        How many runs seized, of how many with a result: the first of those behind the verdict.
    """

    obstacle: str
    assumption: str
    drawn: Ranges
    seized: int
    made: int

    @property
    def holds(self) -> bool:
        """Whether the lower bound of the rate of seizing is above 5 %, as the verdict says."""
        return wilson(self.seized, self.made).low > SEIZES


def assumptions_of(robot: Robot, unknown: Mapping[str, object]) -> dict[str, Ranges]:
    """Return what verdicts may depend on, and is not drawn in all runs anyway.

    Rotors are those of a real drive, of which a file for a simulator says nothing; with them
    motors hold their speed. Chains have no restitution.

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
    """Drive over an obstacle on which the robot seizes, under one assumption after another.

    Parameters
    ----------
    assumed : mapping of str to Ranges
        As from `assumptions_of`.
    runs : Runs
        Those of the verdict; what they draw is drawn here, too.
    robot : Robot
        The robot.
    at : tuple of str, Terrain
        The label of the obstacle, and the obstacle.
    count : RunCounter
        Of the runs.
    """
    obstacle, ground = at
    found = []
    for name, ranges in assumed.items():
        unknown = Ranges(runs.unknown) | ranges
        others = replace(runs, unknown=unknown, repeats=1, trials=())
        driven = robot
        if name == "rotor":
            # Real drives hold their speed: a servo's gain is a simulator's setting.
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
                made=int(results.has_result.sum()),
            )
        )
    return tuple(found)
