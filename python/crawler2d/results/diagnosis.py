"""Why a robot stopped: what is seen, what was tried, and the figures behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from crawler2d.common.table import Table
from crawler2d.results.findings import Findings, Intrusion, Mechanism, Tried
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
        Which kind of stop it is, after what was tried: "seized" if the robot is `jammed` and a
        closed track gets free, else the symptom; "timed_out" if it was `passing`.
    symptom : Outcome
        What is seen, before anything is tried: cycling, hung_up, stalled or slipping.
    passing : bool
        Whether the stop would not have lasted: the unchanged robot got free when it went on, or
        when its track was built anew.
    trials : tuple of Tried
        What was tried so far, and what came of it; `Run.trials` and `Run.what_if` add to it.
    freed_by : tuple of str
        Names of those that freed the robot.
    reached_by_belt : bool or None
        Whether a belt that was tried from the start came as far as the robot; None if none was.
    belly_side : {"", "underside", "tail", "nose"}
        Where the ground pushes against the belly: at its tail if the robot stands on that.
    jammed : bool
        Whether ground between two bodies of a track, deeper than their root circles, bears on that
        track.
    mechanism : Mechanism or None
        How the most loaded ground inside the track is held, whether that is the reason or not. None
        if there is no such ground, or if one body sticks to it and turns with it.
    time, since : float
        [s] When the stop was examined, and when it began.
    position : tuple of float
        [m] Position of the chassis frame.
    chassis_angle : float
        [rad] Chassis angle, nose up > 0.
    intrusion : Intrusion or None
        The most loaded ground inside the track, if it carries more than `criteria.intrusion_load`:
        where it is `jammed`, or else anywhere.
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
    certificate : float or None
        [-] The imbalance if it is, else None.
    """

    @classmethod
    def from_core(cls, plain: Mapping[str, Any]) -> Diagnosis:
        """Convert the dictionary that the core returns."""
        values = dict(plain)
        mechanism, inside = values["mechanism"], values["intrusion"]
        values["outcome"] = Outcome(values["outcome"])
        values["symptom"] = Outcome(values["symptom"])
        values["trials"] = tuple(map(Tried.from_core, values["trials"]))
        values["mechanism"] = None if mechanism is None else Mechanism(mechanism)
        values["intrusion"] = None if inside is None else Intrusion(**inside)
        values["contacts"] = Table(values["contacts"])
        return cls(**values)

    def to_plain(self) -> dict[str, Any]:
        """Write the dictionary that `from_core` reads."""
        plain = {field.name: getattr(self, field.name) for field in fields(self)}
        plain["contacts"] = dict(self.contacts)
        plain["trials"] = tuple(asdict(tried) for tried in self.trials)
        plain["intrusion"] = None if self.intrusion is None else asdict(self.intrusion)
        return plain

    def __str__(self) -> str:
        """Say it in one sentence."""
        return sentence(self)
