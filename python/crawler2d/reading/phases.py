"""How wheels of a track start turned: by a share of their number, and all by an offset."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.models.poses import Array

__all__ = ["Phases", "fitted", "round_belt", "wrapped"]

_EXPLAINED = 0.01
"""[-] A turn that leaves less than this share of what is off without one is there, be it small."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Phases:
    """How the wheels of a track start turned: wheel n by n times a share, and all by an offset.

    Parameters
    ----------
    share, offset : float
        [-] Of the angle between two grousers.
    off : float
        [-] The most by which a wheel starts turned otherwise.
    order : list of int
        Which wheel is the first, the second, ...
    """

    share: float
    offset: float
    off: float
    order: list[int]


def fitted(own: Array, orders: list[list[int]], tolerance: float) -> Phases:
    """Find how wheels are phased; in the first order, and without an offset, if that will do.

    Parameters
    ----------
    own : ndarray, shape (n,)
        [-] How far each wheel starts turned, in angles between two grousers.
    orders : list of list of int
        The orders in which they may be numbered.
    tolerance : float
        [-] What may be left.

    Examples
    --------
    >>> import numpy as np
    >>> round(fitted(np.array([0.3, 0.6, 0.9, 0.2]), [[0, 1, 2, 3]], 1e-3).share, 9)
    0.3
    """
    plain, turned = (
        [_fit(own[order], order, has_offset=has_offset) for order in orders]
        for has_offset in (False, True)
    )
    for each, other in zip(plain, turned, strict=True):
        if each.off <= tolerance:
            # A frame that is hardly tilted turns all by as little, which the share must not take
            # up. Any two wheels have a turn and a share.
            is_turned = len(own) > 2 and other.off < _EXPLAINED * each.off
            return other if is_turned else each
    best = min(plain + turned, key=lambda each: each.off)
    return next((each for each in turned if each.off <= tolerance), best)


def round_belt(places: Array, own: Array) -> list[int]:
    """Return the order of wheels along a belt round them, up at the rear and forward on top.

    The first is where the phases of neighbours break off.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        [m] Their axles.
    own : ndarray, shape (n,)
        [-] How far each starts turned, in angles between two grousers.
    """
    away = places - places.mean(axis=0)
    loop = np.argsort(-np.arctan2(away[:, 1], away[:, 0]), kind="stable")
    ahead = wrapped(np.roll(own[loop], -1) - own[loop])
    usual = ahead[np.abs(wrapped(ahead[:, None] - ahead)).sum(axis=1).argmin()]
    breaks = np.abs(wrapped(ahead - usual))
    last = int(breaks.argmax())
    if breaks[last] < 1e-6:  # it closes on itself: the first is the one that says so
        last = int(np.abs(wrapped(own[loop] - usual)).argmin()) - 1
    return [int(k) for k in np.roll(loop, -(last + 1))]


def wrapped(shares: Any) -> Any:
    """Return shares of the angle between two grousers as the nearest to none, from -0.5 to 0.5."""
    return (np.asarray(shares) + 0.5) % 1.0 - 0.5


def _fit(own: Array, order: list[int], *, has_offset: bool) -> Phases:
    """Find the share, and the offset if there may be one, that comes closest."""
    number = np.arange(1, len(own) + 1)
    # Fine enough that the best of these is on the slope of the best of all.
    shares = np.arange(16 * len(own)) / (16 * len(own))
    sums = np.exp(2j * math.pi * (own - shares[:, None] * number)).sum(axis=1)
    best = int((np.abs(sums) if has_offset else sums.real).argmax())
    share, offset = float(shares[best]), 0.0
    if has_offset:
        offset = float(np.angle(sums[best])) / (2.0 * math.pi)
    left = wrapped(own - offset - share * number)
    if has_offset and len(own) > 1:
        more, rest = np.polyfit(number, left, 1)
        share, offset = share + more, offset + rest
    elif not has_offset:
        share += float(number @ left / (number @ number))
    share %= 1.0
    if 1.0 - share < 1e-9:  # a turn of nothing, but for rounding
        share = 0.0
    off = float(np.abs(wrapped(own - offset - share * number)).max())
    return Phases(share=float(share), offset=float(offset), off=off, order=order)
