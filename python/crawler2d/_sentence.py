"""A diagnosis in plain English."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crawler2d.diagnosis import Diagnosis, Intrusion

__all__ = ["sentence"]

_OUTCOMES = {
    "seized": "seized",
    "hung_up": "hung up on its belly",
    "stalled": "stalled at the torque limit",
    "slipping": "slipping",
    "cycling": "moving to and fro without gain",
}
_FREES = {
    "pocket": "closing the pocket",
    "belly": "taking the belly away",
    "torque": "more torque",
    "friction": "twice the friction",
}


def sentence(diagnosis: Diagnosis) -> str:
    """Say what a diagnosis found, most telling first."""
    d = diagnosis
    head = _OUTCOMES[d.outcome]
    if d.mechanism is not None:
        head += f", {d.mechanism}"
    parts = []
    if d.intrusion is not None:
        parts.append(_inside(d.intrusion))
    parts.extend(_bearing(d))
    parts.extend(_balance(d))
    return f"{head}: {'; '.join(parts)}" if parts else head


def _inside(piece: Intrusion) -> str:
    rear, front = sorted(piece.bodies)
    where = f"between wheels {rear} and {front}" if rear != front else f"at wheel {rear}"
    place = f"edge {piece.edge} at x {piece.x:.2f} m, y {piece.y:.2f} m,"
    return f"{place} {1e3 * piece.depth:.0f} mm inside the envelope {where}"


def _bearing(d: Diagnosis) -> list[str]:
    """Say what the most loaded contact in the pocket, the belly and the motors do."""
    said = []
    contacts = d.contacts
    inside = np.flatnonzero(contacts["in_pocket"])
    if len(inside) > 0:
        most = inside[np.argmax(contacts["normal_force"][inside])]
        body = "the belly" if contacts["body_kind"][most] == _BELLY else None
        body = body or f"wheel {contacts['body'][most]}"
        does = "slides" if contacts["slides"][most] else "bears"
        said.append(f"{body} {does} on it with {contacts['normal_force'][most]:.0f} N")
    if d.belly_share > _WORTH_SAYING:
        said.append(f"{d.belly_share:.0%} of the weight is on the belly")
    if d.stalled_share > 0:
        said.append(f"{_share(d.stalled_share)} motors stand at the torque limit")
    elif d.sliding_share > _WORTH_SAYING:
        said.append(f"{d.sliding_share:.0%} of the load slides")
    return said


def _balance(d: Diagnosis) -> list[str]:
    """Say what would end the equilibrium."""
    said = []
    if not d.certified:
        said.append("no equilibrium of contact forces explains it")
    if d.cause:
        ways = [" with ".join(_FREES[condition] for condition in each) for each in d.cause]
        said.append(f"{' or '.join(ways)} would free it")
    if d.escape_force is not None:
        if math.isinf(d.escape_force):
            said.append("no push forwards frees it")
        else:
            said.append(f"a push of {d.escape_force:.0f} N would move it")
    if d.counterfactual is not None:
        does = "gets away" if d.counterfactual.freed else "does not get away"
        said.append(f"a closed belt {does}")
    return said


def _share(share: float) -> str:
    return "all" if share == 1.0 else f"{share:.0%} of the"


# Code of the belly in `body_kind`.
_BELLY = 3
# Shares below this are noise to a reader.
_WORTH_SAYING = 0.02
