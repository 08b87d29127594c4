"""Rules of lint about what a file says: friction, limits, motors, sides, doubts of the reader."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np

from crawler2d.audits.finding import Finding
from crawler2d.models.tree import Joint, Link
from crawler2d.reading.reading import Reading
from crawler2d.reading.sources import lines
from crawler2d.reading.telling import named

__all__ = ["of_model", "wheel_links"]

_STICKIEST = 2.0
"""[-] Rubber tracks on concrete have up to 1; more is meant to stop sliding, not measured."""

_OFF_AXLE = 0.1
"""[-] Share of its radius by which the centre of mass of a wheel may lie off its axle."""

_SAME = 1e-6
"""[m] Last digit of the files: sides that differ by less are equal."""


def of_model(reading: Reading) -> Iterator[Finding]:
    """Find what a file says that is hardly meant.

    Parameters
    ----------
    reading : Reading
        What was read.
    """
    yield from _friction(reading)
    yield from _effort(reading)
    yield from _driven(reading)
    yield from _sides(reading)
    yield from _balance(reading)
    for doubt in reading.doubts:
        line = re.search(re.escape(reading.tree.file) + r"[^:]*:[0-9]+", doubt)
        where = line[0] if line else reading.tree.file
        yield Finding(rule="doubt", severity="warning", what=doubt, where=where)


def wheel_links(reading: Reading) -> list[tuple[Link, Joint]]:
    """Return the links of all wheels with the joints that they turn on; drums have none."""
    joints = reading.tree.joints
    named = set(reading.wheels["name"].tolist())  # that of a drum has its shape, too
    return [(link, joints[link.name]) for link in reading.tree.links if link.name in named]


def _carrying(reading: Reading) -> list[Link]:
    """Return the links of wheels and drums."""
    shown = set(reading.wheels["line"].tolist())
    return [link for link in reading.tree.links if link.at.line in shown]


def _friction(reading: Reading) -> Iterator[Finding]:
    """Take the coefficients as they are written: an engine may combine them to less."""
    found = [
        (coefficient, at)
        for link in _carrying(reading)
        for shape in link.shapes
        if shape.friction is not None
        for coefficient, at in (
            (shape.friction.first, shape.friction.first_at),
            (shape.friction.second, shape.friction.second_at),
        )
        if coefficient > _STICKIEST
    ]
    if not found:
        return
    largest = max(coefficient for coefficient, _ in found)
    what = (
        f"friction of {largest:g}; tracks have 0.3 to 1. By the rule of {reading.engine} it counts"
        f" as {reading.friction:g} on a floor, other engines may take it as it is"
    )
    severity = "error" if reading.friction > _STICKIEST else "warning"
    where = lines([at for _, at in found])
    yield Finding(rule="friction", severity=severity, what=what, where=where)


def _effort(reading: Reading) -> Iterator[Finding]:
    wheels = [joint for _, joint in wheel_links(reading)]
    without = [joint for joint in wheels if not joint.effort or not math.isfinite(joint.effort)]
    if not without:
        return
    torque = reading.robot.drivetrain.max_torque
    what = (
        f"{len(without)} of {len(wheels)} wheels have no effort limit: their motors hold the speed"
        f" under any load; here they have {torque:.3g} N m a track, an estimate"
    )
    where = lines([joint.effort_at for joint in without])
    yield Finding(rule="effort", severity="warning", what=what, where=where)


def _driven(reading: Reading) -> Iterator[Finding]:
    """Tell of wheels for which the file names no motor: something outside must turn them."""
    wheels = [joint for _, joint in wheel_links(reading)]
    idle = [joint for joint in wheels if joint.name not in reading.tree.driven]
    if not idle:
        return
    names = named([joint.child for joint in idle])
    what = (
        f"the file names no motor for {len(idle)} of {len(wheels)} wheels ({names}); here all are"
        " driven, as by a controller outside it: those that nothing turns drag"
    )
    where = lines([joint.at for joint in idle])
    yield Finding(rule="not driven", severity="note", what=what, where=where)


def _sides(reading: Reading) -> Iterator[Finding]:
    """Compare left and right, wheel by wheel in the order of the table."""
    table = reading.wheels
    left, right = (table["side"] == side for side in ("left", "right"))
    if left.sum() != right.sum():  # double wheels: the reader has paired them
        return
    off = {
        name: np.abs(table[name][left] - table[name][right])
        for name in ("x", "y", "radius", "mass")
    }
    worst = max(float(off[name].max()) for name in ("x", "y", "radius"))
    heavier = float((off["mass"] / np.maximum(table["mass"][left], 1e-9)).max())
    if worst <= _SAME and heavier <= _SAME:
        return
    index = int(np.argmax(off["x"] + off["y"] + off["radius"] + off["mass"]))
    what = (
        f"left and right differ by up to {1e3 * worst:.3g} mm and {heavier:.2g} of a wheel's mass,"
        f" most at {table['name'][left][index]}; here both have the mean"
    )
    where = f"{reading.tree.file}:{table['line'][left][index]}, {table['line'][right][index]}"
    yield Finding(rule="sides", severity="note", what=what, where=where)


def _balance(reading: Reading) -> Iterator[Finding]:
    """Find wheels that are out of balance: what turns with them is swung round the axle."""
    radii = dict(
        zip(reading.wheels["name"].tolist(), reading.wheels["radius"].tolist(), strict=True)
    )
    off = [
        (math.hypot(*np.cross(joint.axis, link.center - joint.place)), link)
        for link, joint in wheel_links(reading)
    ]
    found = [(away, link) for away, link in off if away > _OFF_AXLE * radii[link.name]]
    if found:
        most = max(away for away, _ in found)
        names = named([link.name for _, link in found])
        what = (
            f"{names}: their centres of mass are off their axles by up to {1e3 * most:.3g} mm: such"
            " wheels shake a robot as they turn; here they are in balance"
        )
        where = lines([link.mass_at for _, link in found])
        yield Finding(rule="balance", severity="warning", what=what, where=where)
