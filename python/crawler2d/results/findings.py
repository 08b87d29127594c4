"""Findings about a stop: intrusions, trials, and its balance of forces."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from crawler2d.results.outcome import MECHANISMS, Outcome, glossary_text

__all__ = ["Balance", "Intrusion", "Mechanism", "Pull", "TrialResult"]


class Mechanism(StrEnum):
    """How ground inside the track is held; the first that applies, in this order."""

    FOULED = "fouled"
    PINCHED = "pinched"
    INTERLOCKED = "interlocked"
    BLOCKED = "blocked"
    STRADDLED = "straddled"
    UNDERCUT = "undercut"

    @property
    def meaning(self) -> str:
        """What it means, in a few words."""
        return MECHANISMS[self.value]


if Mechanism.__doc__ is not None:  # not so with python -OO
    Mechanism.__doc__ += "\n\n" + glossary_text(MECHANISMS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Intrusion:
    """A connected piece of ground inside the track.

    Attributes
    ----------
    edge : int
        The deepest convex edge.
    edges : tuple of int
        All edges of the piece, from left to right.
    bodies : tuple of int
        The bodies on either side of the deepest point, in order of belt travel.
    body_kinds : tuple of int
        Kinds of these bodies, as in the contacts.
    side : {"both", "left", "right"}
        The track that it is in; "both" if the tracks are on the same ground.
    carrier : {"chassis", "front flipper", "rear flipper"}
        The part that carries that track.
    depth, root_depth : float
        [m] Depths inside the belts round the circumscribed circles and the root circles.
    x, y : float
        [m] Position of the deepest point.
    force : float
        [N] Mean normal force of the track, without the belly, on the piece.
    """

    edge: int
    edges: tuple[int, ...]
    bodies: tuple[int, int]
    body_kinds: tuple[int, int]
    side: str
    carrier: str
    depth: float
    root_depth: float
    x: float
    y: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialResult:
    """The result of one change at a stop; see `Trial`.

    Attributes
    ----------
    name : str
        What was changed.
    freed : bool
        Whether that freed the robot: within `duration` it cleared, or got
        `criteria.escape_distance` beyond its greatest x, and did not tip over, leave the terrain or
        throw its track afterwards.
    starts, freeing : int
        Number of instants from which it was tried, and how many of these freed the robot. A
        stationary robot is tried from one; a rattling robot from up to five, a fifth of a stop
        window apart, of which four must free it.
    distance : float
        [m] Advance beyond the greatest x before the stop; below 0 if it fell short.
    time : float
        [s] Time to get free; inf if it did not.
    outcome : Outcome
        How it ended: cleared, tipped over, timed out while moving, or the symptom of the next stop,
        without trials.
    jammed : bool
        Whether it ended in a stop with ground jammed between two bodies of a track.
    intrusion : Intrusion or None
        The most loaded ground inside the track in that stop: the jammed one if `jammed`, else any.
    duration : float
        [s] Length of the trial, unless it ended early: `criteria.escape_time` plus the time needed
        to drive `criteria.escape_distance` as commanded, or, from the start of the run, the
        scenario's duration.
    position : tuple of float
        [m] Position of the chassis frame at the end.
    chassis_angle : float
        [rad] Chassis angle at the end, nose up > 0.
    flipper_angles : tuple of float
        [rad] Angle of each pair of flippers at the end, front first, upwards > 0.
    """

    name: str
    freed: bool
    starts: int
    freeing: int
    distance: float
    time: float
    outcome: Outcome
    jammed: bool
    intrusion: Intrusion | None
    duration: float
    position: tuple[float, float]
    chassis_angle: float
    flipper_angles: tuple[float, ...]

    @classmethod
    def from_core(cls, result: Mapping[str, Any]) -> TrialResult:
        """Convert the dictionary that the core returns."""
        values = {"intrusion": None, **result, "outcome": Outcome(result["outcome"])}
        if values["intrusion"] is not None:
            values["intrusion"] = Intrusion(**values["intrusion"])
        return cls(**values)

    @property
    def is_from_the_start(self) -> bool:
        """Whether it began at the start of the run instead of the pose of the stop."""
        return self.name.endswith(", from the start")


_TRIED = (0.02, 5.0)
"""Range of factors of the friction that the core searches."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pull:
    """A contact that would have to pull for equilibrium.

    Attributes
    ----------
    body : int
        Number of the body, as in the contacts.
    point : tuple of float
        [m] Position.
    force : float
        [N] Pulling force.
    """

    body: int
    point: tuple[float, float]
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """Whether the pose of a stop is an equilibrium of rigid bodies with Coulomb friction.

    Only pose, contacts and their sliding come from the run; linear programming finds the forces.
    Sliding contacts have friction at its limit, against their slip; other contacts any friction
    within the limit; motors any force within theirs; and the ground only pushes.

    Attributes
    ----------
    imbalance : float
        [-] Smallest residual force over all admissible forces, as a fraction of the weight.
    tolerance : float
        [-] Largest imbalance of an equilibrium: `criteria.imbalance`, or `criteria.mean_imbalance`
        for a robot that is not stationary.
    holds_between : tuple of two floats, or None
        [-] Factors of the friction for which the pose is an equilibrium: the interval nearest to 1,
        searched from 0.02 to 5; 0 and inf if it extends beyond. None if there is none.
    pulls : tuple of Pull
        The contacts that would have to pull, for the balance with the least pull; () in an
        equilibrium.
    """

    imbalance: float
    tolerance: float
    holds_between: tuple[float, float] | None
    pulls: tuple[Pull, ...]

    @classmethod
    def from_core(cls, result: Mapping[str, Any]) -> Balance:
        """Convert the dictionary that the core returns."""
        pulls = (Pull(body=body, point=(x, y), force=f) for body, (x, y), f in result["pulls"])
        names = ("imbalance", "tolerance", "holds_between")
        return cls(pulls=tuple(pulls), **{name: result[name] for name in names})

    @property
    def holds(self) -> bool:
        """Whether it is an equilibrium."""
        return self.imbalance <= self.tolerance

    def __str__(self) -> str:
        """Describe it briefly."""
        return self.describe([f"body {pull.body}" for pull in self.pulls])

    def describe(self, names: Sequence[str]) -> str:
        """Describe it, with the names of the bodies that would have to pull."""
        if self.holds:
            return f"an equilibrium{self._friction_range()}"
        text = (
            f"no equilibrium: the smallest residual is {100 * self.imbalance:.2g} % of the weight"
        )
        for name, pull in zip(names, self.pulls, strict=True):
            text += f"; {name} would have to pull with {pull.force:.0f} N"
        if self.holds_between is None:
            return f"{text}; no friction from {_TRIED[0]:g} to {_TRIED[1]:g} times makes it one"
        return f"{text}; it would be one{self._friction_range()}"

    def _friction_range(self) -> str:
        """Describe the range of friction for which it holds."""
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
