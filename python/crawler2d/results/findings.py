"""The findings about a stop, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from crawler2d.common.table import Table
from crawler2d.results.outcome import Outcome

__all__ = ["Condition", "Counterfactual", "Findings", "Intrusion", "Mechanism"]


class Mechanism(StrEnum):
    """How the ground inside the track is held; the first that applies, in this order."""

    BELLIED = "bellied"
    FOULED = "fouled"
    PINCHED = "pinched"
    INTERLOCKED = "interlocked"
    BLOCKED = "blocked"
    STRADDLED = "straddled"
    UNDERCUT = "undercut"


class Condition(StrEnum):
    """A condition of an equilibrium that can be relaxed."""

    POCKET = "pocket"
    BELLY = "belly"
    TORQUE = "torque"
    FRICTION = "friction"


@dataclass(frozen=True, slots=True, kw_only=True)
class Intrusion:
    """A connected piece of ground inside the track.

    Attributes
    ----------
    edge : int
        The convex edge that reaches deepest.
    edges : tuple of int
        All edges of the piece, from left to right.
    bodies : tuple of int
        The bodies on either side of the deepest point, in order of belt travel.
    body_kinds : tuple of int
        Kinds of these bodies, as in the contacts.
    depth, root_depth : float
        [m] Depth inside the belt round the circumscribed circles and round the root circles.
    x, y : float
        [m] The deepest point.
    force : float
        [N] Mean normal force on the piece.
    """

    edge: int
    edges: tuple[int, ...]
    bodies: tuple[int, int]
    body_kinds: tuple[int, int]
    depth: float
    root_depth: float
    x: float
    y: float
    force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Counterfactual:
    """How a closed belt fares in the pose of a stop; see `Run.counterfactual`.

    Attributes
    ----------
    freed : bool
        Whether it advanced more than `criteria.escape_distance` within `criteria.escape_time`. If
        so, the wheels caused the stop: it is *unnatural*.
    distance : float
        [m] How far it advanced in that time, in the commanded direction.
    time : float
        [s] How long it took to escape; inf if it did not.
    outcome : Outcome
        Its outcome at the end of that time.
    """

    freed: bool
    distance: float
    time: float
    outcome: Outcome

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Counterfactual:
        """Convert the dictionary that the core returns."""
        return cls(**{**plain, "outcome": Outcome(plain["outcome"])})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Findings:
    """The fields of a `Diagnosis`, which documents them."""

    outcome: Outcome
    mechanism: Mechanism | None
    cause: tuple[tuple[Condition, ...], ...]
    seized_at_tips: bool
    time: float
    since: float
    position: tuple[float, float]
    chassis_angle: float
    intrusion: Intrusion | None
    contacts: Table
    belly_share: float
    sliding_share: float
    stalled_share: float
    progress: float
    stationary: bool
    imbalance: float | None
    certified: bool
    escape_force: float | None
    free_escape_force: float | None
    counterfactual: Counterfactual | None
