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
"""What a reader calls the bodies that are no wheels."""
_LEAST_SHARE = 0.02
"""Smaller shares are noise to a reader."""
_LEAST_DEPTH = 5e-4
"""[m] Smaller depths are none in whole millimetres."""
_LEAST_SLIP = 5e-3
"""[m/s] Slower surfaces do not slip to a reader."""

_MOVES = {
    "pocket": "a closed track",
    "belly": "a robot without its belly",
    "torque": "more torque",
    "friction": "twice the friction",
}


# What the mechanism adds to who bears.
_HELD = {
    "interlocked": ", a grouser's flank against it",
    "pinched": ", which close the gap that it is in",
}


def sentence(found: Findings) -> str:
    """Say what was found of a stop, most telling first.

    Every clause is a fact of its own; what follows from the outcome or from another clause is left
    out.
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
    below = ""
    if has_grousers and rear != front:
        deep = f"{1e3 * piece.root_depth:.0f} mm" if piece.root_depth > _LEAST_DEPTH else "not"
        below = f", {deep} below the roots,"
    place = f"at x {piece.x:z.3f} m, y {piece.y:z.3f} m"
    reach = f"edge {piece.edge} reaches {1e3 * piece.depth:.0f} mm inside the envelope"
    return f"{reach}{below} {where}, {place}"


def _in_chain(piece: Intrusion) -> list[str]:
    """Name the wheels that a chain runs on, on either side of an intrusion."""
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
    does = ["slide" if sliding[body] > 0.5 * forces[body] else "bear" for body in told]
    with_force = [f"with {forces[body]:.0f} N" for body in told]
    if not told:
        return ""
    said = f"{names[0]} {does[0]}s on it {with_force[0]}"
    if len(told) == 2 and does[0] != does[1]:
        said += f" and {names[1]} {does[1]}s on it {with_force[1]}"
    elif len(told) == 2:
        said += f", {names[1]} {with_force[1]}"
    return said + _HELD.get(str(d.mechanism), "")


def _name(d: Findings, body: int) -> str:
    kinds = d.contacts["body_kind"][d.contacts["body"] == body]
    kind = BodyKind(kinds[0]) if len(kinds) else BodyKind.WHEEL
    return _NAMES.get(kind, f"wheel {body}")


def _is_belt(d: Findings) -> bool:
    """Tell a belt, with grousers or without, by what is inside of it, or by what bears."""
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
    return f"{_percent(d.belly_share)} of the load rests on the belly"


def _drives(d: Findings) -> str:
    """Say what motors and surfaces do, where the ground inside the track has not said it."""
    if d.stalled_share > 0.0:
        of = "" if d.stalled_share == 1.0 else f"{d.stalled_share:.0%} of ".replace("%", " %")
        return f"{of}its motors stand at their torque limit"
    track = d.contacts["body_kind"] != BodyKind.BELLY
    forces = d.contacts["normal_force"][track]
    if d.outcome not in ("slipping", "cycling") or forces.sum() == 0.0:
        return ""
    slip = float(np.average(np.abs(d.contacts["surface_speed"][track]), weights=forces))
    return f"its track slips at {slip:.2f} m/s" if slip > _LEAST_SLIP else ""


def _progress(d: Findings) -> str:
    if d.progress < _LEAST_SHARE:
        return ""
    return f"it creeps on at {_percent(d.progress)} of what is commanded"


def _moved_by(d: Findings) -> str:
    """Say what would end the equilibrium: conditions relaxed, or a push."""
    if not d.certified:
        if d.imbalance is None:
            return "its balance could not be computed"
        return f"no contact forces balance it: {100 * d.imbalance:.2g} % of the weight is missing"
    # What a belt does there has been tried, and that is said on its own.
    tried = () if d.counterfactual is None else (("pocket",),)
    ways = [" with ".join(_MOVES[each] for each in way) for way in d.cause if way not in tried]
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
        but = f", but not {' or '.join(in_vain)}" if in_vain else ""
        return f"{_listed(ways)} would move it on{but}"
    if len(in_vain) == 2:
        return f"neither {in_vain[0]} nor {in_vain[1]} would move it on"
    if wedged:
        return "no push would move it on"
    return f"{in_vain[0]} would not move it on" if in_vain else ""


def _belt(d: Findings) -> str:
    if d.counterfactual is None or _is_belt(d):
        return ""
    if d.counterfactual.freed:
        return "a closed belt gets away"
    further = 1e3 * d.counterfactual.distance
    return f"a closed belt gets {f'{further:.0f} mm' if further >= 0.5 else 'no'} further"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _listed(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
