"""The belt round the drums of a track that a plugin moves."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.common.ends import ends_of
from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.where import Where
from crawler2d.reading.sides import Pair
from crawler2d.reading.tracks import FIT

__all__ = ["BELT_TOLERANCE", "belt_ends", "belt_round", "beyond_belt", "ends_among"]

BELT_TOLERANCE = 0.02
"""[-] How far boxes may reach out of the belt, as a share of the larger radius: what is drawn as
boxes between drums only nears their tangents. Those of Gazebo's example do so by 1.2 %."""

_UPWARDS = 0.5  # 30 degrees above level: what reaches out higher meets no obstacle
_MOST = 64  # discs that an outline can have
_AT_ONCE = 10_000  # corners of a mesh that are looked at together, in some tens of MB
_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
_NORMALS = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])


def ends_among(drums: list[Pair]) -> tuple[Pair, Pair]:
    """Return the drums on the rear and on the front end axle, as an outline has them."""
    places = [(drum.x, drum.y, drum.radius) for drum in drums]
    rear, front = ends_of(places)
    return drums[places.index(rear)], drums[places.index(front)]


def belt_round(drums: list[Pair], *, at: Where) -> list[Pair]:
    """Return the drums that bend the belt round all, from the rear to the front.

    What lies within the belt, such as a return roller, or on one of its straight runs, such as a
    road wheel between two others, bends nothing.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is one drum only, or too many bend the belt.
    """
    discs = _discs(drums)
    first = _ends(discs, np.array([1.0, 0.0]), at)
    bent = list(first)
    while True:
        out = _Hull(discs[bent]).beyond(discs)
        if out.max() <= FIT:
            break
        bent.append(int(out.argmax()))
        if len(bent) > _MOST:
            path = f"{drums[bent[-1]].left[0].shape.at}: drum[{drums[bent[-1]].left[0].name}]"
            rule = f"must be a track that bends round at most {_MOST} drums: leave some out"
            raise ScenarioError(path, "one drum more", rule)
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
        If there is one drum only, or another reaches out.
    """
    discs = _discs(drums)
    ends = list(_ends(discs, along, at))
    out = _Hull(discs[ends]).beyond(discs)
    tolerance = BELT_TOLERANCE * float(discs[ends, 2].max())
    beyond = np.flatnonzero(out > tolerance)
    if beyond.size:
        runner = drums[beyond[0]].left[0]
        raise ScenarioError(
            f"{runner.shape.at}: drum[{runner.name}]",
            f"{len(beyond)} beyond the belt round the end drums",
            "must lie within the belt round the end drums: flippers have two",
        )
    rear, front = ends
    return drums[rear], drums[front]


def beyond_belt(outlines: list[Array], drums: list[Pair]) -> list[tuple[float, float]]:
    """[m] Return how far shapes reach out of the belt round drums, and how far but upwards.

    Both are 0 within what boxes may.

    Parameters
    ----------
    outlines : list of ndarray, shape (n, 2)
        [m] Corners of each in the side view.
    drums : list of Pair
        All that the belt bends round.
    """
    discs = _discs(drums)
    hull, tolerance = _Hull(discs), BELT_TOLERANCE * float(discs[:, 2].max())
    found = []
    for flat in outlines:
        points = np.column_stack([flat, np.zeros(len(flat))])
        out = [float(hull.beyond(points, highest).max()) for highest in (1.0, _UPWARDS)]
        found.append((out[0] if out[0] > tolerance else 0.0, out[1] if out[1] > tolerance else 0.0))
    return found


def _discs(drums: list[Pair]) -> Array:
    """[m] Return centres and radii, shape (n, 3)."""
    return np.array([[drum.x, drum.y, drum.radius] for drum in drums])


def _ends(discs: Array, along: Array, at: Where) -> tuple[int, int]:
    """Return which discs reach farthest back and forwards."""
    places = discs[:, :2] @ along
    rear, front = int((places - discs[:, 2]).argmin()), int((places + discs[:, 2]).argmax())
    if rear == front:
        raise ScenarioError(str(at), "one drum", "must have a drum at either end of a track")
    return rear, front


class _Hull:
    """How far a belt round discs reaches in every direction that matters.

    What reaches out of a straight run does so farthest at right angles to that, and what reaches
    out of an arc nearly as far in the nearest of many directions.
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
        # Of the tangents of any two discs, those that no other disc crosses are runs.
        is_run = reach.max(axis=0) <= reach[rows, np.arange(len(rows))] + FIT
        self.normals = np.concatenate([_NORMALS, normals[:, is_run]], axis=1)
        self.reach = (belt[:, :2] @ self.normals + belt[:, 2:]).max(axis=0)

    def beyond(self, discs: Array, highest: float = 1.0) -> Array:
        """[m] Return how far each disc reaches out of the belt; < 0 where it does not.

        Only directions that rise by `highest` at most count.
        """
        counts = self.normals[1] <= highest
        parts = np.array_split(discs, 1 + len(discs) // _AT_ONCE)
        out = [
            (part[:, :2] @ self.normals + part[:, 2:] - self.reach)[:, counts].max(axis=1)
            for part in parts
        ]
        return np.concatenate(out)
