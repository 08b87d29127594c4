"""Slots and pockets between wheels, and variants of the robot that may avoid seizures."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import (
    CircumferentialWheels,
    GearWheel,
    HybridWheels,
    LineOfWheels,
    RoundWheel,
    Track,
)

__all__ = [
    "Candidate",
    "Pocket",
    "candidates_of",
    "left_wheels",
    "pocket_between",
    "pockets",
    "wheel_count",
]

CARRIERS = ("chassis", "flippers")
"""Parts that carry wheels."""

_HEIGHT = 3.0 / 16.0  # of the smallest radius, as the Engineer's grousers
_THICKNESS = 1.0 / 8.0  # of the grouser pitch, likewise
_GROUSERS = (12, 8, 16)
_MORE = 8
"""Largest number of wheel counts to try, from one more to one more between every two."""

Wheeled = LineOfWheels | CircumferentialWheels | HybridWheels

_Variants = Callable[[Robot, str, Wheeled], Iterator[tuple[str, Track]]]

_SAMPLES = 181  # points on the lower half of a wheel, seen from below
_TOUCHING = 1e-9  # [m] Wheels nearer than this touch.

Circle = tuple[float, float, float]
"""[m] x, y and radius of a wheel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pocket:
    """The space between two neighbouring wheels, above a belt under them.

    A check of the geometry, not a verdict: whether ground stays in a pocket depends on the whole
    robot, and robots have seized in pockets that these figures call harmless.

    Parameters
    ----------
    carrier : str
        "chassis", "front flipper", "rear flipper", or both with "and" between.
    bodies : tuple of int
        Numbers of the rear and the front wheel, as in the contacts.
    width : float
        [m] Width of its mouth, along the belt, between the tangent points on both wheels.
    gap : float
        [m] Smallest distance between the wheels: > 0 for a slot, 0 for a pocket.
    depth : float
        [m] Distance from the belt to its bottom; infinite for a slot.
    friction : float
        [-] Tangent of the angle at which the rear wheel touches an edge at the bottom: with less
        friction this wheel alone cannot roll over the edge, and the pocket holds it. Infinite for a
        slot.
    """

    carrier: str
    bodies: tuple[int, int]
    width: float
    gap: float
    depth: float
    friction: float

    @property
    def is_slot(self) -> bool:
        """Whether an edge can pass between the wheels."""
        return self.gap > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A robot that may not seize.

    Parameters
    ----------
    description : str
        The change, in words.
    kind : {"wheels", "gears", "belt"}
        Other numbers, sizes or positions of round wheels; gear wheels instead; or belts.
    robot : Robot
        The changed robot.
    change : int
        Number of wheels and belts of one side that are new, removed, or have another size or shape;
        moved ones do not count.
    """

    description: str
    kind: str
    robot: Robot
    change: int


class Wheel(NamedTuple):
    """A wheel: body number, carrier, and centre and radius [m] in the chassis frame."""

    body: int
    carrier: str
    x: float
    y: float
    radius: float

    @property
    def circle(self) -> Circle:
        """[m] x, y and radius."""
        return self.x, self.y, self.radius


def left_wheels(robot: Robot) -> list[Wheel]:
    """List the wheels of the left side, flippers included."""
    table = robot.wheels()
    left = table["side"] == "left"
    columns = (table[name][left].tolist() for name in Wheel._fields)
    return [Wheel(*row) for row in zip(*columns, strict=True)]


def pocket_between(rear: Circle, front: Circle) -> tuple[float, float, float, float]:
    """Measure the space between two wheels, above their common lower tangent.

    Parameters
    ----------
    rear, front : tuple of float, shape (3,)
        [m] x, y and radius of each wheel.

    Returns
    -------
    width, gap, depth, friction : float
        See `Pocket`.

    Examples
    --------
    For equal wheels the depth is ``r - sqrt(r^2 - p^2 / 4)`` and the angle's sine ``p / (2 r)``.

    >>> width, gap, depth, friction = pocket_between((0.0, 0.0, 0.1), (0.12, 0.0, 0.1))
    >>> width, gap, round(depth, 6), round(friction, 6)
    (0.12, 0.0, 0.02, 0.75)
    """
    (x, y, r), (u, v, s) = rear, front
    apart = math.hypot(u - x, v - y)
    # In a frame with x along the belt, y into the pocket and the belt at y = 0, the axles are at
    # (0, r) and (width, s).
    width = math.sqrt(max(apart**2 - (r - s) ** 2, 0.0))
    gap = apart - r - s
    if gap > _TOUCHING:
        return width, gap, math.inf, math.inf
    # The lower intersection of both circles, or the point where they touch.
    along = (apart**2 + r**2 - s**2) / (2.0 * apart)
    aside = math.sqrt(max(r**2 - along**2, 0.0))
    cos, sin = width / apart, (s - r) / apart
    ahead, depth = along * cos + aside * sin, r + along * sin - aside * cos
    below = r - depth  # bottom, below the axle of the rear wheel
    return width, 0.0, depth, ahead / below if below > 0.0 else math.inf


def pockets(robot: Robot) -> tuple[Pocket, ...]:
    """Measure the spaces between the wheels of one side, including flippers.

    Neighbours are adjacent as seen from below, with the flippers at their `angle`. Wheels are
    measured to the grouser tips.

    Parameters
    ----------
    robot : Robot
        Any robot; one on belts has no pockets.

    Returns
    -------
    tuple of Pocket
        Pockets and slots from the rear to the front.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> absolem = c2d.robots.absolem(track="public", flippers=None)
    >>> found = pockets(absolem)
    >>> len(found), round(1e3 * found[0].depth, 1), round(found[0].friction, 2)
    (7, 7.5, 0.44)
    """
    wheels = left_wheels(robot)
    order = sorted(_seen_from_below([wheel.circle for wheel in wheels]), key=lambda seen: seen[1])
    found = []
    for (first, _), (second, _) in itertools.pairwise(order):
        rear, front = wheels[first], wheels[second]
        width, gap, depth, friction = pocket_between(rear.circle, front.circle)
        both = f"{rear.carrier} and {front.carrier}"
        found.append(
            Pocket(
                carrier=rear.carrier if rear.carrier == front.carrier else both,
                bodies=(rear.body, front.body),
                width=width,
                gap=max(gap, 0.0),
                depth=depth,
                friction=friction,
            )
        )
    return tuple(found)


def _seen_from_below(circles: list[Circle]) -> list[tuple[int, float]]:
    """Find the wheels visible from below, and the mean x of their visible parts."""
    found = []
    for index, (x, y, radius) in enumerate(circles):
        offsets = radius * np.sin(np.linspace(-0.5 * math.pi, 0.5 * math.pi, _SAMPLES)[1:-1])
        heights = y - np.sqrt(radius**2 - offsets**2)
        is_seen = np.ones(len(offsets), dtype=bool)
        for other, (u, v, its_radius) in enumerate(circles):
            within = its_radius**2 - (x + offsets - u) ** 2
            bottom = v - np.sqrt(np.maximum(within, 0.0))
            # Of two wheels at the same position the first counts.
            hides = bottom < heights + (_TOUCHING if other < index else -_TOUCHING)
            is_seen &= ~((within > 0.0) & hides) | (other == index)
        if is_seen.any():
            found.append((index, float(np.mean(x + offsets[is_seen]))))
    return found


def candidates_of(robot: Robot, carriers: Collection[str]) -> list[Candidate]:
    """List candidates that change the wheels where a robot seizes.

    Parameters
    ----------
    robot : Robot
        The robot without changes.
    carriers : collection of str
        Those of `CARRIERS` that seize; only their wheels are changed.

    Returns
    -------
    list of Candidate
        Wheels and gears, the smallest change first. Empty if these carriers have no wheels.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> for each in candidates_of(robot, ["chassis"])[:3]:
    ...     print(each.change, each.description)
    1 chassis: 5 wheels in place of 4
    1 chassis: 3 wheels in place of 4
    2 chassis: 6 wheels in place of 4
    """
    found = [*_of_kind(robot, carriers, "wheels", _more_wheels)]
    found += _of_kind(robot, carriers, "gears", _gears)
    return sorted((each for each in found if _fits(each.robot)), key=lambda each: each.change)


def wheel_count(robot: Robot) -> int:
    """Count the wheels of one side, flippers included."""
    return len(left_wheels(robot))


def _fits(robot: Robot) -> bool:
    """Whether a robot keeps every rule; too many wheels may not."""
    try:
        robot.wheels()
    except ScenarioError:
        return False
    return True


def _of_kind(
    robot: Robot, carriers: Collection[str], kind: str, variants: _Variants
) -> Iterator[Candidate]:
    """Change all carriers to their first variant, then all to their second, and so on."""
    tracks = {each: _track_of(robot, each) for each in CARRIERS if each in carriers}
    options = [
        [(f"{carrier}: {what}", carrier, new) for what, new in variants(robot, carrier, track)]
        for carrier, track in tracks.items()
        if track is not None
    ]
    for changes in zip(*options, strict=False):
        changed = robot
        for _, carrier, track in changes:
            changed = _with(changed, carrier, track)
        description = "; ".join(text for text, _, _ in changes)
        yield Candidate(
            description=description, kind=kind, robot=changed, change=_change(robot, changed)
        )


def _track_of(robot: Robot, carrier: str) -> Wheeled | None:
    """Return the wheels of a carrier; None if it has none."""
    track: Track | None = robot.track
    if carrier == "flippers":
        track = None if robot.flippers is None else robot.flippers.track or robot.track
    return track if isinstance(track, Wheeled) else None


def _with(robot: Robot, carrier: str, track: Track) -> Robot:
    """Put other wheels on one carrier; keep the others."""
    arms = robot.flippers
    if carrier == "flippers":
        assert arms is not None
        return replace(robot, flippers=replace(arms, track=track))
    if arms is not None and arms.track is None and isinstance(robot.track, LineOfWheels):
        robot = replace(robot, flippers=replace(arms, track=robot.track))
    return robot.with_track(track)


def _more_wheels(
    robot: Robot,
    carrier: str,  # noqa: ARG001 - gear wheels depend on it
    track: Wheeled,
) -> Iterator[tuple[str, Track]]:
    """Yield other numbers, sizes and positions of a carrier's wheels."""
    if isinstance(track, HybridWheels):
        yield from _between(track)
        return
    count = track.count
    # One between every two gives 2 n - 1 wheels, two between every two 3 n - 2.
    more = np.linspace(count + 1, 2 * count - 1, min(_MORE, count - 1)).round().astype(int).tolist()
    others = [count + 1, count - 1, *more, 3 * count - 2]
    least = 2 if isinstance(track, LineOfWheels) else 3
    for other in dict.fromkeys(others):
        if other >= least:
            yield f"{other} wheels in place of {count}", replace(track, count=other)
    if isinstance(track, LineOfWheels) and track.wheel_radius is not None:
        whole = robot.outline.front_radius
        for radius in (0.5 * (track.wheel_radius + whole), whole):
            if radius > track.wheel_radius * 1.001:
                text = f"wheels of {1e3 * radius:.1f} mm in place of {1e3 * track.wheel_radius:.1f}"
                yield text, replace(track, wheel_radius=radius)
                text = f"{count + 1} wheels of {1e3 * radius:.1f} mm"
                yield text, replace(track, wheel_radius=radius, count=count + 1)


