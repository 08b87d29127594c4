"""Mass, centre of mass and moment of inertia: sums over all links."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Tree
from crawler2d.reading.arms import AtEnd
from crawler2d.reading.sides import Pair
from crawler2d.reading.tracks import Base
from crawler2d.reading.view import SideView

__all__ = ["Sum", "circulating", "summed"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sum:
    """Several links as one, in the chassis frame.

    Parameters
    ----------
    mass : float
        [kg] Their mass.
    center : tuple of float, shape (2,)
        [m] Their centre of mass.
    inertia : float
        [kg m^2] About that.
    """

    mass: float
    center: tuple[float, float]
    inertia: float


def summed(tree: Tree, view: SideView, base: Base, arms: Iterable[tuple[AtEnd, float]]) -> Sum:
    """Sum all links, with the flippers turned to angle 0, as the figures of a robot have them.

    Parameters
    ----------
    tree : Tree
        The model.
    view : SideView
        Its side view.
    base : Base
        Its chassis frame.
    arms : iterable of (AtEnd, float)
        The flippers, and 1 at the front or -1 at the rear.

    Returns
    -------
    Sum
        Of the whole robot.
    """
    mass = np.array([link.mass for link in tree.links])
    places = base.of(view.of(np.array([link.center for link in tree.links]))[:, :2])
    number = {link.name: index for index, link in enumerate(tree.links)}
    for end, sign in arms:
        for arm in end.pair.arms:
            pivot = base.of(arm.pivot[None, :2])[0]
            turn = _rotation(-sign * end.angle)
            for link in arm.links:
                index = number[link.name]
                places[index] = pivot + turn @ (places[index] - pivot)
    whole = float(mass.sum())
    center = mass @ places / whole if whole > 0.0 else np.zeros(2)
    own = sum(view.about_left(link.inertia) for link in tree.links)
    swung = float(mass @ ((places - center) ** 2).sum(axis=1))
    return Sum(mass=whole, center=(float(center[0]), float(center[1])), inertia=own + swung)


def _rotation(angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


def circulating(pairs: list[Pair]) -> tuple[float, bool]:
    """[kg] Return the mass that turns with the wheels: moment of inertia by radius squared.

    No body within a wheel's radius has more than its mass there, so no wheel counts for more; the
    second value says whether one would have.
    """
    total, is_excessive = 0.0, False
    for pair in pairs:
        for wheel in pair.both:
            own = wheel.inertia / wheel.radius**2
            is_excessive |= own > wheel.mass * (1.0 + 1e-6)
            total += min(own, wheel.mass)
    return total, is_excessive
