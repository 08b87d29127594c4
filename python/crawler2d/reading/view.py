"""The side view of a model: which way is forward, and which way is across."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.tree import Tree
from crawler2d.reading.rounds import PARALLEL, below, is_parallel
from crawler2d.reading.surfaces import Surfaces
from crawler2d.reading.wheels import wheel_of

__all__ = ["SideView", "side_view"]

_UP = np.array([0.0, 0.0, 1.0])
# [rad] An axis so close to one of the model's is meant to be it: files have 3.1415 for pi.
_SNAP = 0.01
_FORWARDS = {
    f"{sign}{name}": (1.0 if sign == "+" else -1.0) * np.eye(3)[axis]
    for sign in "+-"
    for axis, name in enumerate("xy")
}
_FRONT, _REAR = re.compile(r"front|fore"), re.compile(r"rear|back|hind")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SideView:
    """Turns points of the model into x forward, y up and z to the left.

    Parameters
    ----------
    forward, left : ndarray, shape (3,)
        Directions in the frame of the model, whose z axis is up.
    reason : str
        By which rule they were found.
    """

    forward: Array
    left: Array
    reason: str

    @property
    def up(self) -> Array:
        """Direction up in the frame of the model."""
        return _UP

    def of(self, point: Array) -> Array:
        """[m] Return forward, up and left of a point, shape (3,), or of several, shape (n, 3)."""
        turned: Array = np.asarray(point) @ np.stack([self.forward, _UP, self.left], axis=1)
        return turned

    def about_left(self, tensor: Array) -> float:
        """[kg m^2] Return the moment of inertia about the lateral axis."""
        return float(self.left @ tensor @ self.left)


def side_view(tree: Tree, surfaces: Surfaces, forward: str | None) -> SideView:
    """Find the lateral axis from what turns, and the forward sign from the names.

    Parameters
    ----------
    tree : Tree
        The model.
    surfaces : Surfaces
        Those that move.
    forward : {"+x", "-x", "+y", "-y"}, optional
        The direction that is forward; None finds it.

    Returns
    -------
    SideView
        With the rule by which it was found.

    Raises
    ------
    ScenarioError
        If nothing turns, what turns has no common lateral axis, or forward cannot be told.
    """
    lateral = _lateral(tree, surfaces)
    ahead = np.cross(lateral, _UP)
    if forward is not None:
        if forward not in _FORWARDS:
            rule = f"must be one of {', '.join(_FORWARDS)}, or None"
            raise ScenarioError("forward", forward, rule)
        if not is_parallel(_FORWARDS[forward], ahead):
            rule = f"must be across the axes of the wheels, which point along {_words(lateral)}"
            raise ScenarioError("forward", forward, rule)
        sign, reason = float(np.sign(_FORWARDS[forward] @ ahead)), "forward was given"
    elif named := _named_ahead(tree, ahead):
        sign, reason = named
    elif is_parallel(ahead, np.array([1.0, 0.0, 0.0])):
        sign, reason = float(np.sign(ahead[0])), "by convention, x is forward"
    else:
        rule = 'must be given, as "+y" or "-y": no name has front or rear'
        raise ScenarioError("forward", forward, rule)
    ahead = sign * ahead
    return SideView(forward=ahead, left=np.cross(_UP, ahead), reason=reason)


def _lateral(tree: Tree, surfaces: Surfaces) -> Array:
    """Return the direction of the most axes of wheels and of the drums of tracks, horizontal."""
    hanging = below(tree)
    axes = [j.axis for j in tree.joints.values() if wheel_of(tree, j, hanging)]
    axes += [
        shape.axis
        for link in tree.links
        for shape in link.shapes
        if shape.kind in ("cylinder", "capsule") and shape in surfaces.moved
    ]
    if not axes:
        rule = (
            "must have wheels, which are round collision shapes on joints that turn without limit,"
            " bare or with equal grousers evenly round them, or tracks that a plugin moves or"
            " tracks= names"
        )
        kinds = [shape.kind for link in tree.links for shape in link.shapes]
        count = sum(kind in ("cylinder", "capsule", "sphere") for kind in kinds)
        got = f"{count} round shapes, none of them such" if count else "no round shape"
        raise ScenarioError(str(tree.at), got, rule)
    rows = np.array(axes)
    alike = np.abs(rows @ rows.T) >= math.cos(PARALLEL)
    most = rows[alike[alike.sum(axis=0).argmax()]]
    # Of each axis its outer product, which has no sign: the mean of those has their direction.
    lateral: Array = np.linalg.eigh(most.T @ most)[1][:, -1]
    for axis in np.eye(3):
        if np.linalg.norm(np.cross(lateral, axis)) <= _SNAP:
            lateral = axis
    if abs(lateral @ _UP) > _SNAP:
        got = _words(lateral)
        raise ScenarioError(str(tree.at), got, "must have wheels with horizontal axes")
    flat: Array = lateral - (lateral @ _UP) * _UP
    flat /= np.linalg.norm(flat)
    return flat


def _named_ahead(tree: Tree, ahead: Array) -> tuple[float, str] | None:
    """Return on which side the links called front are; None if that is not clear."""
    along: dict[bool, list[float]] = {True: [], False: []}
    for link in tree.links:
        name = link.name.lower()
        is_front, is_rear = bool(_FRONT.search(name)), bool(_REAR.search(name))
        if is_front != is_rear:
            along[is_front].append(float(link.pose.place @ ahead))
    if not along[True] or not along[False]:
        return None
    difference = float(np.mean(along[True]) - np.mean(along[False]))
    if abs(difference) < 1e-6:  # [m] they are in the same place
        return None
    return float(np.sign(difference)), "links called front are ahead of those called rear"


def _words(axis: Array) -> str:
    return f"({', '.join(f'{round(part, 3) + 0.0:g}' for part in axis)})"
