"""Outline and track model: from pairs of wheels and their phases, or the drums of a belt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.common.bodies import end_discs
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Shape, Where
from crawler2d.parameters.track import GearWheel, HybridWheels, LineOfWheels, RoundWheel
from crawler2d.reading.log import ReadLog
from crawler2d.reading.running_gear import Pair, SideView, centers
from crawler2d.reading.wheels import ALIKE, Grousers, Runner, corners_of

__all__ = [
    "BELT_TOLERANCE",
    "FIT",
    "Base",
    "belt_ends",
    "bending_drums",
    "beyond_belt",
    "ends_among",
    "hull",
    "is_same_wheel",
    "silhouette",
    "wheels_of",
]

FIT = 1e-5
"""[m] Discs this close to a belt lie on it: programs round to six decimals."""

_EVEN = 1.2e-4
"""[m] Wheels this close to an evenly spaced line lie on it: people round to four decimals, which
moves wheel and ends by 0.05 mm each."""

BELT_TOLERANCE = 0.02
"""[-] How far boxes may reach out of the belt, relative to the larger radius: boxes that are drawn
between drums only approximate their tangents. Those of Gazebo's example are off by 1.2 %."""

_UPWARDS = 0.5  # 30 degrees above level: what sticks out higher meets no obstacle
_MOST_DISCS = 64  # that an outline can have
_AT_ONCE = 10_000  # corners of a mesh that are processed together, in some tens of MB
_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
_NORMALS = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])
_CHORDS = 16  # of a circle; at most 2 % of its radius inside it
_DIGITS = 6  # Files round to a micrometre.
_SMALLEST = 1e-6  # [m] Closer corners are one, and a thinner hull is none.

_EXPLAINED = 0.01
"""[-] An offset is real, however small, if it leaves less than this fraction of the residual."""

_TURNED = 1e-3
"""[rad] The phase deviation that is allowed: files round angles to this."""

_ROUNDED = 0.01  # relative, of the sizes of grousers, which files round to 0.1 mm
_THICKNESSES = ("tip_thickness", "base_thickness")

_PARALLEL = 1e-6
"""[-] Grousers have parallel flanks if their thickness changes by less than this, relative to the
radius: MuJoCo keeps their corners as float32."""


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """The chassis frame in the side view: midway between the end axles.

    Parameters
    ----------
    rear, front : ndarray, shape (2,)
        [m] The end axles in the side view.
    is_level : bool
        Whether x is the forward direction of the model, instead of the line through both axles.
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
        x, y = self.ahead
        turn = np.array([[x, -y], [y, x]])
        turned: Array = (np.asarray(points) - 0.5 * (self.front + self.rear)) @ turn
        return turned


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Phases:
    """The phases of the wheels of a track at the start: wheel n at offset + n * step.

    Parameters
    ----------
    step, offset : float
        [-] In pitches: the angle between two grousers.
    residual : float
        [-] The largest deviation of a wheel.
    order : list of int
        Which wheel is the first, the second, ...
    """

    step: float
    offset: float
    residual: float
    order: list[int]


def wheels_of(
    log: ReadLog,
    pairs: list[Pair],
    base: Base,
    view: SideView,
    *,
    path: str = "robot.track",
    run: float = 0.0,
    is_whole: bool = True,
) -> LineOfWheels | HybridWheels:
    """Return the track model that has these wheels in their positions.

    A line of wheels, if they stand evenly on the line between the end axles and their radii are
    equal or change evenly; else wheels that are placed one by one, as also where the wheel at an
    end axle is missing.

    Parameters
    ----------
    log : ReadLog
        Takes notes and warnings.
    pairs : list of Pair
        From the rear to the front.
    base : Base
        The frame of what carries them.
    view : SideView
        The side view.
    path : str
        Of the track in a scenario.
    run : float
        [m] Distance that the track has run before the start, because its flipper is raised.
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
    if is_whole and len(pairs) > 1:
        even = np.linspace(-0.5 * base.length, 0.5 * base.length, len(pairs))
        between = np.linspace(radii[0], radii[-1], len(pairs))
        off = np.abs([places[:, 0] - even, places[:, 1], radii - between]).max()
        is_line = bool(off <= _EVEN)
        if is_line and off > FIT:
            log.notes.append(f"{path}: evenly spaced but for {1e3 * off:.2g} mm, which is left out")
    angles = [base.tilt - run / pair.radius for pair in pairs]
    wheel, order = common_wheel(
        log, pairs, view, angles=angles, path=f"{path}.wheel", is_line=is_line
    )
    if is_line:
        return LineOfWheels(len(pairs), wheel=wheel)
    rows = [(*places[k].tolist(), float(radii[k])) for k in order]
    return HybridWheels(tuple(rows), wheel=wheel)


