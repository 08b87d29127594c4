"""Why did it stop: outcome, mechanism and cause of a stop, with the figures that show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import Any

from crawler2d._sentence import sentence
from crawler2d.outcome import Outcome
from crawler2d.table import Table

__all__ = ["Condition", "Counterfactual", "Diagnosis", "Intrusion", "Mechanism"]


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
class Diagnosis:
    """Why a robot that was commanded to move did not; `Run.diagnosis` holds it.

    ``str(diagnosis)`` says it in a sentence. All forces, speeds and the pose are means over the
    last one to two stop windows before `time`.

    Attributes
    ----------
    outcome : Outcome
        What the stop is.
    mechanism : Mechanism or None
        How the most loaded ground inside the track is held, whether that is the cause or not; None
        if there is none, or one body sticks to it and turns with it.
    cause : tuple of tuple of Condition
        The smallest sets of conditions whose relaxation leaves no equilibrium: pockets closed,
        belly removed, torque limit lifted, friction doubled. More than one set is a tie; none means
        that there is no certificate, or that nothing of these frees it.
    seized_at_tips : bool
        Whether closing the pockets would end the equilibrium if the track reached to the
        circumscribed circles, so that ground between the grousers of one wheel is in a pocket, too.
    time, since : float
        [s] When the stop was looked at, and since when it has lasted.
    position : tuple of float
        [m] Of the chassis frame.
    chassis_angle : float
        [rad] Nose up > 0.
    intrusion : Intrusion or None
        The most loaded ground inside the track, if loaded by more than `criteria.intrusion_load`.
    contacts : Table
        What bears: the columns of `Run.contacts` without `time` and `penetration`, and `slides`,
        `in_pocket`.
    belly_share : float
        [-] Share of the lift that the belly has.
    sliding_share : float
        [-] Share of the normal forces at contacts that slide at their friction limit.
    stalled_share : float
        [-] Share of the motors that bear on the ground which stand at their torque limit.
    progress : float
        [-] Share of the commanded distance made in the last stop window.
    stationary : bool
        The pose did not change at all.
    imbalance : float or None
        [-] Share of the weight by which the best choice of contact forces misses balance.
    certified : bool
        The imbalance is within the criteria: the pose may be an equilibrium.
    escape_force, free_escape_force : float or None
        [N] Largest push at the centre of mass along the command that can be balanced: here or
        within the next 5 mm, while surfaces slide on and motors push as they do; and here, if every
        contact and motor could hold within its limits. inf: wedged. None without a certificate, and
        for a state that rattles on.
    counterfactual : Counterfactual or None
        How a closed belt fares from here, where the run was simulated with ``counterfactual=True``.
    """

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

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Diagnosis:
        """Read what the core says."""
        values = dict(plain)
        mechanism, inside = values["mechanism"], values["intrusion"]
        values["outcome"] = Outcome(values["outcome"])
        values["mechanism"] = None if mechanism is None else Mechanism(mechanism)
        values["intrusion"] = None if inside is None else Intrusion(**inside)
        values["cause"] = tuple(tuple(map(Condition, names)) for names in values["cause"])
        belt = values["counterfactual"]
        values["counterfactual"] = None if belt is None else Counterfactual.from_core(belt)
        values["contacts"] = Table(values["contacts"])
        return cls(**values)

    def to_plain(self) -> dict[str, Any]:
        """Write what `from_core` reads."""
        plain = {field.name: getattr(self, field.name) for field in fields(self)}
        plain["contacts"] = dict(self.contacts)
        belt = self.counterfactual
        plain["counterfactual"] = None if belt is None else asdict(belt)
        plain["intrusion"] = None if self.intrusion is None else asdict(self.intrusion)
        return plain

    def __str__(self) -> str:
        """Say it in a sentence."""
        return sentence(self)
