"""Joints that SDF and URDF write in the same words."""

from __future__ import annotations

import math
from dataclasses import replace

from crawler2d.models.poses import Array, Pose, unit
from crawler2d.models.tree import Joint
from crawler2d.models.where import Where
from crawler2d.reading.elements import Element

__all__ = ["joint_of", "moving"]

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}

Limit = tuple[float, Where]
"""A limit of effort or speed, and its line; a negative or an infinite one is none."""


def joint_of(element: Element, parent: str, child: str, pose: Pose) -> Joint:
    """Return a joint as far as its axis plays no part.

    Parameters
    ----------
    element : Element
        The joint.
    parent, child : str
        The links that it joins.
    pose : Pose
        Of its frame.
    """
    kind = element.attribute("type")
    return Joint(
        name=element.attribute("name"),
        kind=_KINDS.get(kind, kind),
        parent=parent,
        child=child,
        place=pose.place,
        axis=pose.turn[:, 2],
        at=element.where,
        effort_at=element.where,
        velocity_at=element.where,
    )


def moving(
    joint: Joint,
    element: Element,
    along: Array,
    *,
    bounds: tuple[float, float],
    effort: Limit | None,
    velocity: Limit | None,
    stiffness: float = 0.0,
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
    stiffness : float
        [N m/rad] or [N/m] Of a spring.

    Raises
    ------
    ScenarioError
        If the axis has no direction, or the lower limit is above the upper.
    """
    axis, (lower, upper) = unit(along), bounds
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
        effort_at=effort[1] if effort else joint.at,
        velocity_at=velocity[1] if velocity else joint.at,
    )


def _figure(limit: Limit | None) -> float | None:
    return limit[0] if limit is not None and 0.0 <= limit[0] < math.inf else None
