"""Looks at the runs over an obstacle: more are made until its verdict is certain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from crawler2d.audits.live import Counted
from crawler2d.audits.pockets import Pocket
from crawler2d.audits.runs import Course
from crawler2d.audits.verdicts import BELT, CLEARS, OWN, Verdict, is_certain, verdicts_of
from crawler2d.parameters.terrain import Gap, Ridge, Terrain

if TYPE_CHECKING:
    import xarray

__all__ = ["likely_first", "looks", "verdict_on"]

_LOOK = 9
"""Samples between two looks: as many at each of the three speeds."""


def looks(samples: int) -> Iterator[int]:
    """Count the samples that are made at each look.

    Examples
    --------
    >>> list(looks(40))
    [9, 18, 27, 36, 40]
    """
    yield from range(_LOOK, samples, _LOOK)
    yield samples


def verdict_on(course: Course, obstacle: str, count: Counted) -> tuple[Verdict, xarray.Dataset]:
    """Drive over an obstacle until the verdict on it is certain, or all samples are made.

    The belt drives the same samples, as soon as the robot seizes or clears less than 95 % of them.

    Parameters
    ----------
    course : Course
        Of the models "model" and "belt".
    obstacle : str
        Its label.
    count : Counted
        Of the runs.

    Returns
    -------
    Verdict, xarray.Dataset
        And the runs behind it.
    """
    for made in looks(course.samples):
        course.drive(OWN, made, count.part())
        table = course.table()
        (verdict,) = verdicts_of(table, [obstacle])
        if verdict.seized.rate > 0.0 or not verdict.cleared.rate >= CLEARS:
            course.drive(BELT, made, count.part())
            table = course.table()
            (verdict,) = verdicts_of(table, [obstacle])
        if is_certain(table, verdict):
            break
    return verdict, table


def likely_first(grounds: Mapping[str, Terrain], pockets: Sequence[Pocket]) -> list[str]:
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
    >>> from crawler2d.audits.pockets import pockets
    >>> likely_first({"kerb": kerb, "low": low, "high": high}, pockets(robot))
    ['high', 'low', 'kerb']
    """
    deepest = max((each.depth for each in pockets), default=0.0)

    def rank(name: str) -> tuple[bool, float]:
        ground = grounds[name]
        is_blunt = isinstance(ground, Gap | Ridge) or getattr(ground, "edge_radius", 0.0) > 0.0
        height = float(getattr(ground, "height", getattr(ground, "rise", 0.0)))
        return is_blunt, -min(height, deepest)

    return sorted(grounds, key=rank)
