"""Outline and track model: from pairs of wheels and their phases, or the drums of a belt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.common.bodies import ends_of
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Shape, Where
from crawler2d.parameters.track import GearWheel, HybridWheels, LineOfWheels, RoundWheel
from crawler2d.reading.log import Telling
from crawler2d.reading.running_gear import Pair, SideView, centers
from crawler2d.reading.wheels import ALIKE, Grousers, Runner, corners_of

__all__ = [
    "BELT_TOLERANCE",
    "FIT",
    "Base",
    "belt_ends",
    "belt_round",
    "beyond_belt",
    "ends_among",
    "hull",
    "is_same_wheel",
    "silhouette",
    "wheels_of",
]

FIT = 1e-5
"""[m] Wheels this near to an even line lie on it: files round to six decimals."""


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """The chassis frame in the side view: midway between the end axles.

    Parameters
    ----------
    rear, front : ndarray, shape (2,)
        [m] The end axles in the side view.
    is_level : bool
        Whether x is forward as in the model, instead of through both end axles.
    """

    rear: Array
    front: Array
    is_level: bool = False

    @property
    def length(self) -> float:
        """[m] Distance of the end axles along x."""
        if self.is_level:
            return float(self.front[0] - self.rear[0])
        return math.hypot(*(self.front - self.rear))

    @property
    def ahead(self) -> Array:
        """Direction of x in the side view, shape (2,)."""
        if self.is_level:
            return np.array([1.0, 0.0])
        along: Array = (self.front - self.rear) / self.length
        return along

    @property
    def tilt(self) -> float:
        """[rad] Angle of x above forward."""
        return math.atan2(self.ahead[1], self.ahead[0])

    def of(self, points: Array) -> Array:
        """[m] Return points of the side view, shape (n, 2), in the chassis frame."""
        ahead = self.ahead
        up = np.array([-ahead[1], ahead[0]])
        turned: Array = (np.asarray(points) - 0.5 * (self.front + self.rear)) @ np.stack(
            [ahead, up], 1
        )
        return turned


def wheels_of(
    told: Telling,
    pairs: list[Pair],
    base: Base,
    view: SideView,
    *,
    path: str = "robot.track",
    run: float = 0.0,
    is_whole: bool = True,
) -> LineOfWheels | HybridWheels:
    """Return the track model that has these wheels where they are.

    A line of wheels, if they stand evenly on the line between the end axles and their radii are
    equal or change evenly; else wheels that are placed one by one, as also where one at an end
    axle is missing, which makes the line no whole one.

    Parameters
    ----------
    told : Telling
        Takes what is to be told about gear wheels.
    pairs : list of Pair
        From the rear to the front.
    base : Base
        The frame of what carries them.
    view : SideView
        The side view.
    path : str
        Of the track in a scenario.
    run : float
        [m] How far the track has run before the start, because its flipper is raised.
    is_whole : bool
        Whether wheels are at both end axles.

    Raises
    ------
    ScenarioError
        If some are gear wheels, and not all are alike.
    """
    radii = np.array([pair.radius for pair in pairs])
    places = base.of(centers(pairs))
    is_line = False
    if is_whole:
        even = np.linspace(-0.5 * base.length, 0.5 * base.length, len(pairs))
        between = np.linspace(radii[0], radii[-1], len(pairs))
        off = np.abs([places[:, 0] - even, places[:, 1], radii - between]).max()
        is_line = bool(off <= FIT)
    angles = [base.tilt - run / pair.radius for pair in pairs]
    wheel, order = wheel_on(told, pairs, view, angles=angles, path=f"{path}.wheel", is_line=is_line)
    if is_line:
        return LineOfWheels(len(pairs), wheel=wheel)
    rows = [(*places[k].tolist(), float(radii[k])) for k in order]
    return HybridWheels(tuple(rows), wheel=wheel)


BELT_TOLERANCE = 0.02
"""[-] How far boxes may reach out of the belt, as a share of the larger radius: what is drawn as
boxes between drums only nears their tangents. Those of Gazebo's example do so by 1.2 %."""


_UPWARDS = 0.5  # 30 degrees above level: what reaches out higher meets no obstacle


_MOST = 64  # discs that an outline can have


_AT_ONCE = 10_000  # corners of a mesh that are looked at together, in some tens of MB


_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)


_NORMALS = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])


