"""The gear wheels of a track: what all have in common, and the phases at which they start."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array
from crawler2d.parameters.track import GearWheel, RoundWheel
from crawler2d.reading.log import Telling
from crawler2d.reading.running_gear import Pair, SideView, centers
from crawler2d.reading.wheels import ALIKE, Grousers, Runner

__all__ = ["Phases", "fitted", "is_same_wheel", "round_belt", "wheel_on", "wrapped"]

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
