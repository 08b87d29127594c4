"""The findings about a stop, as data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Literal

from crawler2d.common.bodies import BodyKind
from crawler2d.common.table import Table
from crawler2d.results.glossary import MECHANISMS, listed
from crawler2d.results.outcome import Outcome

__all__ = ["Findings", "Intrusion", "Mechanism", "Tried"]


class Mechanism(StrEnum):
    """How the ground inside the track is held; the first that applies, in this order."""

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
    Mechanism.__doc__ += "\n\n" + listed(MECHANISMS)


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
    side : {"both", "left", "right"}
        Which track it is in; "both" where the tracks meet the same ground.
    carrier : {"chassis", "front flipper", "rear flipper"}
        What carries that track.
    depth, root_depth : float
        [m] Depth inside the belt round the circumscribed circles and round the root circles.
    x, y : float
        [m] The deepest point.
    force : float
        [N] Mean normal force of the track on the piece; what the belly rests on jams nothing.
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
class Tried:
    """What came of one change at a stop; see `Trial`.

    Attributes
    ----------
    name : str
        What was changed.
    freed : bool
        Whether that freed the robot: within `duration` it cleared, or got ahead of its greatest x
        by `criteria.escape_distance` and did not tip over, leave the terrain or throw its track
        afterwards.
    starts, freeing : int
        From how many instants it was tried, and from how many of these it freed the robot. A robot
        that stands still is tried from one; one that rattles from up to five, a fifth of a stop
        window apart, of which four must free it.
    distance : float
        [m] How far the robot got ahead of its greatest x; less than 0 if it did not come so far.
    time : float
        [s] How long it took to get free; inf if it did not.
    outcome : Outcome
        How it ended: cleared, tipped over, timed out while it was moving, or what was seen of the
        next stop, of which nothing was tried.
    jammed : bool
        Whether it ended in a stop with ground jammed between two bodies of a track.
    intrusion : Intrusion or None
        The most loaded ground inside the track in that stop: where it is jammed, or else anywhere.
    duration : float
        [s] For how long it was tried, unless it ended before: `criteria.escape_time` plus the time
        in which it would drive `criteria.escape_distance` as commanded, or from the start of the
        run on as long as the run may last.
    position : tuple of float
        [m] Of the chassis frame at its end.
    chassis_angle : float
        [rad] Chassis angle then, nose up > 0.
    flipper_angles : tuple of float
        [rad] Of each pair of flippers then, the front first, upwards > 0.
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
    def from_core(cls, plain: Mapping[str, Any]) -> Tried:
        """Convert the dictionary that the core returns."""
        values = {"intrusion": None, **plain, "outcome": Outcome(plain["outcome"])}
        if values["intrusion"] is not None:
            values["intrusion"] = Intrusion(**values["intrusion"])
        return cls(**values)

    @property
    def is_from_the_start(self) -> bool:
        """Whether the robot started where its run did, and not in the pose of the stop."""
        return self.name.endswith(", from the start")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Findings:
    """The fields of a `Diagnosis`, which documents them, and what follows from them."""

    outcome: Outcome
    symptom: Outcome
    passing: bool
    trials: tuple[Tried, ...]
    jammed: bool
    mechanism: Mechanism | None
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

    @property
    def certificate(self) -> float | None:
        """[-] The imbalance if it proves that forces can balance the stop, else None."""
        return self.imbalance if self.certified else None

    @property
    def freed_by(self) -> tuple[str, ...]:
        """Names of the trials made so far that freed the robot."""
        return tuple(tried.name for tried in self.trials if tried.freed)

    @property
    def reached_by_belt(self) -> bool | None:
        """Whether a belt came as far as the robot from the start; None if none was tried."""
        starts = [tried.distance >= 0.0 for tried in self.trials if tried.is_from_the_start]
        return any(starts) if starts else None

    @property
    def belly_side(self) -> Literal["", "underside", "tail", "nose"]:
        """Where the ground pushes against the belly; "" if it does not.

        At the tail or the nose if it pushes along the belly more than away from its underside: so
        it does when a robot stands on the tail of its hull.
        """
        on_it = self.contacts["body_kind"] == BodyKind.BELLY
        force = self.contacts["normal_force"][on_it]
        if not force.size:
            return ""
        x, y = (force @ self.contacts[name][on_it] for name in ("normal_x", "normal_y"))
        sine, cosine = math.sin(self.chassis_angle), math.cos(self.chassis_angle)
        along, across = cosine * x + sine * y, cosine * y - sine * x
        if abs(along) <= across:
            return "underside"
        return "tail" if along > 0.0 else "nose"
