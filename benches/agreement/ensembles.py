"""Cells of the study whose runs end unlike on gears and small wheels, over many starts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from benches.agreement.passing import counts, who_gets_over
from benches.agreement.study import STUDY, at_height, read_cells
from benches.engines.telling import tell
from crawler2d.parameters.settings import Solver, Start
from crawler2d.sweeps.statistics import newcombe_paired
from research.markdown import markdown_table

__all__ = ["ENSEMBLES", "ensembles", "ensembles_table"]

ENSEMBLES = Path(__file__).with_name("ensembles.json")
_SOLVERS = {
    "own": Solver(),
    "own, finer": Solver(accuracy=3e-8),
    "rapier": Solver(engine="rapier"),
}
"""The default accuracy and a tenth of it, and rapier's usual step."""
_APPROACH = 0.1  # [m]
_PITCH = 0.048  # [m] of the Engineer's grousers


def ensembles(starts: int, study: Path = STUDY, path: Path = ENSEMBLES) -> None:
    """Make runs of each such cell whose starts are spread evenly over a grouser pitch.

    Nothing else is drawn: the pairs differ by how the robot meets the edge. On from where it
    stopped.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    found: list[dict[str, Any]] = json.loads(path.read_text("utf-8")) if path.exists() else []
    there = [_key(each) for each in found]
    for cell in read_cells(study):
        if _key(cell) in there or not _some_end_unlike(cell):
            continue
        base = at_height(cell["model"], cell["obstacle"], cell["height"])
        spread = _PITCH * (np.arange(starts) + 0.5) / starts
        over = [base.replace({"start": Start(approach=float(a))}) for a in _APPROACH + spread]
        gets = who_gets_over(over, _SOLVERS)
        found.append({**dict(zip(_KEY, _key(cell), strict=True)), "gets_over": gets})
        path.write_text(json.dumps(found) + "\n", encoding="utf-8")
        tell(f"{_key(cell)}: {[sum(each) for each in gets.values()]} of {starts}")


_KEY = ("model", "obstacle", "height")


def _key(cell: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(cell[name] for name in _KEY)


def _some_end_unlike(cell: dict[str, Any]) -> bool:
    own, other = ([end == "cleared" for end in ends] for ends in cell["ends"])
    return own != other


def ensembles_table(path: Path = ENSEMBLES) -> str:
    """Write how many runs of each cell get over, and how far the rates are apart."""
    if not path.exists():
        return "Not tried."
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
    names = list(found[0]["gets_over"])
    head = (*_KEY[:2], "mm", *names, "rapier less own [%]", "Chipmunk less own [%]")
    return markdown_table(head, [_row(cell) for cell in found])


def _row(cell: dict[str, Any]) -> tuple[str, ...]:
    gets = cell["gets_over"]
    return (
        cell["model"],
        cell["obstacle"],
        f"{1e3 * cell['height']:.0f}",
        *counts(gets),
        *(_gap(gets[name], gets["own"]) for name in ("rapier", "Chipmunk")),
    )


def _gap(first: list[bool], second: list[bool]) -> str:
    pairs = list(zip(first, second, strict=True))
    gap = newcombe_paired(
        pairs.count((True, True)),
        pairs.count((True, False)),
        pairs.count((False, True)),
        pairs.count((False, False)),
    )
    return f"{100 * gap.low:+.0f} to {100 * gap.high:+.0f}"
