"""The gear wheels of a track: what all have alike, and what is told of how they start turned."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.track import GearWheel, RoundWheel
from crawler2d.reading.grousers import ALIKE
from crawler2d.reading.parts import Grousers, Runner
from crawler2d.reading.phases import Phases, fitted, round_belt, wrapped
from crawler2d.reading.sides import Pair, centers
from crawler2d.reading.telling import Telling
from crawler2d.reading.view import SideView

__all__ = ["is_same_wheel", "wheel_on"]

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
