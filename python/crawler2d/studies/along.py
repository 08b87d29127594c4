"""The range of an unknown: all fields of its path move along it together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from crawler2d.errors import raise_first
from crawler2d.parameters.paths import is_whole, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.boundary import POINTS, Line
from crawler2d.studies.campaign import Campaign, Counts
from crawler2d.variation.draws import Variation

__all__ = ["Range", "check_ends", "line_over", "range_of"]

_TAIL = 0.01
"""[-] Of an unbounded distribution, how much of each end is left out of its range."""

_NARROW = 0.01
"""[-] Width of a bracket, as a share of the range."""


@dataclass(frozen=True, slots=True)
class Range:
    """The values of one unknown, from end to end.

    Attributes
    ----------
    cell : Scenario
        With its own values.
    ends : mapping of str to pair of float
        By path of a field.
    """

    cell: Scenario
    ends: Mapping[str, tuple[float, float]]

    @property
    def own(self) -> float:
        """The scenario's own value of the first field."""
        return float(read_path(self.cell, next(iter(self.ends))))

    @property
    def first(self) -> tuple[float, float]:
        """The ends of the first field, which tells where the others are."""
        return next(iter(self.ends.values()))

    @property
    def is_line(self) -> bool:
        """Whether there is a boundary to look for: not of whole numbers, nor of a single value."""
        low, high = self.first
        return low < high and not any(is_whole(self.cell, field) for field in self.ends)

    def at(self, value: float) -> Scenario:
        """Return the scenario with this value of the first field."""
        low, high = self.first
        share = (value - low) / (high - low)
        moved = {
            field: value if ends == self.first else ends[0] + share * (ends[1] - ends[0])
            for field, ends in self.ends.items()
        }
        return self.cell.replace(moved)


def range_of(unknowns: Variation, path: str, cell: Scenario) -> Range:
    """Take the ends of a distribution, the lower one of the first field first.

    Parameters
    ----------
    unknowns : Variation
        What is not known.
    path : str
        Which of them.
    cell : Scenario
        Whose own values count.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> unknowns = Variation.of(base, {"robot.mass": c2d.scaled(0.5, 2.0)}, [])
    >>> range_of(unknowns, "robot.mass", base).first
    (10.6, 42.4)
    """
    alone = replace(unknowns, distributions={path: unknowns.distributions[path]})
    drawn = alone.draw(cell, {path: np.array([0.0, 1.0])})
    if not all(np.isfinite(values).all() for values in drawn.values.values()):
        drawn = alone.draw(cell, {path: np.array([_TAIL, 1.0 - _TAIL])})
    low, high = drawn.shown[path]
    order = (0, 1) if low <= high else (1, 0)
    ends = {f: (float(v[order[0]]), float(v[order[1]])) for f, v in drawn.values.items()}
    return Range(cell, ends)


def check_ends(study: Campaign, over: Range, names: tuple[str, str]) -> None:
    """Raise the rule that an end of a range breaks, before anything is simulated."""
    model, name = names
    for value in over.first if over.is_line else ():
        worlds = study.planner.worlds(over.at(value), (model, f"{name}={value:g}"))
        raise_first(world.checked for world in worlds)


def line_over(study: Campaign, over: Range, names: tuple[str, str], counts: Counts) -> Line | None:
    """Look where the rate passes one half over a range; None if that is no line."""
    if not over.is_line:
        return None
    low, high = over.first
    line = Line(study, names, over.at, counts)
    line.add(np.linspace(low, high, POINTS).tolist())
    line.narrow(_NARROW * (high - low))
    return line
