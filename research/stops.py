"""Why runs of the seizure study stopped, gear wheels compared with round ones, and replays."""

import math
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d.sweeps.axes import short_name
from crawler2d.sweeps.statistics import clustered
from research.tables import aligned_table, group_by, mm, percent

STOPS = tuple(str(outcome) for outcome in c2d.Outcome if outcome.is_stop)
"""Outcomes that are stops, by name."""

TRIALS = (
    *("closed track", "closed track, clear of the ground"),
    *("torque x 2", "friction x 2", "no belly"),
)
"""Trials that the study makes of every stop."""

FIGURES = (
    *("cleared", "stopped", "seized", "jammed"),
    *("freed_by_torque", "freed_by_friction", "unnatural_stops", "unnatural_passes"),
)
"""Counts of `Stops` by which gear and round wheels are compared."""

_PERCENTS = {
    "jammed": "jammed",
    "closed": "unnatural_stops",
    "torque": "freed_by_torque",
    "friction": "freed_by_friction",
    "no belly": "freed_by_no_belly",
}
"""Counts of `Stops` that are written as percentages of the stops, by their headings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stops:
    """Outcomes of the runs of one model on one obstacle, all heights together."""

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
    transient: int
    """Stops that the robot left by itself; they count as timed out."""
    mechanism: str
    """The commonest mechanism of the stops; "" if most have none."""
    of_mechanism: int
    """Number of stops with that mechanism."""
    jammed: int
    """Stops with ground between two bodies of a track bearing on it."""
    unnatural_stops: int
    """Stops from which a closed track gets free, in the same pose or moved clear of the ground."""
    freed_by_torque: int
    """Stops that twice the torque ends."""
    freed_by_friction: int
    """Stops that twice the friction ends."""
    freed_by_no_belly: int
    """Stops that removing the belly ends."""
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
class WheelRate:
    """Rate of an event for one model of a pair that differs only in its wheels."""

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
    """[-] Lower bound of the 95 % interval, with repeats as clusters."""
    high: float


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


class _Place(NamedTuple):
    """The coordinates of a run in the sweeps."""

    obstacle: str
    model: str
    height: float
    repeat: int

    def of(self, tables: Mapping[str, xarray.Dataset]) -> xarray.Dataset:
        """Return the run at these coordinates."""
        where = {"track": self.model, "height": self.height, "repeat": self.repeat}
        return tables[self.obstacle].sel(where)


def stops(table: xarray.Dataset, obstacle: str, belt: str = "belt") -> list[Stops]:
    """Count the outcomes of a sweep over track and height, with one row per model.

    Parameters
    ----------
    table : xarray.Dataset
        With the dimensions track, height and repeat, and the trials of `TRIALS`.
    obstacle : str
        The obstacle.
    belt : str
        The model that decides whether a run clears naturally.
    """
    return [
        _stops(table, obstacle, str(model), belt) for model in table["track"].to_numpy().tolist()
    ]


def compare_wheels(
    table: xarray.Dataset,
    obstacle: str,
    pairs: Mapping[str, str],
    robot: str = "preset",
    belt: str = "belt",
) -> list[WheelRate]:
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
    list of WheelRate
        Round and gear wheels of each pair, and of all pairs together.
    """
    # Runs of one repeat have the same draws at all heights and for all models, so they are a
    # cluster.
    repeats = [
        {row.model: row for row in stops(table.isel(repeat=[k]), obstacle, belt)}
        for k in range(table.sizes["repeat"])
    ]
    groups = [(name, [name]) for pair in pairs.items() for name in reversed(pair)]
    groups += [("all of these", list(names)) for names in (pairs.values(), pairs.keys())]
    wheels = ("round", "gear") * (len(pairs) + 1)
    rates = []
    for (name, own), wheel in zip(groups, wheels, strict=True):
        runs = [sum(rows[each].count for each in own) for rows in repeats]
        for figure in FIGURES:
            times = [sum(getattr(rows[each], figure) for each in own) for rows in repeats]
            rates.append(
                WheelRate(
                    robot=robot,
                    obstacle=obstacle,
                    model=name,
                    wheel=wheel,
                    figure=figure,
                    found=sum(times),
                    count=sum(runs),
                    **clustered(times, runs)._asdict(),
                )
            )
    return rates


def write_replays(
    tables: Mapping[str, xarray.Dataset],
    folder: Path,
    belt: str = "belt",
    threads: int | None = None,
) -> list[Replay]:
    """Simulate the clearest runs again, and write each as a page.

    There is one run for each outcome and mechanism of a stop, and the belt where it cleared what
    stopped the first of these. The clearest run is one from which a closed track gets free and,
    among these, the one with the deepest edge.

    Parameters
    ----------
    tables : mapping of str to xarray.Dataset
        Sweeps over track and height by obstacle, with the trials of `TRIALS`.
    folder : Path
        Folder for the pages; created if missing. Pages of earlier studies are removed.
    belt : str
        The model that is a belt.
    threads : int, optional
        See `simulate_many`.
    """
    chosen = _clearest(tables)
    twins = [place._replace(model=belt) for place in chosen]
    chosen += [each for each in twins if each.of(tables)["outcome"].item() == "cleared"][:1]
    scenarios = [c2d.Scenario.from_json(place.of(tables)["scenario"].item()) for place in chosen]
    runs = c2d.simulate_many(scenarios, trials="auto", threads=threads)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.html"):
        old.unlink()
    replays = []
    for place, run in zip(chosen, runs, strict=True):
        outcome, mechanism = str(run.outcome), str(run.mechanism or "")
        names = (place.model, place.obstacle, outcome, mechanism)
        file = "-".join(re.sub(r"\W+", "_", name) for name in names if name) + ".html"
        run.to_html(folder / file)
        replays.append(
            Replay(
                file=file,
                **place._asdict(),
                outcome=outcome,
                mechanism=mechanism,
                sentence=str(run.diagnosis or ""),
            )
        )
    return replays


