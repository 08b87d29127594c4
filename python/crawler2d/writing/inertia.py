"""Masses in side view, what is left of a whole without its parts, and estimates across it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array

__all__ = ["Part", "rest", "tensor"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Part:
    """A body in the chassis frame of the side view.

    Parameters
    ----------
    mass : float
        [kg] Its mass.
    center : ndarray, shape (2,)
        [m] Its centre of mass.
    inertia : float
        [kg m^2] About that.
    """

    mass: float
    center: Array
    inertia: float


def rest(whole: Part, parts: Iterable[Part]) -> Part | None:
    """Return what is left of a whole without its parts; None if no body can be that.

    Examples
    --------
    >>> rod = Part(mass=3.0, center=np.zeros(2), inertia=0.5)
    >>> tip = Part(mass=1.0, center=np.array([0.5, 0.0]), inertia=0.0)
    >>> left = rest(rod, [tip])
    >>> left.mass, left.center.tolist(), round(left.inertia, 3)
    (2.0, [-0.25, 0.0], 0.125)
    """
    parts = list(parts)
    mass = whole.mass - sum(part.mass for part in parts)
    if not mass >= _LEAST * whole.mass:
        return None
    moment: Array = whole.mass * whole.center - sum(
        (part.mass * part.center for part in parts), np.zeros(2)
    )
    center = moment / mass
    inertia = whole.inertia - mass * _squared(center - whole.center)
    for part in parts:
        inertia -= part.inertia + part.mass * _squared(part.center - whole.center)
    if not inertia >= _LEAST * whole.inertia:
        return None
    return Part(mass=mass, center=center, inertia=inertia)


def tensor(part: Part, *, length: float, height: float, width: float) -> Array:
    """[kg m^2] Widen a moment of inertia to three axes: x along it, y across, z up.

    The moment about y is that of the part. The others are estimates: the squares of x and of z
    share it as in a uniform box of this length and height, and the mass is spread evenly over the
    width. So a body with these three moments exists, whatever the sizes.
    """
    along = part.inertia * length**2 / (length**2 + height**2)
    across = part.mass * width**2 / 12.0
    moments: Array = np.diag(
        [part.inertia - along + across, part.inertia, along + across],
    )
    return moments


# A body with less than this share of the mass or the moment of inertia would make a simulation
# of the whole stiff, if it is possible at all.
_LEAST = 0.01


def _squared(vector: Array) -> float:
    return float(vector @ vector)
