"""Motion of the surfaces of bodies by drives, for the second judge."""

import numpy as np
from numpy.typing import NDArray

from tests.judges.geometry import Array, right_of


def round_surface(normals: Array) -> Array:
    """[-] Velocity of a wheel's or belt's surface for a speed of 1: along itself."""
    return -right_of(normals)


def gear_surface(points: Array, axle: Array, radius: float) -> Array:
    """[-] The same for points of a gear, which turns clockwise; `axle` has a row for each."""
    return right_of(points - axle) / radius


def carried_by_belt(points: Array, circles: Array) -> Array:
    """[-] The same for points of grousers on a belt taut round circles.

    On a run they go along it, round a circle they turn about its axle.
    """
    turns = np.linspace(0.0, 2.0 * np.pi, 20_001)[:-1]
    normals = np.column_stack([np.cos(turns), np.sin(turns)])
    # The circle that the belt lies on where its outward normal is this one, clockwise.
    on = np.argmax(normals @ circles[:, :2].T + circles[:, 2], axis=1)
    runs = np.flatnonzero(on != np.roll(on, -1))
    nearest = np.full(len(points), np.inf)
    found = np.zeros_like(points)

    def take(rows: NDArray[np.bool_], distances: Array, motions: Array) -> None:
        nearer = rows & (abs(distances) < nearest)
        nearest[nearer] = abs(distances[nearer])
        found[nearer] = motions[nearer]

    for circle in np.unique(on):
        arm, radius = points - circles[circle, :2], circles[circle, 2]
        far = np.hypot(*arm.T)
        at = np.round(np.arctan2(arm[:, 1], arm[:, 0]) / (2.0 * np.pi) * len(turns)).astype(int)
        take(on[at % len(turns)] == circle, far - radius, right_of(arm) / radius)
    for k in runs:
        normal = normals[k]
        ends = [circles[c, :2] + circles[c, 2] * normal for c in (on[k], on[(k + 1) % len(on)])]
        way = ends[1] - ends[0]
        share = (points - ends[0]) @ way / (way @ way)
        between = (share >= 0.0) & (share <= 1.0)
        motions = np.broadcast_to(right_of(normal), points.shape)
        take(between, (points - ends[0]) @ normal, motions)
    return found
