"""What becomes of a seizure where motors or blows are assumed otherwise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from crawler2d.audits.live import Counted
from crawler2d.audits.runs import Runs, column
from crawler2d.audits.verdicts import OWN, RESULTS, SEIZES
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.terrain import Terrain
from crawler2d.presets.unknowns import of_blows, of_robot
from crawler2d.results.outcome import Outcome
from crawler2d.sweeps.statistics import wilson
from crawler2d.variation.ranges import Ranges

__all__ = ["Assumed", "assumptions", "seizure_under"]

_SAMPLES = 18
"""As many at each of the three speeds: of a seizure that holds in a sixth of them, the lower bound
is above the 5 % from which it is one."""

_ROTOR = "rotor_inertia"


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumed:
    """How often a robot that seizes on an obstacle does so under another assumption.

    Parameters
    ----------
    obstacle : str
        Its label.
    assumption : {"rotor", "restitution"}
        What is drawn besides what is not known anyway: rotors of motors, or what blows give back.
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


def assumptions(robot: Robot, unknown: Mapping[str, object]) -> dict[str, Ranges]:
    """Return what verdicts may hang on, and is not drawn in all runs anyway.

    Rotors are those of a real drive, of which a file for a simulator says nothing; with them
    motors hold their speed. Chains are left out of blows: they give nothing back.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    >>> list(assumptions(robot, {})), list(assumptions(robot, c2d.unknowns.of_robot(robot)))
    (['rotor', 'restitution'], ['restitution'])
    """
    own = of_robot(robot)
    rotors = [path for path in own if path.endswith(_ROTOR) and path not in unknown]
    found = {
        "rotor": Ranges(
            {path: own[path] for path in rotors}, {path: own.sources[path] for path in rotors}
        ),
        "restitution": of_blows(robot),
    }
    return {name: ranges for name, ranges in found.items() if ranges}


def _held(robot: Robot) -> Robot:
    """Have motors hold their speed, as real drives do: a servo's gain is a simulator's setting."""
    return replace(robot, drivetrain=replace(robot.drivetrain, controller=None))


def seizure_under(
    assumed: Mapping[str, Ranges],
    runs: Runs,
    robot: Robot,
    at: tuple[str, Terrain],
    count: Counted,
) -> tuple[Assumed, ...]:
    """Drive over an obstacle on which the robot seizes, under one assumption after another.

    Parameters
    ----------
    assumed : mapping of str to Ranges
        As from `assumptions`.
    runs : Runs
        Those of the verdict; what they draw is drawn here, too.
    robot : Robot
        The robot.
    at : tuple of str, Terrain
        The label of the obstacle, and the obstacle.
    count : Counted
        Of the runs.
    """
    obstacle, ground = at
    found = []
    for name, ranges in assumed.items():
        unknown = Ranges(runs.unknown) | ranges
        others = replace(runs, unknown=unknown, repeats=1, trials=())
        driven = _held(robot) if name == "rotor" else robot
        course = others.course({OWN: driven}, obstacle, ground)
        course.drive(OWN, min(_SAMPLES, course.samples), count.part())
        ends = column(course.table(), "outcome", model=OWN, terrain=obstacle)
        made = int(np.isin(ends, RESULTS).sum())
        seized = int((ends == Outcome.SEIZED).sum())
        found.append(
            Assumed(obstacle=obstacle, assumption=name, drawn=ranges, seized=seized, made=made)
        )
    return tuple(found)
