"""How cost and error grow along a curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np


class Curve(NamedTuple):
    """One curve of a figure, its points ascending."""

    figure: str
    panel: str
    name: str
    x: list[float]
    per_second: list[float]

    @property
    def slope(self) -> float:
        """[-] Exponent of the power law that fits all points best."""
        return float(np.polyfit(np.log(self.x), np.log(self.per_second), 1)[0])

    @property
    def last_slope(self) -> float:
        """[-] Exponent between the last two points."""
        return float(np.diff(np.log(self.per_second[-2:]))[0] / np.diff(np.log(self.x[-2:]))[0])


def curves(rows: Sequence[dict[str, Any]], figure: str) -> list[Curve]:
    """Collect the curves of a figure, except those with only one point."""
    keys = dict.fromkeys((row["panel"], row["curve"]) for row in rows if row["figure"] == figure)
    found = []
    for panel, name in keys:
        own = [row for row in rows if (row["figure"], row["panel"]) == (figure, panel)]
        own = [row for row in own if row["curve"] == name]
        x, per_second = [row["x"] for row in own], [row["per_second"] for row in own]
        if len(own) > 1:
            found.append(Curve(figure, panel, name, x, per_second))
    return found


def deviations(rows: Sequence[dict[str, Any]], curve: Curve) -> list[float]:
    """[m] How far the robot gets from where it does at the first point, at least a nanometre."""
    own = {row["x"]: row["final_x"] for row in rows if _is_on(row, curve)}
    first, *others = (own[x] for x in curve.x)
    return [max(abs(other - first), 1e-9) for other in others]


def _is_on(row: dict[str, Any], curve: Curve) -> bool:
    return (row["figure"], row["panel"], row["curve"]) == (curve.figure, curve.panel, curve.name)
