"""The stops of the seizure study as text for a terminal: causes, and runs to look at."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from research.columns import aligned, mm
from research.stops import STOPS

if TYPE_CHECKING:
    from research.replays import Replay
    from research.stops import Against, Stops

__all__ = ["against_text", "replays_text", "stops_text"]


_SHARES = (
    *("jammed", "unnatural_stops", "freed_by_torque"),
    *("freed_by_friction", "freed_by_no_belly"),
)
"""Counts of `Stops` that are told as shares of the stops."""


def stops_text(stops: Iterable[Stops]) -> str:
    """Write how the runs of each model ended, and what held those that stopped."""
    rows = [
        (
            row.model,
            row.obstacle,
            *(str(n) if n else "-" for n in (row.count, row.cleared)),
            *(str(getattr(row, name) or "-") for name in STOPS),
            f"{row.mechanism or 'none'}, {row.of_mechanism}" if row.stopped else "-",
            *(_of_stops(getattr(row, name), row) for name in _SHARES),
            str(row.unnatural_passes or "-"),
            *("-" if math.isnan(d) else f"{1e3 * d:.1f}" for d in (row.depth, row.root_depth)),
        )
        for row in stops
    ]
    head = (
        *("model", "obstacle", "runs", "cleared"),
        *(name.replace("_", " ") for name in STOPS),
        *("mechanism", "jammed [%]", "closed [%]", "torque [%]", "friction [%]", "no belly [%]"),
        "passes",
        *("depth [mm]", "roots [mm]"),
    )
    return (
        "How the runs ended, all heights together. Of those that stopped: the commonest\n"
        "mechanism; the share with ground jammed in a track; the share that a closed track frees,\n"
        "in the pose of the stop or set down clear of the ground; and those that twice the\n"
        "torque, twice the friction and taking the belly off free, all by trial. Passes are\n"
        "unnatural ones: the belt of the same repeat did not clear. Depths are medians of the\n"
        "edges that seized, below the circumscribed circles and below the root circles.\n\n"
    ) + aligned(head, rows, left=(1, 9))


def against_text(against: Sequence[Against]) -> str:
    """Write gear wheels beside round ones, two rows per pair, with their intervals."""
    rows: dict[tuple[str, str, str], list[str]] = {}
    for row in against:
        cells = rows.setdefault((row.robot, row.model, row.wheel), [str(row.count)])
        cells.append(f"{100 * row.rate:.0f} ({100 * row.low:.0f} to {100 * row.high:.0f})")
    figures = dict.fromkeys(row.figure.replace("_", " ") for row in against)
    head = ("model", "robot", "wheels", "runs", *figures)
    obstacle = against[0].obstacle
    return (
        f"Gear wheels beside round ones on {obstacle}s, all heights together: shares of all runs\n"
        "[%], with 95 % intervals of repeats. Freed by: twice the torque, twice the friction.\n"
        "Unnatural: stops that a closed track leaves, passes where the belt does not get over.\n\n"
    ) + aligned(
        head,
        [(model, robot, wheel, *cells) for (robot, model, wheel), cells in rows.items()],
        left=(1, 2),
    )


def replays_text(replays: Iterable[Replay], folder: str) -> str:
    """Write which runs can be replayed, and the diagnosis of each."""
    said = []
    for replay in replays:
        place = f"{replay.obstacle} of {mm(replay.height)} mm, repeat {replay.repeat}"
        why = replay.sentence or replay.outcome
        said.append(f"{folder}/{replay.file}")
        said.append(textwrap.indent(f"{replay.model}, {place}:", "    "))
        said += textwrap.wrap(why, 92, initial_indent="    ", subsequent_indent="    ")
    return "Runs to look at: one per kind of stop, and a belt:\n\n" + "\n".join(said)


def _of_stops(count: int, row: Stops) -> str:
    return f"{100 * count / row.stopped:.0f}" if row.stopped else "-"
