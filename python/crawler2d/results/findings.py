"""What there is to find of a stop, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from crawler2d.common.table import Table
from crawler2d.results.outcome import Outcome

__all__ = ["Condition", "Counterfactual", "Findings", "Intrusion", "Mechanism"]


class Mechanism(StrEnum):
    """How the ground inside the track is held; the first that fits."""

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
        The edge that stands out and reaches deepest.
    edges : tuple of int
        All edges in the piece, from the left.
    bodies : tuple of int
        The bodies on either side of the deepest point, in order of belt travel.
    body_kinds : tuple of int
        What these are, as in the contacts.
    depth, root_depth : float
        [m] Deepest reach below the belt round the circumscribed and the root circles.
    x, y : float
        [m] The deepest point.
    force : float
        [N] Normal force on the piece, in the mean.
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
    """How a closed belt fares in the pose of a stop; `Run.counterfactual` tries it.

    Attributes
    ----------
    freed : bool
        It advanced by more than `criteria.escape_distance` within `criteria.escape_time`: the stop
        was the wheels' fault, *unnatural*.
    distance : float
        [m] How far it got along the command in that time.
    time : float
        [s] How long it took to get away; inf if it did not.
    outcome : Outcome
        How it stood in the end.
    """

    freed: bool
    distance: float
    time: float
    outcome: Outcome

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Counterfactual:
        """Read what the core says."""
        return cls(**{**plain, "outcome": Outcome(plain["outcome"])})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Findings:
    """What a `Diagnosis` holds, which says what each of them is."""

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
