"""The largest speed and accelerations of the tracks that a file states."""

from __future__ import annotations

import math
from collections.abc import Sequence

from crawler2d.model_tree import Tree, Where
from crawler2d.reading.log import ReadLog, estimate, lines
from crawler2d.reading.parts import is_drive
from crawler2d.reading.running_gear import Pair
from crawler2d.reading.wheels import Runner

__all__ = [
    "ALIKE",
    "FASTEST",
    "SIDES",
    "acceleration_of",
    "deceleration_of",
    "speed_of",
    "warn_of_controllers",
    "warn_of_speeds",
]

SIDES = ("left", "right")

FASTEST = 100.0
"""[rad/s] and [m/s] Larger speed limits mean no limit."""

ALIKE = 0.01
"""[-] Tolerated difference of rotors, forces or sides, relative to the largest, as files round."""

_SPEEDS = ("max_velocity", "max_linear_velocity", "linear_velocity/max_velocity")
"""Settings of Gazebo's TrackController, DiffDrive and TrackedVehicle."""

_RATES = ("_acceleration", "_linear_acceleration")
"""Their names after "max" and "min"; TrackedVehicle has its own in ``linear_velocity``."""

_RATES_OF_RIMS = ("max_wheel_acceleration", "wheelAcceleration")
"""Those of Gazebo Classic, both ways, which its source code takes as m/s^2 of the rim."""

_QUICKEST = 1e6  # [m/s^2]
_OF_TRACKS = {
    "max_velocity": FASTEST,
    "max_acceleration": _QUICKEST,
    "min_acceleration": _QUICKEST,
}
"""Settings of Gazebo's TrackController, and from where on they are no limit."""
_SPEED, _ACCELERATION, _DECELERATION = 1.0, 1.0, 4.0  # those of Robot.simple


def speed_of(tree: Tree, pairs: list[Pair]) -> tuple[float, str]:
    """[m/s] Return the largest speed of the tracks: the slowest of all their wheels sets it."""
    limits = _in_range(_of_plugins(tree, _SPEEDS))
    limits += _speeds(tree, [runner for pair in pairs for runner in pair.both])
    if not limits:
        return _SPEED, estimate("that of Robot.simple: the file has no limit")
    return _least(limits)


def _speeds(tree: Tree, runners: Sequence[Runner]) -> list[tuple[float, Where]]:
    """[m/s] Return the largest speeds of wheels and drums, as far as they have any."""
    limits = []
    for runner in runners:
        if runner.joint is None:
            limits.append((runner.shape.surface_speed, runner.shape.at))
            continue
        if runner.joint.velocity:
            limits.append((runner.joint.velocity * runner.radius, runner.joint.velocity_at))
        if runner.joint.name in tree.commanded:
            rate, where = tree.commanded[runner.joint.name]
            limits.append((rate * runner.radius, where))
    return _in_range(limits)


def _in_range(limits: Sequence[tuple[float, Where]]) -> list[tuple[float, Where]]:
    return [(speed, where) for speed, where in limits if 0.0 < speed <= FASTEST]


def warn_of_controllers(log: ReadLog) -> None:
    """Warn if track controllers have unlike limits, as all tracks have one speed."""
    controllers = [each for each in log.tree.plugins if each.is_one_of("trackcontroller")]
    for name, most in _OF_TRACKS.items():
        stated = [plugin.numbers(name) for plugin in controllers]
        numbers = [abs(own[0][0]) if own else math.inf for own in stated]
        limits = {each if 0.0 < each <= most else math.inf for each in numbers}
        if limits and not math.isclose(min(limits), max(limits), rel_tol=ALIKE):
            value = ", ".join(
                "none" if each == math.inf else f"{each:g}" for each in sorted(limits)
            )
            path = f"{lines([plugin.at for plugin in controllers])}: {name}"
            log.add_warning(path, value, "differs between tracks: all have the smallest")


def warn_of_speeds(log: ReadLog, pairs: Sequence[Pair], speed: float) -> None:
    """Warn if one side is slower than the other, and sets the speed [m/s] of both."""
    every = [
        _speeds(log.tree, [each for pair in pairs for each in getattr(pair, side)])
        for side in SIDES
    ]
    slowest = [min((own for own, _ in side), default=math.inf) for side in every]
    if min(slowest) > speed or math.isclose(*slowest, rel_tol=ALIKE):
        return
    _, source = _least(every[slowest.index(min(slowest))])
    left, right = (f"{own:.4g} m/s" if own < math.inf else "no limit" for own in slowest)
    reason = "differs from side to side: both have that of the slower one"
    log.add_warning(f"{source}: velocity", f"{left} left and {right} right", reason)


def acceleration_of(tree: Tree) -> tuple[float, str]:
    """[m/s^2] Return the limit of acceleration, and its source."""
    return _rate(tree, "max", _ACCELERATION)


def deceleration_of(tree: Tree) -> tuple[float, str]:
    """[m/s^2] Return the limit of deceleration, which files state below 0, and its source."""
    return _rate(tree, "min", _DECELERATION)


def _rate(tree: Tree, which: str, usual: float) -> tuple[float, str]:
    """[m/s^2] Return the limit under names with "max" or "min", and its source."""
    names = [f"{which}{name}" for name in _RATES]
    stated = _of_plugins(tree, [*names, f"linear_velocity/{names[0]}", *_RATES_OF_RIMS])
    limits = [(abs(rate), where) for rate, where in stated if 0.0 < abs(rate) <= _QUICKEST]
    return _least(limits) if limits else (usual, estimate("that of Robot.simple"))


def _of_plugins(tree: Tree, names: Sequence[str]) -> list[tuple[float, Where]]:
    """List the numbers that plugins of drives state under some names."""
    return [
        stated
        for plugin in tree.plugins
        if is_drive(plugin) or plugin.is_one_of("track")
        for stated in plugin.numbers(*names)
    ]


def _least(limits: Sequence[tuple[float, Where]]) -> tuple[float, str]:
    """Return the smallest limit and its line."""
    least = min(limit for limit, _ in limits)
    return least, lines([where for each, where in limits if each == least])
