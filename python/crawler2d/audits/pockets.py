"""Slots and pockets between neighbouring wheels: a screen of geometry, no verdict."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from crawler2d.parameters.robot import Robot

__all__ = ["Pocket", "pocket_between", "pockets"]

_SAMPLES = 181  # points of the lower half of a wheel that are looked at from below
_TOUCHING = 1e-9  # [m] Wheels nearer than this touch.

Circle = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pocket:
    """What is open between two neighbouring wheels below the belt that would run under them.

    It is a screen, no verdict: whether ground stays in a pocket depends on the whole robot. In a
    pocket that this figure calls harmless robots have seized all the same.

    Parameters
    ----------
    carrier : str
        "chassis", "front flipper", "rear flipper", or both with "and" between.
    bodies : tuple of int
        Numbers of the rear and the front wheel, as in the contacts.
    width : float
        [m] Of its mouth: along the belt, from where that leaves one wheel to where it meets the
        next.
    gap : float
        [m] What is open between the wheels at the narrowest: of a slot > 0, of a pocket 0.
    depth : float
        [m] From the belt to its bottom; of a slot infinite.
    friction : float
        [-] Tangent of the angle at which the rear wheel meets an edge at the bottom: with less,
        this wheel alone does not roll over it, and the pocket holds it. Infinite for a slot.
    """

    carrier: str
    bodies: tuple[int, int]
    width: float
    gap: float
    depth: float
    friction: float

    @property
    def is_slot(self) -> bool:
        """Whether an edge gets through between the wheels."""
        return self.gap > 0.0


def pocket_between(rear: Circle, front: Circle) -> tuple[float, float, float, float]:
    """Measure what is open between two wheels below their common tangent.

    Parameters
    ----------
    rear, front : tuple of float, shape (3,)
        [m] x, y and radius of each.

    Returns
    -------
    width, gap, depth, friction : float
        As in `Pocket`.

    Examples
    --------
    Two equal wheels: the depth is ``r - sqrt(r^2 - p^2 / 4)``, the sine of the angle ``p / (2 r)``.

    >>> width, gap, depth, friction = pocket_between((0.0, 0.0, 0.1), (0.12, 0.0, 0.1))
    >>> width, gap, round(depth, 6), round(friction, 6)
    (0.12, 0.0, 0.02, 0.75)
    """
    (x, y, r), (u, v, s) = rear, front
    apart = math.hypot(u - x, v - y)
    # In a frame whose x runs along the belt and whose y points into the pocket, with the belt at 0,
    # the axles are at (0, r) and (width, s).
    width = math.sqrt(max(apart**2 - (r - s) ** 2, 0.0))
    gap = apart - r - s
    if gap > _TOUCHING:
        return width, gap, math.inf, math.inf
    # The lower of the two points that both circles share, or the one in which they touch.
    along = (apart**2 + r**2 - s**2) / (2.0 * apart)
    aside = math.sqrt(max(r**2 - along**2, 0.0))
    cos, sin = width / apart, (s - r) / apart
    ahead, depth = along * cos + aside * sin, r + along * sin - aside * cos
    below = r - depth  # of the bottom, under the axle of the rear wheel
    return width, 0.0, depth, ahead / below if below > 0.0 else math.inf


def pockets(robot: Robot) -> tuple[Pocket, ...]:
    """Measure what is open between the wheels of one side, chassis and flippers together.

    Neighbours are wheels that are seen from below next to each other, with the flippers at their
    `angle`. Wheels are measured to the tips of their grousers.

    Parameters
    ----------
    robot : Robot
        Any robot; one of belts has no wheels, and no pockets.

    Returns
    -------
    tuple of Pocket
        From the rear to the front.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> absolem = c2d.robots.absolem(track="public", flippers=None)
    >>> found = pockets(absolem)
    >>> len(found), round(1e3 * found[0].depth, 1), round(found[0].friction, 2)
    (7, 7.5, 0.44)
    """
    table = robot.wheels()
    left = table["side"] == "left"
    rows = zip(
        table["carrier"][left].tolist(),
        table["body"][left].tolist(),
        *(table[name][left].tolist() for name in ("x", "y", "radius")),
        strict=True,
    )
    wheels = [(carrier, body, (x, y, radius)) for carrier, body, x, y, radius in rows]
    circles = [circle for _, _, circle in wheels]
    order = sorted(_seen(circles), key=lambda seen: seen[1])
    found = []
    for (first, _), (second, _) in itertools.pairwise(order):
        (carrier, body, rear), (other, its_body, front) = wheels[first], wheels[second]
        width, gap, depth, friction = pocket_between(rear, front)
        found.append(
            Pocket(
                carrier=carrier if carrier == other else f"{carrier} and {other}",
                bodies=(body, its_body),
                width=width,
                gap=max(gap, 0.0),
                depth=depth,
                friction=friction,
            )
        )
    return tuple(found)


def _seen(circles: list[Circle]) -> list[tuple[int, float]]:
    """Return which wheels are seen from below, and at which x in the middle."""
    found = []
    for index, (x, y, radius) in enumerate(circles):
        offsets = radius * np.sin(np.linspace(-0.5 * math.pi, 0.5 * math.pi, _SAMPLES)[1:-1])
        heights = y - np.sqrt(radius**2 - offsets**2)
        is_seen = np.ones(len(offsets), dtype=bool)
        for other, (u, v, its_radius) in enumerate(circles):
            within = its_radius**2 - (x + offsets - u) ** 2
            bottom = v - np.sqrt(np.maximum(within, 0.0))
            # Of two wheels in one place the first counts.
            hides = bottom < heights + (_TOUCHING if other < index else -_TOUCHING)
            is_seen &= ~((within > 0.0) & hides) | (other == index)
        if is_seen.any():
            found.append((index, float(np.mean(x + offsets[is_seen]))))
    return found