def _between(track: HybridWheels) -> Iterator[tuple[str, Track]]:
    """Yield placed wheels with one more in the deepest pocket, and one more in every pocket.

    Wheels are named by their body numbers, in the order given.
    """
    if len(track.placements) < 2:
        return
    numbers = sorted(range(len(track.placements)), key=track.placements.__getitem__)
    order = [track.placements[number] for number in numbers]
    pairs = list(itertools.pairwise(order))
    between = [tuple(0.5 * (a + b) for a, b in zip(*pair, strict=True)) for pair in pairs]
    deepest = max(range(len(pairs)), key=lambda k: _holding_friction(*pairs[k]))
    first, second = sorted(numbers[deepest : deepest + 2])
    for what, more in (
        (f"one wheel more, between wheels {first} and {second}", [between[deepest]]),
        ("one wheel more between every two", between),
    ):
        placed = sorted([*order, *((x, y, radius) for x, y, radius in more)])
        yield what, replace(track, placements=tuple(placed))


def _holding_friction(rear: Circle, front: Circle) -> float:
    """[-] Friction below which two wheels hold an edge; 0 if one is inside the other."""
    is_inside = math.dist(rear[:2], front[:2]) <= abs(rear[2] - front[2])
    return 0.0 if is_inside else pocket_between(rear, front)[-1]


