"""The belt round the drums of a track that a plugin moves."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.where import Where
from crawler2d.reading.sides import Pair

__all__ = ["belt_ends"]

_BEYOND = 0.02
"""[-] How far anything may reach out of the belt, as a share of the larger radius: what is drawn as
boxes between drums only nears their tangents. Those of Gazebo's example do so by 1.2 %."""

_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
_NORMALS = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])


def belt_ends(
    drums: list[Pair], bars: list[Array], *, along: Array, at: Where
) -> tuple[Pair, Pair]:
    """Return the rearmost and the foremost drum, if the belt round all is one round these two.

    Parameters
    ----------
    drums : list of Pair
        From the rear to the front, at least one.
    bars : list of ndarray, shape (n, 3)
        [m] Corners of what else is moved.
    along : ndarray, shape (2,)
        Direction from the rear end to the front end, roughly.
    at : Where
        Line of the model, for errors.

    Raises
    ------
    ScenarioError
        If there is one drum only, or something reaches out.
    """
    places = {drum: float(np.array([drum.x, drum.y]) @ along) for drum in drums}
    rear = min(drums, key=lambda drum: places[drum] - drum.radius)
    front = max(drums, key=lambda drum: places[drum] + drum.radius)
    if rear is front:
        raise ScenarioError(str(at), "one drum", "must have a drum at either end of a track")
    reach = np.maximum(_reach(rear), _reach(front))
    tolerance = _BEYOND * max(rear.radius, front.radius)
    out = [drum for drum in drums if (_reach(drum) - reach).max() > tolerance]
    if out:
        runner = out[0].left[0]
        raise ScenarioError(
            f"{runner.shape.at}: drum[{runner.name}]",
            f"{len(out)} beyond the belt round the end drums",
            "must lie within the belt round the end drums: tracks round more are not read",
        )
    for corners in bars:
        beyond = float((corners[:, :2] @ _NORMALS - reach).max())
        if beyond > tolerance:
            rule = f"must lie within the belt round the end drums, within {1e3 * tolerance:g} mm"
            raise ScenarioError(str(at), f"a moved shape {1e3 * beyond:.3g} mm beyond it", rule)
    return rear, front


def _reach(drum: Pair) -> Array:
    """[m] Return how far a drum reaches in each direction."""
    reach: Array = np.array([drum.x, drum.y]) @ _NORMALS + drum.radius
    return reach