def stops_text(stops: Iterable[Stops]) -> str:
    """Write the outcomes of each model, and the mechanisms of stops."""
    rows = (
        {
            "model": row.model,
            "obstacle": row.obstacle,
            "runs": str(row.count or "-"),
            "cleared": str(row.cleared or "-"),
            **{name.replace("_", " "): str(getattr(row, name) or "-") for name in STOPS},
            "mechanism": f"{row.mechanism or 'none'}, {row.of_mechanism}" if row.stopped else "-",
            **{
                f"{what} [%]": percent(getattr(row, name) / row.stopped) if row.stopped else "-"
                for what, name in _PERCENTS.items()
            },
            "passes": str(row.unnatural_passes or "-"),
            "depth [mm]": "-" if math.isnan(row.depth) else mm(row.depth, 1),
            "roots [mm]": "-" if math.isnan(row.root_depth) else mm(row.root_depth, 1),
        }
        for row in stops
    )
    return (
        "How the runs ended, all heights together. Of those that stopped: the commonest\n"
        "mechanism; the share with ground jammed in a track; the share that a closed track frees,\n"
        "in the pose of the stop or set down clear of the ground; and those that twice the\n"
        "torque, twice the friction and taking the belly off free, all by trial. Passes are\n"
        "unnatural ones: the belt of the same repeat did not clear. Depths are medians of the\n"
        "edges that seized, below the circumscribed circles and below the root circles.\n\n"
    ) + aligned_table(rows, left=("obstacle", "mechanism"))


def wheels_text(rates: Sequence[WheelRate]) -> str:
    """Compare gear wheels with round ones, two rows per pair, with their intervals."""
    rows = (
        {
            "model": model,
            "robot": robot,
            "wheels": wheel,
            "runs": str(own[0].count),
            **{
                row.figure.replace("_", " "): f"{percent(row.rate)}"
                f" ({percent(row.low)} to {percent(row.high)})"
                for row in own
            },
        }
        for (robot, model, wheel), own in group_by(rates, "robot", "model", "wheel").items()
    )
    obstacle = rates[0].obstacle
    return (
        f"Gear wheels beside round ones on {obstacle}s, all heights together: shares of all runs\n"
        "[%], with 95 % intervals of repeats. Freed by: twice the torque, twice the friction.\n"
        "Unnatural: stops that a closed track leaves, passes where the belt does not get over.\n\n"
    ) + aligned_table(rows, left=("robot", "wheels"))


def replays_text(replays: Iterable[Replay], folder: str) -> str:
    """Write which runs can be replayed, and the diagnosis of each."""
    lines = []
    for replay in replays:
        place = f"{replay.obstacle} of {mm(replay.height)} mm, repeat {replay.repeat}"
        lines.append(f"{folder}/{replay.file}")
        lines.append(textwrap.indent(f"{replay.model}, {place}:", "    "))
        lines += textwrap.wrap(
            replay.sentence or replay.outcome, 92, initial_indent="    ", subsequent_indent="    "
        )
    return "Runs to look at: one per kind of stop, and a belt:\n\n" + "\n".join(lines)


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
        count=sum(counts[each] for each in c2d.Outcome),
        cleared=counts["cleared"],
        **{name: counts[name] for name in STOPS},
        mechanism=str(mechanism),
        of_mechanism=most,
        transient=_count(own["transient"].to_numpy()),
        jammed=_count(own["jammed"].to_numpy() & stopped),
        unnatural_stops=_count(np.logical_or(*(freed(name) for name in TRIALS[:2]))),
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


def _clearest(tables: Mapping[str, xarray.Dataset]) -> list[_Place]:
    """Choose one run for each outcome and mechanism of a stop."""
    best: dict[tuple[str, str], tuple[tuple[bool, float], _Place]] = {}
    for obstacle, table in tables.items():
        outcomes = table["outcome"].to_numpy()
        for index in np.argwhere(np.isin(outcomes, STOPS)):
            run = table.isel(dict(zip(table["outcome"].dims, map(int, index), strict=True)))
            ending = (run["outcome"].item(), run["mechanism"].item())
            freed = any(run[f"freed_by_{short_name(trial)}"].item() for trial in TRIALS[:2])
            clarity = (freed, run["intrusion_depth"].item())
            # The last of equal runs: models with wheels come after force tracks.
            if ending not in best or clarity >= best[ending][0]:
                where = (run[name].item() for name in ("track", "height", "repeat"))
                best[ending] = (clarity, _Place(obstacle, *where))
    endings = sorted(best, key=lambda ending: (STOPS.index(ending[0]), ending[1]))
    return [best[ending][1] for ending in endings]