def ends_among(drums: list[Pair]) -> tuple[Pair, Pair]:
    """Return the drums on the rear and on the front end axle, as an outline has them."""
    discs = [(drum.x, drum.y, drum.radius) for drum in drums]
    rear, front = end_discs(discs)
    return drums[discs.index(rear)], drums[discs.index(front)]


def bending_drums(drums: list[Pair], *, at: Where) -> list[Pair]:
    """Return the drums that bend the belt round all, from the rear to the front.

    Those within the belt, such as a return roller, or on one of its straight runs, such as a road
    wheel between two others, do not bend it.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is only one drum, or too many bend the belt.
    """
    discs = _discs(drums)
    first = _ends(discs, np.array([1.0, 0.0]), at)
    bent = list(first)
    while True:
        out = _Hull(discs[bent]).beyond(discs)
        if out.max() <= FIT:
            break
        bent.append(int(out.argmax()))
        if len(bent) > _MOST_DISCS:
            rule = f"must be a track that bends round at most {_MOST_DISCS} drums: leave some out"
            raise ScenarioError(drums[bent[-1]].left[0].path, "one drum more", rule)
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
        If there is only one drum, or another one reaches out.
    """
    discs = _discs(drums)
    ends = list(_ends(discs, along, at))
    out = _Hull(discs[ends]).beyond(discs)
    tolerance = BELT_TOLERANCE * float(discs[ends, 2].max())
    beyond = np.flatnonzero(out > tolerance)
    if beyond.size:
        rule = "must lie within the belt round the end drums: flippers have two"
        value = f"{len(beyond)} beyond the belt round the end drums"
        raise ScenarioError(drums[beyond[0]].left[0].path, value, rule)
    return drums[ends[0]], drums[ends[1]]


def beyond_belt(outlines: list[Array], drums: list[Pair]) -> list[tuple[float, float]]:
    """[m] Return how far shapes reach out of the belt round drums: anywhere, and not upwards.

    Both are 0 within the tolerance of boxes.

    Parameters
    ----------
    outlines : list of ndarray, shape (n, 2)
        [m] Corners of each in the side view.
    drums : list of Pair
        Those that bend the belt.
    """
    discs = _discs(drums)
    hull, tolerance = _Hull(discs), BELT_TOLERANCE * float(discs[:, 2].max())

    def beyond(flat: Array, highest: float) -> float:
        points = np.column_stack([flat, np.zeros(len(flat))])
        out = float(hull.beyond(points, highest).max())
        return out if out > tolerance else 0.0

    return [(beyond(flat, 1.0), beyond(flat, _UPWARDS)) for flat in outlines]


def silhouette(shape: Shape, view: SideView, chords: int = _CHORDS) -> Array:
    """[m] Return points of the side view whose hull is that of the shape, circles as polygons."""
    if shape.kind in ("box", "hull"):
        return view.of(corners_of(shape))[:, :2]
    half = np.array([-0.5, 0.5]) * (0.0 if shape.kind == "sphere" else shape.length)
    middles = shape.pose.place + half[:, None] * shape.axis
    angles = np.linspace(0.0, 2.0 * math.pi, chords, endpoint=False)
    circle = shape.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if shape.kind == "cylinder":
        rim = circle @ shape.pose.turn[:, :2].T
        return view.of((middles[:, None, :] + rim).reshape(-1, 3))[:, :2]
    return (view.of(middles)[:, None, :2] + circle).reshape(-1, 2)


def hull(points: Array) -> list[Array]:
    """Return the corners of the convex hull, counter-clockwise, none on a straight edge."""
    order = np.unique(np.round(points, _DIGITS) + 0.0, axis=0).tolist()  # floats, which are faster
    ends = [_chain(order), _chain(order[::-1])]
    return [np.array(corner) for chain in ends for corner in chain[:-1]]


def fit_phases(own: Array, orders: list[list[int]], tolerance: float) -> Phases:
    """Fit the phases of wheels; in the first order and without an offset, if that suffices.

    Parameters
    ----------
    own : ndarray, shape (n,)
        [-] Phase of each wheel, in pitches.
    orders : list of list of int
        The orders in which they may be numbered.
    tolerance : float
        [-] The residual that is allowed.

    Examples
    --------
    >>> import numpy as np
    >>> round(fit_phases(np.array([0.3, 0.6, 0.9, 0.2]), [[0, 1, 2, 3]], 1e-3).step, 9)
    0.3
    """
    without, turned = (
        [_fit(own[order], order, has_offset=has_offset) for order in orders]
        for has_offset in (False, True)
    )
    for each, other in zip(without, turned, strict=True):
        if each.residual <= tolerance:
            # A frame with a slight tilt turns all wheels by as little, which the step must not take
            # up. Any two wheels have an offset and a step.
            is_turned = len(own) > 2 and other.residual < _EXPLAINED * each.residual
            return other if is_turned else each
    best = min(without + turned, key=lambda each: each.residual)
    return next((each for each in turned if each.residual <= tolerance), best)


def belt_order(places: Array, own: Array) -> list[int]:
    """Return the order of wheels along a belt round them, up at the rear and forward on top.

    The first is where the phases of neighbours are discontinuous.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        [m] Their axles.
    own : ndarray, shape (n,)
        [-] Phase of each, in pitches.
    """
    away = places - places.mean(axis=0)
    loop = np.argsort(-np.arctan2(away[:, 1], away[:, 0]), kind="stable")
    ahead = wrap_phase(np.roll(own[loop], -1) - own[loop])
    usual = ahead[np.abs(wrap_phase(ahead[:, None] - ahead)).sum(axis=1).argmin()]
    breaks = np.abs(wrap_phase(ahead - usual))
    last = int(breaks.argmax())
    if breaks[last] < 1e-6:  # a closed loop: the first wheel is the one whose phase is one step
        last = int(np.abs(wrap_phase(own[loop] - usual)).argmin()) - 1
    return [int(k) for k in np.roll(loop, -(last + 1))]


def wrap_phase(phase: Any) -> Any:
    """[-] Wrap phases, in pitches, to -0.5 to 0.5."""
    return (np.asarray(phase) + 0.5) % 1.0 - 0.5


def common_wheel(
    log: ReadLog,
    pairs: list[Pair],
    view: SideView,
    *,
    angles: list[float],
    path: str,
    is_line: bool,
) -> tuple[RoundWheel | GearWheel, list[int]]:
    """Return the shape that all wheels of a track have, and the order of their phases.

    Parameters
    ----------
    log : ReadLog
        Takes notes and warnings on their phases.
    pairs : list of Pair
        The wheels, from the rear to the front.
    view : SideView
        The side view.
    angles : list of float
        [rad] By how much the carrier, and the run of its track, have turned each already.
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
    first, *_ = gears
    for runner in runners:
        _refuse_unlike(runner, first)
    pitch = 2.0 * math.pi / first.count
    own = (np.array([_phase(pair.left[0], view) for pair in pairs]) - angles) / pitch
    orders = [order] if is_line else [order, belt_order(centers(pairs), own)]
    phases = fit_phases(own, orders, _TURNED / pitch)
    expected = {k: phases.step * n + phases.offset for n, k in enumerate(phases.order, 1)}
    off = max(
        abs(wrap_phase((_phase(runner, view) - turned) / pitch - expected[k]))
        for k, (pair, turned) in enumerate(zip(pairs, angles, strict=True))
        for runner in pair.both
    )
    is_turned, is_off = (abs(each) * pitch > _TURNED for each in (phases.offset, off))
    turn, degrees = (f"{math.degrees(each * pitch):.3g} degrees" for each in (phases.offset, off))
    names = " to ".join(dict.fromkeys(pair.left[0].name for pair in (pairs[0], pairs[-1])))
    if is_turned:
        log.notes.append(f"{names}: all start turned by {turn} more than they do here")
    if is_off:
        more = ", in addition to a turn that all have" if is_turned else ""
        reason = f"is the best fit: {names} start up to {degrees} off{more}"
        log.add_warning(f"{path}.phase_fraction", float(f"{phases.step:.4g}"), reason)
    tip, base = (float(np.mean([getattr(gear, name) for gear in gears])) for name in _THICKNESSES)
    is_parallel = base - tip <= _PARALLEL * first.radius
    return GearWheel(
        grouser_count=first.count,
        grouser_height=float(np.mean([grousers.height for grousers in gears])),
        tip_thickness=tip,
        base_thickness=None if is_parallel else base,
        phase_fraction=phases.step,
    ), phases.order


