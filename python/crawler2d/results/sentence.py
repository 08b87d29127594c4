"""A diagnosis in plain English."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.results.bodies import BodyKind

if TYPE_CHECKING:
    from crawler2d.results.findings import Findings, Intrusion

__all__ = ["sentence"]

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
_LEAST_SHARE = 0.02
"""Smaller shares are not worth telling."""
_LEAST_DEPTH = 5e-4
"""[m] Smaller depths round to 0 mm."""
_LEAST_SLIP = 5e-3
"""[m/s] Slower slip is not worth telling."""

_MOVES = {
    "pocket": "a closed track",
    "belly": "removing the belly",
    "torque": "more torque",
    "friction": "twice the friction",
}


# What the mechanism adds to the bodies that bear on the ground inside.
_HELD = {
    "interlocked": ", with the flank of a grouser against it",
    "pinched": ", closing the gap around it",
}


def sentence(found: Findings) -> str:
    """Say what was found about a stop, the most telling facts first.

    Each clause states one fact; what follows from the outcome or from another clause is left out.
    """
    d = found
    names = [str(d.outcome), *([] if d.mechanism is None else [str(d.mechanism)])]
    head = ", ".join(name.replace("_", " ") for name in names)
    tellers = (_inside, _on_it, _belly, _drives, _progress, _moved_by, _belt)
    said = "; ".join(clause for clause in (tell(d) for tell in tellers) if clause)
    return f"{head}: {said}" if said else head


def _inside(d: Findings) -> str:
    piece = d.intrusion
    if piece is None:
        return ""
    rear, front = sorted(piece.bodies)
    kind = BodyKind(piece.body_kinds[0])
    has_grousers = piece.depth - piece.root_depth > _LEAST_DEPTH
    if rear != front and kind.is_in_chain:
        where = f"under the shoes between {' and '.join(_in_chain(piece))}"
    elif rear != front:
        where = f"between wheels {rear} and {front}"
    elif kind.is_in_chain:
        where = "between two shoes"
    elif has_grousers:
        where = f"between two grousers of {_NAMES.get(kind, f'wheel {rear}')}"
    else:
        where = f"at {_NAMES.get(kind, f'wheel {rear}')}"
    roots = ""
    if has_grousers and rear != front:
        is_past = piece.root_depth > _LEAST_DEPTH
        how_far = f"{1e3 * piece.root_depth:.0f} mm past" if is_past else "not as far as"
        roots = f" ({how_far} the grouser roots)"
    place = f"at x = {piece.x:z.3f} m, y = {piece.y:z.3f} m"
    reach = f"edge {piece.edge} reaches {1e3 * piece.depth:.0f} mm into the track"
    return f"{reach}{roots} {where}, {place}"


def _in_chain(piece: Intrusion) -> list[str]:
    """Name the wheels that the chain runs on, on either side of an intrusion."""
    names = [_NAMES[BodyKind(kind)] for kind in piece.body_kinds]
    return [names[0], "the next"] if names[0] == names[1] else names


def _on_it(d: Findings) -> str:
    """Say what bears on the ground inside the track, most loaded first."""
    contacts = d.contacts
    rows = np.flatnonzero(contacts["in_pocket"])
    bodies = contacts["body"][rows]
    forces = {int(body): 0.0 for body in bodies}
    sliding = dict(forces)
    for body, force, slides in zip(
        bodies, contacts["normal_force"][rows], contacts["slides"][rows], strict=True
    ):
        forces[int(body)] += float(force)
        sliding[int(body)] += float(force) * bool(slides)
    told = sorted(forces, key=forces.__getitem__, reverse=True)[:2]
    told = [body for body in told if forces[body] >= _LEAST_SHARE * sum(forces.values())]
    names = [_name(d, body) for body in told]
    if len(names) == 2 and names[0] == names[1]:
        names[1] = "another"
    slides = [sliding[body] > 0.5 * forces[body] for body in told]
    does = ["slides on it under a load of" if slide else "bears on it with" for slide in slides]
    newtons = [f"{forces[body]:.0f} N" for body in told]
    if not told:
        return ""
    said = f"{names[0]} {does[0]} {newtons[0]}"
    if len(told) == 2 and does[0] != does[1]:
        said += f" and {names[1]} {does[1]} {newtons[1]}"
    elif len(told) == 2:
        said += f", {names[1]} {'under' if slides[1] else 'with'} {newtons[1]}"
    return said + _HELD.get(str(d.mechanism), "")


def _name(d: Findings, body: int) -> str:
    kinds = d.contacts["body_kind"][d.contacts["body"] == body]
    kind = BodyKind(kinds[0]) if len(kinds) else BodyKind.WHEEL
    return _NAMES.get(kind, f"wheel {body}")


def _is_belt(d: Findings) -> bool:
    """Whether the track is a belt, with or without grousers."""
    if d.intrusion is not None:
        return d.intrusion.body_kinds[0] == BodyKind.BELT
    kinds = d.contacts["body_kind"]
    of_chain = [kind for kind in BodyKind if kind == BodyKind.SHOE or kind.is_in_chain]
    is_chain = np.isin(kinds, of_chain).any()
    return bool(np.isin(kinds, (BodyKind.BELT, BodyKind.GROUSER)).any() and not is_chain)


def _belly(d: Findings) -> str:
    on_it = d.contacts["in_pocket"] & (d.contacts["body_kind"] == BodyKind.BELLY)
    if d.belly_share < _LEAST_SHARE or (on_it.any() and d.outcome != "hung_up"):
        return ""
    return f"the belly carries {_percent(d.belly_share)} of the load"


def _drives(d: Findings) -> str:
    """Say what motors and surfaces do, unless the ground inside the track implies it."""
    if d.stalled_share > 0.0:
        of = "" if d.stalled_share == 1.0 else f"{_percent(d.stalled_share)} of "
        return f"{of}the motors are at their torque limit"
    track = d.contacts["body_kind"] != BodyKind.BELLY
    forces = d.contacts["normal_force"][track]
    if d.outcome not in ("slipping", "cycling") or forces.sum() == 0.0:
        return ""
    slip = float(np.average(np.abs(d.contacts["surface_speed"][track]), weights=forces))
    return f"the track slips at {slip:.2f} m/s" if slip > _LEAST_SLIP else ""


def _progress(d: Findings) -> str:
    if d.progress < _LEAST_SHARE:
        return ""
    return f"it still creeps at {_percent(d.progress)} of the commanded speed"


def _moved_by(d: Findings) -> str:
    """Say what would end the equilibrium: relaxing a condition, or a push."""
    if not d.certified:
        if d.imbalance is None:
            return "the balance of forces could not be computed"
        residual = f"the smallest residual is {100 * d.imbalance:.2g} % of the weight"
        return f"no contact forces balance it: {residual}"
    # If a closed belt has been tried, `_belt` says how it fared.
    tried = () if d.counterfactual is None else (("pocket",),)
    ways = [" plus ".join(_MOVES[each] for each in way) for way in d.cause if way not in tried]
    push = d.escape_force
    wedged = push is not None and math.isinf(push)
    if push is not None and not wedged:
        ways.append(f"a push of {push:.0f} N" if push >= 0.5 else "the slightest push")
    helpless = {"stalled": "more torque", "slipping": "twice the friction"}
    known = d.sliding_share if d.outcome == "slipping" else d.stalled_share
    in_vain = [helpless[d.outcome]] if not d.cause and known and d.outcome in helpless else []
    if wedged:
        in_vain.append("any push")
    if ways:
        no_help = "no push would" if wedged else f"{in_vain[0]} would not" if in_vain else ""
        but = f", but {no_help}" if no_help else ""
        return f"{_listed(ways)} would free it{but}"
    if len(in_vain) == 2:
        return f"neither {in_vain[0]} nor {in_vain[1]} would free it"
    if wedged:
        return "no push would free it"
    return f"{in_vain[0]} would not free it" if in_vain else ""


def _belt(d: Findings) -> str:
    if d.counterfactual is None or _is_belt(d):
        return ""
    if d.counterfactual.freed:
        return "a closed belt escapes from the same pose"
    advance = 1e3 * d.counterfactual.distance
    how_far = f" (it advances {advance:.0f} mm)" if advance >= 0.5 else ""
    return f"a closed belt does not escape from the same pose either{how_far}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _listed(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
