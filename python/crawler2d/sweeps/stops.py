"""The columns of a table that tell of stops: where, how, and what was tried."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from crawler2d.results.glossary import TRIALS

if TYPE_CHECKING:
    from crawler2d.results.diagnosis import Diagnosis
    from crawler2d.results.findings import Tried

__all__ = ["short_name", "stop_columns"]

Column = tuple[type, str, list[Any]]


_NEEDED = (
    *("closed track", "closed track, clear of the ground", "belt"),
    *("belt, from the start", "closed track, from the start"),
)
"""Trials of every jam."""


def short_name(trial: str) -> str:
    """Name a trial as in the names of its columns.

    Examples
    --------
    >>> short_name("closed track, clear of the ground"), short_name("torque x 2")
    ('closed_track_clear_of_the_ground', 'torque_x2')
    """
    return trial.replace(" x ", "_x").replace(", ", "_").replace(" ", "_")


def stop_columns(why: Sequence[Diagnosis | None], asked: Sequence[str] = ()) -> dict[str, Column]:
    """Kind, unit and values of each column, by name; for runs that did not stop they are empty.

    Trials that were asked for, and those of every jam, have three columns each, named after them.
    """

    def of(name: str, empty: Any) -> list[Any]:
        return [empty if d is None else getattr(d, name) for d in why]

    def of_edge(name: str, empty: Any) -> list[Any]:
        pieces = [None if d is None else d.intrusion for d in why]
        return [empty if piece is None else getattr(piece, name) for piece in pieces]

    columns: dict[str, Column] = {
        "symptom": (str, "", [str(each) for each in of("symptom", "")]),
        "passing": (bool, "", of("passing", False)),
        "mechanism": (str, "", [str(each or "") for each in of("mechanism", "")]),
        "jammed": (bool, "", of("jammed", False)),
        "belly_side": (str, "", of("belly_side", "")),
        "stop_x": (float, "m", [math.nan if d is None else d.position[0] for d in why]),
        "stop_angle": (float, "rad", of("chassis_angle", math.nan)),
        "stop_edge": (int, "", of_edge("edge", -1)),
        "stop_side": (str, "", [str(each) for each in of_edge("side", "")]),
        "stop_carrier": (str, "", [str(each) for each in of_edge("carrier", "")]),
        "stop_bodies": (str, "", [_pair(each) for each in of_edge("bodies", ())]),
    }
    for name in (each for each in TRIALS if each in asked or each in _NEEDED):
        made = [_made(d, name) for d in why]
        short = short_name(name)
        columns[f"tried_{short}"] = (bool, "", [t is not None for t in made])
        columns[f"freed_by_{short}"] = (bool, "", [t is not None and t.freed for t in made])
        columns[f"then_{short}"] = (str, "", ["" if t is None else str(t.outcome) for t in made])
    return columns


def _made(why: Diagnosis | None, name: str) -> Tried | None:
    trials = () if why is None else why.trials
    return next((tried for tried in trials if tried.name == name), None)


def _pair(bodies: tuple[int, ...]) -> str:
    return "-".join(map(str, sorted(bodies)))