def is_same_wheel(first: RoundWheel | GearWheel, second: RoundWheel | GearWheel) -> bool:
    """Whether two wheels are the same but for the rounding of files."""
    if not isinstance(first, GearWheel) or not isinstance(second, GearWheel):
        return first == second
    count = first.grouser_count
    if count is None or count != second.grouser_count:
        return False
    off = abs(wrap_phase(first.phase_fraction - second.phase_fraction))
    sizes = [
        (gear.grouser_height, gear.tip_thickness, gear.base_thickness or gear.tip_thickness)
        for gear in (first, second)
    ]
    is_alike = bool(np.allclose(np.array(sizes[0]), np.array(sizes[1]), rtol=_ROUNDED))
    return is_alike and off <= _TURNED * count / (2.0 * math.pi)


def _discs(drums: list[Pair]) -> Array:
    """[m] Return centres and radii, shape (n, 3)."""
    return np.array([[drum.x, drum.y, drum.radius] for drum in drums])


def _ends(discs: Array, along: Array, at: Where) -> tuple[int, int]:
    """Return the discs that reach farthest back and farthest forward."""
    places = discs[:, :2] @ along
    rear, front = int((places - discs[:, 2]).argmin()), int((places + discs[:, 2]).argmax())
    if rear == front:
        raise ScenarioError(str(at), "one drum", "must have a drum at either end of a track")
    return rear, front


