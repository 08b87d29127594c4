"""The diagnosis of a stop, and its sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal

import numpy as np

from crawler2d.common.arrays import ByValue, Table
from crawler2d.common.bodies import BodyKind
from crawler2d.results.findings import Intrusion, Mechanism, TrialResult
from crawler2d.results.outcome import Outcome

__all__ = ["Diagnosis", "body_name", "end_text", "sentence", "trial_text", "vocabulary"]

_NAMES = {
    BodyKind.BELT: "the belt",
    BodyKind.SKID: "the skid",
    BodyKind.BELLY: "the belly",
    BodyKind.GROUSER: "a grouser",
    BodyKind.SHOE: "a shoe",
    BodyKind.GUIDE: "the guide",
    BodyKind.SPROCKET: "the sprocket",
    BodyKind.IDLER: "the idler",
    BodyKind.ROAD_WHEEL: "a road wheel",
    BodyKind.ROLLER: "a return roller",
}
"""Names of the bodies that are not wheels."""
_LEAST_FRACTION = 0.02
"""[-] Smaller fractions are left out."""
_LEAST_DEPTH = 5e-4
"""[m] Smaller depths round to 0 mm."""
_LEAST_SLIP = 5e-3
"""[m/s] Slower slip is left out."""
_CHANGES = {
    "closed track": "closed track",
    "closed track, clear of the ground": "closed track, set down clear of the ground",
    "closed smooth track": "smooth closed track",
    "closed track, from the start": "closed track from the start",
    "belt": "belt along its outline",
    "belt, from the start": "belt from the start",
    "one motor": "one motor for all wheels",
    "torque x 2": "twice the torque",
    "torque x 10": "ten times the torque",
    "friction x 2": "twice the friction",
    "no belly": "without its belly",
    "flippers level": "flippers level",
}
"""The change of each trial in words; controls change nothing."""
_ENDS = {
    Outcome.CLEARED: "clears",
    Outcome.TIPPED_OVER: "tips over",
    Outcome.LEFT_TERRAIN: "leaves the ground",
    Outcome.DETRACKED: "throws its track",
    Outcome.TIMED_OUT: "is still moving",
    Outcome.SEIZED: "seizes",
    Outcome.CYCLING: "moves back and forth",
    Outcome.HUNG_UP: "hangs on its belly",
    Outcome.STALLED: "is stalled",
    Outcome.SLIPPING: "slips",
}
"""How a trial ends in words; for a stop, its symptom."""
_GRIPS = {
    "interlocked": ", with the flank of a grouser against it",
    "pinched": ", closing the gap around it",
}
"""What the mechanism adds to the text about the bodies."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Diagnosis(ByValue):
    """Why a robot stopped despite its command; see `Run.diagnosis`.

    ``str(diagnosis)`` summarises it in a sentence. Forces, speeds and pose are means over the last
    one to two stop windows before `time`.

    Attributes
    ----------
    outcome : Outcome
        Kind of stop, given the trials: "seized" if the robot is `jammed` and a closed track gets
        free, else the symptom; "timed_out" if it was `transient`.
    symptom : Outcome
        Kind of stop before any trial: cycling, hung_up, stalled or slipping.
    transient : bool
        Whether the stop would not have lasted: the unchanged robot got free, or it did with its
        track rebuilt.
    trials : tuple of TrialResult
        The trials so far and their results; `Run.trials` and `Run.what_if` add to it.
    freed_by : tuple of str
        Names of the trials that freed the robot.
    reached_by_belt : bool or None
        Whether a belt tried from the start got as far as the robot; None if none was tried.
    belly_side : {"", "underside", "tail", "nose"}
        Side of the belly that the ground pushes on: "tail" if the robot stands on its tail.
    jammed : bool
        Whether ground between two bodies of a track, deeper than their root circles, presses on
        that track.
    mechanism : Mechanism or None
        How the most loaded ground inside the track is held, whether or not it is the reason. None
        without such ground, or if a single body sticks to it and turns with it.
    time, since : float
        [s] When the stop was examined, and when it began.
    position : tuple of float
        [m] Position of the chassis frame.
    chassis_angle : float
        [rad] Chassis angle, nose up > 0.
    intrusion : Intrusion or None
        The most loaded ground inside the track, if it carries more than `criteria.intrusion_load`:
        the jammed one if `jammed`, else any.
    contacts : Table
        The load-bearing contacts: the columns of `Run.contacts` without `time` and `penetration`,
        plus `slides` and `in_pocket`.
    belly_share : float
        [-] Fraction of the load that the belly carries.
    sliding_share : float
        [-] Fraction of the normal force at contacts that slide at their friction limit.
    stalled_share : float
        [-] Fraction of motors at their torque limit, among those with ground contact.
    progress : float
        [-] Distance made in the last stop window, as a fraction of the commanded one.
    stationary : bool
        Whether the pose stayed the same.
    imbalance : float or None
        [-] Smallest residual force over all admissible contact forces, as a fraction of the weight.
    certified : bool
        Whether the imbalance is within `criteria`: forces can balance the pose.
    certificate : float or None
        [-] The imbalance if certified, else None.
    """

    outcome: Outcome
    symptom: Outcome
    transient: bool
    trials: tuple[TrialResult, ...]
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

    @classmethod
    def from_core(cls, result: Mapping[str, Any]) -> Diagnosis:
        """Convert a dictionary from the core or an older file."""
        values = dict(result)
        if "passing" in values:  # its former name, in files of November 2026
            values["transient"] = values.pop("passing")
        mechanism, inside = values["mechanism"], values["intrusion"]
        values["outcome"] = Outcome(values["outcome"])
        values["symptom"] = Outcome(values["symptom"])
        values["trials"] = tuple(map(TrialResult.from_core, values["trials"]))
        values["mechanism"] = None if mechanism is None else Mechanism(mechanism)
        values["intrusion"] = None if inside is None else Intrusion(**inside)
        values["contacts"] = Table(values["contacts"])
        return cls(**values)

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
        """Whether a belt tried from the start got as far as the robot; None if none was tried."""
        starts = [tried.distance >= 0.0 for tried in self.trials if tried.is_from_the_start]
        return any(starts) if starts else None

    @property
    def belly_side(self) -> Literal["", "underside", "tail", "nose"]:
        """Side of the belly that the ground pushes on; "" if it does not.

        "tail" or "nose" if it pushes along the belly more than up from its underside, as when a
        robot stands on the tail of its hull.
        """
        on_belly = self.contacts["body_kind"] == BodyKind.BELLY
        force = self.contacts["normal_force"][on_belly]
        if not force.size:
            return ""
        x, y = (force @ self.contacts[name][on_belly] for name in ("normal_x", "normal_y"))
        sine, cosine = math.sin(self.chassis_angle), math.cos(self.chassis_angle)
        along, across = cosine * x + sine * y, cosine * y - sine * x
        if abs(along) <= across:
            return "underside"
        return "tail" if along > 0.0 else "nose"

    def to_dict(self) -> dict[str, Any]:
        """Write the dictionary that `from_core` reads."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        values["contacts"] = dict(self.contacts)
        values["trials"] = tuple(asdict(tried) for tried in self.trials)
        values["intrusion"] = None if self.intrusion is None else asdict(self.intrusion)
        return values

    def __str__(self) -> str:
        """Summarise it in one sentence."""
        return sentence(self)


def sentence(d: Diagnosis) -> str:
    """Describe a stop, then the trials.

    Each clause states one fact; facts that follow from the outcome or another clause are left out.
    """
    clauses = (_intrusion, _bearers, _belly, _drives, _progress, _balance)
    facts = ": ".join(filter(None, (_head(d), "; ".join(filter(None, (f(d) for f in clauses))))))
    if d.transient:
        return f"{facts}. {_continuation(d)}"
    tried = "; ".join(filter(None, (trial_text(d, each) for each in d.trials)))
    return f"{facts}. Tried: {tried}{_belt_limit(d)}" if tried else facts


def trial_text(d: Diagnosis, tried: TrialResult) -> str:
    """Describe change and result of a trial; empty for a control."""
    return f"{_CHANGES[tried.name]}: {_result(d, tried)}" if tried.name in _CHANGES else ""


def _head(d: Diagnosis) -> str:
    if d.transient:
        return f"temporarily {_word(d.symptom)}"
    where = _where(d.intrusion) if d.outcome == Outcome.SEIZED and d.intrusion else ""
    on_end = d.outcome == Outcome.HUNG_UP and d.belly_side in ("tail", "nose")
    return f"{_word(d.outcome)}{where}" + (f" on the {d.belly_side} of its hull" if on_end else "")


def _word(outcome: Outcome) -> str:
    return str(outcome).replace("_", " ")


def _continuation(d: Diagnosis) -> str:
    """Name the control that got out of a transient stop."""
    control = next(tried for tried in d.trials if tried.freed)
    by_itself = control.name == "unchanged"
    text = "It goes on by itself" if by_itself else "With its track rebuilt it goes on"
    return f"{text}: {_result(d, control)}"


def _belt_limit(d: Diagnosis) -> str:
    """Say if no belt tried from the start reached the stop, or got past it."""
    starts = [tried for tried in d.trials if tried.is_from_the_start]
    if not starts or any(map(_is_past, starts)):
        return ""
    return f". No belt {'got past here' if d.reached_by_belt else 'came this far'} from the start"


def _is_past(tried: TrialResult) -> bool:
    """Whether a belt got past the stop, even if it tipped over farther on."""
    is_lost = tried.outcome in (Outcome.TIPPED_OVER, Outcome.LEFT_TERRAIN)
    return tried.freed or (is_lost and tried.distance > 0.0)


def _result(d: Diagnosis, tried: TrialResult) -> str:
    """Describe the result of a trial."""
    end = _end(d, tried)
    if tried.freed:
        text = f"{'past here' if tried.is_from_the_start else 'free'} after {tried.time:.1f} s"
        if tried.outcome != Outcome.TIMED_OUT:
            text += f", then {end}"
    elif tried.is_from_the_start:
        text = f"{end} {_advance(tried) or 'here'}"
    elif tried.outcome == Outcome.TIMED_OUT:
        text = "still moving, but not free"
    else:
        is_placed = tried.distance < 0.0 or _is_jammed_elsewhere(d, tried)
        further = "" if is_placed else _advance(tried)
        text = f"{end} {further}" if further else end
    if tried.starts > 1:
        text += f" ({tried.freeing} of {tried.starts} times free)"
    return text


def _advance(tried: TrialResult) -> str:
    """Describe how far ahead or short of the stop a trial ended."""
    if abs(tried.distance) < _LEAST_DEPTH:
        return ""
    direction = "further on" if tried.distance > 0.0 else "short of here"
    return f"{1e3 * abs(tried.distance):.0f} mm {direction}"


def _end(d: Diagnosis, tried: TrialResult) -> str:
    if not tried.jammed:
        return end_text(tried.outcome)
    jam = tried.intrusion
    if jam is None:
        return "is jammed"
    if _is_jammed_elsewhere(d, tried):
        return f"is jammed{_where(jam)}, in {_track(jam)} at x = {jam.x:z.3f} m, y = {jam.y:z.3f} m"
    again = d.intrusion is not None and sorted(jam.bodies) == sorted(d.intrusion.bodies)
    return "is jammed again" if again else f"is jammed again,{_where(jam)}"


def _is_jammed_elsewhere(d: Diagnosis, tried: TrialResult) -> bool:
    """Whether a trial ended in a jam at another edge or in another track than the stop."""
    was, jam = d.intrusion, tried.intrusion
    if not tried.jammed or jam is None:
        return False
    here = (jam.side, jam.carrier, jam.edge)
    return not d.jammed or was is None or here != (was.side, was.carrier, was.edge)


def _intrusion(d: Diagnosis) -> str:
    """Describe the ground inside the track, and its position unless already given."""
    piece = d.intrusion
    if piece is None:
        return ""
    where = "" if d.outcome == Outcome.SEIZED and not d.transient else _where(piece)
    roots = ""
    if _has_grousers(piece) and piece.bodies[0] != piece.bodies[1]:
        is_past = piece.root_depth > _LEAST_DEPTH
        how_far = f"{1e3 * piece.root_depth:.0f} mm past" if is_past else "not as far as"
        roots = f" ({how_far} the grouser roots)"
    place = f"the ground at x = {piece.x:z.3f} m, y = {piece.y:z.3f} m"
    return f"{place} stands {1e3 * piece.depth:.0f} mm inside {_track(piece)}{roots}{where}"


def _has_grousers(piece: Intrusion) -> bool:
    return piece.depth - piece.root_depth > _LEAST_DEPTH


def _track(piece: Intrusion) -> str:
    side = "" if piece.side == "both" else f"{piece.side} "
    if piece.carrier == "chassis":
        return f"the {side}track"
    return f"the track of the {side}{piece.carrier}"


def _where(piece: Intrusion) -> str:
    """Name the bodies on either side of a piece of ground."""
    rear, front = sorted(piece.bodies)
    kind = BodyKind(piece.body_kinds[0])
    if rear != front and kind.is_in_chain:
        return f" under the shoes between {' and '.join(_in_chain(piece))}"
    if rear != front:
        return f" between wheels {rear} and {front}"
    if kind.is_in_chain:
        return " between two shoes"
    name = _NAMES.get(kind, f"wheel {rear}")
    return f" between two grousers of {name}" if _has_grousers(piece) else f" at {name}"


def _in_chain(piece: Intrusion) -> list[str]:
    """Name the wheels that the chain runs on, on either side of an intrusion."""
    names = [_NAMES[BodyKind(kind)] for kind in piece.body_kinds]
    return [names[0], "the next"] if names[0] == names[1] else names


def _bearers(d: Diagnosis) -> str:
    """Describe the bodies that press on the ground inside the track, most loaded first."""
    inside = d.contacts["in_pocket"].astype(bool)
    bodies, forces = d.contacts["body"][inside], d.contacts["normal_force"][inside]
    slides = d.contacts["slides"][inside].astype(bool)
    loads = {body: float(forces[bodies == body].sum()) for body in dict.fromkeys(bodies.tolist())}
    bearers = sorted(loads, key=loads.__getitem__, reverse=True)[:2]
    bearers = [body for body in bearers if loads[body] >= _LEAST_FRACTION * sum(loads.values())]
    if not bearers:
        return ""
    names = [body_name(d, body) for body in bearers]
    if len(names) == 2 and names[0] == names[1]:
        names[1] = "another"
    sliding = [forces[(bodies == body) & slides].sum() > 0.5 * loads[body] for body in bearers]
    verbs = ["slides on it under a load of" if each else "bears on it with" for each in sliding]
    newtons = [f"{loads[body]:.0f} N" for body in bearers]
    text = f"{names[0]} {verbs[0]} {newtons[0]}"
    if len(bearers) == 2 and verbs[0] != verbs[1]:
        text += f" and {names[1]} {verbs[1]} {newtons[1]}"
    elif len(bearers) == 2:
        text += f", {names[1]} {'under' if sliding[1] else 'with'} {newtons[1]}"
    return text + _GRIPS.get(str(d.mechanism), "")


def end_text(outcome: Outcome) -> str:
    """Describe how a trial ends, in the present tense."""
    return _ENDS[outcome]


def body_name(d: Diagnosis, body: int) -> str:
    """Name a load-bearing body."""
    kinds = d.contacts["body_kind"][d.contacts["body"] == body]
    kind = BodyKind(kinds[0]) if len(kinds) else BodyKind.WHEEL
    return _NAMES.get(kind, f"wheel {body}")


def _belly(d: Diagnosis) -> str:
    if d.belly_share < _LEAST_FRACTION:
        return ""
    side = d.belly_side
    part = f"the {side}" if side in ("tail", "nose") else "the belly"
    text = f"{part} carries {_percent(d.belly_share)} of the supporting force"
    on_belly = d.contacts["body_kind"] == BodyKind.BELLY
    if d.outcome != Outcome.HUNG_UP or not on_belly.any():
        return text
    force = d.contacts["normal_force"][on_belly]
    x, y = (np.average(d.contacts[name][on_belly], weights=force) for name in ("x", "y"))
    return f"{text} at x = {x:z.3f} m, y = {y:z.3f} m"


def _drives(d: Diagnosis) -> str:
    """Describe motors and surfaces, unless implied by the ground inside the track."""
    if d.stalled_share > 0.0:
        of = "" if d.stalled_share == 1.0 else f"{_percent(d.stalled_share)} of "
        return f"{of}the motors are at their torque limit"
    if d.symptom == Outcome.CYCLING:
        return "it moves back and forth"
    track = d.contacts["body_kind"] != BodyKind.BELLY
    forces = d.contacts["normal_force"][track]
    if d.outcome != Outcome.SLIPPING or forces.sum() == 0.0:
        return ""
    slip = float(np.average(np.abs(d.contacts["surface_speed"][track]), weights=forces))
    return f"the track slips at {slip:.2f} m/s" if slip > _LEAST_SLIP else ""


def _progress(d: Diagnosis) -> str:
    if d.progress < _LEAST_FRACTION:
        return ""
    return f"it still creeps at {_percent(d.progress)} of the commanded speed"


def _balance(d: Diagnosis) -> str:
    """State if the forces do not balance."""
    if d.certified:
        return ""
    if d.imbalance is None:
        return "the balance of forces could not be computed"
    residual = f"the smallest residual is {100 * d.imbalance:.2g} % of the weight"
    return f"no contact forces balance it: {residual}"


def _percent(fraction: float) -> str:
    return f"{100 * fraction:.0f} %"


def vocabulary() -> dict[str, Any]:
    """List words and limits of the sentence, for pages that write it from the core's data."""
    return {
        "names": {kind.value: name for kind, name in _NAMES.items()},
        "in_chain": [kind.value for kind in BodyKind if kind.is_in_chain],
        "belly": BodyKind.BELLY.value,
        "changes": _CHANGES,
        "ends": _ENDS,
        "grips": _GRIPS,
        "least_fraction": _LEAST_FRACTION,
        "least_depth": _LEAST_DEPTH,
        "least_slip": _LEAST_SLIP,
    }