def ends_among(drums: list[Pair]) -> tuple[Pair, Pair]:
    """Return the drums on the rear and on the front end axle, as an outline has them."""
    places = [(drum.x, drum.y, drum.radius) for drum in drums]
    rear, front = ends_of(places)
    return drums[places.index(rear)], drums[places.index(front)]


def belt_round(drums: list[Pair], *, at: Where) -> list[Pair]:
    """Return the drums that bend the belt round all, from the rear to the front.

    What lies within the belt, such as a return roller, or on one of its straight runs, such as a
    road wheel between two others, bends nothing.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is one drum only, or too many bend the belt.
    """
    discs = _discs(drums)
    first = _ends(discs, np.array([1.0, 0.0]), at)
    bent = list(first)
    while True:
        out = _Hull(discs[bent]).beyond(discs)
        if out.max() <= FIT:
            break
        bent.append(int(out.argmax()))
        if len(bent) > _MOST:
            path = f"{drums[bent[-1]].left[0].shape.at}: drum[{drums[bent[-1]].left[0].name}]"
            rule = f"must be a track that bends round at most {_MOST} drums: leave some out"
            raise ScenarioError(path, "one drum more", rule)
    # Of several drums on one run, the first that was found may lie between two later ones.
    for each in list(bent):
        others = [other for other in bent if other != each]
        if len(others) > 1 and _Hull(discs[others]).beyond(discs[[each]]).max() <= FIT:
            bent = others
    return [drums[each] for each in sorted(bent)]


def belt_ends(drums: list[Pair], *, along: Array, at: Where) -> tuple[Pair, Pair]:
    """Return the rearmost and the foremost drum of a belt that runs round two, as on a flipper.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    along : ndarray, shape (2,)
        Direction from the rear end to the front end, roughly.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is one drum only, or another reaches out.
    """
    discs = _discs(drums)
    ends = list(_ends(discs, along, at))
    out = _Hull(discs[ends]).beyond(discs)
    tolerance = BELT_TOLERANCE * float(discs[ends, 2].max())
    beyond = np.flatnonzero(out > tolerance)
    if beyond.size:
        runner = drums[beyond[0]].left[0]
        raise ScenarioError(
            f"{runner.shape.at}: drum[{runner.name}]",
            f"{len(beyond)} beyond the belt round the end drums",
            "must lie within the belt round the end drums: flippers have two",
        )
    rear, front = ends
    return drums[rear], drums[front]


def beyond_belt(outlines: list[Array], drums: list[Pair]) -> list[tuple[float, float]]:
    """[m] Return how far shapes reach out of the belt round drums, and how far but upwards.

    Both are 0 within what boxes may.

    Parameters
    ----------
    outlines : list of ndarray, shape (n, 2)
        [m] Corners of each in the side view.
    drums : list of Pair
        All that the belt bends round.
    """
    discs = _discs(drums)
    hull, tolerance = _Hull(discs), BELT_TOLERANCE * float(discs[:, 2].max())
    found = []
    for flat in outlines:
        points = np.column_stack([flat, np.zeros(len(flat))])
        out = [float(hull.beyond(points, highest).max()) for highest in (1.0, _UPWARDS)]
        found.append((out[0] if out[0] > tolerance else 0.0, out[1] if out[1] > tolerance else 0.0))
    return found


def _discs(drums: list[Pair]) -> Array:
    """[m] Return centres and radii, shape (n, 3)."""
    return np.array([[drum.x, drum.y, drum.radius] for drum in drums])


def _ends(discs: Array, along: Array, at: Where) -> tuple[int, int]:
    """Return which discs reach farthest back and forwards."""
    places = discs[:, :2] @ along
    rear, front = int((places - discs[:, 2]).argmin()), int((places + discs[:, 2]).argmax())
    if rear == front:
        raise ScenarioError(str(at), "one drum", "must have a drum at either end of a track")
    return rear, front


