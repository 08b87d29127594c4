"""The study's runs on lines of round wheels that end unlike, made again one by one."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import crawler2d as c2d
from benches.agreement.pairs import finer
from benches.agreement.study import STUDY, at_height, read_cells
from benches.agreement.third import in_chipmunk
from benches.engines.telling import tell
from crawler2d.parameters.scenario import Scenario
from research.markdown import markdown_table

__all__ = ["ONE_BY_ONE", "one_by_one", "one_by_one_table"]

ONE_BY_ONE = Path(__file__).with_name("one_by_one.json")


def one_by_one(study: Path = STUDY, path: Path = ONE_BY_ONE) -> None:
    """Make each of these runs again, and keep how they end.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    found: list[dict[str, Any]] = []
    path.write_text(json.dumps(found) + "\n", encoding="utf-8")
    for cell in read_cells(study):
        ends = list(zip(*cell["ends"], strict=True))
        unlike = [k for k, end in enumerate(ends) if end.count("cleared") == 1]
        if not unlike or not _is_round_line(cell["model"]):
            continue
        base = at_height(cell["model"], cell["obstacle"], cell["height"])
        draws = _draws(base, cell["height"], len(ends))
        for k in unlike:
            found.append(_again(cell, k, base.replace({field: v[k] for field, v in draws.items()})))
            path.write_text(json.dumps(found) + "\n", encoding="utf-8")
            tell(f"{cell['model']}, {cell['obstacle']} of {1e3 * cell['height']:.0f} mm, run {k}")


def _is_round_line(model: str) -> bool:
    return model.startswith("line") and "gear" not in model


def _draws(base: Scenario, height: float, repeats: int) -> dict[str, list[float]]:
    """Give what a sweep draws, by path: it depends on the repeat alone."""
    table = c2d.sweep(base, {"terrain.height": [height]}, repeats=repeats)
    drawn = [column for name, column in table.data_vars.items() if str(name).startswith("drawn_")]
    return {column.attrs["path"]: column.values.ravel().tolist() for column in drawn}


def _again(cell: dict[str, Any], number: int, scenario: Scenario) -> dict[str, Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        check = c2d.simulate(scenario, record="summary", trials=None).cross_check()
        return {
            **{name: cell[name] for name in ("model", "obstacle", "height")},
            "run": number,
            "own": str(check.run.outcome),
            "rapier": str(check.other.outcome),
            "finer": finer(scenario),
            "Chipmunk": in_chipmunk(scenario),
            "holds": [None if each is None else each.holds for each in check.balances],
        }


def one_by_one_table(path: Path = ONE_BY_ONE) -> str:
    """Write these runs, one a row."""
    if not path.exists():
        return "Not tried."
    head = (
        *("model", "obstacle", "mm", "own", "own, finer", "own, steps of 0.05 ms", "rapier"),
        *("rapier, finer", "Chipmunk", "the stop is an equilibrium"),
    )
    return markdown_table(head, [_row(each) for each in json.loads(path.read_text("utf-8"))])


def _row(each: dict[str, Any]) -> tuple[str, ...]:
    held = [hold for hold in each["holds"] if hold is not None]
    return (
        *(each["model"], each["obstacle"], f"{1e3 * each['height']:.0f}"),
        *(each["own"], each["finer"]["own"], each["finer"]["fixed"]),
        *(each["rapier"], each["finer"]["rapier"], each["Chipmunk"]),
        ", ".join("yes" if hold else "no" for hold in held),
    )
