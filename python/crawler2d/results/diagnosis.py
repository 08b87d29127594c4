"""Why a robot stopped: outcome, mechanism and cause, with the figures behind them."""

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
    """Why a robot stopped although commanded to move; see `Run.diagnosis`.

    ``str(diagnosis)`` says it in a sentence. All forces, speeds and the pose are means over the
    last one to two stop windows before `time`.

    Attributes
    ----------
    outcome : Outcome
        Which kind of stop it is.
    mechanism : Mechanism or None
        How the most loaded ground inside the track is held, whether that is the cause or not. None
        if there is no such ground, or if one body sticks to it and turns with it.
    cause : tuple of tuple of Condition
        The smallest sets of conditions without which there is no equilibrium: pockets (closed),
        belly (removed), torque limit (lifted), friction (doubled). More than one set is a tie. None
        means that there is no certificate, or that relaxing all of them would not free the robot.
    seized_at_tips : bool
        Whether closing the pockets would end the equilibrium if the track reached out to the
        circumscribed circles. Ground between the grousers of one wheel then counts as in a pocket.
    time, since : float
        [s] When the stop was examined, and when it began.
    position : tuple of float
        [m] Position of the chassis frame.
    chassis_angle : float
        [rad] Chassis angle, nose up > 0.
    intrusion : Intrusion or None
        The most loaded ground inside the track, if it carries more than `criteria.intrusion_load`.
    contacts : Table
        The contacts that bear: the columns of `Run.contacts` without `time` and `penetration`, plus
        `slides` and `in_pocket`.
    belly_share : float
        [-] Share of the load that the belly carries.
    sliding_share : float
        [-] Share of the normal force that is at contacts sliding at their friction limit.
    stalled_share : float
        [-] Share of the motors with ground contact that are at their torque limit.
    progress : float
        [-] Share of the commanded distance made in the last stop window.
    stationary : bool
        The pose did not change.
    imbalance : float or None
        [-] Smallest residual force that any choice of contact forces leaves, as a share of the
        weight.
    certified : bool
        The imbalance is within `criteria`: the pose may be an equilibrium.
    escape_force, free_escape_force : float or None
        [N] Largest push at the centre of mass, along the command, that can still be balanced.
        `escape_force`: here or within the next 5 mm, while surfaces keep sliding and motors keep
        pushing. `free_escape_force`: here, with every contact and motor free to hold within its
        limits. inf: wedged. None without a certificate, and for a state that keeps rattling.
    counterfactual : Counterfactual or None
        How a closed belt fares from this pose, if the run was made with ``counterfactual=True``.
    """

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Diagnosis:
        """Convert the dictionary that the core returns."""
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
        """Write the dictionary that `from_core` reads."""
        plain = {field.name: getattr(self, field.name) for field in fields(self)}
        plain["contacts"] = dict(self.contacts)
        belt = self.counterfactual
        plain["counterfactual"] = None if belt is None else asdict(belt)
        plain["intrusion"] = None if self.intrusion is None else asdict(self.intrusion)
        return plain

    def __str__(self) -> str:
        """Say it in one sentence."""
        return sentence(self)