class _Hull:
    """How far a belt round discs reaches in every direction that matters.

    What reaches out of a straight run does so farthest at right angles to that, and what reaches
    out of an arc nearly as far in the nearest of many directions.
    """

    def __init__(self, belt: Array) -> None:
        away = belt[None, :, :2] - belt[:, None, :2]
        narrower = belt[:, None, 2] - belt[None, :, 2]
        distance = np.hypot(away[..., 0], away[..., 1])
        rows, columns = np.nonzero(distance > np.abs(narrower))
        along = np.arctan2(away[rows, columns, 1], away[rows, columns, 0])
        across = along - np.arccos(narrower[rows, columns] / distance[rows, columns])
        normals = np.stack([np.cos(across), np.sin(across)])
        reach = belt[:, :2] @ normals + belt[:, 2:]
        # Of the tangents of any two discs, those that no other disc crosses are runs.
        is_run = reach.max(axis=0) <= reach[rows, np.arange(len(rows))] + FIT
        self.normals = np.concatenate([_NORMALS, normals[:, is_run]], axis=1)
        self.reach = (belt[:, :2] @ self.normals + belt[:, 2:]).max(axis=0)

    def beyond(self, discs: Array, highest: float = 1.0) -> Array:
        """[m] Return how far each disc reaches out of the belt; < 0 where it does not.

        Only directions that rise by `highest` at most count.
        """
        counts = self.normals[1] <= highest
        parts = np.array_split(discs, 1 + len(discs) // _AT_ONCE)
        out = [
            (part[:, :2] @ self.normals + part[:, 2:] - self.reach)[:, counts].max(axis=1)
            for part in parts
        ]
        return np.concatenate(out)


_CHORDS = 16  # that stand for a circle; at most 2 % of its radius inside it


_DIGITS = 6  # Files round to a micrometre.


_SMALLEST = 1e-6  # [m] Corners nearer than this are one, and a hull thinner than this is none.


def silhouette(shape: Shape, view: SideView, chords: int = _CHORDS) -> Array:
    """[m] Return points of the side view whose hull is the shape's, rounds as chords."""
    if shape.kind in ("box", "hull"):
        return view.of(corners_of(shape))[:, :2]
    half = np.array([-0.5, 0.5]) * (0.0 if shape.kind == "sphere" else shape.length)
    middles = shape.pose.place + half[:, None] * shape.axis
    angles = np.linspace(0.0, 2.0 * math.pi, chords, endpoint=False)
    circle = shape.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if shape.kind == "cylinder":
        rim = circle @ shape.pose.turn[:, :2].T
        points = (middles[:, None, :] + rim).reshape(-1, 3)
        return view.of(points)[:, :2]
    return (view.of(middles)[:, None, :2] + circle).reshape(-1, 2)


def hull(points: Array) -> list[Array]:
    """Return the corners of the convex hull, counter-clockwise, none on a straight edge."""
    order = np.unique(np.round(points, _DIGITS) + 0.0, axis=0).tolist()  # floats, which are faster
    ends = [_chain(order), _chain(order[::-1])]
    return [np.array(corner) for chain in ends for corner in chain[:-1]]


def _chain(order: list[list[float]]) -> list[list[float]]:
    """Return one half of a hull of sorted points."""
    chain: list[list[float]] = []
    for point in order:
        while len(chain) > 1 and _height(chain[-2], chain[-1], point) <= _SMALLEST:
            chain.pop()
        chain.append(point)
    return chain


def _height(start: list[float], corner: list[float], end: list[float]) -> float:
    """[m] Return by how much a corner stands out to the right of the line past it."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y)
    out = y * (corner[0] - start[0]) - x * (corner[1] - start[1])
    return out / length if length > 0.0 else 0.0


_EXPLAINED = 0.01
"""[-] A turn that leaves less than this share of what is off without one is there, be it small."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Phases:
    """How the wheels of a track start turned: wheel n by n times a share, and all by an offset.

    Parameters
    ----------
    share, offset : float
        [-] Of the angle between two grousers.
    off : float
        [-] The most by which a wheel starts turned otherwise.
    order : list of int
        Which wheel is the first, the second, ...
    """

    share: float
    offset: float
    off: float
    order: list[int]


def fitted(own: Array, orders: list[list[int]], tolerance: float) -> Phases:
    """Find how wheels are phased; in the first order, and without an offset, if that will do.

    Parameters
    ----------
    own : ndarray, shape (n,)
        [-] How far each wheel starts turned, in angles between two grousers.
    orders : list of list of int
        The orders in which they may be numbered.
    tolerance : float
        [-] What may be left.

    Examples
    --------
    >>> import numpy as np
    >>> round(fitted(np.array([0.3, 0.6, 0.9, 0.2]), [[0, 1, 2, 3]], 1e-3).share, 9)
    0.3
    """
    plain, turned = (
        [_fit(own[order], order, has_offset=has_offset) for order in orders]
        for has_offset in (False, True)
    )
    for each, other in zip(plain, turned, strict=True):
        if each.off <= tolerance:
            # A frame that is hardly tilted turns all by as little, which the share must not take
            # up. Any two wheels have a turn and a share.
            is_turned = len(own) > 2 and other.off < _EXPLAINED * each.off
            return other if is_turned else each
    best = min(plain + turned, key=lambda each: each.off)
    return next((each for each in turned if each.off <= tolerance), best)


def round_belt(places: Array, own: Array) -> list[int]:
    """Return the order of wheels along a belt round them, up at the rear and forward on top.

    The first is where the phases of neighbours break off.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        [m] Their axles.
    own : ndarray, shape (n,)
        [-] How far each starts turned, in angles between two grousers.
    """
    away = places - places.mean(axis=0)
    loop = np.argsort(-np.arctan2(away[:, 1], away[:, 0]), kind="stable")
    ahead = wrapped(np.roll(own[loop], -1) - own[loop])
    usual = ahead[np.abs(wrapped(ahead[:, None] - ahead)).sum(axis=1).argmin()]
    breaks = np.abs(wrapped(ahead - usual))
    last = int(breaks.argmax())
    if breaks[last] < 1e-6:  # it closes on itself: the first is the one that says so
        last = int(np.abs(wrapped(own[loop] - usual)).argmin()) - 1
    return [int(k) for k in np.roll(loop, -(last + 1))]


def wrapped(shares: Any) -> Any:
    """Return shares of the angle between two grousers as the nearest to none, from -0.5 to 0.5."""
    return (np.asarray(shares) + 0.5) % 1.0 - 0.5


def _fit(own: Array, order: list[int], *, has_offset: bool) -> Phases:
    """Find the share, and the offset if there may be one, that comes closest."""
    number = np.arange(1, len(own) + 1)
    # Fine enough that the best of these is on the slope of the best of all.
    shares = np.arange(16 * len(own)) / (16 * len(own))
    sums = np.exp(2j * math.pi * (own - shares[:, None] * number)).sum(axis=1)
    best = int((np.abs(sums) if has_offset else sums.real).argmax())
    share, offset = float(shares[best]), 0.0
    if has_offset:
        offset = float(np.angle(sums[best])) / (2.0 * math.pi)
    left = wrapped(own - offset - share * number)
    if has_offset and len(own) > 1:
        more, rest = np.polyfit(number, left, 1)
        share, offset = share + more, offset + rest
    elif not has_offset:
        share += float(number @ left / (number @ number))
    share %= 1.0
    if 1.0 - share < 1e-9:  # a turn of nothing, but for rounding
        share = 0.0
    off = float(np.abs(wrapped(own - offset - share * number)).max())
    return Phases(share=float(share), offset=float(offset), off=off, order=order)


_TURNED = 1e-3
"""[rad] By how much a wheel may start turned otherwise: files round angles to so much."""


_ROUNDED = 0.01  # of the sizes of grousers, which files round to 0.1 mm


_THICKNESSES = ("tip_thickness", "base_thickness")


_PARALLEL = 1e-6
"""[-] Grousers whose thickness changes by less than this share of the radius have parallel flanks:
MuJoCo keeps their corners as float32."""


def wheel_on(
    told: Telling,
    pairs: list[Pair],
    view: SideView,
    *,
    angles: list[float],
    path: str,
    is_line: bool,
) -> tuple[RoundWheel | GearWheel, list[int]]:
    """Return the shape of all wheels of a track, and in which order they are phased.

    Parameters
    ----------
    told : Telling
        Takes what is to be told about their phases.
    pairs : list of Pair
        The wheels, from the rear to the front.
    view : SideView
        The side view.
    angles : list of float
        [rad] By how much what carries them, and the run of its track, has turned each already.
    path : str
        Of the wheel in a scenario.
    is_line : bool
        Whether they stand in a line, from the rear to the front; others may be phased in the order
        of a belt round them.

    Raises
    ------
    ScenarioError
        If wheels differ in their grousers.
    """
    runners = [runner for pair in pairs for runner in pair.both]
    gears = [runner.grousers for runner in runners if runner.grousers is not None]
    order = list(range(len(pairs)))
    if not gears:
        return RoundWheel(), order
    for runner in runners:
        _refuse_unlike(runner, gears[0])
    angle = 2.0 * math.pi / gears[0].count
    first = [_turned(pair.left[0], view) for pair in pairs]
    own = (np.array(first) - angles) / angle
    orders = [order] if is_line else [order, round_belt(centers(pairs), own)]
    found = fitted(own, orders, _TURNED / angle)
    shares = {k: found.share * n + found.offset for n, k in enumerate(found.order, 1)}
    off = max(
        abs(wrapped((_turned(runner, view) - turned) / angle - shares[k]))
        for k, (pair, turned) in enumerate(zip(pairs, angles, strict=True))
        for runner in pair.both
    )
    _tell(told, found, _named(pairs), off, angle=angle, path=path)
    tip, base = (float(np.mean([getattr(g, name) for g in gears])) for name in _THICKNESSES)
    is_parallel = base - tip <= _PARALLEL * gears[0].radius
    return GearWheel(
        grouser_count=gears[0].count,
        grouser_height=float(np.mean([grousers.height for grousers in gears])),
        tip_thickness=tip,
        base_thickness=None if is_parallel else base,
        phase_fraction=found.share,
    ), found.order


def is_same_wheel(first: RoundWheel | GearWheel, second: RoundWheel | GearWheel) -> bool:
    """Whether two wheels are the same but for the rounding of files."""
    if not isinstance(first, GearWheel) or not isinstance(second, GearWheel):
        return first == second
    count = first.grouser_count
    if count is None or count != second.grouser_count:
        return False
    off = abs(wrapped(first.phase_fraction - second.phase_fraction))
    sizes = [
        (gear.grouser_height, gear.tip_thickness, gear.base_thickness or gear.tip_thickness)
        for gear in (first, second)
    ]
    is_alike = bool(np.allclose(np.array(sizes[0]), np.array(sizes[1]), rtol=_ROUNDED))
    return is_alike and off <= _TURNED * count / (2.0 * math.pi)


def _tell(
    told: Telling, found: Phases, wheels: str, off: float, *, angle: float, path: str
) -> None:
    """Tell by how much wheels start turned otherwise than those of the robot that is made.

    Parameters
    ----------
    told : Telling
        Takes it.
    found : Phases
        How they start.
    wheels : str
        Their names.
    off : float
        [-] The most by which one of them, left or right, starts turned otherwise.
    angle : float
        [rad] Between two grousers.
    path : str
        Of the wheel in a scenario.
    """
    is_turned, is_off = (abs(each) * angle > _TURNED for each in (found.offset, off))
    turn, degrees = (f"{math.degrees(each * angle):.3g} degrees" for each in (found.offset, off))
    if is_turned:
        told.notes.append(f"{wheels}: all start turned by {turn} more than they do here")
    if is_off:
        more = ", besides a turn that all have" if is_turned else ""
        reason = f"comes closest: {wheels} start up to {degrees} off{more}"
        told.doubts.append((f"{path}.phase_fraction", float(f"{found.share:.4g}"), reason))


def _named(pairs: list[Pair]) -> str:
    """Return the names of the first and the last wheel on the left."""
    return " to ".join(dict.fromkeys(pair.left[0].name for pair in (pairs[0], pairs[-1])))


def _refuse_unlike(runner: Runner, first: Grousers) -> None:
    """Refuse a wheel whose grousers are not those of the first: a track has one kind."""
    path = f"{runner.shape.at}: wheel[{runner.name}]"
    own = runner.grousers
    if own is None:
        rule = "must have grousers, as other wheels of its track: a track has one kind of wheel"
        raise ScenarioError(path, "a round wheel", rule)
    off = [abs(getattr(own, name) - getattr(first, name)) for name in ("height", *_THICKNESSES)]
    if own.count != first.count or max(off) > ALIKE * max(own.radius, first.radius):
        rule = f"must have the grousers of the other wheels of its track, {_words(first)}"
        raise ScenarioError(path, _words(own), rule)


def _words(grousers: Grousers) -> str:
    sizes = (grousers.height, grousers.tip_thickness, grousers.base_thickness)
    high, tip, base = (f"{1e3 * size:.4g}" for size in sizes)
    return f"{grousers.count} of {high} mm, {tip} mm thick at the tip and {base} mm at the root"


def _turned(runner: Runner, view: SideView) -> float:
    """[rad] Return the direction of a grouser in side view."""
    assert runner.grousers is not None
    x, y, _ = view.of(runner.grousers.direction)
    return math.atan2(y, x)
