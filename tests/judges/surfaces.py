"""How drives move the surfaces of bodies, to the second judge."""

import numpy as np

from tests.judges.geometry import Array, cross, right_of


def round_surface(normals: Array) -> Array:
    """[-] Velocity of a wheel's or belt's surface for a speed of 1: along itself."""
    return -right_of(normals)


def gear_surface(points: Array, axle: Array, radius: float) -> Array:
    """[-] The same of points of a gear, which turns clockwise; `axle` has a row for each."""
    return right_of(points - axle) / radius


def carried_by_belt(points: Array, circles: Array) -> Array:
    """[-] The same of points of grousers on a belt round two circles, the rear one first.

    On a run they go along it, round an end they turn about its axle.
    """
    (rear, front), (big, small) = circles[:, :2], circles[:, 2]
    way = front - rear
    length = np.hypot(*way)
    along = way / length
    side = np.where(cross(along, points - rear) >= 0.0, 1.0, -1.0)
    rise = (big - small) / length
    # Outward normals of the runs, and the way along them from the rear end to the front one.
    normals = rise * along + side[:, None] * np.sqrt(1.0 - rise**2) * -right_of(along)
    ahead = side[:, None] * right_of(normals)
    at_rear = ((points - rear) * ahead).sum(axis=1) < 0.0
    at_front = ((points - front) * ahead).sum(axis=1) > 0.0
    found = right_of(normals)
    found[at_rear] = right_of(points[at_rear] - rear) / big
    found[at_front] = right_of(points[at_front] - front) / small
    return found
