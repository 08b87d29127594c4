"""Replays of the clearest runs of the seizure study: one per kind of stop, and one of a belt."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.batch import simulate_many
from crawler2d.sweeps.axes import short_name
from research.stops import STOPS, TRIED

if TYPE_CHECKING:
    from pathlib import Path

    import xarray

__all__ = ["Replay", "write_replays"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """A run written as a page."""

    file: str
    model: str
    obstacle: str
    height: float
    """[m]"""
    repeat: int
    outcome: str
    mechanism: str
    """Mechanism of the stop; "" if there is none."""
    sentence: str
    """The sentence of the diagnosis; "" if the run did not stop."""


@dataclass(frozen=True, slots=True)
class _Place:
    """The place of a run in the sweeps."""

    obstacle: str
    model: str
    height: float
    repeat: int


def write_replays(
    tables: Mapping[str, xarray.Dataset],
    folder: Path,
    belt: str = "belt",
    threads: int | None = None,
) -> list[Replay]:
    """Simulate the clearest runs again, and write each as a page.

    One run for each outcome and mechanism of a stop; and the belt where it cleared what stopped
    the first of these. The clearest run is one that a closed track is freed from and, among these,
    the one with the deepest edge.

    Parameters
    ----------
    tables : mapping of str to xarray.Dataset
        Sweeps over track and height by obstacle, with the trials of `TRIED`.
    folder : Path
        Folder for the pages; created if missing. Pages of earlier studies are removed.
    belt : str
        The model that is a belt.
    threads : int, optional
        See `simulate_many`.
    """
    chosen = list(_most_telling(tables))
    chosen += list(_passes(tables, chosen, belt))[:1]
    scenarios = [Scenario.from_json(_of(tables, place)["scenario"].item()) for place in chosen]
    runs = simulate_many(scenarios, trials="auto", threads=threads)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.html"):
        old.unlink()
    found = []
    for place, run in zip(chosen, runs, strict=True):
        mechanism = "" if run.mechanism is None else str(run.mechanism)
        names = (place.model, place.obstacle, str(run.outcome), mechanism)
        file = "-".join(filter(None, (re.sub(r"\W+", "_", name) for name in names))) + ".html"
        run.to_html(folder / file)
        found.append(
            Replay(
                file=file,
                model=place.model,
                obstacle=place.obstacle,
                height=place.height,
                repeat=place.repeat,
                outcome=str(run.outcome),
                mechanism=mechanism,
                sentence="" if run.diagnosis is None else str(run.diagnosis),
            )
        )
    return found


def _most_telling(tables: Mapping[str, xarray.Dataset]) -> Iterator[_Place]:
    best: dict[tuple[str, str], tuple[tuple[bool, float], _Place]] = {}
    for obstacle, table in tables.items():
        outcomes = table["outcome"].to_numpy()
        for index in np.argwhere(np.isin(outcomes, STOPS)):
            run = table.isel(dict(zip(table["outcome"].dims, map(int, index), strict=True)))
            way = (run["outcome"].item(), run["mechanism"].item())
            belts = [run[f"freed_by_{short_name(trial)}"].item() for trial in TRIED[:2]]
            telling = (any(belts), run["intrusion_depth"].item())
            # Of equal runs the last: models with wheels come after the mere forces.
            if way not in best or telling >= best[way][0]:
                best[way] = (telling, _place(obstacle, run))
    order = {name: rank for rank, name in enumerate(STOPS)}
    for way in sorted(best, key=lambda way: (order[way[0]], way[1])):
        yield best[way][1]


def _passes(
    tables: Mapping[str, xarray.Dataset], stopped: list[_Place], belt: str
) -> Iterator[_Place]:
    for place in stopped:
        twin = _Place(place.obstacle, belt, place.height, place.repeat)
        if _of(tables, twin)["outcome"].item() == "cleared":
            yield twin


def _of(tables: Mapping[str, xarray.Dataset], place: _Place) -> xarray.Dataset:
    where: dict[str, Any] = {"track": place.model, "height": place.height, "repeat": place.repeat}
    return tables[place.obstacle].sel(where)


def _place(obstacle: str, run: xarray.Dataset) -> _Place:
    return _Place(
        obstacle, str(run["track"].item()), run["height"].item(), int(run["repeat"].item())
    )
