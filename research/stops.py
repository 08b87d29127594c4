"""Why the runs of the seizure study stopped, and how gear wheels compare with round ones."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.results.outcome import Outcome
from crawler2d.sweeps.axes import short_name
from crawler2d.sweeps.statistics import clustered

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["FIGURES", "STOPS", "TRIED", "Against", "Stops", "gear_against_round", "stops"]

STOPS = tuple(str(outcome) for outcome in Outcome if outcome.is_stop)
"""Outcomes that are stops, by name."""

TRIED = (
    *("closed track", "closed track, clear of the ground"),
    *("torque x 2", "friction x 2", "no belly"),
)
"""Trials that the study makes of every stop."""

FIGURES = (
    *("cleared", "stopped", "seized", "jammed"),
    *("freed_by_torque", "freed_by_friction", "unnatural_stops", "unnatural_passes"),
)
"""Counts of `Stops` by which gear and round wheels are compared."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stops:
    """How the runs of one model on one obstacle ended, all heights together."""

    obstacle: str
    model: str
    count: int
    """Runs with a result."""
    cleared: int
    seized: int
    cycling: int
    hung_up: int
    stalled: int
    slipping: int
    passing: int
    """Stops that the robot left by itself; they count as timed out."""
    mechanism: str
    """The commonest mechanism of the stops; "" if most have none."""
    of_mechanism: int
    """Number of stops with that mechanism."""
    jammed: int
    """Stops with ground between two bodies of a track bearing on it."""
    unnatural_stops: int
    """Stops from which a closed track gets free, in their pose or set down clear of the ground."""
    freed_by_torque: int
    """Stops that twice the torque ends."""
    freed_by_friction: int
    """Stops that twice the friction ends."""
    freed_by_no_belly: int
    """Stops that taking the belly off ends."""
    depth: float
    """[m] Median depth of the edges in seized stops, below the circumscribed circles; nan: none."""
    root_depth: float
    """[m] The same, below the root circles."""
    unnatural_passes: int
    """Runs that cleared although the belt of the same repeat did not."""

    @property
    def stopped(self) -> int:
        """All stops."""
        return sum(getattr(self, name) for name in STOPS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Against:
    """How often something happened to one model of a pair that differs only in its wheels."""

    robot: str
    obstacle: str
    """The obstacle, all its heights together."""
    model: str
    wheel: str
    """"round" or "gear"."""
    figure: str
    """One of `FIGURES`."""
    found: int
    count: int
    """Runs with a result."""
    rate: float
    low: float
    """[-] Lower bound of the 95 % interval, of which the repeats are the clusters."""
    high: float


def stops(table: xarray.Dataset, obstacle: str, belt: str = "belt") -> list[Stops]:
    """Count how the runs of a sweep over track and height ended, one row per model.

    Parameters
    ----------
    table : xarray.Dataset
        With the dimensions track, height and repeat, and the trials of `TRIED`.
    obstacle : str
        What they ran over.
    belt : str
        The model that decides whether a pass is natural.
    """
    return [
        _stops(table, obstacle, str(model), belt) for model in table["track"].to_numpy().tolist()
    ]


def gear_against_round(
    table: xarray.Dataset,
    obstacle: str,
    pairs: Mapping[str, str],
    robot: str = "preset",
    belt: str = "belt",
) -> list[Against]:
    """Compare models with gear wheels with the same models with round ones.

    Parameters
    ----------
    table : xarray.Dataset
        See `stops`.
    obstacle, robot : str
        Names of the obstacle and of the robot.
    pairs : mapping of str to str
        From each model with gear wheels to the one with round wheels.
    belt : str
        See `stops`.

    Returns
    -------
    list of Against
        Round and gear wheels of each pair, and of all pairs together.
    """
    # Runs of one repeat share their draws, at all heights and of all models: a cluster.
    repeats = [
        {row.model: row for row in stops(table.isel(repeat=[k]), obstacle, belt)}
        for k in range(table.sizes["repeat"])
    ]
    groups = [(name, [name]) for gear, plain in pairs.items() for name in (plain, gear)]
    groups += [("all of these", list(names)) for names in (pairs.values(), pairs.keys())]
    wheels = ("round", "gear") * (len(pairs) + 1)
    found = []
    for (name, own), wheel in zip(groups, wheels, strict=True):
        counts = [sum(rows[each].count for each in own) for rows in repeats]
        for figure in FIGURES:
            times = [sum(getattr(rows[each], figure) for each in own) for rows in repeats]
            rate, low, high = clustered(times, counts)
            found.append(
                Against(
                    robot=robot,
                    obstacle=obstacle,
                    model=name,
                    wheel=wheel,
                    figure=figure,
                    found=sum(times),
                    count=sum(counts),
                    rate=rate,
                    low=low,
                    high=high,
                )
            )
    return found


def _stops(table: xarray.Dataset, obstacle: str, model: str, belt: str) -> Stops:
    own = table.sel(track=model)
    outcomes = own["outcome"].to_numpy()
    counts = Counter(outcomes.ravel().tolist())
    stopped, seized = np.isin(outcomes, STOPS), outcomes == "seized"
    mechanisms = Counter(own["mechanism"].to_numpy()[stopped].tolist())
    mechanism, most = mechanisms.most_common(1)[0] if mechanisms else ("", 0)
    passes = (outcomes == "cleared") & (table["outcome"].sel(track=belt).to_numpy() != "cleared")

    def freed(trial: str) -> NDArray[np.bool_]:
        by_trial: NDArray[np.bool_] = own[f"freed_by_{short_name(trial)}"].to_numpy() & stopped
        return by_trial

    return Stops(
        obstacle=obstacle,
        model=model,
        count=sum(counts[each] for each in Outcome),
        cleared=counts["cleared"],
        **{name: counts[name] for name in STOPS},
        mechanism=str(mechanism),
        of_mechanism=most,
        passing=_count(own["passing"].to_numpy()),
        jammed=_count(own["jammed"].to_numpy() & stopped),
        unnatural_stops=_count(np.logical_or(*(freed(name) for name in TRIED[:2]))),
        freed_by_torque=_count(freed("torque x 2")),
        freed_by_friction=_count(freed("friction x 2")),
        freed_by_no_belly=_count(freed("no belly")),
        depth=_median(own["intrusion_depth"].to_numpy()[seized]),
        root_depth=_median(own["intrusion_root_depth"].to_numpy()[seized]),
        unnatural_passes=_count(passes),
    )


def _count(chosen: NDArray[np.bool_]) -> int:
    return int(np.count_nonzero(chosen))


def _median(values: NDArray[np.float64]) -> float:
    return float(np.median(values)) if values.size else math.nan
