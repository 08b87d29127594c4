"""The parts of the report, some of which docs/studies/scaling.md shows: how cost and error grow."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from benches.scaling.scenes import BLOCKS, CUT, FLAT, LEVEL, STEP
from benches.shared.measuring import sentence
from research.tables import group_by, table


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
    mine = (row for row in rows if row["figure"] == figure)
    return [
        Curve(figure, panel, name, [row["x"] for row in own], [row["per_second"] for row in own])
        for (panel, name), own in group_by(mine, "panel", "curve").items()
        if len(own) > 1
    ]


def deviations(rows: Sequence[dict[str, Any]], curve: Curve) -> list[float]:
    """[m] Distance of the robot's end from that at the first point, at least a nanometre."""
    mine = group_by(rows, "figure", "panel", "curve")[curve.figure, curve.panel, curve.name]
    own = {row["x"]: row["final_x"] for row in mine}
    first, *others = (own[x] for x in curve.x)
    return [max(abs(other - first), 1e-9) for other in others]


def render(result: dict[str, Any]) -> dict[str, str]:
    """Return the parts by name."""
    rows = result["rows"]
    return {
        "measured": sentence(result["machine"], result["wall"]),
        "wheels": _exponents(curves(rows, "wheels"), (FLAT, STEP)),
        "stopped": _stopped(rows),
        "grousers": _exponents(curves(rows, "grousers"), (FLAT, STEP)),
        "points": _exponents(curves(rows, "points"), (CUT, BLOCKS)),
        "ratios": _ratios(rows),
        "threads": _speed_ups(result["threads"]),
        "accuracy": _accuracies(rows),
    }


_CELLS = (
    "Cells: ms per simulated second at the first and last point; exponent over all, the last two."
)


def _exponents(drawn: Sequence[Curve], panels: tuple[str, str]) -> str:
    """Write the ends and the exponents of the curves, both panels side by side."""
    found = {(curve.panel, curve.name): curve for curve in drawn}
    rows = table(
        {"model": name, **{panel: _ends(found.get((panel, name))) for panel in panels}}
        for name in dict.fromkeys(curve.name for curve in drawn)
    )
    return f"{_CELLS}\n\n{rows}"


def _ends(curve: Curve | None) -> str:
    if curve is None:
        return ""
    first, last = curve.per_second[0] * 1e3, curve.per_second[-1] * 1e3
    return f"{_short(first)} to {_short(last)}; {curve.slope:.2f}, {curve.last_slope:.2f}"


def _stopped(rows: Sequence[dict[str, Any]]) -> str:
    """Name the robots that the step stops, whose cost is that of a stopped robot."""
    at_step = (row for row in rows if (row["figure"], row["panel"]) == ("wheels", STEP))
    held = group_by((row for row in at_step if row["final_x"] < 0.0), "curve")
    names = [", ".join((name, *(f"{row['x']:g}" for row in own))) for name, own in held.items()]
    return f"Still in front of the step at the end: {'; '.join(names) or 'none'}."


def _ratios(rows: Sequence[dict[str, Any]]) -> str:
    """Compare the finest cuts of flat ground with ground in one piece."""
    own = {(row["curve"], row["x"]): row["per_second"] for row in rows if row["panel"] == CUT}
    most = max(x for _, x in own)
    names = [name for name, x in own if x == 1]
    endings = {"level": f", {LEVEL}", "rough": ""}
    cuts = {kind: end for kind, end in endings.items() if (names[0] + end, most) in own}
    return table(
        {"track": name, "whole": _short(own[name, 1] * 1e3)}
        | {kind: _short(own[name + end, most] * 1e3) for kind, end in cuts.items()}
        | {
            f"{kind} / whole": f"{own[name + end, most] / own[name, 1]:.2f}"
            for kind, end in cuts.items()
        }
        for name in names
    )


def _speed_ups(rows: Sequence[dict[str, Any]]) -> str:
    return table(
        {
            "threads": str(row["threads"]),
            "real time": f"{row['real_time']:,.0f}x",
            "speed-up": f"{row['worlds']:.2f}",
            "of a loop that counts": f"{row['loops']:.2f}",
        }
        for row in rows
    )


def _accuracies(rows: Sequence[dict[str, Any]]) -> str:
    drawn = curves(rows, "accuracy")
    off = [["", *(f"{1e3 * way:.2g}" for way in deviations(rows, curve))] for curve in drawn]
    return table(
        {
            "accuracy [um]": f"{accuracy * 1e6:g}",
            **{
                f"{curve.panel}, ms per simulated second": _short(curve.per_second[i] * 1e3)
                for curve in drawn
            },
            **{f"{curve.panel}, mm off": own[i] for curve, own in zip(drawn, off, strict=True)},
        }
        for i, accuracy in enumerate(drawn[0].x)
    )


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}"
