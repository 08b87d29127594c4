"""A gear wheel in a model file: a round wheel, and equal grousers evenly round it."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Joint, Shape
from crawler2d.reading.parts import Grousers
from crawler2d.reading.rounds import PARALLEL, plane_across, radius_about

__all__ = ["ALIKE", "grousers_on"]

ALIKE = 2e-3
"""[-] By how much grousers may differ, as a share of the radius: files round to 0.1 mm."""

_SHARP = 1e-5
"""[-] Corners nearer than this share of the distance from the axle are one: those of a prism on its
two sides, which MuJoCo keeps as float32."""

_MOST_CORNERS = 64  # A prism has eight; the mesh of one may name each for every facet.
_COUNT = range(3, 201)  # grousers that a gear wheel can have


def grousers_on(shapes: list[Shape], joint: Joint) -> Grousers | None:
    """Return the grousers of a wheel; None if its shapes are none such.

    Each is a box or a prism across whose section has a straight tip and two flanks, alike on both
    sides of the line from the axle through its middle, and which reaches down into the wheel.

    Parameters
    ----------
    shapes : list of Shape
        What turns.
    joint : Joint
        On which it turns.

    Returns
    -------
    Grousers or None
        Their figures, each a mean of all.
    """
    radii = [radius_about(shape, joint.place, joint.axis) for shape in shapes]
    root = max((radius for radius in radii if radius is not None), default=0.0)
    others = [shape for shape, radius in zip(shapes, radii, strict=True) if radius is None]
    if root <= 0.0 or len(others) not in _COUNT:
        return None
    plane = plane_across(joint.axis)
    found = [_grouser(shape, joint, plane, root) for shape in others]
    rows = np.array([row for row in found if row is not None])
    if len(rows) < len(others):
        return None
    tip, base, radius, angles = rows.T
    tolerance = ALIKE * float(radius.max())
    slots, off = _spaced(angles)
    if max(np.ptp(each) for each in (tip, base, radius, radius * off)) > tolerance:
        return None
    if sorted(slots) != list(range(len(others))):
        return None
    first = float(angles[0] + np.mean(off))
    return Grousers(
        count=len(others),
        radius=float(radius.mean()),
        height=float(radius.mean()) - root,
        tip_thickness=float(tip.mean()),
        base_thickness=max(float(tip.mean()), float(base.mean())),
        direction=plane @ (math.cos(first), math.sin(first)),
        shapes=tuple(others),
    )


def _spaced(angles: Array) -> tuple[list[int], Array]:
    """Return which of evenly spaced places is nearest to each angle, and how far off that is [rad].

    The first place is the first angle.
    """
    count, step = len(angles), 2.0 * math.pi / len(angles)
    away = (angles - angles[0]) / step
    slots = np.round(away)
    return [int(slot) % count for slot in slots], (away - slots) * step


def _grouser(
    shape: Shape, joint: Joint, plane: Array, root: float
) -> tuple[float, float, float, float] | None:
    """Return thickness at tip and root, radius of the tip [m] and direction [rad] of a grouser."""
    corners = _section(shape, joint, plane)
    if corners is None:
        return None
    tolerance = ALIKE * root
    (third, fourth, *tip), distances = _by_distance(corners)
    out = tip[0] + tip[1]
    length = math.hypot(*out)
    if distances[2] <= root + tolerance or length <= tolerance:
        return None
    out /= length
    side = np.array([-out[1], out[0]])
    # Half of the section: away from the axle and to the side, tip first.
    half_tip = np.array([0.5 * length, 0.5 * abs(float((tip[0] - tip[1]) @ side))])
    half_base = np.array([float((third + fourth) @ out), abs(float((third - fourth) @ side))]) / 2.0
    lopsided = abs(float((third + fourth) @ side))
    if max(distances[3] - distances[2], lopsided, distances[1] - root) > tolerance:
        return None
    base = _at_root(half_tip, half_base, root)
    if base < half_tip[1] - tolerance:
        return None
    angle = math.atan2(out[1], out[0])
    return 2.0 * float(half_tip[1]), 2.0 * base, float(distances[2:].mean()), angle


def _by_distance(corners: Array) -> tuple[Array, Array]:
    """Return corners and their distances [m] from the axle, the nearest first."""
    distances = np.hypot(*corners.T)
    order = np.argsort(distances, kind="stable")
    return corners[order], distances[order]


def _at_root(tip: Array, base: Array, root: float) -> float:
    """[m] Return how far to the side a flank from tip to base meets the root circle."""
    along = base - tip
    square, half, beyond = along @ along, tip @ along, tip @ tip - root**2
    under = half**2 - square * beyond
    share = 1.0 if under < 0.0 else min(1.0, (-half - math.sqrt(under)) / square)
    return float(tip[1] + share * along[1])


def _section(shape: Shape, joint: Joint, plane: Array) -> Array | None:
    """[m] Return the corners of a shape about the axle, shape (4, 2); None if it has others."""
    if shape.kind == "box":
        along = np.abs(shape.pose.turn.T @ joint.axis)
        across = int(along.argmax())
        if along[across] < math.cos(PARALLEL):
            return None
        half = [0.5 * shape.size[k] * shape.pose.turn[:, k] for k in range(3) if k != across]
        points = [shape.pose.place + i * half[0] + j * half[1] for i in (-1, 1) for j in (-1, 1)]
        corners: Array = (np.array(points) - joint.place) @ plane
        return corners
    if shape.kind != "hull" or len(shape.points) > _MOST_CORNERS:
        return None
    flat = (shape.points - joint.place) @ plane
    near = _SHARP * float(np.abs(flat).max(initial=0.0))
    found: list[Array] = []
    for point in flat:
        if all(math.hypot(*(point - other)) > near for other in found):
            found.append(point)
        if len(found) > 4:
            return None
    return np.array(found) if len(found) == 4 else None
