"""Why did it stop: outcome, mechanism and cause of a stop, with the figures that show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from crawler2d.common.table import Table
from crawler2d.results.findings import Condition, Counterfactual, Findings, Intrusion, Mechanism
from crawler2d.results.outcome import Outcome
from crawler2d.results.sentence import sentence

__all__ = ["Diagnosis"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagnosis(Findings):
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
