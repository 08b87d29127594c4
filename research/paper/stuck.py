"""Runs that stand for the paper's Figs. 4 and 5: wheels that seize on a sharp corner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.batch import simulate
from research.paper.layouts import READINGS
from research.paper.published import CWA_ROUND, LWA_ROUND

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from crawler2d.runs.run import Run
    from crawler2d.sweeps.found import Found

__all__ = ["Stuck", "stuck_runs", "write_stuck"]

_FIGURES = {4: LWA_ROUND, 5: CWA_ROUND}


@dataclass(frozen=True, slots=True, kw_only=True)
class Stuck:
    """A run that stands for a figure of the paper."""

    figure: int
    model: str
    where: str
    """Setting and obstacle, in words."""
    run: Run
    """With its history."""

    @property
    def file(self) -> str:
        """The name of its page."""
        return f"figure_{self.figure}.html"


def stuck_runs(tables: Mapping[str, Found]) -> list[Stuck]:
    """Take, for each figure, the first run that seized with an edge between two wheels.

    Parameters
    ----------
    tables : mapping of str to Found
        What was run over the parallelepiped of Table 3, by setting, with the dimensions `model`,
        `height` and `repeat`: a sharp corner on level ground, as in the figures.

    Returns
    -------
    list of Stuck
        Of the first setting in which there is one, the lowest height, the first repeat; a figure
        without such a run is left out.
    """
    layouts = {reading.row: reading.layout for reading in READINGS}
    found = []
    for number, row in _FIGURES.items():
        for setting, table in tables.items():
            own = table.sel(model=layouts[row]).transpose("height", "repeat", ...)
            held = (own["outcome"] == "seized") & (own["stop_carrier"] == "chassis")
            places = np.argwhere(held.to_numpy())
            if places.size:
                height, repeat = places[0]
                one = own.isel(height=height, repeat=repeat)
                run = simulate(Scenario.from_json(one["scenario"].item()))
                where = f"{setting}, block of {1e3 * one['height'].item():.0f} mm"
                found.append(Stuck(figure=number, model=layouts[row], where=where, run=run))
                break
    return found


def write_stuck(found: list[Stuck], folder: Path) -> None:
    """Write each run as a page that replays it."""
    folder.mkdir(parents=True, exist_ok=True)
    for stuck in found:
        stuck.run.to_html(folder / stuck.file)
