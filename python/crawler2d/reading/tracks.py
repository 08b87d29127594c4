"""Find outline and track model from pairs of wheels with their phases, or from drums of a belt."""

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
"""[m] Discs this close to a belt are taken to lie on it: programs round to six decimals."""

_EVEN = 1.2e-4
"""[m] Wheels this close to an evenly spaced line are taken to lie on it: people round to four
decimals, which moves the wheel and both ends by 0.05 mm each."""

BELT_TOLERANCE = 0.02
"""[-] How far boxes may protrude from the belt, relative to the larger radius: boxes between drums
only approximate the tangents. Those of Gazebo's example are off by 1.2 %."""

_UPWARDS = 0.5  # sine of 30 degrees: what protrudes more steeply upwards meets no obstacle
_MOST_DISCS = 64  # of an outline
_AT_ONCE = 10_000  # corners of a mesh that are processed together, which takes some tens of MB
_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
_NORMALS = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])
_CHORDS = 16  # of a circle; at most 2 % of its radius from it
_DIGITS = 6  # Files round to a micrometre.
_SMALLEST = 1e-6  # [m] Corners that protrude by less are dropped; a hull must be thicker.

_EXPLAINED = 0.01
"""[-] An offset is real, however small, if it leaves less than this fraction of the residual."""

_TURNED = 1e-3
"""[rad] Allowed deviation of a phase: files round angles to this."""

_ROUNDED = 0.01  # relative tolerance for sizes of grousers, which files round to 0.1 mm
_THICKNESSES = ("tip_thickness", "base_thickness")

_PARALLEL = 1e-6
"""[-] Flanks of grousers are parallel if the thickness changes by less than this, relative to the
radius: MuJoCo stores corners as float32."""


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """The chassis frame in the side view, with its origin midway between the end axles.

    Parameters
    ----------
    rear, front : ndarray, shape (2,)
        [m] Positions of the end axles in the side view.
    is_level : bool
        Whether x points along the model's forward direction, instead of from axle to axle.
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
        """Direction of the x axis in the side view, shape (2,)."""
        if self.is_level:
            return np.array([1.0, 0.0])
        along: Array = (self.front - self.rear) / self.length
        return along

    @property
    def tilt(self) -> float:
        """[rad] Angle of the x axis above the forward direction."""
        return math.atan2(self.ahead[1], self.ahead[0])

    def of(self, points: Array) -> Array:
        """[m] Transform points of the side view, shape (n, 2), to the chassis frame."""
        x, y = self.ahead
        turn = np.array([[x, -y], [y, x]])
        turned: Array = (np.asarray(points) - 0.5 * (self.front + self.rear)) @ turn
        return turned


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Phases:
    """Initial phases of the wheels of a track: offset + n * step for wheel n = 1, 2, ...

    Parameters
    ----------
    step, offset : float
        [-] In pitches; one pitch is the angle between neighbouring grousers.
    residual : float
        [-] The largest deviation of a wheel.
    order : list of int
        Indices of the first wheel, the second wheel, ...
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
    """Return the track model with these wheels at these positions.

    It is a line of wheels if they are evenly spaced on the line between the end axles, both of
    which have wheels, and their radii are equal or change evenly. Otherwise each wheel has its own
    position.

    Parameters
    ----------
    log : ReadLog
        Collects notes and warnings.
    pairs : list of Pair
        The wheels, from the rear to the front.
    base : Base
        The frame of their carrier.
    view : SideView
        The side view.
    path : str
        Path of the track in a scenario.
    run : float
        [m] Distance that the track has run before the start, because its flipper is raised.
    is_whole : bool
        Whether both end axles have wheels.

    Raises
    ------
    ScenarioError
        If there are gear wheels, and not all wheels are alike.
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
            log.notes.append(f"{path}: evenly spaced within {1e3 * off:.2g} mm, which is ignored")
    angles = [base.tilt - run / pair.radius for pair in pairs]
    wheel, order = common_wheel(
        log, pairs, view, angles=angles, path=f"{path}.wheel", is_line=is_line
    )
    if is_line:
        return LineOfWheels(len(pairs), wheel=wheel)
    rows = [(*places[k].tolist(), float(radii[k])) for k in order]
    return HybridWheels(tuple(rows), wheel=wheel)


def ends_among(drums: list[Pair]) -> tuple[Pair, Pair]:
    """Return the drums on the rear and front end axles, chosen as for any outline."""
    discs = [(drum.x, drum.y, drum.radius) for drum in drums]
    rear, front = end_discs(discs)
    return drums[discs.index(rear)], drums[discs.index(front)]


def bending_drums(drums: list[Pair], *, at: Where) -> list[Pair]:
    """Return the drums that bend the belt round all of them, from the rear to the front.

    Drums inside the belt, such as a return roller, or on a straight run, such as a road wheel
    between two others, do not bend it.

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
    # If several drums are on one run, the first that was found may lie between two later ones.
    for each in list(bent):
        others = [other for other in bent if other != each]
        if len(others) > 1 and _Hull(discs[others]).beyond(discs[[each]]).max() <= FIT:
            bent = others
    return [drums[each] for each in sorted(bent)]