class _Hull:
    """The support of a belt round discs, in every direction that matters.

    What reaches out of a straight run does so farthest at right angles to it; out of an arc, nearly
    as far in the closest of many directions.
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
        # The runs are those tangents of two discs that no other disc crosses.
        is_run = reach.max(axis=0) <= reach[rows, np.arange(len(rows))] + FIT
        self.normals = np.concatenate([_NORMALS, normals[:, is_run]], axis=1)
        self.reach = (belt[:, :2] @ self.normals + belt[:, 2:]).max(axis=0)

    def beyond(self, discs: Array, highest: float = 1.0) -> Array:
        """[m] Return how far each disc reaches out of the belt; < 0 where it does not.

        Only directions that rise by at most `highest` count.
        """
        counts = self.normals[1] <= highest
        parts = np.array_split(discs, 1 + len(discs) // _AT_ONCE)
        out = [
            (part[:, :2] @ self.normals + part[:, 2:] - self.reach)[:, counts].max(axis=1)
            for part in parts
        ]
        return np.concatenate(out)


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


def _fit(own: Array, order: list[int], *, has_offset: bool) -> Phases:
    """Fit the step, and the offset if there may be one."""
    number = np.arange(1, len(own) + 1)
    # Fine enough that the best of these is on the slope of the global optimum.
    steps = np.arange(16 * len(own)) / (16 * len(own))
    sums = np.exp(2j * math.pi * (own - steps[:, None] * number)).sum(axis=1)
    best = int((np.abs(sums) if has_offset else sums.real).argmax())
    step, offset = float(steps[best]), 0.0
    if has_offset:
        offset = float(np.angle(sums[best])) / (2.0 * math.pi)
    left = wrap_phase(own - offset - step * number)
    if has_offset and len(own) > 1:
        slope, intercept = np.polyfit(number, left, 1)
        step, offset = step + slope, offset + intercept
    elif not has_offset:
        step += float(number @ left / (number @ number))
    step %= 1.0
    if 1.0 - step < 1e-9:  # zero, but for rounding
        step = 0.0
    residual = float(np.abs(wrap_phase(own - offset - step * number)).max())
    return Phases(step=float(step), offset=float(offset), residual=residual, order=order)


def _refuse_unlike(runner: Runner, first: Grousers) -> None:
    """Refuse a wheel whose grousers are not those of the first: a track has one kind."""
    own = runner.grousers
    if own is None:
        rule = "must have grousers, as other wheels of its track: a track has one kind of wheel"
        raise ScenarioError(runner.path, "a round wheel", rule)
    off = [abs(getattr(own, name) - getattr(first, name)) for name in ("height", *_THICKNESSES)]
    if own.count != first.count or max(off) > ALIKE * max(own.radius, first.radius):
        rule = f"must have the grousers of the other wheels of its track, {_words(first)}"
        raise ScenarioError(runner.path, _words(own), rule)


def _words(grousers: Grousers) -> str:
    sizes = (grousers.height, grousers.tip_thickness, grousers.base_thickness)
    high, tip, base = (f"{1e3 * size:.4g}" for size in sizes)
    return f"{grousers.count} of {high} mm, {tip} mm thick at the tip and {base} mm at the root"


def _phase(runner: Runner, view: SideView) -> float:
    """[rad] Return the direction of a grouser in side view."""
    assert runner.grousers is not None
    x, y, _ = view.of(runner.grousers.direction)
    return math.atan2(y, x)
