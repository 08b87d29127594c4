"""Find the cells: heights at which some runs clear and some do not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from benches.engines.cells import Cell
from benches.engines.robots import MODELS
from crawler2d.runs.batch import simulate_many

__all__ = ["scanned"]

_HEIGHTS = (0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.4, 1.6, 1.8)
"""[-] times the radius, for a first look."""

_RUNS = 8
_FEW, _MANY = 0.2, 0.8
_HALVINGS = 4
_FRICTIONS = (0.7, 0.85, 0.55, 1.0)

_GIVEN = {
    ("step", "6 N m, track"): (0.0496, 0.7),
    ("step", "6 N m, servos"): (0.0256, 0.85),
    ("step", "60 N m, track"): (0.052, 0.55),
    ("step", "60 N m, servos"): (0.0256, 1.0),
    ("knife edge", "6 N m, servos"): (0.0256, 0.7),
    ("knife edge", "60 N m, servos"): (0.03, 1.0),
    ("oblique edge", "60 N m, track"): (0.03, 0.7),
    ("one-sided edge", "60 N m, track"): (0.03, 0.7),
}
"""Height [m] and friction of 24 gears, whose runs take too long for a search: those of the steps
were found by one with the first of the robots, the others are given."""

_SLOW = "24 gears"
_OTHERS = ("line of 3", "line of 5", "line of 9", "5 gears")
_PAPER = (
    ("knife edge", 0.04),
    ("step", 0.05),
    ("step", 0.075),
    ("step", 0.1),
    ("step field", 0.025),
)
"""Grounds, and [m] their heights, at the settings of the public model."""


def wanted() -> Iterator[Cell]:
    """Yield what cells are to be found for, their height and friction still open.

    On two lanes 24 gears are on one motor a track: with servos their runs take minutes there.
    """
    usual = [model for model in MODELS if model != "public 3"]
    for model, robot in product(usual, ("engineer", "engineer, ahead")):
        for drive in ("6 N m, track", "6 N m, servos", "60 N m, track", "60 N m, servos"):
            yield _open("plane", robot, model, drive, "step")
        for drive in ("6 N m, servos", "60 N m, servos"):
            yield _open("plane", robot, model, drive, "knife edge")
    for robot, model, ground in product(("absolem", "marv"), _OTHERS, ("step", "knife edge")):
        yield _open("plane", robot, model, "60 N m, servos", ground)
    for model, ground in product(usual, ("oblique edge", "one-sided edge")):
        drive = "60 N m, track" if model == _SLOW else "60 N m, servos"
        yield _open("space", "engineer", model, drive, ground)


def paper() -> Iterator[Cell]:
    """Yield the cells at the settings of the public simulation model.

    24 gears are on one motor a track of 60 N m, in other engines 74 N m a wheel: with such servos
    their runs take minutes.
    """
    for model in MODELS:
        drive = "60 N m, track" if model == _SLOW else "100 N m a wheel"
        for ground, height in _PAPER:
            cell = _open("paper", "engineer", model, drive, ground)
            yield replace(cell, height=height, friction=1.0)


def scanned() -> Iterator[tuple[Cell, float]]:
    """Yield each cell with its rate of clearing; a friction further where a first one has none."""
    for number, cell in enumerate(wanted()):
        if cell.model == _SLOW:
            height, friction = _GIVEN[cell.ground, cell.drive]
            given = replace(cell, height=height, friction=friction)
            yield given, _rate(given)
            continue
        first = number % len(_FRICTIONS)
        order = _FRICTIONS[first:] + _FRICTIONS[:first]
        found = [_search(replace(cell, friction=friction)) for friction in order[:1]]
        for friction in order[1:]:
            if _FEW <= found[-1][1] <= _MANY:
                break
            found.append(_search(replace(cell, friction=friction)))
        yield min(found, key=lambda each: abs(each[1] - 0.5))
    for cell in paper():
        yield cell, _rate(cell)


def _open(group: str, robot: str, model: str, drive: str, ground: str) -> Cell:
    return Cell(
        group=group,
        robot=robot,
        model=model,
        drive=drive,
        ground=ground,
        height=0.0,
        friction=0.0,
    )


def _search(cell: Cell) -> tuple[Cell, float]:
    """Return the cell at the height whose rate is nearest to one half, and that rate."""
    radius = cell.built().outline.front_radius
    looked: list[tuple[Cell, float]] = []
    for share in _HEIGHTS:
        looked.append(_look(cell, share * radius))
        if _FEW <= looked[-1][1] <= _MANY or looked[0][1] == 0.0:
            return looked[-1]  # what the lowest one stops is not tried at higher ones
        if len(looked) > 1 and _crosses(looked[-2:]):
            low, high = looked[-2:]
            for _ in range(_HALVINGS):
                middle = _look(cell, 0.5 * (low[0].height + high[0].height))
                looked.append(middle)
                if _FEW <= middle[1] <= _MANY:
                    return middle
                low, high = (low, middle) if _crosses((low, middle)) else (middle, high)
    return min(looked, key=lambda each: abs(each[1] - 0.5))


def _crosses(pair: Sequence[tuple[Cell, float]]) -> bool:
    return (pair[0][1] > 0.5) != (pair[1][1] > 0.5)


def _look(cell: Cell, height: float) -> tuple[Cell, float]:
    made = replace(cell, height=round(height, 4))
    return made, _rate(made)


def _rate(cell: Cell) -> float:
    runs = simulate_many(cell.scenarios(_RUNS), record="summary", threads=1)
    return sum(str(run.outcome) == "cleared" for run in runs) / _RUNS
