"""Whether forces could hold a stop, whatever engine came to it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

__all__ = ["Balance", "Pull"]

_TRIED = (0.02, 5.0)
"""Factors of the friction between which the core searches."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pull:
    """A contact that would have to hold the robot down.

    Attributes
    ----------
    body : int
        As in the contacts.
    point : tuple of float
        [m] Where.
    force : float
        [N] By how much.
    """

    body: int
    point: tuple[float, float]
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """Whether the pose of a stop is an equilibrium of rigid bodies with Coulomb friction.

    Only pose, contacts and what slides there are taken from the run; the forces are found anew, by
    linear programming: sliding contacts have friction at its limit, against their slip, others any
    within it; motors have any force within theirs, and the ground only pushes.

    Attributes
    ----------
    imbalance : float
        [-] Smallest residual force that any choice of forces leaves, as a share of the weight.
    tolerance : float
        [-] Up to which share of the weight it counts as none: `criteria.imbalance`, or
        `criteria.mean_imbalance` of a robot that does not stand still.
    holds_between : tuple of two floats, or None
        [-] By which factors of the friction the pose is an equilibrium: the interval nearest to 1,
        searched from 0.02 to 5; beyond these 0 and inf. None if it is one at none of them.
    pulls : tuple of Pull
        The contacts that would have to pull, in the balance in which they pull least; () in an
        equilibrium.
    """

    imbalance: float
    tolerance: float
    holds_between: tuple[float, float] | None
    pulls: tuple[Pull, ...]

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Balance:
        """Convert the dictionary that the core returns."""
        pulls = tuple(
            Pull(body=body, point=(x, y), force=force) for body, (x, y), force in plain["pulls"]
        )
        between = plain["holds_between"]
        return cls(
            imbalance=plain["imbalance"],
            tolerance=plain["tolerance"],
            holds_between=between,
            pulls=pulls,
        )

    @property
    def holds(self) -> bool:
        """Whether it is an equilibrium."""
        return self.imbalance <= self.tolerance

    def __str__(self) -> str:
        """Say it in a few words."""
        return self.said([f"body {pull.body}" for pull in self.pulls])

    def said(self, names: Sequence[str]) -> str:
        """Say it, with the names of the bodies that would have to pull."""
        if self.holds:
            return f"an equilibrium{self._where()}"
        said = (
            f"no equilibrium: the smallest residual is {100 * self.imbalance:.2g} % of the weight"
        )
        for name, pull in zip(names, self.pulls, strict=True):
            said += f"; {name} would have to pull with {pull.force:.0f} N"
        if self.holds_between is None:
            return f"{said}; no friction from {_TRIED[0]:g} to {_TRIED[1]:g} times makes it one"
        return f"{said}; it would be one{self._where()}"

    def _where(self) -> str:
        """Say at which friction."""
        if self.holds_between is None:
            return ""
        low, high = self.holds_between
        if low == 0.0 and math.isinf(high):
            return " at any friction tried"
        if low == 0.0:
            return f" up to {high:.2f} times the friction"
        if math.isinf(high):
            return f" from {low:.2f} times the friction on"
        return f" from {low:.2f} to {high:.2f} times the friction"
