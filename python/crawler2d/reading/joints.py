"""Joints that SDF and URDF write in the same words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array, Pose, unit
from crawler2d.models.tree import Joint
from crawler2d.models.where import Where
from crawler2d.reading.elements import Element
from crawler2d.reading.telling import Doubt

__all__ = ["Limit", "joint_of", "moving", "settled"]

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}

Limit = tuple[float, Where]
"""A figure of a joint and its line. A negative or infinite limit of effort or speed is none."""


def joint_of(element: Element, name: str, parent: str, child: str, pose: Pose) -> Joint:
    """Return a joint as far as its axis plays no part.

    Parameters
    ----------
    element : Element
        The joint.
    name : str
        Its name.
    parent, child : str
        The links that it joins.
    pose : Pose
        Of its frame.
    """
    kind = element.attribute("type")
    return Joint(
        name=name,
        kind=_KINDS.get(kind, kind),
        parent=parent,
        child=child,
        place=pose.place,
        axis=pose.turn[:, 2],
        at=element.where,
        effort_at=element.where,
        velocity_at=element.where,
        dynamics_at=element.where,
    )


def settled(
    made: Joint, moves: Callable[[], Joint], *, carries: bool, doubts: list[Doubt]
) -> Joint:
    """Return a joint that moves, or a fixed one where what is wrong with it makes no difference.

    Parameters
    ----------
    made : Joint
        What `joint_of` made of it.
    moves : callable
        Returns it with its axis and limits, or raises what is wrong with them.
    carries : bool
        Whether anything that hangs on it collides.
    doubts : list of Doubt
        Where it is noted.
    """
    try:
        return moves()
    except ScenarioError as error:
        if carries:
            raise
        reason = f"is taken as fixed, for nothing on its joint collides: {error.rule}"
        doubts.append((error.path, error.value, reason))
        return replace(made, kind="fixed")


def moving(
    joint: Joint,
    element: Element,
    along: Array,
    *,
    bounds: tuple[float, float],
    effort: Limit | None,
    velocity: Limit | None,
    dynamics: Mapping[str, Limit],
) -> Joint:
    """Return a joint with its axis and limits.

    Parameters
    ----------
    joint : Joint
        What `joint_of` made of it.
    element : Element
        That errors are about.
    along : ndarray, shape (3,)
        Along its axis, of any length.
    bounds : tuple of float
        [rad] or [m] The lower and the upper limit.
    effort, velocity : Limit or None
        As the file has them.
    dynamics : mapping of str to Limit
        "stiffness", "damping" and "friction" as far as the file has them.

    Raises
    ------
    ScenarioError
        If a joint that is not locked has an axis without a direction, or the lower limit is above
        the upper.
    """
    axis, (lower, upper) = unit(along), bounds
    stiffness, damping, friction = (
        dynamics[name][0] if name in dynamics else 0.0
        for name in ("stiffness", "damping", "friction")
    )
    if axis is None and lower == upper:
        return replace(joint, kind="fixed")  # locked, so it needs none
    if axis is None:
        element.refuse("0 0 0", "must have an axis with a direction")
    if lower > upper:
        element.refuse(lower, f"must have a lower limit of at most the upper, {upper}")
    return replace(
        joint,
        axis=axis,
        lower=lower,
        upper=upper,
        effort=_figure(effort),
        velocity=_figure(velocity),
        stiffness=stiffness,
        damping=max(0.0, damping),
        friction=max(0.0, friction),
        effort_at=effort[1] if effort else joint.at,
        velocity_at=velocity[1] if velocity else joint.at,
        dynamics_at=next((where for _, where in dynamics.values()), joint.at),
    )


def _figure(limit: Limit | None) -> float | None:
    return limit[0] if limit is not None and 0.0 <= limit[0] < math.inf else None