def _gears(robot: Robot, carrier: str, track: Wheeled) -> Iterator[tuple[str, Track]]:
    """Yield gear wheels instead of round ones, with grousers of the Engineer's proportions."""
    if not isinstance(track.wheel, RoundWheel):
        return
    table = robot.wheels()
    here = np.char.find(table["carrier"].astype(str), carrier.removesuffix("s")) >= 0
    smallest = float(table["radius"][here].min())
    height = None if robot.outline.grouser_height > 0.0 else _HEIGHT * smallest
    for grousers in _GROUSERS:
        thickness = _THICKNESS * 2.0 * np.pi * smallest / grousers
        gear = GearWheel(
            grouser_count=grousers,
            grouser_height=height,
            tip_thickness=None if robot.outline.grouser_thickness > 0.0 else float(thickness),
        )
        yield f"gear wheels with {grousers} grousers", replace(track, wheel=gear)


def _change(before: Robot, after: Robot) -> int:
    """Count the wheels of one side that are new, removed, or have another size or shape."""
    changed = 0
    for carrier in CARRIERS:
        old, new = _track_of(before, carrier), _track_of(after, carrier)
        if old is None or new is None or old == new:
            continue
        arms = 1
        if carrier == "flippers" and before.flippers is not None:
            arms = 2 if before.flippers.ends == "both" else 1
        was, now = _count(old), _count(new)
        alike = old.wheel == new.wheel and _size(old) == _size(new)
        changed += arms * (abs(now - was) if alike else max(now, was))
    return changed


def _count(track: Wheeled) -> int:
    return len(track.placements) if isinstance(track, HybridWheels) else track.count


def _size(track: Wheeled) -> float | None:
    return None if isinstance(track, HybridWheels) else track.wheel_radius