def belt_ends(drums: list[Pair], *, along: Array, at: Where) -> tuple[Pair, Pair]:
    """Return the rearmost and foremost drums of a belt that runs round only two, as on a flipper.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    along : ndarray, shape (2,)
        Approximate direction from the rear end to the front end.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is only one drum, or another one protrudes from the belt.
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
    """[m] Return how far shapes protrude from the belt: in any direction, and not steeply upwards.

    A distance within the tolerance for boxes is 0.

    Parameters
    ----------
    outlines : list of ndarray, shape (n, 2)
        [m] Corners of each shape in the side view.
    drums : list of Pair
        The drums that bend the belt.
    """
    discs = _discs(drums)
    hull, tolerance = _Hull(discs), BELT_TOLERANCE * float(discs[:, 2].max())

    def beyond(flat: Array, highest: float) -> float:
        points = np.column_stack([flat, np.zeros(len(flat))])
        out = float(hull.beyond(points, highest).max())
        return out if out > tolerance else 0.0

    return [(beyond(flat, 1.0), beyond(flat, _UPWARDS)) for flat in outlines]


def silhouette(shape: Shape, view: SideView, chords: int = _CHORDS) -> Array:
    """[m] Return points of the side view with the shape's hull; circles become polygons."""
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
    """Return the corners of the convex hull counter-clockwise, without points on its edges."""
    order = np.unique(np.round(points, _DIGITS) + 0.0, axis=0).tolist()  # plain floats are faster
    ends = [_chain(order), _chain(order[::-1])]
    return [np.array(corner) for chain in ends for corner in chain[:-1]]


def fit_phases(own: Array, orders: list[list[int]], tolerance: float) -> Phases:
    """Fit the phases of wheels, preferably in the first order and without an offset.

    Parameters
    ----------
    own : ndarray, shape (n,)
        [-] Phase of each wheel, in pitches.
    orders : list of list of int
        Orders in which the wheels may be numbered.
    tolerance : float
        [-] Largest residual of a good fit.

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
            # A slightly tilted frame turns all wheels by the same small angle, which the step must
            # not absorb. An offset and a step fit any two wheels.
            is_turned = len(own) > 2 and other.residual < _EXPLAINED * each.residual
            return other if is_turned else each
    best = min(without + turned, key=lambda each: each.residual)
    return next((each for each in turned if each.residual <= tolerance), best)


def belt_order(places: Array, own: Array) -> list[int]:
    """Return the order of wheels along a belt round them: up at the rear, then forward on top.

    It begins where the phase jumps between neighbours.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        [m] Positions of the axles.
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
    """[-] Wrap phases, in pitches, to the range -0.5 to 0.5."""
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
    """Return the common shape of the wheels of a track, and the order of their phases.

    Parameters
    ----------
    log : ReadLog
        Collects notes and warnings about their phases.
    pairs : list of Pair
        The wheels, from the rear to the front.
    view : SideView
        The side view.
    angles : list of float
        [rad] Angle by which carrier and travel of the track have already turned each pair.
    path : str
        Path of the wheel in a scenario.
    is_line : bool
        Whether they form a line of wheels; otherwise their phases may follow the order along a
        belt round them.

    Raises
    ------
    ScenarioError
        If the wheels have different grousers.
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
    """Whether two wheels are the same except for rounding in files."""
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
    """[m] Return centres and radii of drums, shape (n, 3)."""
    return np.array([[drum.x, drum.y, drum.radius] for drum in drums])


def _ends(discs: Array, along: Array, at: Where) -> tuple[int, int]:
    """Return the indices of the discs that reach farthest back and farthest forward."""
    places = discs[:, :2] @ along
    rear, front = int((places - discs[:, 2]).argmin()), int((places + discs[:, 2]).argmax())
    if rear == front:
        raise ScenarioError(str(at), "one drum", "must have a drum at either end of a track")
    return rear, front


class _Hull:
    """The support function of a belt round discs, in many directions and normal to its runs.

    What protrudes from a straight run does so most along its normal; what protrudes from an arc,
    nearly as far in the closest of the other directions.
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
        # The straight runs are the tangents of two discs that no other disc crosses.
        is_run = reach.max(axis=0) <= reach[rows, np.arange(len(rows))] + FIT
        self.normals = np.concatenate([_NORMALS, normals[:, is_run]], axis=1)
        self.reach = (belt[:, :2] @ self.normals + belt[:, 2:]).max(axis=0)

    def beyond(self, discs: Array, highest: float = 1.0) -> Array:
        """[m] Return how far each disc protrudes from the belt; negative if it does not.

        Only directions whose upward component is at most `highest` count.
        """
        counts = self.normals[1] <= highest
        parts = np.array_split(discs, 1 + len(discs) // _AT_ONCE)
        out = [
            (part[:, :2] @ self.normals + part[:, 2:] - self.reach)[:, counts].max(axis=1)
            for part in parts
        ]
        return np.concatenate(out)


def _chain(order: list[list[float]]) -> list[list[float]]:
    """Return one half of the hull of sorted points."""
    chain: list[list[float]] = []
    for point in order:
        while len(chain) > 1 and _height(chain[-2], chain[-1], point) <= _SMALLEST:
            chain.pop()
        chain.append(point)
    return chain


def _height(start: list[float], corner: list[float], end: list[float]) -> float:
    """[m] Return the distance of a corner to the right of the line from start to end."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y)
    out = y * (corner[0] - start[0]) - x * (corner[1] - start[1])
    return out / length if length > 0.0 else 0.0


def _fit(own: Array, order: list[int], *, has_offset: bool) -> Phases:
    """Fit the step, and the offset if there is one."""
    number = np.arange(1, len(own) + 1)
    # Fine enough for the best of these to be in the basin of the global optimum.
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
    if 1.0 - step < 1e-9:  # zero, except for rounding
        step = 0.0
    residual = float(np.abs(wrap_phase(own - offset - step * number)).max())
    return Phases(step=float(step), offset=float(offset), residual=residual, order=order)


def _refuse_unlike(runner: Runner, first: Grousers) -> None:
    """Refuse a wheel whose grousers differ from those of the first: a track has one kind."""
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
    """[rad] Return the direction of one of its grousers in side view."""
    assert runner.grousers is not None
    x, y, _ = view.of(runner.grousers.direction)
    return math.atan2(y, x)
