"""Tables of the pairs: who ends alike, how far stops are apart, and what tells who is right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benches.agreement.drawing import MODELS
from crawler2d.sweeps.statistics import wilson
from research.markdown import markdown_table

__all__ = ["parts"]

_NEAR = 1e-3  # [m]
Pair = dict[str, Any]


def parts(pairs: Sequence[Pair], third: Mapping[str, str]) -> dict[str, str]:
    """Write the tables of a page, by name; a third engine's ends are by the robot's number."""
    return {"models": _by_model(pairs), "unlike": _unlike(pairs, third)}


def _by_model(pairs: Sequence[Pair]) -> str:
    head = (
        *("model", "robots", "same: gets over or not", "same outcome", "both stop"),
        *("within 1 mm", "apart [mm]: median, 90th", "turned [mrad]: median, 90th"),
        "no equilibrium: own, rapier",
    )
    groups = [(model, [p for p in pairs if p["model"] == model]) for model in MODELS]
    return markdown_table(head, [_row(*group) for group in [*groups, ("all", list(pairs))]])


def _row(name: str, pairs: list[Pair]) -> tuple[str, ...]:
    alike = sum(_same(pair, "gets_over") for pair in pairs)
    named = sum(_same(pair, "outcome") for pair in pairs)
    stops = [pair for pair in pairs if all(end["stops"] for end in pair["ends"])]
    near = sum(pair["apart"] < _NEAR for pair in stops)
    unheld = [sum(pair["balances"][k] is False for pair in pairs) for k in (0, 1)]
    return (
        name,
        str(len(pairs)),
        _share(alike, len(pairs)),
        _share(named, len(pairs)),
        str(len(stops)),
        str(near),
        _spread([1e3 * pair["apart"] for pair in stops]),
        _spread([1e3 * abs(pair["turn"]) for pair in stops]),
        ", ".join(map(str, unheld)),
    )


def _same(pair: Pair, what: str) -> bool:
    one, other = (end[what] for end in pair["ends"])
    return bool(one == other)


def _share(count: int, of: int) -> str:
    if not of:
        return ""
    found = wilson(count, of)
    return f"{count} ({100 * found.low:.0f} to {100 * found.high:.0f} %)"


def _spread(values: list[float]) -> str:
    if not values:
        return ""
    median, ninth = np.quantile(values, (0.5, 0.9))
    return f"{median:.2g}, {ninth:.2g}"


def _unlike(pairs: Sequence[Pair], third: Mapping[str, str]) -> str:
    head = (
        *(
            "robot",
            "model",
            "own",
            "own, finer",
            "own, fixed steps",
            "rapier",
            "rapier, finer",
            "Chipmunk",
        ),
        *("the stop is an equilibrium", "rapier sinks in by [mm]"),
    )
    rows = [
        (
            str(pair["number"]),
            pair["model"],
            pair["ends"][0]["outcome"],
            pair["finer"]["own"],
            pair["finer"]["fixed"],
            pair["ends"][1]["outcome"],
            pair["finer"]["rapier"],
            third.get(str(pair["number"]), ""),
            ", ".join("yes" if held else "no" for held in pair["balances"] if held is not None),
            f"{1e3 * pair['ends'][1]['penetration']:.2g}",
        )
        for pair in pairs
        if "finer" in pair
    ]
    return markdown_table(head, rows)
