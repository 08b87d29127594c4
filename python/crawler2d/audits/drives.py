"""Compare what plugins that drive wheels say of these with the wheels of the file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

from crawler2d.model_tree import Joint, Link, Plugin, Where
from crawler2d.reading.log import lines, list_names
from crawler2d.reading.parts import driven_on, is_drive
from crawler2d.reading.reading import Reading
from crawler2d.reading.speeds import SIDES

__all__ = ["opposed", "other_radius"]

_RADII = {"wheel_radius": 1.0, "wheelRadius": 1.0, "wheel_diameter": 0.5, "wheelDiameter": 0.5}
"""[-] Settings of the size of wheels, each with its ratio to the radius."""

_ALIKE = 0.05
"""[-] Tolerated difference of a radius from that of a wheel: that of a worn or soft tyre."""

Broken = tuple[str, str, str]
"""Message, place and severity, "" for that of the rule."""


@dataclass(frozen=True, slots=True, eq=False)
class _Wheel:
    """A wheel of the file, and the line on which a plugin names its joint."""

    link: Link
    joint: Joint
    side: str
    radius: float
    turns_ahead: bool
    named_at: Where

    def is_of_radius(self, radius: float) -> bool:
        """Whether it has a radius, or with grousers one between their roots and tips."""
        root = max((each.radius for each in self.link.shapes), default=0.0) or self.radius
        return (1.0 - _ALIKE) * min(root, self.radius) <= radius <= (1.0 + _ALIKE) * self.radius


def opposed(reading: Reading) -> Iterator[Broken]:
    """Find wheels that a drive turns against others, or has on the other side."""
    for plugin in filter(is_drive, reading.tree.plugins):
        by_side = {side: _wheels(reading, driven_on(plugin, side)) for side in SIDES}
        yield from _opposite_axes(by_side)
        yield from _other_sides(plugin, by_side)


def other_radius(reading: Reading) -> Iterator[Broken]:
    """Find drives with another radius than that of the wheels that they turn."""
    for plugin in filter(is_drive, reading.tree.plugins):
        sizes = list(_sizes(plugin))
        for size in dict.fromkeys(sizes):
            name, value, where = size
            radius = value * _RADII[name]
            off = [
                wheel
                for side in SIDES
                for wheel in _wheels(reading, _with_size(driven_on(plugin, side), sizes, size))
                if not wheel.is_of_radius(radius)
            ]
            if off:
                worst = max(off, key=lambda wheel: abs(math.log(wheel.radius / radius)))
                ratio, fastest = worst.radius / radius, reading.robot.drivetrain.max_speed
                asked = fastest / max(1.0, ratio)
                message = (
                    f"{_names(off)}: {name} of the plugin is"
                    f" {value:.4g} m, but theirs is {worst.radius / _RADII[name]:.4g} m: asked to"
                    f" drive at {asked:.3g} m/s, it turns them for {asked * ratio:.3g} m/s; here"
                    " they turn as asked"
                )
                yield message, str(where), ""


def _wheels(reading: Reading, named: list[tuple[str, Where]]) -> list[_Wheel]:
    """Return the wheels that turn on named joints."""
    table, left = reading.wheels, reading.frame.turn[:, 1]
    names, sides, radii = (table[column].tolist() for column in ("name", "side", "radius"))
    rows = {name: row for name, *row in zip(names, sides, radii, strict=True)}
    joints, links = {each.name: each for each in reading.tree.joints.values()}, reading.tree.by_name
    found = []
    for name, named_at in named:
        joint = joints.get(name)
        if joint is not None and joint.child in rows:
            side, radius = rows[joint.child]
            ahead = bool(joint.axis @ left > 0.0)
            found.append(_Wheel(links[joint.child], joint, side, radius, ahead, named_at))
    return found


def _names(wheels: list[_Wheel]) -> str:
    return list_names([wheel.link.name for wheel in wheels])


def _opposite_axes(by_side: dict[str, list[_Wheel]]) -> Iterator[Broken]:
    """Find wheels that one command turns against each other; the fewer of both are named."""
    every = [wheel for wheels in by_side.values() for wheel in wheels]
    ahead = [wheel for wheel in every if wheel.turns_ahead]
    back = [wheel for wheel in every if not wheel.turns_ahead]
    if not ahead or not back:
        return
    odd, others = (back, ahead) if len(back) <= len(ahead) else (ahead, back)
    if all(len({wheel.turns_ahead for wheel in wheels}) == 1 for wheels in by_side.values()):
        message = (
            "the axes of the wheels on the left are opposite to those on the right: asked to drive"
            " ahead, the plugin turns the robot on the spot; here both sides turn alike"
        )
    else:
        message = (
            f"{_names(odd)}: opposite in axis to {_names(others)}, which the same plugin turns:"
            " asked for one speed, they work against each other; here all turn alike"
        )
    yield message, lines([wheel.joint.at for wheel in odd]), ""


def _other_sides(plugin: Plugin, by_side: dict[str, list[_Wheel]]) -> Iterator[Broken]:
    """Find wheels that a drive has on the other side: some, or all of both sides."""
    on = [wheel for side in SIDES for wheel in by_side[side] if wheel.side == side]
    off = [wheel for side in SIDES for wheel in by_side[side] if wheel.side != side]
    if any(len({wheel.side for wheel in wheels}) > 1 for wheels in by_side.values()):
        odd = off if len(off) <= len(on) else on
        message = (
            f"{_names(odd)}: the plugin has them among the"
            " wheels of the other side, against which they work as the robot turns"
        )
        yield message, lines([wheel.named_at for wheel in odd]), ""
    # Old drives of Gazebo Classic, with leftJoint and rightJoint, confuse the sides themselves.
    elif off and not on and plugin.values("left_joint", "right_joint"):
        message = (
            "the plugin has the wheels on the right as those on the left: asked to turn left, the"
            " robot turns right, or its forward direction is another one"
        )
        yield message, lines([wheel.named_at for wheel in off]), "warning"


def _sizes(plugin: Plugin) -> Iterator[tuple[str, float, Where]]:
    """Yield the sizes of wheels that a plugin states [m], with their names and lines."""
    for name, text, where in plugin.settings:
        if name in _RADII:
            with suppress(ValueError):
                if 0.0 < (size := float(text)) < math.inf:
                    yield name, size, where


def _with_size(
    named: list[tuple[str, Where]],
    sizes: list[tuple[str, float, Where]],
    size: tuple[str, float, Where],
) -> list[tuple[str, Where]]:
    """Return the joints of a side that have a size: all have the only one, else each its own."""
    if len(sizes) == 1:
        return named
    if len(sizes) != len(named):  # the plugin itself would guess
        return []
    return [joint for joint, own in zip(named, sizes, strict=True) if own == size]
